#include "src/state/pins.hpp"

#include "src/config/cloths.hpp"
#include "src/config/methods.hpp"
#include "src/state/labelled.hpp"
#include "src/state/told_apart.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

namespace {

/// The centre of a keyframe that does not turn is without meaning; that of the other one then holds for both.
const Vec3& centre_of(const config::Keyframe& k, const config::Keyframe& other) {
  return k.rotate.angle == 0 ? other.rotate.centre : k.rotate.centre;
}

/// Rotations between two keyframes interpolate the angle if they turn about one axis, and the rotation vector
/// if not.
config::Keyframe between(const config::Keyframe& a, const config::Keyframe& b, double time) {
  const double s = (time - a.time) / (b.time - a.time);
  config::Keyframe k = b;
  k.time = time;
  k.translate = (1 - s) * a.translate + s * b.translate;
  k.rotate.centre = (1 - s) * centre_of(a, b) + s * centre_of(b, a);
  const Vec3 turn =
      (1 - s) * a.rotate.angle * a.rotate.axis.normalized() + s * b.rotate.angle * b.rotate.axis.normalized();
  k.rotate.angle = turn.norm();
  if (k.rotate.angle > 0) k.rotate.axis = turn;
  return k;
}

Vec3 apply(const config::Keyframe& k, const Vec3& start) {
  const Eigen::AngleAxisd turn(k.rotate.angle, k.rotate.axis.normalized());
  return k.rotate.centre + turn * (start - k.rotate.centre) + k.translate;
}

/// The owned vertex of the rank that is nearest to `point`, of those `among`; the lowest original number
/// decides among equals. -1 on all other ranks.
Local nearest(const Cloth& cloth, std::span<const Vec3> start, const Vec3& point, const Slab& among) {
  const IndexMap& map = cloth.mesh.vertices;
  double best = std::numeric_limits<double>::infinity();
  Local vertex = -1;
  for (Local i = 0; i < map.owned; ++i) {
    if (!among.contains(map.original[i])) continue;
    const double d = (start[i] - point).squaredNorm();
    if (d < best || (d == best && map.original[i] < map.original[vertex])) {
      best = d;
      vertex = i;
    }
  }
  const double least = -max_over(cloth.mesh.comm, -best);
  const Global mine =
      vertex >= 0 && best == least ? -map.original[vertex] : std::numeric_limits<Global>::min();
  return max_over(cloth.mesh.comm, mine) == mine && vertex >= 0 && best == least ? vertex : -1;
}

void require_vertex(const Slab& among, Global v, const std::string& key) {
  if (v < 0 || v >= among.count)
    throw InputError(fmt::format("{}: there is no vertex {}: the cloth has {} vertices, numbered from 0", key,
                                 v, among.count));
}

/// All, or the one that is meant.
std::span<const Piece> pieces_of(const config::Pin& pin, const Cloth& cloth, const Case& input) {
  const std::span<const Piece> all(cloth.pieces);
  return pin.cloth ? all.subspan(config::find_cloth(input, *pin.cloth).value(), 1) : all;
}

/// The vertices that a pin counts, of all cloths or of one.
Slab counted_by(const config::Pin& pin, const Cloth& cloth, const Case& input) {
  const auto pieces = pieces_of(pin, cloth, input);
  return {pieces.front().first_vertex,
          pieces.back().first_vertex + pieces.back().vertices - pieces.front().first_vertex,
          cloth.mesh.vertices.total};
}

std::vector<Local> vertices_of(const Cloth& cloth, const Case& input, const config::Pin& pin,
                               std::span<const Vec3> start, const std::string& key) {
  const IndexMap& map = cloth.mesh.vertices;
  const Slab among = counted_by(pin, cloth, input);
  std::vector<Local> found;
  if (pin.near) {
    for (const Vec3& point : *pin.near)
      if (const Local v = nearest(cloth, start, point, among); v >= 0) found.push_back(v);
    return found;
  }
  std::vector<Global> wanted = pin.vertices.value_or(std::vector<Global>{});
  if (pin.label)
    for (const Global v : labelled(pieces_of(pin, cloth, input), *pin.label, key + ".label"))
      wanted.push_back(v - among.first);
  for (const Global v : wanted) require_vertex(among, v, key + ".vertices");
  if (pin.range) require_vertex(among, (*pin.range)[1], key + ".range");
  std::sort(wanted.begin(), wanted.end());
  for (Local i = 0; i < map.owned; ++i) {
    if (!among.contains(map.original[i])) continue;
    const bool inside = pin.box && (start[i].array() >= pin.box->min.array()).all() &&
                        (start[i].array() <= pin.box->max.array()).all();
    const Global v = map.original[i] - among.first;
    const bool in_range = pin.range && v >= (*pin.range)[0] && v <= (*pin.range)[1];
    if (inside || in_range || std::binary_search(wanted.begin(), wanted.end(), v)) found.push_back(i);
  }
  if (sum_over(cloth.mesh.comm, Global(found.size())) == 0)
    throw InputError(
        fmt::format("{}: no vertex of the cloth starts inside this box; `taut info CASE` tells where the "
                    "cloth starts",
                    key));
  return found;
}

} // namespace

