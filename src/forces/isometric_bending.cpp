#include "src/forces/isometric_bending.hpp"

#include <cmath>

namespace taut {

template<class Visit>
void IsometricBending::for_each(Visit&& visit) const {
  for (const auto& s : narrow_) visit(s);
  for (const auto& s : wide_) visit(s);
}

IsometricBending::IsometricBending(const Cloth& cloth, const Pattern& pattern,
                                   std::span<const HingeStencil> folds, const PerPiece<double>& damping)
    : cloth_(cloth) {
  for (const HingeStencil& f : folds) {
    const auto& v = f.vertices;
    const double d = damping.of(cloth.piece_of(v[0])).value_or(0);
    const double length = (f.rest[1] - f.rest[0]).norm(); // f.stiffness / length^2 = B / A
    std::array<double, 4> row = isometric_row(f.rest);
    for (double& k : row) k *= std::sqrt(f.stiffness) / length;
    if (f.size() == 4) {
      const std::array<Local, 4> four{v[0], v[1], v[2], v[4]};
      narrow_.push_back({four, row, pattern.slots<4>(four), d});
    } else {
      wide_.push_back({v, spread(f, row), pattern.slots<6>(v), d});
    }
  }
}

double IsometricBending::energy(const State& state) const {
  double energy = 0;
  for_each([&](const auto& s) {
    if (cloth_.mesh.owns_vertex(s.vertices[0])) energy += 0.5 * s.sum(state.positions).squaredNorm();
  });
  return energy;
}

void IsometricBending::add_to(StepSystem& system, const State& state) {
  for_each([&](const auto& s) {
    constexpr std::size_t n = std::tuple_size_v<std::decay_t<decltype(s.vertices)>>;
    const Vec3 sum = s.sum(state.positions);
    for (std::size_t k = 0; k < n; ++k) system.add_force(s.vertices[k], -s.weights[k] * sum);
    system.template add_outer<n>(s.vertices, s.slots, s.weights, 1.0, s.damping);
  });
}

} // namespace taut
