#include "src/command/arrival.hpp"

#include "src/config/cloths.hpp"
#include "src/contact/body_growth.hpp"
#include "src/forces/seam_force.hpp"
#include "src/garment/load_garment.hpp"

#include <fmt/format.h>

namespace taut::command {

namespace {

constexpr double round_off = 1e-9; // s

double largest_speed(const Simulation& simulation) {
  const DistributedMesh& mesh = simulation.cloth().mesh;
  double largest = 0; // squared
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    largest = std::max(largest, simulation.state().velocities[i].squaredNorm());
  return std::sqrt(max_over(mesh.comm, largest));
}

double last_of(const std::vector<config::Keyframe>& motion) {
  return motion.empty() ? 0 : motion.back().time;
}

/// s, after which nothing that moves or holds the cloth changes any more.
double last_change(const Case& input) {
  double last = input.gravity.keyframes.back().time;
  for (const config::Pin& pin : input.pins)
    last = std::max({last, last_of(pin.motion), pin.release.value_or(0)});
  for (const config::Attachment& a : input.attachments)
    last = std::max({last, a.time, a.release.value_or(0)});
  for (const config::Obstacle& o : input.obstacles) {
    const double played = o.sequence ? (o.sequence->frames - 1) / o.sequence->fps : 0;
    last = std::max({last, last_of(o.motion), played});
  }
  return last;
}

/// The name of the seam that has this vertex, by its number among all cloths.
std::string name_of_seam(const Case& input, const Cloth& cloth, Global vertex) {
  const std::size_t k = cloth.piece_of_original(vertex);
  const Global number = vertex - cloth.pieces[k].first_vertex;
  const auto garment = garment::load_garment(cloth.mesh.comm, input, k);
  for (const auto& seam : garment.mesh.seams)
    for (const auto& [a, b] : seam.pairs)
      if (a == number || b == number) return seam.name;
  return "";
}

} // namespace

bool has_arrived(const Case& input, const Simulation& simulation) {
  if (input.sewing)
    return widest_seam(simulation.cloth(), simulation.state(), *input.sewing).over_closed <= 1;
  if (simulation.obstacles().grow()) return has_grown(simulation.obstacles(), simulation.state());
  if (!input.time.until_rest || simulation.state().time <= last_change(input) + round_off) return false;
  return largest_speed(simulation) <= *input.time.until_rest;
}

Outcome judge_seams(const Case& input, const Simulation& simulation) {
  const OpenSeam open = widest_seam(simulation.cloth(), simulation.state(), *input.sewing);
  if (open.over_closed <= 1) return {};
  const std::string name =
      broadcast_text(simulation.cloth().mesh.comm, name_of_seam(input, simulation.cloth(), open.vertex));
  return {
      Ending::failed,
      fmt::format("seam {} is still open by {:.3g} mm at ({:.4g}, {:.4g}, {:.4g}) m, between vertices {} and "
                  "{}, after sewing.limit, {:g} s; "
                  "give it more sewing.force, {:g} N/m, or more time, or stiffer panels (sewing.bending), or "
                  "place the panels nearer to where "
                  "they belong, or let pins slide that hold it apart (pins[].plane)",
                  name, 1000 * open.distance, open.place[0], open.place[1], open.place[2], open.joint,
                  open.vertex, input.sewing->limit, input.sewing->force)};
}

} // namespace taut::command
