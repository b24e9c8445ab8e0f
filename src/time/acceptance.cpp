#include "src/time/acceptance.hpp"

#include <fmt/format.h>

#include <cmath>

namespace taut {

namespace {

/// With three digits, or as many as it takes to be seen to differ.
std::string told_apart(double value, double limit) {
  int digits = 3;
  while (digits < 17 && fmt::format("{:.{}g}", value, digits) == fmt::format("{:.{}g}", limit, digits))
    ++digits;
  return fmt::format("{:.{}g}", value, digits);
}

} // namespace

Acceptance::Acceptance(const Cloth& cloth, const Resolved& resolved, std::optional<double> max_stretch_change)
    : cloth_(cloth), constrain_(*resolved.inextensibility.constrain), strain_limit_(resolved.strain_limit),
      max_stretch_change_(max_stretch_change), gauge_(cloth, constrain_) {
  if (max_stretch_change || constrain_ == config::Constrain::vertices) tangents_ = tangents_of(cloth);
}

std::string Acceptance::fault_of(const State& state, const Candidate& candidate, const Strain& strain) const {
  if (!std::isfinite(strain.max)) return "positions are no longer numbers";
  if (is_beyond_limit(strain))
    return fmt::format("the measured strain is {}, over the limit {:g}",
                       told_apart(strain.max, *strain_limit_), *strain_limit_);
  return fault_of_stretch(state, candidate);
}

/// How drastically stretch changes in the step [BW98 section 6].
std::string Acceptance::fault_of_stretch(const State& state, const Candidate& candidate) const {
  if (!max_stretch_change_) return "";
  const double change = largest_stretch_change(cloth_, tangents_, state.positions, candidate.positions);
  if (change <= *max_stretch_change_) return "";
  return fmt::format("the stretch of warp or weft changes by {:.3g}, over time.max_stretch_change, {:g}",
                     change, *max_stretch_change_);
}

double Acceptance::face_strain(std::span<const Vec3> positions) const {
  if (constrain_ != config::Constrain::vertices) return 0;
  return largest_strain(cloth_, tangents_, positions);
}

} // namespace taut
