#include "src/contact/body_normals.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace taut {

std::vector<Vec3> outward_normals(std::span<const Vec3> x, std::span<const std::array<Local, 3>> triangles) {
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

void even_out(std::vector<Vec3>& values, std::span<const std::array<Local, 3>> triangles, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vec3> sum(values.size(), Vec3::Zero());
    std::vector<int> count(values.size(), 0);
    for (const auto& t : triangles)
      for (int k = 0; k < 3; ++k) {
        sum[t[k]] += values[t[(k + 1) % 3]] + values[t[(k + 2) % 3]];
        count[t[k]] += 2;
      }
    for (std::size_t v = 0; v < values.size(); ++v)
      if (count[v] > 0) values[v] = sum[v] / count[v];
  }
}

} // namespace taut
