#include "src/time/acceptance.hpp"

#include "src/state/told_apart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

Acceptance::Acceptance(const Cloth& cloth, const Resolved& resolved, std::optional<double> max_stretch_change)
    : cloth_(cloth), constrain_(*resolved.inextensibility.constrain), strain_limit_(resolved.strain_limit),
      faces_limit_(resolved.faces_limit), max_stretch_change_(max_stretch_change), gauge_(cloth, constrain_) {
  if (max_stretch_change) tangents_ = tangents_of(cloth);
  if (constrain_ == config::Constrain::vertices) faces_ = bounded_tangents(cloth, cloth.mesh.owned_cells);
}

/// The limit may hold for none of what a vertex belongs to, and its velocity is part of the next step.
bool Acceptance::is_finite(const Candidate& candidate) const {
  const auto all = [](const std::vector<Vec3>& field) {
    return std::all_of(field.begin(), field.end(), [](const Vec3& v) { return v.allFinite(); });
  };
  const bool mine = all(candidate.positions) && all(candidate.velocities) && all(candidate.end_velocities);
  return !any_of(cloth_.mesh.comm, !mine);
}

std::string Acceptance::fault_of(const State& state, const Candidate& candidate, const Strain& strain) const {
  if (!std::isfinite(strain.max) || !is_finite(candidate)) return "positions are no longer numbers";
  if (is_beyond_limit(strain))
    return fmt::format("the measured strain is {}, over the limit {:g}",
                       told_apart(strain.max, *strain_limit_), *strain_limit_);
  const std::string fault = fault_of_faces(candidate);
  return fault.empty() ? fault_of_stretch(state, candidate) : fault;
}

std::string Acceptance::fault_of_faces(const Candidate& candidate) const {
  if (!faces_limit_) return "";
  const double strain = face_strain(candidate.positions);
  if (strain <= *faces_limit_) return "";
  return fmt::format("a single triangle strains by {}, over its limit {:g}",
                     told_apart(strain, *faces_limit_), *faces_limit_);
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
  return largest_strain(cloth_, faces_, positions);
}

} // namespace taut
