#pragma once
#include "src/contact/contact_search.hpp"
#include "src/state/freedom.hpp"
#include "src/state/inverse_mass.hpp"
#include "src/state/state.hpp"

namespace taut {

/// Where everything that can collide is: m, of local vertices of the cloth, ghosts current, and of the
/// vertices of all obstacles.
struct Scene {
  std::vector<Vec3> cloth, obstacles;
};

/// Cloth and obstacles over one step: where they start, where they are to end, and the pairs of features that
/// can meet on the way. Its contact fields have the places of the last search.
class ContactScene {
public:
  /// Both must outlive the scene. Obstacles stop `strings` (see strings_clear_of) too. Collective.
  ContactScene(const Cloth& cloth, const Obstacles& obstacles, std::span<const Element> strings = {});

  /// The step from `state` over `dt` seconds, in which local vertices move at `velocities`. Not collective.
  void begin(const State& state, double dt, std::span<const Vec3> velocities);
  /// The same with the cloth at rest.
  void begin(const State& state, double dt);

  /// And only as `freedom` allows. Not collective.
  void restrict_to(const Freedom& freedom) { take_inverse_masses(cloth_, freedom, inverse_mass_); }

  Motion motion() const { return between(start_, target); }
  static Motion between(const Scene& from, const Scene& to) {
    return {from.cloth, to.cloth, from.obstacles, to.obstacles};
  }

  /// Brings the fields of what stays in a step to the places of the search. Collective over neighbours.
  void gather_start();
  /// The same of the target. Collective over neighbours.
  void gather_target() { gather(target, target_field_); }
  void gather(const Scene& scene, std::vector<Vec3>& field) const {
    search.gather(scene.cloth, scene.obstacles, field);
  }

  /// 1/kg: so much two features part, along any direction, per unit of what presses them.
  double inverse_effective_mass(const Pair& pair, const std::array<double, 4>& weights) const {
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += weights[i] * weights[i] * inverse_mass_field_[pair.vertices[i]];
    return sum;
  }

  /// A vector fixed to a body, as the body turns it over the step.
  Vec3 turned(int body, const Vec3& vector) const { return body >= 0 ? Vec3(turns_[body] * vector) : vector; }

  /// m by which what is fixed to a body moves in excess of its feature nearby, from which it is at `offset`.
  Vec3 spin(int body, const Vec3& offset) const { return turned(body, offset) - offset; }

  /// Whether a vertex at a place of a contact field can be moved.
  bool can_move(Local place) const { return inverse_mass_field_[place] > 0; }

  bool is_cloth(Local place) const { return place < search.own() || place >= search.home(); }

  const Cloth& cloth() const { return cloth_; }
  const Obstacles& obstacles() const { return obstacles_; }
  const Scene& start() const { return start_; }
  std::span<const Vec3> start_field() const { return start_field_; }
  std::span<const Vec3> target_field() const { return target_field_; }
  std::span<const double> inverse_mass() const {
    return inverse_mass_;
  } ///< 1/kg, of local vertices, 0 if held

  ContactSearch search;
  Scene target; ///< where the step is to end; who moves it brings ghosts up to date

private:
  const Cloth& cloth_;
  const Obstacles& obstacles_;
  Scene start_;
  std::vector<Mat3> turns_; ///< of the obstacles over the step
  std::vector<double> inverse_mass_;
  std::vector<double> inverse_mass_field_;
  std::vector<Vec3> start_field_, target_field_;
};

} // namespace taut
