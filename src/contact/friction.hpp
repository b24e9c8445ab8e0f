#pragma once
#include "src/contact/obstacles.hpp"
#include "src/contact/pair.hpp"

namespace taut {

/// Coulomb's coefficient between the features of a pair: that of the obstacle, or of cloth on cloth.
inline double friction_of(const Pair& pair, const Obstacles& obstacles, const config::Contact& contact) {
  return pair.body >= 0 ? obstacles.body(pair.body).friction : contact.friction;
}

} // namespace taut
