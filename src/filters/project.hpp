#pragma once
#include "src/filters/fast_projection.hpp"

#include <limits>
#include <stdexcept>

/// Fast Projection for other integrators: from where they would have vertices go to where edges have their
/// length. This header and `partition/` are all a program needs; see tests/filters/example_project.cpp.
namespace taut {

/// The mass of a vertex that stays where the candidate has it.
constexpr double held = std::numeric_limits<double>::infinity();

struct ProjectOptions {
  double strain = 0.01;    ///< largest |strain| of an edge that is left
  int max_iterations = 20; ///< most projections
  config::LinearSolver solver = config::LinearSolver::cg;
  double compliance =
      0;         ///< strain of an edge per newton of its tension in a step of `dt`; above 0 where edges
                 ///< may be redundant, such as a straight line of them between two held vertices
  double dt = 1; ///< s; of consequence with a compliance only
};

/// The strain limit was not reached. Thrown alike on all ranks; the message says what was left.
class ProjectionError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Projects candidates of one mesh again and again; what can be set up once, is.
class Projector {
public:
  /// `masses`: kg, of local vertices, above 0 or `held`; ghosts are not read. The rest lengths are those of
  /// `mesh.rest_positions`; constrained are the edges of `mesh.edge_vertices`. Keeps a copy of the mesh.
  /// Throws InputError for masses and options out of range. Collective.
  Projector(const DistributedMesh& mesh, std::span<const double> masses, const ProjectOptions& options);
  Projector(const Projector&) = delete;
  Projector& operator=(const Projector&) = delete;

  /// Positions, in m, of local vertices, ghosts current. `candidate`: the same, ghosts not read. Without held
  /// vertices the centre of mass stays where it is. Throws ProjectionError, and InputError for a candidate of
  /// another length or with what is not a number. Collective.
  std::vector<Vec3> project(std::span<const Vec3> candidate);

private:
  Cloth cloth_;
  double dt_;
  FastProjection<EdgeSet> filter_;
  Freedom freedom_;
};

/// `Projector(mesh, masses, options).project(candidate)`. Collective.
std::vector<Vec3> project(const DistributedMesh& mesh, std::span<const double> masses,
                          std::span<const Vec3> candidate, const ProjectOptions& options = {});

} // namespace taut
