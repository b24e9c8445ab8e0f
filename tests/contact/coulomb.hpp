#pragma once
// Whether what contacts rub is in Coulomb's cone of what presses them.
#include "src/time/simulation.hpp"

#include <algorithm>

namespace taut::test {

/// Watches every contact of every step.
class CoulombCheck : public Observer {
public:
  CoulombCheck(const Simulation& simulation, const Case& input)
      : comm_(simulation.cloth().mesh.comm), cloth_vertices_(simulation.cloth().mesh.vertices.total),
        on_cloth_(input.contact.value_or(config::Contact{}).friction) {
    const Obstacles& obstacles = simulation.obstacles();
    friction_.resize(obstacles.vertices());
    for (const Element& e : obstacles.elements())
      for (int k = 0; k < e.corners; ++k) friction_[e.vertices[k]] = obstacles.body(e.body).friction;
    for (const Obstacles::Plane& p : obstacles.planes()) friction_[p.point] = obstacles.body(p.body).friction;
  }

  void after_step(const State& state, const StepRecord&) override {
    double sums[2] = {0, 0}; // N, number
    for (const auto& [key, entry] : state.multipliers.contacts) sums[0] += entry.pressed.normal, ++sums[1];
    sum_in_place(comm_, sums);
    for (const auto& [key, entry] : state.multipliers.contacts) {
      const auto& [normal, tangent] = entry.pressed;
      if (normal * sums[1] <= 1e-3 * sums[0]) continue; // N; nothing to speak of
      const double most = friction_of(key) * normal, ratio = tangent.norm() / std::max(most, 1e-9 * normal);
      ++contacts_;
      beyond_ += ratio > 1.05;
      largest_ = std::max(largest_, ratio);
    }
  }

  /// Collective, as the next two.
  double largest() const { return max_over(comm_, largest_); } ///< times Coulomb's force
  Global beyond() const { return sum_over(comm_, beyond_); }   ///< contacts, each in each step
  Global contacts() const { return sum_over(comm_, contacts_); }

private:
  double friction_of(const ContactKey& key) const {
    const Global highest = *std::max_element(key.begin(), key.end());
    return highest < cloth_vertices_ ? on_cloth_ : friction_[std::size_t(highest - cloth_vertices_)];
  }

  MPI_Comm comm_;
  Global cloth_vertices_;
  double on_cloth_;
  std::vector<double> friction_; ///< of the vertices of obstacles
  double largest_ = 0;
  Global beyond_ = 0, contacts_ = 0;
};

} // namespace taut::test
