#pragma once
// A cloth that a step is about to tear out of shape, for tests of filters.
#include "src/constraints/strain_gauge.hpp"
#include "src/filters/make_filter.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

namespace taut::test {

/// One step of a cloth, from `start` to where `end` says: both by original number; no end: the vertex is
/// held.
struct Thrown {
  Cloth cloth;
  Pattern pattern;
  State start;
  Candidate candidate;
  std::vector<char> prescribed;
  double dt = 0.01; ///< s

  Thrown(DistributedMesh mesh, const std::function<Vec3(Global)>& from,
         const std::function<std::optional<Vec3>(Global)>& to)
      : cloth(make_cloth(std::move(mesh), config::Material{})), pattern(cloth.mesh) {
    for (const Global v : cloth.mesh.vertices.original) {
      start.positions.push_back(from(v));
      const std::optional<Vec3> end = to(v);
      prescribed.push_back(!end);
      candidate.velocities.push_back(end ? Vec3((*end - from(v)) / dt) : Vec3(Vec3::Zero()));
    }
    start.velocities.assign(start.positions.size(), Vec3::Zero());
    candidate.multipliers.force_density.assign(cloth.mesh.edges.size(), 0.0);
  }
  Thrown(const Thrown&) = delete;

  FilterReport apply(const config::Inextensibility& how) {
    return make_filter(cloth, pattern, how)->apply(start, dt, Freedom(prescribed), candidate);
  }

  /// End positions, in original order on every rank.
  Column end() const {
    std::vector<Vec3> x = start.positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * candidate.velocities[i];
    return gather<Vec3>(cloth.mesh.comm, cloth.mesh.vertices, x);
  }

  double strain() const {
    std::vector<Vec3> x = start.positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * candidate.velocities[i];
    return measure_strain(cloth, x).max;
  }
};

inline config::Inextensibility method(config::InextensibilityMethod m, config::LinearSolver solver,
                                      double strain) {
  config::Inextensibility how;
  how.method = m;
  how.solver = solver;
  how.strain = strain;
  how.compliance = 0;
  how.max_iterations = 50;
  return how;
}

} // namespace taut::test
