#include "src/contact/rows.hpp"

#include <algorithm>
#include <tuple>

namespace taut {

Pressed lasting(const Pressed& before, const Pressed& now) {
  Pressed both{std::min(before.normal, now.normal), Vec3::Zero()};
  const double along = now.tangent.dot(before.tangent), length = now.tangent.norm();
  if (along > 0) both.tangent = std::min(1.0, along / (length * length)) * now.tangent;
  return both;
}

namespace {

/// Numbers of at most three vertices, in order.
struct Feature {
  std::array<Global, 3> numbers{-1, -1, -1};
  int size = 0;

  void add(Global number) {
    int i = size++;
    for (; i > 0 && numbers[i - 1] > number; --i) numbers[i] = numbers[i - 1];
    numbers[i] = number;
  }
  bool operator<(const Feature& other) const {
    return std::tie(size, numbers) < std::tie(other.size, other.numbers);
  }
};

} // namespace

ContactKey key_of(const Pair& pair, const Approach& approach, std::span<const Global> keys) {
  // First the features with fewer vertices, then the lower numbers, so that one contact has one name.
  Feature a, b;
  const int split = pair.kind == PairKind::edge_edge ? 2 : 1;
  for (int i = 0; i < 4; ++i)
    if (approach.weights[i] != 0) (i < split ? a : b).add(keys[pair.vertices[i]]);
  if (b < a) std::swap(a, b);
  ContactKey key{-1, -1, -1, -1};
  std::copy_n(a.numbers.begin(), a.size, key.begin());
  std::copy_n(b.numbers.begin(), b.size, key.begin() + a.size);
  // two edges are told from a vertex and a face by the sign of the first number
  if (a.size == 2) key[0] = -2 - key[0];
  return key;
}

ContactKey name_of(const Pair& pair, std::span<const Global> keys) {
  ContactKey key;
  for (int i = 0; i < 4; ++i) key[i] = keys[pair.vertices[i]];
  if (pair.kind == PairKind::edge_edge) key[0] = -2 - key[0];
  return key;
}

} // namespace taut
