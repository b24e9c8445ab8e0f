#pragma once
#include "io/xdmf.hpp"
#include "src/contact/gap_gauge.hpp"
#include "src/state/state.hpp"

namespace taut {

class H5Writer;

/// What a frame shows of contact: `contact_force` (N on each vertex, pressed and rubbed) and `gap` (m to what
/// is nearest, measured; at most twice the thickness).
class ContactFrames {
public:
  /// `cloth` and `obstacles` must outlive it. Collective.
  ContactFrames(const Cloth& cloth, const Obstacles& obstacles, const Case& input);

  void describe(std::vector<XdmfField>& fields) const;
  void write(H5Writer& file, const State& state); ///< Collective.

private:
  const Cloth& cloth_;
  const Obstacles& obstacles_;
  GapGauge gauge_;
  std::vector<Vec3> bodies_; ///< positions of the obstacles' vertices, m
};

} // namespace taut
