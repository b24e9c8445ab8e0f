#include "src/time/xpbd.hpp"

namespace taut {

Xpbd::Xpbd(const Cloth& cloth, const Pattern& pattern, const std::vector<std::unique_ptr<Force>>& forces,
           const Pins& pins, const config::Inextensibility& options)
    : cloth_(cloth), forces_(forces), pins_(pins), substeps_(options.xpbd.value_or(config::Xpbd{}).substeps),
      compliance_(options.compliance.value_or(0.0)), sweeps_(cloth),
      loads_(pattern, cloth.mesh.vertices.size()), impulse_(cloth.mesh.vertices.size()),
      x_(cloth.mesh.vertices.size()), s_(cloth.mesh.edges.size()) {}

void Xpbd::advance(const State& start, double dt, std::vector<char>& prescribed, Candidate& candidate) {
  const double h = dt / substeps_;
  now_ = start;
  std::fill(now_.force_density.begin(), now_.force_density.end(), 0.0);
  for (int k = 0; k < substeps_; ++k) {
    now_.time = start.time + k * h;
    substep(h, prescribed);
  }
  candidate.velocities.resize(x_.size());
  for (std::size_t i = 0; i < x_.size(); ++i)
    candidate.velocities[i] = (now_.positions[i] - start.positions[i]) / dt;
  candidate.end_velocities = now_.velocities;
  for (Local e = 0; e < cloth_.mesh.edges.owned; ++e) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    candidate.force_density[e] =
        now_.force_density[e] / (substeps_ * (now_.positions[b] - now_.positions[a]).norm());
  }
  cloth_.mesh.edge_halo.update(candidate.force_density);
}

/// `now_.force_density` gathers the tensions.
void Xpbd::substep(double h, std::vector<char>& prescribed) {
  pins_.prescribe(now_, h, prescribed, now_.velocities);
  fall(h, prescribed);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) x_[i] = now_.positions[i] + h * now_.velocities[i];
  cloth_.mesh.vertex_halo.update(x_);
  sweeps_.start(h, compliance_, prescribed);
  std::fill(s_.begin(), s_.end(), 0.0);
  sweeps_.gauss_seidel(x_, s_);
  for (std::size_t i = 0; i < x_.size(); ++i) now_.velocities[i] = (x_[i] - now_.positions[i]) / h;
  std::swap(now_.positions, x_);
  for (std::size_t e = 0; e < s_.size(); ++e) now_.force_density[e] += s_[e] / (h * h);
}

/// v <- v + h f/m of the owned vertices that are free.
void Xpbd::fall(double h, std::span<const char> prescribed) {
  const double damping = cloth_.material.damping.mass;
  loads_.start_explicit(h);
  for (const auto& force : forces_) force->add_to(loads_, now_);
  loads_.explicit_impulse(now_.velocities, impulse_);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    if (!prescribed[i]) now_.velocities[i] += impulse_[i] / cloth_.mass[i] - h * damping * now_.velocities[i];
}

} // namespace taut
