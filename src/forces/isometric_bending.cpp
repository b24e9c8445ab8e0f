#include "src/forces/isometric_bending.hpp"

#include <cmath>

namespace taut {

template<class Visit>
void IsometricBending::for_each(Visit&& visit) const {
  for (const auto& s : triangles_) visit(s);
  for (const auto& s : narrow_) visit(s);
  for (const auto& s : wide_) visit(s);
}

IsometricBending::IsometricBending(const Cloth& cloth, const Pattern& pattern, const Folds& folds,
                                   const PerPiece<double>& damping)
    : cloth_(cloth) {
  const auto damping_at = [&](Local v) { return damping.of(cloth.piece_of(v)).value_or(0); };
  for (const TriangleStencil& t : folds.triangles) add_triangle(t, folds, pattern, damping_at(t.vertices[0]));
  for (const HingeStencil& f : folds.hinges)
    if (f.stiffness > 0) add_hinge(f, pattern, damping_at(f.vertices[0]));
}

void IsometricBending::add_hinge(const HingeStencil& f, const Pattern& pattern, double damping) {
  const auto& v = f.vertices;
  std::array<double, 4> row = isometric_row(f.rest); // K x = |e| theta
  for (double& k : row) k *= std::sqrt(f.stiffness) / f.length();
  if (f.size() == 4) {
    const std::array<Local, 4> four{v[0], v[1], v[2], v[4]};
    narrow_.push_back({four, {row}, pattern.slots<4>(four), damping});
  } else {
    wide_.push_back({v, {spread(f, row)}, pattern.slots<6>(v), damping});
  }
}

void IsometricBending::add_triangle(const TriangleStencil& t, const Folds& folds, const Pattern& pattern,
                                    double damping) {
  auto& stencil =
      triangles_.emplace_back(Stencil<6, 3>{t.vertices, {}, pattern.slots<6>(t.vertices), damping});
  for (std::size_t k = 0; k < 3 && t.folds[k] >= 0; ++k) {
    const HingeStencil& f = folds.hinges[std::size_t(t.folds[k])];
    const auto row = isometric_row(f.rest);
    for (std::size_t m = 0; m < 3; ++m)
      for (std::size_t c = 0; c < 4; ++c)
        stencil.weights[m][std::size_t(t.place[k][c])] += t.rows[m][k] * row[c] / f.area;
  }
}

double IsometricBending::energy(const State& state) const {
  double energy = 0;
  for_each([&](const auto& s) {
    if (!cloth_.mesh.owns_vertex(s.vertices[0])) return;
    for (std::size_t r = 0; r < s.weights.size(); ++r)
      energy += 0.5 * s.sum(r, state.positions).squaredNorm();
  });
  return energy;
}

void IsometricBending::add_to(StepSystem& system, const State& state) {
  for_each([&](const auto& s) {
    constexpr std::size_t n = std::tuple_size_v<std::decay_t<decltype(s.vertices)>>;
    for (std::size_t r = 0; r < s.weights.size(); ++r) {
      const Vec3 sum = s.sum(r, state.positions);
      for (std::size_t k = 0; k < n; ++k) system.add_force(s.vertices[k], -s.weights[r][k] * sum);
      system.template add_outer<n>(s.vertices, s.slots, s.weights[r], 1.0, s.damping);
    }
  });
}

} // namespace taut
