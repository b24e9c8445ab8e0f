#pragma once
#include "src/constraints/edge_constraints.hpp"
#include "src/filters/velocity_filter.hpp"
#include "src/linear/solver_options.hpp"

#include <functional>
#include <string_view>

namespace taut {

/// A step whose end positions x and tensions mu = h^2 lambda are sought together [G07 section 4]: what the
/// methods that keep to x = x0 - W J^T mu share. x0 is where the vertices would be without any tension. The
/// candidate has that carried from the last step in it, mu_c, as an implicit force: x0 = x + W J(x)^T mu_c;
/// without carried tension x0 is the candidate.
class ConstrainedStep {
public:
  /// `cloth` must outlive the step.
  ConstrainedStep(const Cloth& cloth, const config::Inextensibility& options);

  /// x, mu and x0 from the candidate. `start` must outlive the step. Collective.
  void begin(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);

  /// Calls `iterate(strain)`, which improves x and mu, at least once, until the largest strain is within the
  /// limit and `is_settled()`, with the constraints evaluated at x. `method` is for messages. Collective.
  FilterReport solve(std::string_view method, const std::function<SolveReport(double strain)>& iterate,
                     const std::function<bool()>& is_settled);

  /// Velocities and tensions of the candidate from x and mu. Not collective.
  void end(Candidate& candidate) const;

  /// x <- x - W J^T d_mu with the gradients given; ghosts current. Collective over neighbours.
  void pull(std::span<const Vec3> gradients, std::span<const double> d_mu);

  bool is_free(Local vertex) const { return constraints.inverse_mass()[vertex] > 0; }
  const DistributedMesh& mesh() const { return constraints.cloth().mesh; }

  EdgeConstraints constraints; ///< evaluated at x whenever `solve` iterates
  std::vector<Vec3> free;      ///< x0, of local vertices
  std::vector<Vec3> x;         ///< of local vertices
  std::vector<double> mu;      ///< of local edges

private:
  config::Inextensibility options_;
  const State* start_ = nullptr;
  double dt_ = 0;
};

} // namespace taut
