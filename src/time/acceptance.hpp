#pragma once
#include "src/constraints/strain_gauge.hpp"
#include "src/constraints/triangle_bounds.hpp"
#include "src/forces/stretch.hpp"
#include "src/state/resolve.hpp"

#include <string>

namespace taut {

/// Whether a proposed step can be accepted, by what is measured at its end.
class Acceptance {
public:
  /// `max_stretch_change` of a step; none: any. `cloth` must outlive it. Not collective.
  Acceptance(const Cloth& cloth, const Resolved& resolved, std::optional<double> max_stretch_change);

  const StrainGauge& gauge() const { return gauge_; }
  std::optional<double> strain_limit() const { return strain_limit_; }

  /// Also where the strain is not a number.
  bool is_beyond_limit(const Strain& strain) const {
    return strain_limit_ && !(strain.max <= *strain_limit_);
  }

  /// Why the step from `state` to `candidate`, with this strain at its end, cannot be accepted; empty if it
  /// can. Collective.
  std::string fault_of(const State& state, const Candidate& candidate, const Strain& strain) const;

  /// Largest strain of any triangle but slivers (bounded_tangents) along warp or weft, where the limit is for
  /// averages of it; else 0. Collective.
  double face_strain(std::span<const Vec3> positions) const;

private:
  bool is_finite(const Candidate& candidate) const;
  std::string fault_of_faces(const Candidate& candidate) const;
  std::string fault_of_stretch(const State& state, const Candidate& candidate) const;

  const Cloth& cloth_;
  config::Constrain constrain_;
  std::optional<double> strain_limit_, faces_limit_, max_stretch_change_;
  StrainGauge gauge_;
  std::vector<Tangent> tangents_; ///< whose change of stretch is watched
  std::vector<Tangent> faces_;    ///< of owned triangles that have a bound
};

} // namespace taut
