#include "src/linear/yarn_system.hpp"

namespace taut {

YarnSystem::YarnSystem(const DistributedMesh& mesh)
    : mesh_(mesh), yarns_(find_yarns(mesh)), matrix_(yarns_), factor_(yarns_) {}

void YarnSystem::factor(std::span<const Vec3> gradient, std::span<const double> inverse_mass,
                        const Freedom& freedom, std::span<const double> scaled_compliance) {
  const auto moved = [&](Local v, Local e) { // W g
    return Vec3(inverse_mass[v] * freedom.allowed(v, gradient[e]));
  };
  const auto on_diagonal = [&](Local e) {
    const auto& [a, b] = mesh_.edge_vertices[e];
    const double diagonal = gradient[e].dot(moved(a, e) + moved(b, e));
    return diagonal > 0 ? diagonal + scaled_compliance[e] : 1.0;
  };
  const auto coupling = [&](Local e, Local f) {
    return sum_over_shared(mesh_, e, f, [&](Local v) { return gradient[e].dot(moved(v, f)); });
  };
  matrix_.fill(yarns_, on_diagonal, coupling);
  factor_.factor(matrix_);
}

} // namespace taut
