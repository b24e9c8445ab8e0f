#pragma once
#include "src/contact/contact_search.hpp"
#include "src/state/contact_memory.hpp"

namespace taut {

/// What two steps have in common: an impact is in one of them only.
Pressed lasting(const Pressed& before, const Pressed& now);

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
  double friction = 0;    ///< Coulomb coefficient, of a normal row
  std::int16_t body = -1; ///< the obstacle, of a normal row
};

/// The features of a pair that are in play at its closest points, those with a weight.
ContactKey key_of(const Pair& pair, const Approach& approach, std::span<const Global> keys);

/// Names a pair by its vertices, whatever its closest points are.
ContactKey name_of(const Pair& pair, std::span<const Global> keys);

} // namespace taut
