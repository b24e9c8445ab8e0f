#include "src/linear/yarn_system.hpp"

namespace taut {

YarnSystem::YarnSystem(const DistributedMesh& mesh) : mesh_(mesh), yarns_(find_yarns(mesh)), factor_(yarns_) {
  matrix_.diagonal.assign(mesh.edges.owned, 0.0);
  matrix_.to_previous.assign(mesh.edges.owned, 0.0);
  matrix_.to_segment_before.assign(yarns_.knots.size(), 0.0);
}

void YarnSystem::factor(std::span<const Vec3> gradient, std::span<const double> inverse_mass,
                        const Freedom& freedom, std::span<const double> shift) {
  const auto moved = [&](Local v, Local e) { // W g
    return Vec3(inverse_mass[v] * freedom.allowed(v, gradient[e]));
  };
  const auto coupling = [&](Local e, Local f) { // entry (e, f) of J W J^T
    double sum = 0;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const Local v = mesh_.edge_vertices[e][i];
        if (v != mesh_.edge_vertices[f][j]) continue;
        const double value = gradient[e].dot(moved(v, f));
        sum += i == j ? value : -value;
      }
    return sum;
  };
  for (Local e = 0; e < mesh_.edges.owned; ++e) {
    const auto& [a, b] = mesh_.edge_vertices[e];
    const double diagonal = gradient[e].dot(moved(a, e) + moved(b, e));
    matrix_.diagonal[e] = diagonal > 0 ? diagonal + shift[e] : 1.0;
  }
  for (const YarnSegment& s : yarns_.segments)
    for (Local e = s.begin + 1; e < s.end; ++e) matrix_.to_previous[e] = coupling(e, e - 1);
  for (std::size_t k = 0; k < yarns_.knots.size(); ++k)
    if (yarns_.before_knot[k] >= 0)
      matrix_.to_segment_before[k] = coupling(yarns_.knots[k], yarns_.before_knot[k]);
  factor_.factor(matrix_);
}

} // namespace taut
