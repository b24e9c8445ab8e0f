#pragma once
#include "src/state/cloth.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// W of a step in 1/kg: 1 / m_i, or 0 where a vertex is held; of local vertices. Where it may move in some
/// directions only, W is S_i / m_i, and S_i is for `freedom` to apply. Not collective.
inline void take_inverse_masses(const Cloth& cloth, const Freedom& freedom, std::span<double> inverse_mass) {
  for (std::size_t i = 0; i < inverse_mass.size(); ++i)
    inverse_mass[i] = freedom.is_held(Local(i)) ? 0.0 : 1.0 / cloth.mass[i];
}

} // namespace taut
