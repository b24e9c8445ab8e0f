#include "src/time/make_forces.hpp"

#include "src/config/methods.hpp"
#include "src/contact/penalty_springs.hpp"
#include "src/forces/air_drag.hpp"
#include "src/forces/angle_bending.hpp"
#include "src/forces/bending.hpp"
#include "src/forces/carried_contact.hpp"
#include "src/forces/carried_tension.hpp"
#include "src/forces/diagonal_springs.hpp"
#include "src/forces/gravity.hpp"
#include "src/forces/isometric_bending.hpp"
#include "src/forces/shear.hpp"
#include "src/forces/springs.hpp"
#include "src/forces/stretch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

using config::BendingModel;
using config::Material;

bool has_cells_of(const Cloth& cloth, int vertices) {
  const auto& cells = cloth.mesh.cells;
  return any_of(cloth.mesh.comm, std::any_of(cells.begin(), cells.end(),
                                             [&](const LocalCell& c) { return c.size() == vertices; }));
}

[[noreturn]] void refuse(const Case& input, const std::string& key, const std::string& why) {
  throw InputError(fmt::format("{}: cloth.material.{}: {}", input.file.string(), key, why));
}

/// Whether the model can do what the material asks of it.
void check_bending(const Case& input, const Cloth& cloth, BendingModel model, std::span<const Fold> folds) {
  const Material& material = cloth.material;
  const std::string name(config::words_of(model)[std::size_t(model)]);
  if (model == BendingModel::yarn && has_cells_of(cloth, 3))
    refuse(input, "bending_model",
           "yarn cannot serve this mesh: its triangles have no yarns; use isometric, discrete_shells or "
           "baraff_witkin");
  if (model == BendingModel::yarn && material.bending_weft)
    refuse(input, "bending_weft",
           "yarn bends all threads alike; use isometric, discrete_shells or baraff_witkin");
  constexpr double flat = 1e-6; // rad
  if (material.rest_angles == config::RestAngles::mesh && model != BendingModel::discrete_shells &&
      (model == BendingModel::yarn || largest_rest_angle(cloth, folds) > flat))
    refuse(
        input, "rest_angles",
        fmt::format("mesh: {} knows no rest shape but a flat one; use discrete_shells, or rest_angles: flat",
                    name));
}

std::unique_ptr<Force> make_fold_bending(const Cloth& cloth, const Pattern& pattern, BendingModel model,
                                         std::span<const Fold> folds) {
  const Material& material = cloth.material;
  const double damping = material.damping.stiffness;
  if (model == BendingModel::isometric)
    return std::make_unique<IsometricBending>(cloth, pattern, folds, damping);
  const bool curved = material.rest_angles == config::RestAngles::mesh;
  return std::make_unique<AngleBending>(cloth, folds, curved ? RestAngle::of_rest_shape : RestAngle::flat,
                                        damping);
}

void add_bending(const Cloth& cloth, const Pattern& pattern, const Case& input, Forces& forces) {
  const Material& material = cloth.material;
  const BendingModel model = material.bending_model.value();
  const auto folds = folds_of(cloth, material.bending, material.bending_weft.value_or(material.bending));
  check_bending(input, cloth, model, folds);
  if (model != BendingModel::yarn) forces.push_back(make_fold_bending(cloth, pattern, model, folds));
  if (model == BendingModel::yarn || has_cells_of(cloth, 2))
    forces.push_back(std::make_unique<YarnBending>(
        cloth, pattern, model == BendingModel::yarn ? Threads::all : Threads::lines, material.bending,
        material.damping.stiffness));
}

void add_shear(const Cloth& cloth, const Pattern& pattern, const Case& input, Forces& forces) {
  const Material& material = cloth.material;
  const double damping = material.damping.stiffness;
  if (material.shear_model == config::ShearModel::baraff_witkin) {
    forces.push_back(std::make_unique<Shear>(cloth, pattern, material.shear, damping));
    return;
  }
  if (has_cells_of(cloth, 3))
    refuse(input, "shear_model", "diagonals cannot serve this mesh: triangles have none; use baraff_witkin");
  forces.push_back(std::make_unique<DiagonalSprings>(cloth, pattern, material.shear, damping));
}

/// Where only averages around vertices are kept, single triangles may stretch against each other, on
/// irregular meshes until no step is found. What hinders them is a stiffness at which the weight of the
/// cloth, spread over its width, would strain it by a tenth of the limit.
double stretch_stiffness(const Cloth& cloth, const Case& input) {
  if (cloth.material.stretch) return *cloth.material.stretch;
  if (config::constrain_of(input, cloth.mesh.triangles_only) == config::Constrain::edges) return 0;
  std::array<double, 2> sums{}; // kg, m^2
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) {
    sums[0] += cloth.mass[i];
    sums[1] += cloth.measure[i];
  }
  sum_in_place(cloth.mesh.comm, sums);
  return sums[0] * input.gravity.norm() / (std::sqrt(sums[1]) * 0.1 * input.inextensibility.strain);
}

void add_stretch(const Cloth& cloth, const Pattern& pattern, const Case& input, Forces& forces) {
  const Material& material = cloth.material;
  const double warp = stretch_stiffness(cloth, input), weft = material.stretch_weft.value_or(warp);
  if (warp > 0 || weft > 0)
    forces.push_back(std::make_unique<Stretch>(
        cloth, pattern, StretchMaterial{{warp, weft}, material.stretch_target, material.damping.stiffness}));
}

} // namespace

Forces make_forces(const Cloth& cloth, const Obstacles& obstacles, const Pattern& pattern,
                   const Case& input) {
  const Material& material = cloth.material;
  Forces forces;
  forces.push_back(std::make_unique<Gravity>(cloth, input.gravity));
  add_bending(cloth, pattern, input, forces);
  add_shear(cloth, pattern, input, forces);
  add_stretch(cloth, pattern, input, forces);
  if (input.inextensibility.method == config::InextensibilityMethod::springs)
    forces.push_back(std::make_unique<Springs>(
        cloth, pattern, input.inextensibility.springs.value_or(config::Springs{}).stiffness,
        material.damping.stiffness));
  if (input.air) forces.push_back(std::make_unique<AirDrag>(cloth, *input.air));
  if (input.contact_model() == config::ContactModel::constraint)
    forces.push_back(std::make_unique<CarriedContact>(cloth));
  if (input.contact_model() == config::ContactModel::penalty)
    forces.push_back(std::make_unique<PenaltySprings>(cloth, obstacles, input));
  if (input.inextensibility.carried_tension && config::is_filter(input.inextensibility.method))
    forces.push_back(std::make_unique<CarriedTension>(cloth, pattern));
  return forces;
}

} // namespace taut
