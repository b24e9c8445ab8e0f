#include "src/filters/edge_sweeps.hpp"

#include "src/state/inverse_mass.hpp"

namespace taut {

EdgeSweeps::EdgeSweeps(const Cloth& cloth)
    : cloth_(cloth), colours_(colour_edges(cloth.mesh)), inverse_mass_(cloth.mesh.vertices.size()),
      corrections_(cloth.mesh.edges.size()) {}

void EdgeSweeps::start(double dt, double compliance, const Freedom& freedom) {
  compliance_over_dt2_ = compliance / (dt * dt);
  freedom_ = freedom;
  take_inverse_masses(cloth_, freedom, inverse_mass_);
}

EdgeSweeps::Correction EdgeSweeps::correction(Local edge, std::span<const Vec3> x, double s) const {
  const auto& [a, b] = cloth_.mesh.edge_vertices[edge];
  const double l = cloth_.rest_length[edge], softness = l * compliance_over_dt2_;
  const Vec3 d = x[b] - x[a];
  const double length = d.norm();
  if (length == 0) return {0.0, Vec3::Zero()};
  const Vec3 n = d / length;
  const double inverse_effective_mass = n.dot(step(a, n) + step(b, n));
  if (inverse_effective_mass == 0) return {0.0, Vec3::Zero()};
  return {(length - l - softness * s) / (inverse_effective_mass + softness), n};
}

void EdgeSweeps::gauss_seidel(std::vector<Vec3>& x, std::vector<double>& s) const {
  for (const auto& colour : colours_.edges) {
    for (const Local e : colour) {
      const auto& [a, b] = cloth_.mesh.edge_vertices[e];
      const auto [ds, normal] = correction(e, x, s[e]);
      x[a] += ds * step(a, normal);
      x[b] -= ds * step(b, normal);
      s[e] += ds;
    }
    cloth_.mesh.vertex_halo.update(x);
  }
}

void EdgeSweeps::jacobi(std::vector<Vec3>& x, std::vector<double>& s) {
  constexpr double part = 0.5;
  for (const auto& colour : colours_.edges)
    for (const Local e : colour) {
      corrections_[e] = correction(e, x, s[e]);
      s[e] += part * corrections_[e].ds;
    }
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    for (const EdgeEnd& end : cloth_.mesh.star_of(i)) {
      const auto& [ds, normal] = corrections_[end.edge];
      x[i] -= part * end.sign * ds * step(i, normal);
    }
  cloth_.mesh.vertex_halo.update(x);
}

} // namespace taut
