#pragma once
#include "src/contact/contact_search.hpp"
#include "src/state/contact_memory.hpp"

namespace taut {

/// What two steps have in common: an impact is in one of them only.
ContactImpulse lasting(const ContactImpulse& before, const ContactImpulse& now);

/// Two features near each other, wherever pairs found them.
struct Contact {
  std::array<Local, 4> vertices;
  std::array<double, 4> weights; ///< sum_i weights[i] x_i goes from the second feature to the first
  Vec3 normal;
  double inverse_effective_mass; ///< 1/kg: so much the features part per unit of what presses them
  double violation;              ///< m by which they have to part
  ContactKey key;
  double friction;   ///< Coulomb's coefficient
  std::int16_t body; ///< the obstacle, or -1
  bool is_close;     ///< to its thickness, or has stopped the safe iterate
};

/// One scalar condition on a contact: its left side is direction . sum_i weights[i] y_i.
struct ContactRow {
  Local contact;
  bool is_normal;
  Vec3 direction;
  double violation;    ///< m by which the left side has to grow
  double lower, upper; ///< of the multiplier's increment
  double slack;        ///< m that may stay violated
  double guess;        ///< of the multiplier's increment
};

/// The features of a pair that are in play at its closest points, those with a weight.
ContactKey key_of(const Pair& pair, const Approach& approach, std::span<const Global> keys);

struct HashOfKey {
  std::size_t operator()(const ContactKey& key) const {
    std::size_t hash = 0;
    for (const Global part : key) hash = (hash ^ std::size_t(part)) * 0x9e3779b97f4a7c15u;
    return hash ^ hash >> 32;
  }
};

/// Names a pair by its vertices, whatever its closest points are.
ContactKey name_of(const Pair& pair, std::span<const Global> keys);

} // namespace taut
