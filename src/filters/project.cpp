#include "src/filters/project.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

using Complaint = std::optional<std::string>;

Complaint fault_of(const ProjectOptions& o) {
  if (!(o.strain > 0 && o.strain < 1)) return "project: options.strain must be above 0 and below 1";
  if (o.max_iterations < 1) return "project: options.max_iterations must be at least 1";
  if (!(o.compliance >= 0 && std::isfinite(o.compliance)))
    return "project: options.compliance must not be negative";
  if (!(o.dt > 0 && std::isfinite(o.dt))) return "project: options.dt must be above 0";
  return std::nullopt;
}

template<class T>
Complaint fault_of_size(const DistributedMesh& mesh, const char* name, std::span<const T> values) {
  const std::size_t expected = mesh.vertices.size();
  if (values.size() == expected) return std::nullopt;
  return fmt::format("project: there are {} {} on a rank with {} local vertices; give one for each",
                     values.size(), name, expected);
}

/// The masses of local vertices, ghosts current.
std::vector<double> checked_masses(const DistributedMesh& mesh, std::span<const double> given) {
  agree(mesh.comm, fault_of_size(mesh, "masses", given));
  std::vector<double> masses(given.begin(), given.end());
  const auto owned = given.first(mesh.vertices.owned);
  const auto bad = std::find_if(owned.begin(), owned.end(), [](double m) { return !(m > 0); });
  Complaint fault;
  if (bad != owned.end())
    fault = fmt::format("project: the mass of vertex {} is {}; it must be above 0, or `held`",
                        mesh.vertices.original[bad - owned.begin()], *bad);
  agree(mesh.comm, fault);
  mesh.vertex_halo.update(masses);
  return masses;
}

Cloth cloth_of(const DistributedMesh& mesh, std::span<const double> masses, const ProjectOptions& options) {
  agree(mesh.comm, fault_of(options));
  std::vector<double> checked = checked_masses(mesh, masses);
  Cloth cloth = make_cloth(mesh, config::Material{});
  cloth.mass = std::move(checked);
  return cloth;
}

config::Inextensibility inextensibility(const ProjectOptions& o) {
  config::Inextensibility result;
  result.strain = o.strain;
  result.max_iterations = o.max_iterations;
  result.solver = o.solver;
  result.compliance = o.compliance;
  return result;
}

} // namespace

Projector::Projector(const DistributedMesh& mesh, std::span<const double> masses,
                     const ProjectOptions& options)
    : cloth_(cloth_of(mesh, masses, options)), dt_(options.dt), filter_(cloth_, inextensibility(options)),
      freedom_(cloth_.mass.size()) {
  for (Local i = 0; i < Local(cloth_.mass.size()); ++i)
    if (std::isinf(cloth_.mass[i])) freedom_.hold(i);
}

/// A step from the candidate at rest: the filter's velocities are then the correction over dt.
std::vector<Vec3> Projector::project(std::span<const Vec3> candidate) {
  const DistributedMesh& mesh = cloth_.mesh;
  agree(mesh.comm, fault_of_size(mesh, "positions in the candidate", candidate));
  const auto owned = candidate.first(mesh.vertices.owned);
  const bool finite = std::all_of(owned.begin(), owned.end(), [](const Vec3& x) { return x.allFinite(); });
  agree(mesh.comm, finite ? Complaint() : "project: the candidate holds a position that is not a number");
  State start;
  start.positions.assign(candidate.begin(), candidate.end());
  mesh.vertex_halo.update(start.positions);
  Candidate step;
  step.velocities.assign(candidate.size(), Vec3::Zero());
  step.multipliers.force_density.assign(mesh.edges.size(), 0.0);
  const FilterReport report = filter_.apply(start, dt_, freedom_, step);
  if (!report.failure.empty()) throw ProjectionError(report.failure);
  for (std::size_t i = 0; i < candidate.size(); ++i) start.positions[i] += dt_ * step.velocities[i];
  return std::move(start.positions);
}

std::vector<Vec3> project(const DistributedMesh& mesh, std::span<const double> masses,
                          std::span<const Vec3> candidate, const ProjectOptions& options) {
  return Projector(mesh, masses, options).project(candidate);
}

} // namespace taut