Vec3 place_at(const std::vector<config::Keyframe>& motion, const Vec3& start, double time) {
  if (motion.empty()) return start;
  const auto after = std::upper_bound(motion.begin(), motion.end(), time,
                                      [](double t, const config::Keyframe& k) { return t < k.time; });
  if (after == motion.begin()) return apply(motion.front(), start);
  if (after == motion.end()) return apply(motion.back(), start);
  return apply(between(after[-1], *after, time), start);
}

Pins::Pins(const Cloth& cloth, const Case& input, std::span<const Vec3> start) : pins_(input.pins) {
  const IndexMap& map = cloth.mesh.vertices;
  const auto key = [&](std::size_t pin) { return fmt::format("{}: pins.{}", input.file.string(), pin); };
  std::vector<int> pin_of(map.size(), -1);
  std::optional<std::string> fault;
  for (std::size_t k = 0; k < pins_.size(); ++k)
    for (const Local v : vertices_of(cloth, input, pins_[k], start, key(k))) {
      if (pin_of[v] >= 0 && pin_of[v] != int(k) && !fault)
        fault = fmt::format("{}: vertex {} is held by pins.{} already; a vertex can belong to one pin only",
                            key(k), map.original[v], pin_of[v]);
      pin_of[v] = int(k);
    }
  agree(cloth.mesh.comm, fault);

  cloth.mesh.vertex_halo.update(pin_of);
  for (Local i = 0; i < map.size(); ++i)
    if (pin_of[i] >= 0) held_.push_back({i, std::size_t(pin_of[i]), start[i]});
  count_ = sum_over(cloth.mesh.comm, Global(std::count_if(pin_of.begin(), pin_of.begin() + map.owned,
                                                          [](int pin) { return pin >= 0; })));
  const auto holds_all = [](const config::Pin& pin) { return !pin.along && !pin.plane; };
  if (count_ == map.total && std::all_of(pins_.begin(), pins_.end(), holds_all))
    throw InputError(
        fmt::format("{}: pins: all {} vertices are pinned, so nothing is left to move; pin fewer",
                    input.file.string(), count_));
  if (!config::holds_limit(input)) return;
  check_edges(cloth, input);
  check_reach(cloth, input, outermost(cloth));
}

/// Distances between points that move along straight lines are largest at keyframes, so it is enough to look
/// there.
void Pins::check_edges(const Cloth& cloth, const Case& input) const {
  std::vector<double> times{0.0};
  for (const config::Pin& pin : pins_)
    for (const config::Keyframe& k : pin.motion) times.push_back(k.time);
  std::vector<const Held*> held_at(cloth.mesh.vertices.size(), nullptr);
  for (const Held& h : held_) held_at[h.vertex] = &h;
  const double limit = input.inextensibility.strain;
  std::optional<std::string> fault;
  for (Local e = 0; e < cloth.mesh.edges.owned && !fault; ++e) {
    const Held *a = held_at[cloth.mesh.edge_vertices[e][0]], *b = held_at[cloth.mesh.edge_vertices[e][1]];
    if (!a || !b || !holds_fast(*a) || !holds_fast(*b)) continue;
    const double released =
        std::min(pins_[a->pin].release.value_or(HUGE_VAL), pins_[b->pin].release.value_or(HUGE_VAL));
    for (const double time : times) {
      const Vec3 d =
          place_at(pins_[a->pin].motion, a->start, time) - place_at(pins_[b->pin].motion, b->start, time);
      const double strain = d.norm() / cloth.rest_length[e] - 1.0;
      if (time >= released || time > input.time.end || std::abs(strain) <= limit) continue;
      fault = fmt::format(
          "{}: pins.{} and pins.{} hold the two ends of an edge, vertices {} and {}, and bring it to a "
          "strain of {} at {:g} s, beyond the limit {:g}; move them less, or pin only one of the two",
          input.file.string(), a->pin, b->pin, cloth.mesh.vertices.original[a->vertex],
          cloth.mesh.vertices.original[b->vertex], told_apart(strain, limit), time, limit);
      break;
    }
  }
  agree(cloth.mesh.comm, fault);
}

