#include "src/contact/solid_constraints.hpp"

#include "src/contact/friction.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double at_rest = 0.01; ///< of what friction can stop in a step: slip below it is none
constexpr double arrived =
    0.99; ///< of the thickness: one that was let go stands a rounding error away from it

/// The vertices of the cloth that are near an obstacle if `pair` is, each with it: of what is near a round
/// one, all; otherwise the one that meets a plane or a face.
std::vector<Pair> vertices_near(const Pair& pair, const ContactScene& scene) {
  if (!scene.obstacles().body(pair.body).is_round)
    return pair.kind != PairKind::edge_edge && scene.is_cloth(pair.vertices[0]) ? std::vector{pair}
                                                                                : std::vector<Pair>{};
  std::vector<Local> axis; // one or two vertices of the obstacle
  for (const Local v : pair.vertices)
    if (!scene.is_cloth(v)) axis.push_back(v);
  std::vector<Pair> found;
  for (const Local v : pair.vertices)
    if (scene.is_cloth(v))
      found.push_back({{v, axis.front(), axis.back(), axis.front()},
                       PairKind::vertex_edge,
                       pair.body,
                       pair.radius,
                       pair.normal});
  return found;
}

} // namespace

SolidConstraints::SolidConstraints(const Cloth& cloth, const Obstacles& obstacles, const Case& input)
    : contact_(*input.contact), thickness_(cloth, input), scene_(cloth, obstacles),
      rests_(cloth.mesh.vertices.size()), alteration_(cloth.mesh.vertices.size()) {}

void SolidConstraints::find(const State& state, double dt, const Freedom& freedom) {
  const std::vector<Nearest> found = nearest(state, dt);
  for (Local i = 0; i < scene_.search.own(); ++i) {
    rests_[i] = {};
    alteration_[i] = Vec3::Zero();
    if (!freedom.is_free(i) || found[i].gap == HUGE_VAL) continue;
    rests_[i] = rest_on(found[i], state.multipliers.carried_contact_force[i],
                        scene_.cloth().mass[i] * (state.velocities[i] - found[i].surface), dt);
    if (rests_[i].hold != Hold::none) alteration_[i] = (found[i].thickness - found[i].gap) * found[i].normal;
  }
  scene_.cloth().mesh.vertex_halo.update(rests_);
  scene_.cloth().mesh.vertex_halo.update(alteration_);
}

/// What each vertex is nearest to, of what comes within twice the thickness; a pair may have been found by
/// another rank than the vertex's.
std::vector<SolidConstraints::Nearest> SolidConstraints::nearest(const State& state, double dt) {
  scene_.begin(state, dt);
  const double reach = 2.0 * thickness_.largest();
  scene_.search.find(ContactScene::between(scene_.start(), scene_.start()), reach);
  scene_.gather_start();
  scene_.gather_target();
  const auto from = scene_.start_field(), to = scene_.target_field();
  std::vector<Nearest> result(scene_.search.size());
  for (const Pair& met : scene_.search.pairs()) {
    if (met.body < 0) continue;
    for (const Pair& pair : vertices_near(met, scene_)) {
      const Approach here = approach(pair, at(pair, from));
      if (here.gap > reach) continue;
      Vec3 moves = scene_.spin(pair.body, here.offset(pair)); // of what is fixed to the body there
      for (int i = 1; i < 4; ++i) moves -= here.weights[i] * (to[pair.vertices[i]] - from[pair.vertices[i]]);
      Nearest& known = result[pair.vertices[0]];
      known = std::min(known, Nearest{here.gap, thickness_.of(pair, scene_.search.keys()), here.normal,
                                      moves / dt, friction_of(pair, scene_.obstacles(), contact_)});
    }
  }
  scene_.search.plan().reverse_min<Nearest>(result, result);
  return result;
}

/// By the force that the obstacle exerted on the vertex in the step before, and its momentum relative to the
/// surface.
SolidConstraints::Rest SolidConstraints::rest_on(const Nearest& nearest, const Vec3& force,
                                                 const Vec3& momentum, double dt) const {
  const Vec3& n = nearest.normal;
  const double normal_force = n.dot(force);
  const bool was_held = !force.isZero(0);
  if (was_held ? normal_force <= 0 : nearest.gap > arrived * nearest.thickness) return {};
  Rest rest{Hold::slips, n, nearest.surface, Vec3::Zero()};
  const double most = nearest.friction * normal_force;
  if (most <= 0) return rest; // has just arrived, or is smooth
  const Vec3 slips = momentum - n.dot(momentum) * n, held = force - normal_force * n;
  const bool slipped = slips.norm() > at_rest * dt * most;
  if (slipped ? slips.norm() <= dt * most : held.norm() <= most)
    rest.hold = Hold::sticks;
  else
    rest.friction = most * (slipped ? Vec3(-slips.normalized()) : Vec3(held.normalized()));
  return rest;
}

void SolidConstraints::prescribe(Freedom& freedom, std::vector<Vec3>& velocities) const {
  for (std::size_t i = 0; i < rests_.size(); ++i) {
    const Rest& rest = rests_[i];
    if (rest.hold == Hold::none) continue;
    if (rest.hold == Hold::sticks)
      freedom.hold(Local(i));
    else
      freedom.keep_in_plane(Local(i), rest.normal);
    velocities[i] = freedom.allowed(Local(i), velocities[i]) + freedom.denied(Local(i), rest.surface);
  }
}

bool SolidConstraints::let_go(std::span<const Vec3> reaction) {
  bool any = false;
  for (Local i = 0; i < scene_.search.own(); ++i) {
    if (rests_[i].hold == Hold::none || rests_[i].normal.dot(reaction[i]) >= 0) continue;
    rests_[i] = {};
    any = true;
  }
  any = any_of(scene_.cloth().mesh.comm, any);
  if (any) scene_.cloth().mesh.vertex_halo.update(rests_);
  return any;
}

void SolidConstraints::loosen(Freedom& freedom) const {
  for (std::size_t i = 0; i < rests_.size(); ++i)
    if (rests_[i].hold == Hold::sticks) freedom.keep_in_plane(Local(i), rests_[i].normal);
}

void SolidConstraints::add_friction(StepSystem& system) const {
  for (Local i = 0; i < scene_.search.own(); ++i)
    if (rests_[i].hold == Hold::slips) system.add_force(i, rests_[i].friction);
}

void SolidConstraints::note_forces(Candidate& candidate) const {
  for (Local i = 0; i < scene_.search.own(); ++i) {
    const Rest& rest = rests_[i];
    if (rest.hold == Hold::none) continue;
    candidate.reported.contact_force[i] = candidate.reported.reaction[i] + rest.friction;
    candidate.reported.reaction[i] = Vec3::Zero();
    candidate.multipliers.carried_contact_force[i] = candidate.reported.contact_force[i];
  }
  scene_.cloth().mesh.vertex_halo.update(candidate.multipliers.carried_contact_force);
}

} // namespace taut
