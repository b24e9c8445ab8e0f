#include "src/contact/attachments.hpp"

#include "src/config/cloths.hpp"
#include "src/state/labelled.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut {

Attachments::Attachments(const Cloth& cloth, const Obstacles& obstacles, const Pattern& pattern,
                         const Case& input, std::span<const Vec3> start)
    : cloth_(cloth), obstacles_(obstacles), attachments_(input.attachments) {
  for (const config::Attachment& a : attachments_) laws_.push_back({a.force, a.force / held});
  add_ties(pattern, start);
  for (std::size_t k = 0; k < attachments_.size(); ++k)
    if (const auto& name = attachments_[k].obstacle)
      add_holds(pattern, k, fmt::format("{}: attachments.{}.label", input.file.string(), k),
                int(config::find_obstacle(input, *name).value()), start);
}

void Attachments::add_ties(const Pattern& pattern, std::span<const Vec3> start) {
  const IndexMap& map = cloth_.mesh.vertices;
  for (const auto& ends : cloth_.mesh.ties) {
    const std::array<Global, 2> originals{map.original[ends[0]], map.original[ends[1]]};
    for (const auto& [vertices, attachment] : cloth_.ties)
      if (vertices == originals)
        ties_.push_back({attachment, ends, (start[ends[1]] - start[ends[0]]).norm(), pattern.slots<2>(ends)});
  }
}

void Attachments::add_holds(const Pattern& pattern, std::size_t k, const std::string& key, int body,
                            std::span<const Vec3> start) {
  const auto vertices = labelled(cloth_.pieces, *attachments_[k].label, key);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    if (std::binary_search(vertices.begin(), vertices.end(), cloth_.mesh.vertices.original[i]))
      holds_.push_back({k, {i}, obstacles_.anchor(body, start[i]), pattern.slots<1>(std::array{i})});
}

bool Attachments::is_open(std::size_t attachment, double time) const {
  constexpr double round_off = 1e-9; // s
  const auto& release = attachments_[attachment].release;
  return release && time > *release + round_off;
}

/// From its length at the start by 1 - 3 s^2 + 2 s^3, whose ends are at rest.
double Attachments::length_at(const Tie& tie, double time) const {
  const config::Attachment& a = attachments_[tie.attachment];
  const double s = a.time > 0 ? std::clamp(time / a.time, 0.0, 1.0) : 1.0;
  return a.length + std::max(tie.length - a.length, 0.0) * (1 - s * s * (3 - 2 * s));
}

double Attachments::energy(const State& state) const {
  const auto& x = state.positions;
  double energy = 0;
  for (const Tie& t : ties_)
    if (cloth_.mesh.owns_vertex(t.ends[0]) && !is_open(t.attachment, state.time))
      energy += laws_[t.attachment].energy((x[t.ends[1]] - x[t.ends[0]]).norm() - length_at(t, state.time));
  for (const Hold& h : holds_)
    if (!is_open(h.attachment, state.time))
      energy += laws_[h.attachment].energy((obstacles_.follow(h.anchor, state.time) - x[h.vertex[0]]).norm() -
                                           attachments_[h.attachment].length);
  return energy;
}

void Attachments::add_to(StepSystem& system, const State& state) {
  const double time = state.time + system.dt();
  const auto& x = state.positions;
  for (const Tie& t : ties_) {
    const Vec3 d = x[t.ends[1]] - x[t.ends[0]];
    const double e = d.norm() - length_at(t, time);
    if (e > 0 && !is_open(t.attachment, time))
      add_string<2>(system, laws_[t.attachment], t.ends, t.slots, d, e);
  }
  for (const Hold& h : holds_) {
    const Vec3 d = obstacles_.follow(h.anchor, time) - x[h.vertex[0]];
    const double e = d.norm() - attachments_[h.attachment].length;
    if (e > 0 && !is_open(h.attachment, time))
      add_string<1>(system, laws_[h.attachment], h.vertex, h.slots, d, e);
  }
}

} // namespace taut
