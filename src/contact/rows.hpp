#pragma once
#include "src/contact/contact_search.hpp"

#include <map>

namespace taut {

/// Names two features in contact, whichever pairs found them: the vertices in play, in an order of their own,
/// -1 for none.
using ContactKey = std::array<Global, 4>;

/// What has been pressed and rubbed between two features: position-level multipliers, kg m (newtons times the
/// step squared).
struct Pressed {
  double normal = 0;
  Vec3 tangent = Vec3::Zero();

  Pressed scaled(double factor) const { return {normal * factor, tangent * factor}; }
};

/// What two steps have in common: an impact is in one of them only.
Pressed lasting(const Pressed& before, const Pressed& now);

using PressedMap = std::map<ContactKey, Pressed>;

/// One scalar condition between the vertices of a pair: its left side is direction . sum_i weights[i] y_i.
struct ContactRow {
  std::array<Local, 4> vertices;
  std::array<double, 4> weights;
  Vec3 direction;
  double mobility;     ///< 1/kg: the left side grows by it per unit of the multiplier, the other rows aside
  double missing;      ///< m by which the left side has to grow
  double lower, upper; ///< of the multiplier's increment
  double slack;        ///< m that may stay missing
  double guess;        ///< of the multiplier's increment
  ContactKey key;
  bool is_normal;
  double friction = 0; ///< Coulomb coefficient, of a normal row
};

/// The features of a pair that are in play at its closest points, those with a weight.
ContactKey key_of(const Pair& pair, const Approach& approach, std::span<const Global> keys);

} // namespace taut
