#include "src/time/xpbd.hpp"

#include "src/time/integrator.hpp"

namespace taut {

Xpbd::Xpbd(const StepperParts& parts)
    : cloth_(parts.cloth), forces_(parts.forces), pins_(parts.pins),
      substeps_(parts.resolved.inextensibility.xpbd.value_or(config::Xpbd{}).substeps),
      compliance_(parts.resolved.inextensibility.compliance.value_or(0.0)), sweeps_(parts.cloth),
      loads_(parts.pattern, cloth_.mesh.vertices.size()), freedom_(cloth_.mesh.vertices.size()),
      impulse_(cloth_.mesh.vertices.size()), x_(cloth_.mesh.vertices.size()), s_(cloth_.mesh.edges.size()) {}

StepReport Xpbd::propose(const State& state, double dt, Candidate& candidate) {
  const double h = dt / substeps_;
  now_ = state;
  pin_impulse_.assign(cloth_.mesh.vertices.owned, Vec3::Zero());
  std::fill(now_.multipliers.force_density.begin(), now_.multipliers.force_density.end(), 0.0);
  for (int k = 0; k < substeps_; ++k) {
    now_.time = state.time + k * h;
    substep(h);
  }
  candidate.velocities.resize(x_.size());
  for (std::size_t i = 0; i < x_.size(); ++i)
    candidate.velocities[i] = (now_.positions[i] - state.positions[i]) / dt;
  set_positions({state, dt, state}, candidate);
  candidate.end_velocities = now_.velocities;
  candidate.reported.reaction = pin_impulse_;
  for (Vec3& r : candidate.reported.reaction) r /= dt;
  for (Local e = 0; e < cloth_.mesh.edges.owned; ++e) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    candidate.multipliers.force_density[e] =
        now_.multipliers.force_density[e] / (substeps_ * (now_.positions[b] - now_.positions[a]).norm());
  }
  cloth_.mesh.edge_halo.update(candidate.multipliers.force_density);
  StepReport report;
  report.iterations = substeps_;
  return report;
}

/// `now_.multipliers.force_density` gathers the tensions.
void Xpbd::substep(double h) {
  start_velocities_ = now_.velocities;
  pins_.prescribe(now_, h, freedom_, now_.velocities);
  fall(h);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) x_[i] = now_.positions[i] + h * now_.velocities[i];
  cloth_.mesh.vertex_halo.update(x_);
  sweeps_.start(h, compliance_, freedom_);
  std::fill(s_.begin(), s_.end(), 0.0);
  sweeps_.gauss_seidel(x_, s_);
  for (std::size_t i = 0; i < x_.size(); ++i) now_.velocities[i] = (x_[i] - now_.positions[i]) / h;
  std::swap(now_.positions, x_);
  note_reaction(h);
  for (std::size_t e = 0; e < s_.size(); ++e) now_.multipliers.force_density[e] += s_[e] / (h * h);
}

/// v <- v + h f/m of the owned vertices, as far as they are free; h f into `impulse_`.
void Xpbd::fall(double h) {
  loads_.start_explicit(h);
  for (const auto& force : forces_) force->add_to(loads_, now_);
  loads_.explicit_impulse(now_.velocities, impulse_);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    const double damping = cloth_.pieces[cloth_.piece_of(i)].material.damping.mass;
    impulse_[i] -= h * damping * cloth_.mass[i] * now_.velocities[i];
    now_.velocities[i] += freedom_.allowed(i, impulse_[i]) / cloth_.mass[i];
  }
}

/// Where a vertex may not move, its pin makes up for what the momentum it gained owes to no other force.
void Xpbd::note_reaction(double h) {
  if (freedom_.all_free()) return;
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    if (freedom_.is_free(i)) continue;
    const Vec3 gained = cloth_.mass[i] * (now_.velocities[i] - start_velocities_[i]);
    pin_impulse_[i] += freedom_.denied(i, gained - impulse_[i] - h * pull_of_edges(i, h));
  }
}

/// In N, over the last substep.
Vec3 Xpbd::pull_of_edges(Local vertex, double h) const {
  Vec3 pull = Vec3::Zero();
  for (const EdgeEnd& end : cloth_.mesh.star_of(vertex)) {
    const Vec3 d = now_.positions[end.other] - now_.positions[vertex];
    pull += s_[end.edge] / (h * h) * d.normalized();
  }
  return pull;
}

} // namespace taut
