#pragma once
#include "partition/yarns.hpp"
#include "src/linear/solver_options.hpp"
#include "src/state/freedom.hpp"

#include <functional>
#include <memory>

namespace taut {

/// The system of one fast-projection iteration, (S + diag a) mu = b with S = J W J^T [G07 eq. 7, scaled by
/// h^2]: one row per constrained edge, J the constraint gradients, W the inverse vertex masses. Its pattern
/// never changes; it is assembled straight from the edges, every rank its own rows, without communication.
///
/// PETSc prefix `-projection_`. `cg` uses the preconditioner `yarn`; `mumps` factorises.
class ProjectionSystem {
public:
  /// `mesh` must outlive the system. Collective.
  ProjectionSystem(const DistributedMesh& mesh, const SolverOptions& options);
  ~ProjectionSystem();

  /// W = S_i / m_i: `gradient[e]` is the derivative of constraint e by its second vertex (minus that by its
  /// first), for all local edges; `inverse_mass` is 1 / m_i, or 0 at vertices that may not move, for all
  /// local vertices; `scaled_compliance` is a, for owned edges. An edge that no motion changes gets the row
  /// mu = b: give it 0. Collective.
  void assemble(std::span<const Vec3> gradient, std::span<const double> inverse_mass, const Freedom& freedom,
                std::span<const double> scaled_compliance);

  /// The same with S_i = I for all vertices.
  void assemble(std::span<const Vec3> gradient, std::span<const double> inverse_mass,
                std::span<const double> scaled_compliance);

  /// As above for S = J' W J^T with other gradients `rows` in J' than in J, `columns`; the options must say
  /// that the matrix is not symmetric. The preconditioner `yarn` is that of J W J^T. Collective.
  void assemble(std::span<const Vec3> rows, std::span<const Vec3> columns,
                std::span<const double> inverse_mass, const Freedom& freedom,
                std::span<const double> scaled_compliance);

  /// Solves for `mu` (owned part; ghosts are updated) to the relative tolerance `tolerance` in the natural
  /// norm. `rhs` holds owned edges; it may be `mu`. Collective.
  SolveReport solve(std::span<const double> rhs, double tolerance, std::vector<double>& mu);

  /// product = A mu over owned edges; may be collective.
  using Operator = std::function<void(std::span<const double> mu, std::span<double> product)>;

  /// As `solve`, for a symmetric positive definite A of which the assembled matrix only makes the
  /// preconditioner; `added_to_inverse`, of owned edges, is added to the diagonal of that. The options must
  /// say cg. Collective.
  SolveReport solve(const Operator& a, std::span<const double> rhs, double tolerance, std::vector<double>& mu,
                    std::span<const double> added_to_inverse = {});

  /// Of the mesh; they live as long as the system.
  const Yarns& yarns() const;

  /// product = (S + diag a) mu over owned edges. Collective over neighbours.
  void multiply(std::span<const double> mu, std::span<double> product);

private:
  struct Petsc;
  const DistributedMesh& mesh_;
  std::unique_ptr<Petsc> petsc_;
};

} // namespace taut
