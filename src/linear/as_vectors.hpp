#pragma once
#include "partition/types.hpp"

#include <span>

namespace taut {

/// Three numbers each as a vector in space.
inline std::span<Vec3> as_vectors(std::span<double> numbers) {
  return {reinterpret_cast<Vec3*>(numbers.data()), numbers.size() / 3};
}

} // namespace taut
