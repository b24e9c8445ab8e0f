#include "src/contact/slim_body.hpp"

#include "partition/comm.hpp"
#include "partition/mesh_slab.hpp"
#include "src/contact/body_normals.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double part = 0.9;                  ///< of the radius of the ball
constexpr double cone = 0.7;                  ///< cosine of the angle to the inward normal
constexpr int rounds = 15;                    ///< of evening out
constexpr std::size_t most_looked_at = 20000; ///< vertices q for each p

double radius_at(std::size_t v, std::span<const Vec3> x, const Vec3& inwards) {
  const std::size_t stride = 1 + x.size() / most_looked_at;
  double radius = HUGE_VAL;
  for (std::size_t w = 0; w < x.size(); w += stride) {
    const Vec3 apart = x[w] - x[v];
    const double deep = apart.dot(inwards);
    if (deep > 0 && deep * deep > cone * cone * apart.squaredNorm())
      radius = std::min(radius, radius_of_ball(apart, inwards));
  }
  return radius;
}

} // namespace

std::vector<Vec3> ways_to_slim(MPI_Comm comm, std::span<const Vec3> positions,
                               std::span<const std::array<Local, 3>> triangles) {
  const std::vector<Vec3> normals = outward_normals(positions, triangles);
  std::vector<double> radii; // of this rank's share
  const Slab share = slab_of(Global(positions.size()), size_of(comm), rank_of(comm));
  for (Global v = share.first; v < share.first + share.count; ++v)
    radii.push_back(radius_at(std::size_t(v), positions, -normals[v]));
  radii = gather_to_all<double>(comm, radii);
  std::vector<Vec3> slim(positions.begin(), positions.end());
  for (std::size_t v = 0; v < slim.size(); ++v)
    if (std::isfinite(radii[v])) slim[v] -= part * radii[v] * normals[v];
  even_out(slim, triangles, rounds);
  for (std::size_t v = 0; v < slim.size(); ++v) slim[v] -= positions[v];
  return slim;
}

} // namespace taut
