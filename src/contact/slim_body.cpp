#include "src/contact/slim_body.hpp"

#include "partition/comm.hpp"
#include "partition/mesh_slab.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace taut {

namespace {

constexpr double part = 0.9;  ///< of the radius of the ball
constexpr double cone = 0.7;  ///< cosine of the angle to the inward normal
constexpr int rounds = 15;    ///< of evening out
constexpr std::size_t most_looked_at = 20000; ///< vertices q for each p

/// Of length 1, outwards; weighted by area. Zero where there is no area.
std::vector<Vec3> normals_of(std::span<const Vec3> x, std::span<const std::array<Local, 3>> triangles) {
  std::vector<Vec3> normals(x.size(), Vec3::Zero());
  double volume = 0; // times 6
  for (const auto& [a, b, c] : triangles) {
    const Vec3 n = (x[b] - x[a]).cross(x[c] - x[a]);
    volume += n.dot(x[a] - x[0]);
    for (const Local v : {a, b, c}) normals[v] += n;
  }
  for (Vec3& n : normals) n = std::copysign(1.0, volume) * n.stableNormalized();
  return normals;
}

double radius_at(std::size_t v, std::span<const Vec3> x, const Vec3& normal) {
  const std::size_t stride = 1 + x.size() / most_looked_at;
  double radius = HUGE_VAL;
  for (std::size_t w = 0; w < x.size(); w += stride) {
    const Vec3 d = x[v] - x[w];
    const double square = d.squaredNorm(), deep = d.dot(normal);
    if (deep > 0 && deep * deep > cone * cone * square) radius = std::min(radius, square / (2 * deep));
  }
  return radius;
}

void even_out(std::vector<Vec3>& x, std::span<const std::array<Local, 3>> triangles) {
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vec3> sum(x.size(), Vec3::Zero());
    std::vector<int> count(x.size(), 0);
    for (const auto& t : triangles)
      for (int k = 0; k < 3; ++k) {
        sum[t[k]] += x[t[(k + 1) % 3]] + x[t[(k + 2) % 3]];
        count[t[k]] += 2;
      }
    for (std::size_t v = 0; v < x.size(); ++v)
      if (count[v] > 0) x[v] = sum[v] / count[v];
  }
}

} // namespace

std::vector<Vec3> ways_to_slim(MPI_Comm comm, std::span<const Vec3> positions,
                               std::span<const std::array<Local, 3>> triangles) {
  const std::vector<Vec3> normals = normals_of(positions, triangles);
  std::vector<double> radii; // of this rank's share
  const Slab share = slab_of(Global(positions.size()), size_of(comm), rank_of(comm));
  for (Global v = share.first; v < share.first + share.count; ++v)
    radii.push_back(radius_at(std::size_t(v), positions, normals[v]));
  radii = gather_to_all<double>(comm, radii);
  std::vector<Vec3> slim(positions.begin(), positions.end());
  for (std::size_t v = 0; v < slim.size(); ++v)
    if (std::isfinite(radii[v])) slim[v] -= part * radii[v] * normals[v];
  even_out(slim, triangles);
  for (std::size_t v = 0; v < slim.size(); ++v) slim[v] -= positions[v];
  return slim;
}

} // namespace taut
