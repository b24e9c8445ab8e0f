#pragma once
// The mixed mesh with every force there is, in states far from rest.
#include "src/forces/air_drag.hpp"
#include "src/forces/bending.hpp"
#include "src/forces/carried_tension.hpp"
#include "src/forces/gravity.hpp"
#include "src/forces/shear.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace taut::test {

inline const config::Material material = [] {
  config::Material m;
  m.density = 0.3;
  m.bending = 2e-4;
  m.shear = 7;
  return m;
}();
inline constexpr double beta = 0.02; ///< stiffness-proportional damping of the damped forces, s
inline const config::Air air{.wind = {1.5, -0.7, 2},
                             .density = 1.2,
                             .drag = 0.9,
                             .gust = {.speed = 0.8, .length = 0.6, .period = 0.4}};
inline const Vec3 oblique_gravity{0.3, -1, -9.81};
inline constexpr double state_time = 0.3; ///< s

/// A state in original order.
struct WholeState {
  std::vector<Vec3> positions, velocities;
  std::vector<double> force_density;
};

/// One rank's part of a cloth. Stays where it is: forces refer to it.
struct Bed {
  Cloth cloth;
  Pattern pattern;

  explicit Bed(DistributedMesh mesh) : cloth(make_cloth(std::move(mesh), material)), pattern(cloth.mesh) {}
  Bed(const Bed&) = delete;

  State at(const WholeState& whole) const {
    const IndexMap &vertices = cloth.mesh.vertices, &edges = cloth.mesh.edges;
    State state{.time = state_time,
                .positions = local(vertices, whole.positions),
                .velocities = local(vertices, whole.velocities)};
    state.multipliers.force_density = local(edges, whole.force_density);
    state.multipliers.carried_contact_force.assign(vertices.size(), Vec3::Zero());
    return state;
  }
};

/// Edges stretch and turn by a half and more; tensions have both signs.
inline WholeState random_state(const Bed& whole, unsigned seed) {
  const DistributedMesh& mesh = whole.cloth.mesh;
  WholeState state{random_vectors(mesh.vertices.total, 0.1, 10 + seed),
                   random_vectors(mesh.vertices.total, 2, 50 + seed),
                   random_numbers(mesh.edges.total, 30, 90 + seed)};
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    state.positions[mesh.vertices.original[i]] += mesh.rest_positions[i];
  return state;
}

using MakeForce = std::unique_ptr<Force> (*)(const Bed&);

inline std::unique_ptr<Force> bending(const Bed& b) {
  return std::make_unique<YarnBending>(b.cloth, b.pattern, Threads::all, material.bending, 0.0);
}
inline std::unique_ptr<Force> shear(const Bed& b) {
  return std::make_unique<Shear>(b.cloth, b.pattern, material.shear, 0.0);
}
inline std::unique_ptr<Force> damped_bending(const Bed& b) {
  return std::make_unique<YarnBending>(b.cloth, b.pattern, Threads::all, material.bending, beta);
}
inline std::unique_ptr<Force> damped_shear(const Bed& b) {
  return std::make_unique<Shear>(b.cloth, b.pattern, material.shear, beta);
}
inline std::unique_ptr<Force> drag(const Bed& b) { return std::make_unique<AirDrag>(b.cloth, air); }
inline std::unique_ptr<Force> tension(const Bed& b) {
  return std::make_unique<CarriedTension>(b.cloth, b.pattern,
                                          std::vector<char>(b.cloth.mesh.edges.size(), 0));
}

inline std::unique_ptr<Force> tension_and_pushes(const Bed& b) {
  return std::make_unique<CarriedTension>(b.cloth, b.pattern,
                                          std::vector<char>(b.cloth.mesh.edges.size(), 1));
}
inline std::unique_ptr<Force> gravity(const Bed& b) {
  return std::make_unique<Gravity>(b.cloth, oblique_gravity);
}

/// A step of `dt` with inertia and all forces.
inline StepSystem full_step(const Bed& bed, const WholeState& whole, double dt) {
  const State state = bed.at(whole);
  StepSystem system(bed.pattern, bed.cloth.mesh.vertices.size());
  system.start(dt);
  for (Local i = 0; i < bed.cloth.mesh.vertices.owned; ++i)
    system.add_inertia(i, bed.cloth.mass[i], state.velocities[i]);
  for (const MakeForce make : {gravity, damped_bending, damped_shear, drag, tension})
    make(bed)->add_to(system, state);
  return system;
}

/// The right-hand side, whole; to the bit.
inline Column whole_rhs(const Bed& bed, const StepSystem& system) {
  return gather<Vec3>(bed.cloth.mesh.comm, bed.cloth.mesh.vertices, system.rhs());
}

struct Step {
  Column rhs;
  Dense matrix;
};

/// What a force adds to a step of `dt`, whole. For dt = 1 and without damping: f and K.
inline Step step_of(const Bed& bed, MakeForce make, const WholeState& state, double dt) {
  StepSystem system(bed.pattern, bed.cloth.mesh.vertices.size());
  system.start(dt);
  make(bed)->add_to(system, bed.at(state));
  return {whole_rhs(bed, system), gather(bed.cloth.mesh, system.matrix())};
}

/// Relative, of sums of some tens of terms of like size.
inline constexpr double round_off = 1e-13;

class OnABed : public testing::Test {
protected:
  const Bed whole_{serial(mixed_mesh)};
  const WholeState state_ = random_state(whole_, 0);
};

} // namespace taut::test