/// Of each pin that holds fast the first and the last of its vertices, which stand for all: those of a pin
/// move together. The same on all ranks. Collective.
std::vector<HeldVertex> Pins::outermost(const Cloth& cloth) const {
  const IndexMap& map = cloth.mesh.vertices;
  constexpr Global none = std::numeric_limits<Global>::min();
  std::vector<HeldVertex> result;
  for (std::size_t pin = 0; pin < pins_.size(); ++pin)
    for (const int sign : {-1, 1}) {
      Global outermost = none;
      for (const Held& h : held_)
        if (h.pin == pin && holds_fast(h)) outermost = std::max(outermost, sign * map.original[h.vertex]);
      outermost = max_over(cloth.mesh.comm, outermost);
      if (outermost == none) continue;
      std::array<double, 3> place{};
      for (const Held& h : held_)
        if (map.original[h.vertex] == sign * outermost && cloth.mesh.owns_vertex(h.vertex))
          for (int k = 0; k < 3; ++k) place[k] = h.start[k];
      sum_in_place(cloth.mesh.comm, place);
      result.push_back({pin, sign * outermost, Vec3(place[0], place[1], place[2])});
    }
  return result;
}

/// A line or plane turns with its pin: the place of a point of it less that of the vertex itself.
void Pins::restrict_motion(const Held& h, double time, Freedom& freedom) const {
  const config::Pin& pin = pins_[h.pin];
  if (!pin.along && !pin.plane) return freedom.hold(h.vertex);
  const Vec3 direction = (pin.along ? *pin.along : *pin.plane).normalized();
  const Vec3 turned =
      (place_at(pin.motion, h.start + direction, time) - place_at(pin.motion, h.start, time)).normalized();
  pin.along ? freedom.keep_on_line(h.vertex, turned) : freedom.keep_in_plane(h.vertex, turned);
}

void Pins::prescribe(const State& state, double dt, Freedom& freedom, std::vector<Vec3>& velocities) const {
  freedom.free_all();
  for (const Held& h : held_) {
    const config::Pin& pin = pins_[h.pin];
    if (pin.release && state.time >= *pin.release - 1e-9 * dt) continue;
    restrict_motion(h, state.time + dt, freedom);
    const Vec3 to_place = (place_at(pin.motion, h.start, state.time + dt) - state.positions[h.vertex]) / dt;
    Vec3& v = velocities[h.vertex];
    v = freedom.allowed(h.vertex, v) + freedom.denied(h.vertex, to_place);
  }
}

std::optional<std::string> Pins::find_jump(const Cloth& cloth, const State& state) const {
  constexpr double round_off = 1e-6; // m, and of its distance from the origin; far more than steps leave
  Freedom freedom(cloth.mesh.vertices.size());
  double farthest = 0;
  std::string words;
  for (const Held& h : held_) {
    const config::Pin& pin = pins_[h.pin];
    if (!cloth.mesh.owns_vertex(h.vertex) || (pin.release && state.time >= *pin.release)) continue;
    restrict_motion(h, state.time, freedom);
    const Vec3 &here = state.positions[h.vertex], place = place_at(pin.motion, h.start, state.time);
    const double off = freedom.denied(h.vertex, place - here).norm();
    if (!(off > std::max(farthest, round_off * (1 + place.norm())))) continue;
    farthest = off;
    words = fmt::format("pins.{}: at {:g} s vertex {} is {:.3g} m away from where its pin has it", h.pin,
                        state.time, cloth.mesh.vertices.original[h.vertex], off);
  }
  const MPI_Comm comm = cloth.mesh.comm;
  const double most = max_over(comm, farthest);
  if (most == 0) return std::nullopt;
  const Global speaker = max_over(comm, farthest == most ? Global(rank_of(comm)) : -1);
  return broadcast_text(comm, words, int(speaker));
}

std::vector<Vec3> Pins::totals(const Cloth& cloth, std::span<const Vec3> reaction) const {
  std::vector<Vec3> totals(pins_.size(), Vec3::Zero());
  for (const Held& h : held_)
    if (cloth.mesh.owns_vertex(h.vertex)) totals[h.pin] += reaction[h.vertex];
  return totals;
}

} // namespace taut
