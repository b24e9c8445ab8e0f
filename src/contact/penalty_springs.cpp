#include "src/contact/penalty_springs.hpp"

#include "src/contact/friction.hpp"
#include "src/state/resolve.hpp"

#include <Eigen/Geometry>

namespace taut {

namespace {

constexpr double creep = 5e-3; ///< m/s, below which friction is viscous

/// N/m: with it 500 vertices' weight on one spring use up the thickness.
double default_stiffness(const Cloth& cloth, double gravity, double thickness) {
  const double mean = mass_of(cloth) / double(cloth.mesh.vertices.total);
  return 500.0 * mean * (gravity > 0 ? gravity : 9.81) / thickness;
}

} // namespace

/// One spring in the step's terms: the force at its start and for no motion of the cloth, and what resists.
struct PenaltySprings::Spring {
  std::array<Local, 4> places;
  std::array<double, 4> weights; ///< zero where a place is an obstacle's
  Vec3 force;                    ///< N on the first feature
  std::array<Vec3, 3> resists;   ///< n and two tangents, scaled: resists resists^T is h^2 K + h D
};

PenaltySprings::PenaltySprings(const Cloth& cloth, const Obstacles& obstacles, const Case& input)
    : contact_(*input.contact), gravity_(input.gravity), thickness_(cloth, input), scene_(cloth, obstacles) {
  const config::Penalty given = contact_.penalty.value_or(config::Penalty{});
  stiffness_ =
      given.stiffness.value_or(default_stiffness(cloth, input.gravity.largest(), thickness_.largest()));
  damping_ = given.damping * stiffness_;
}

/// Pairs that may come near enough in free flight.
void PenaltySprings::find_pairs(const State& state, double dt) {
  const Vec3 gravity = gravity_.at(state.time + dt);
  displacement_ = state.velocities;
  for (Vec3& v : displacement_) v += dt * gravity;
  scene_.begin(state, dt, displacement_);
  scene_.search.find(scene_.motion(), thickness_.largest());
  scene_.gather_start();
  scene_.gather(scene_.target, displacement_);
  for (std::size_t i = 0; i < displacement_.size(); ++i) displacement_[i] -= scene_.start_field()[i];
}

/// Whether SolidConstraints keeps the two apart: vertices of the cloth on an obstacle, and all of it on a
/// round one.
bool PenaltySprings::is_solid(const Pair& pair) const {
  if (pair.body < 0) return false;
  const Local v = pair.vertices[0];
  return scene_.obstacles().body(pair.body).is_round ||
         (pair.kind != PairKind::edge_edge && scene_.is_cloth(v));
}

std::optional<PenaltySprings::Spring> PenaltySprings::spring(const Pair& pair, double dt) const {
  if (is_solid(pair)) return {};
  const Approach here = approach(pair, at(pair, scene_.start_field()));
  const auto& w = here.weights;
  if (pair.kind == PairKind::edge_edge && (w[0] == 0 || w[1] == 0 || w[2] == 0 || w[3] == 0))
    return {}; // vertices against faces have it
  Vec3 moves = Vec3::Zero(), body_moves = Vec3::Zero();
  Spring s{pair.vertices, w, Vec3::Zero(), {}};
  for (int i = 0; i < 4; ++i) {
    const Vec3 part = w[i] * displacement_[pair.vertices[i]];
    moves += part;
    if (scene_.is_cloth(pair.vertices[i])) continue;
    body_moves += part;
    s.weights[i] = 0;
  }
  const Vec3& n = here.normal;
  const double thickness = thickness_.of(pair, scene_.search.keys());
  const double ahead = thickness - here.gap - n.dot(moves);
  if (ahead <= 0) return {};
  s.force = (stiffness_ * (thickness - here.gap - n.dot(body_moves)) - damping_ * n.dot(body_moves) / dt) * n;
  s.resists[0] = std::sqrt(dt * dt * stiffness_ + dt * damping_) * n;
  const double friction = friction_of(pair, scene_.obstacles(), contact_);
  const Vec3 spin = scene_.spin(pair.body, here.offset(pair));
  moves -= spin;
  body_moves -= spin;
  const Vec3 slip = moves - n.dot(moves) * n, body_slip = body_moves - n.dot(body_moves) * n;
  const double pressed = stiffness_ * std::max(0.0, thickness - here.gap); // by the step before
  const double drag = friction * pressed / std::max(slip.norm() / dt, creep);
  s.force -= drag / dt * body_slip; // sum w_i v_i of the body has the sign of its weights
  const Vec3 first = n.unitOrthogonal();
  s.resists[1] = std::sqrt(dt * drag) * first;
  s.resists[2] = std::sqrt(dt * drag) * n.cross(first);
  return s;
}

void PenaltySprings::add_to(StepSystem& system, const State& state) {
  const double dt = system.dt();
  find_pairs(state, dt);
  std::vector<ContactCouplings::Term> terms;
  std::vector<Vec3> forces(scene_.search.size(), Vec3::Zero());
  for (const Pair& pair : scene_.search.pairs()) {
    const auto s = spring(pair, dt);
    if (!s) continue;
    for (int i = 0; i < 4; ++i) forces[s->places[i]] += s->weights[i] * s->force;
    for (const Vec3& r : s->resists) {
      if (r.isZero()) continue;
      const auto& w = s->weights;
      terms.push_back({s->places, {w[0] * r, w[1] * r, w[2] * r, w[3] * r}});
    }
  }
  scene_.search.accumulate(forces);
  for (Local i = 0; i < scene_.search.own(); ++i) system.add_force(i, forces[i]);
  system.set_far(
      ContactCouplings(scene_.search.plan(), scene_.search.own(), scene_.search.size(), std::move(terms)));
}

} // namespace taut
