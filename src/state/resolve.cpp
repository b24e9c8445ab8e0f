#include "src/state/resolve.hpp"

#include "src/config/methods.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

/// m/s^2, of the weights below: that of the Earth, or more where the case has more. Where it has less, bodies
/// that press, wind and pins pull as hard as elsewhere. A shirt that sank at a tenth of g onto shoulders was
/// ten times as compliant, yielded by the whole limit to a neck that grew in it, and took 1123 steps for 112.
double gravity_of_loads(const Case& input) {
  constexpr double standard = 9.80665;
  return std::max(standard, input.gravity.largest());
}

/// The compliance c in 1/N, unless the case says it. It is such that a taut thread which bears the whole
/// weight W stretches by e = a tenth of the limit: it sags by s with e = 8/3 (s/L)^2 and T = W L/(8 s), so c
/// = e/T = 4.9 e^(3/2) / W.
double default_compliance(double strain_limit, double weight) {
  return 4.9 * std::pow(0.1 * strain_limit, 1.5) / weight;
}

/// Where only averages around vertices are kept, single triangles may stretch against each other, on
/// irregular meshes until no step is found. What hinders them is a stiffness at which the weight of the
/// piece, spread over its width, would strain it by a tenth of the limit. With a tenth of that stiffness
/// pins that pull hold triangles at their bounds, whose force no prediction knows: a disc that hangs by two
/// patches takes three times the CPU time, and a sleeve that pins pull over an arm ends with 3 from one of
/// six starts. Newton's method with contact has none: it is the stiffest of forces, linear in the step, and a
/// sheet that was pressed out of its plane went off at 5 m/s; without it a disc of 259 vertices rests on a
/// ball with 5e-7 J after 3 s, by Fast Projection with 7e-5. Collective.
double default_stretch(const Cloth& cloth, std::size_t k, const Case& input) {
  if (config::constrain_of(input, cloth.mesh.has_triangles) == config::Constrain::edges) return 0;
  const bool has_contact = input.contact_model() == config::ContactModel::constraint;
  if (has_contact && input.inextensibility.method == config::InextensibilityMethod::newton) return 0;
  std::array<double, 2> sums{}; // kg, m^2
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) {
    if (cloth.piece_of(i) != k) continue;
    sums[0] += cloth.mass[i];
    sums[1] += cloth.measure[i];
  }
  sum_in_place(cloth.mesh.comm, sums);
  constexpr double part = 0.1;
  return sums[0] * gravity_of_loads(input) / (std::sqrt(sums[1]) * part * input.inextensibility.strain);
}

std::vector<Vec2> stretch_of_sections(const Case& input, const Cloth& cloth) {
  std::vector<double> by_default; // of pieces
  for (std::size_t k = 0; k < cloth.pieces.size(); ++k)
    by_default.push_back(default_stretch(cloth, k, input));
  std::vector<Vec2> result;
  for (const Section& section : cloth.sections) {
    const config::Material& material = cloth.material_of(section);
    const double warp = material.stretch.value_or(by_default[section.piece]);
    result.emplace_back(warp, material.stretch_weft.value_or(warp));
  }
  return result;
}

config::Constrain constrain_of(const Case& input, const Cloth& cloth) {
  const config::Constrain constrain = config::constrain_of(input, cloth.mesh.has_triangles);
  if (constrain == config::Constrain::vertices && !cloth.mesh.has_triangles)
    throw InputError(input.file.string() + ": inextensibility.constrain: vertices is for meshes with "
                                           "triangles; quads and lines keep warp and weft "
                                           "by their edges: choose edges");
  if (constrain == config::Constrain::vertices && !cloth.mesh.triangles_only &&
      input.inextensibility.solver == config::LinearSolver::mumps &&
      input.inextensibility.method != config::InextensibilityMethod::newton)
    throw InputError(input.file.string() +
                     ": inextensibility.solver: mumps has no matrix for triangles beside quads or lines; "
                     "choose cg, or constrain: edges");
  return constrain;
}

/// Grids do badly where triangles lie in no order, and the factor of a mesh of a few thousand vertices costs
/// no more than they do (src/newton/README.md).
config::LinearSolver default_solver(const Case& input, const Cloth& cloth, config::Constrain constrain) {
  const bool factors = input.inextensibility.method == config::InextensibilityMethod::newton &&
                       constrain == config::Constrain::vertices &&
                       cloth.mesh.vertices.total <= most_vertices_to_factor;
  return factors ? config::LinearSolver::mumps : config::LinearSolver::cg;
}

} // namespace

double mass_of(const Cloth& cloth) {
  double mass = 0;
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) mass += cloth.mass[i];
  return sum_over(cloth.mesh.comm, mass);
}

Resolved resolve(const Case& input, const Cloth& cloth) {
  Resolved result;
  result.inextensibility = input.inextensibility;
  const double mass = mass_of(cloth);
  result.weight = mass * input.gravity.largest();
  config::Inextensibility& limits = result.inextensibility;
  limits.constrain = constrain_of(input, cloth);
  if (limits.faces != config::Inextensibility{}.faces &&
      limits.method == config::InextensibilityMethod::newton &&
      input.contact_model() != config::ContactModel::constraint)
    throw InputError(input.file.string() + ": inextensibility.faces: method newton has no such bound without "
                                           "contact; remove it, or choose method fast_projection");
  if (!limits.solver) limits.solver = default_solver(input, cloth, *limits.constrain);
  if (!limits.compliance && limits.method != config::InextensibilityMethod::xpbd) {
    limits.compliance = default_compliance(limits.strain, mass * gravity_of_loads(input));
    limits.may_bound_compliance = config::holds_limit(input);
  }
  result.stretch = stretch_of_sections(input, cloth);
  if (!config::holds_limit(input)) return result;
  result.strain_limit = limits.strain;
  if (limits.constrain == config::Constrain::vertices &&
      (config::is_filter(limits.method) || input.contact_model() == config::ContactModel::constraint))
    result.faces_limit = limits.faces * limits.strain;
  return result;
}

} // namespace taut
