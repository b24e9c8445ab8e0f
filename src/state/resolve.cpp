#include "src/state/resolve.hpp"

#include "src/config/methods.hpp"

#include <cmath>

namespace taut {

namespace {

/// In N. Collective.
double weight_of(const Cloth& cloth, double gravity) {
  double mass = 0;
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) mass += cloth.mass[i];
  return sum_over(cloth.mesh.comm, mass) * gravity;
}

/// The compliance c in 1/N, unless the case says it. It is such that a taut thread which bears the whole
/// weight W stretches by e = a tenth of the limit: it sags by s with e = 8/3 (s/L)^2 and T = W L/(8 s), so c
/// = e/T = 4.9 e^(3/2) / W.
double default_compliance(double strain_limit, double weight) {
  return weight > 0 ? 4.9 * std::pow(0.1 * strain_limit, 1.5) / weight : 0.0;
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

Resolved resolve(const Case& input, const Cloth& cloth) {
  Resolved result;
  result.inextensibility = input.inextensibility;
  result.weight = weight_of(cloth, input.gravity.largest());
  config::Inextensibility& limits = result.inextensibility;
  limits.constrain = constrain_of(input, cloth);
  if (limits.faces != config::Inextensibility{}.faces &&
      limits.method == config::InextensibilityMethod::newton &&
      input.contact_model() != config::ContactModel::constraint)
    throw InputError(input.file.string() + ": inextensibility.faces: method newton has no such bound without "
                                           "contact; remove it, or choose method fast_projection");
  if (!limits.solver) limits.solver = default_solver(input, cloth, *limits.constrain);
  if (!limits.compliance && limits.method != config::InextensibilityMethod::xpbd) {
    limits.compliance = default_compliance(limits.strain, result.weight);
    limits.may_bound_compliance = config::holds_limit(input);
  }
  if (!config::holds_limit(input)) return result;
  result.strain_limit = limits.strain;
  if (limits.constrain == config::Constrain::vertices &&
      (config::is_filter(limits.method) || input.contact_model() == config::ContactModel::constraint))
    result.faces_limit = limits.faces * limits.strain;
  return result;
}

} // namespace taut
