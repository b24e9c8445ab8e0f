#include "src/contact/rows.hpp"

#include <boost/container/static_vector.hpp>

#include <algorithm>

namespace taut {

ContactImpulse lasting(const ContactImpulse& before, const ContactImpulse& now) {
  ContactImpulse both{std::min(before.normal, now.normal), Vec3::Zero()};
  const double along = now.tangent.dot(before.tangent), length = now.tangent.norm();
  if (along > 0) both.tangent = std::min(1.0, along / (length * length)) * now.tangent;
  return both;
}

ContactKey key_of(const Pair& pair, const Approach& approach, std::span<const Global> keys) {
  // First the features with fewer vertices, then the lower numbers, so that one contact has one name.
  boost::container::static_vector<Global, 3> a, b;
  const int split = pair.kind == PairKind::edge_edge ? 2 : 1;
  for (int i = 0; i < 4; ++i)
    if (approach.weights[i] != 0) {
      auto& feature = i < split ? a : b;
      const Global key = keys[pair.vertices[i]];
      feature.insert(std::upper_bound(feature.begin(), feature.end(), key), key);
    }
  if (std::pair(b.size(), b) < std::pair(a.size(), a)) std::swap(a, b);
  ContactKey key{-1, -1, -1, -1};
  std::copy(a.begin(), a.end(), key.begin());
  std::copy(b.begin(), b.end(), key.begin() + a.size());
  // two edges are told from a vertex and a face by the sign of the first number
  if (a.size() == 2) key[0] = -2 - key[0];
  return key;
}

ContactKey name_of(const Pair& pair, std::span<const Global> keys) {
  ContactKey key;
  for (int i = 0; i < 4; ++i) key[i] = keys[pair.vertices[i]];
  if (pair.kind == PairKind::edge_edge) key[0] = -2 - key[0];
  return key;
}

} // namespace taut
