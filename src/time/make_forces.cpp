#include "src/time/make_forces.hpp"

#include "src/config/cloths.hpp"
#include "src/config/methods.hpp"
#include "src/contact/attachments.hpp"
#include "src/contact/penalty_springs.hpp"
#include "src/forces/air_drag.hpp"
#include "src/forces/angle_bending.hpp"
#include "src/forces/bending.hpp"
#include "src/forces/carried_contact.hpp"
#include "src/forces/carried_tension.hpp"
#include "src/forces/diagonal_springs.hpp"
#include "src/forces/gravity.hpp"
#include "src/forces/isometric_bending.hpp"
#include "src/forces/seam_force.hpp"
#include "src/forces/shear.hpp"
#include "src/forces/springs.hpp"
#include "src/forces/stretch.hpp"
#include "src/forces/twist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

using config::BendingModel;
using config::Material;

/// Whether piece `k` has such cells. Collective.
bool has_cells_of(const Cloth& cloth, std::size_t k, int vertices) {
  const auto& cells = cloth.mesh.cells;
  return any_of(cloth.mesh.comm, std::any_of(cells.begin(), cells.end(), [&](const LocalCell& c) {
                  return c.size() == vertices && cloth.piece_of(c.vertices[0]) == k;
                }));
}

/// For each piece what `value(its number, its material)` says.
template<class T = double, class Value>
PerPiece<T> per_piece(const Cloth& cloth, Value&& value) {
  std::vector<std::optional<T>> values;
  for (std::size_t k = 0; k < cloth.pieces.size(); ++k) values.push_back(value(k, cloth.pieces[k].material));
  return PerPiece<T>(std::move(values));
}

/// For each section what `value(number of its piece, its material)` says.
template<class T = double, class Value>
PerSection<T> per_section(const Cloth& cloth, Value&& value) {
  std::vector<std::optional<T>> values;
  for (const Section& s : cloth.sections) values.push_back(value(s.piece, cloth.material_of(s)));
  return PerSection<T>(std::move(values));
}

PerPiece<double> damping_of(const Cloth& cloth) {
  return per_piece(cloth, [](std::size_t, const Material& m) { return m.damping.stiffness; });
}

[[noreturn]] void refuse(const Case& input, std::size_t k, const std::string& key, const std::string& why) {
  throw InputError(
      fmt::format("{}: {}.material.{}: {}", input.file.string(), config::key_of_cloth(input, k), key, why));
}

BendingModel bending_model_of(const Material& material) { return material.bending_model.value(); }

double weft_bending_of(const Material& m) { return m.bending_weft.value_or(m.bending); }

bool bends_to_mesh(const Material& material) { return material.rest_angles == config::RestAngles::mesh; }

/// By default that of an isotropic plate, or of one between its two stiffnesses.
double twist_of(const Material& m) { return m.twist.value_or(std::sqrt(m.bending * weft_bending_of(m))); }

/// The folds of the pieces for which `has(number, material)` holds.
template<class Has>
Folds folds_where(const Cloth& cloth, Has&& has) {
  return folds_of(cloth, per_section<Rigidity>(cloth, [&](std::size_t k, const Material& m) {
                    return has(k, m) ? std::optional(Rigidity{m.bending, weft_bending_of(m), twist_of(m),
                                                              m.seam_bending.value_or(0)})
                                     : std::nullopt;
                  }));
}

/// Whether the model of piece `k` can do what its material asks of it.
void check_bending(const Case& input, const Cloth& cloth, std::size_t k) {
  const Material& material = cloth.pieces[k].material;
  const BendingModel model = bending_model_of(material);
  const std::string name(config::word_of(model));
  if (model == BendingModel::yarn && has_cells_of(cloth, k, 3))
    refuse(input, k, "bending_model",
           "yarn cannot serve this mesh: its triangles have no yarns; use isometric, discrete_shells or "
           "baraff_witkin");
  if (material.seam_bending && cloth.pieces[k].parts.seams.empty())
    refuse(input, k, "seam_bending", "the cloth has no seams; it is for garments of a sewing pattern");
  if (model == BendingModel::yarn && material.seam_bending)
    refuse(input, k, "seam_bending", "yarn bends no folds; use isometric, discrete_shells or baraff_witkin");
  if (model == BendingModel::yarn && material.bending_weft)
    refuse(input, k, "bending_weft",
           "yarn bends all threads alike; use isometric, discrete_shells or baraff_witkin");
  if (model == BendingModel::yarn && !cloth.pieces[k].own.empty())
    refuse(input, k, "bending_model",
           "yarn bends all panels alike; use isometric, discrete_shells or baraff_witkin");
  const auto is_flat = [&] {
    constexpr double flat = 1e-6; // rad
    const auto folds = folds_where(cloth, [&](std::size_t piece, const Material&) { return piece == k; });
    return largest_rest_angle(cloth, folds) <= flat;
  };
  if (bends_to_mesh(material) && model != BendingModel::discrete_shells &&
      (model == BendingModel::yarn || !is_flat()))
    refuse(
        input, k, "rest_angles",
        fmt::format("mesh: {} knows no rest shape but a flat one; use discrete_shells, or rest_angles: flat",
                    name));
}

/// For pieces that share a model, one force.
void add_fold_bending(const Cloth& cloth, const Pattern& pattern, Forces& forces) {
  const auto damping = damping_of(cloth);
  const auto where = [&](auto&& has) {
    const auto& pieces = cloth.pieces;
    return std::any_of(pieces.begin(), pieces.end(), [&](const Piece& p) { return has(p.material); });
  };
  const auto folds = [&](auto&& has) {
    return folds_where(cloth, [&](std::size_t, const Material& m) { return has(m); });
  };
  const auto is_isometric = [](const Material& m) { return bending_model_of(m) == BendingModel::isometric; };
  if (where(is_isometric))
    forces.push_back(std::make_unique<IsometricBending>(cloth, pattern, folds(is_isometric), damping));
  for (const RestAngle rest : {RestAngle::flat, RestAngle::of_rest_shape}) {
    const auto has = [&](const Material& m) {
      return !is_isometric(m) && bending_model_of(m) != BendingModel::yarn &&
             bends_to_mesh(m) == (rest == RestAngle::of_rest_shape);
    };
    if (where(has)) forces.push_back(std::make_unique<AngleBending>(cloth, folds(has), rest, damping));
  }
}

void add_bending(const Cloth& cloth, const Pattern& pattern, const Case& input, Forces& forces) {
  for (std::size_t k = 0; k < cloth.pieces.size(); ++k) check_bending(input, cloth, k);
  add_fold_bending(cloth, pattern, forces);
  const auto threads = [&](Threads which) {
    return per_piece(cloth, [&](std::size_t k, const Material& m) -> std::optional<double> {
      const bool bends_all = bending_model_of(m) == BendingModel::yarn;
      const bool has = which == Threads::all ? bends_all : !bends_all && has_cells_of(cloth, k, 2);
      return has ? std::optional(m.bending) : std::nullopt;
    });
  };
  for (const Threads which : {Threads::all, Threads::lines})
    if (const auto stiffness = threads(which); stiffness.any())
      forces.push_back(std::make_unique<YarnBending>(cloth, pattern, which, stiffness, damping_of(cloth)));
}

/// That of quads; triangles have it in their folds.
void add_twist(const Cloth& cloth, const Pattern& pattern, Forces& forces) {
  const auto stiffness = per_section(cloth, [&](std::size_t k, const Material& m) -> std::optional<double> {
    return has_cells_of(cloth, k, 4) && twist_of(m) > 0 ? std::optional(twist_of(m)) : std::nullopt;
  });
  if (stiffness.any())
    forces.push_back(std::make_unique<Twist>(cloth, pattern, stiffness, damping_of(cloth)));
}

void add_shear(const Cloth& cloth, const Pattern& pattern, const Case& input, Forces& forces) {
  const auto stiffness = [&](config::ShearModel model) {
    return per_section(cloth, [&](std::size_t, const Material& m) {
      return m.shear_model == model ? std::optional(m.shear) : std::nullopt;
    });
  };
  const auto angles = stiffness(config::ShearModel::baraff_witkin),
             diagonals = stiffness(config::ShearModel::diagonals);
  for (std::size_t k = 0; k < cloth.pieces.size(); ++k)
    if (cloth.pieces[k].material.shear_model == config::ShearModel::diagonals && has_cells_of(cloth, k, 3))
      refuse(input, k, "shear_model",
             "diagonals cannot serve this mesh: triangles have none; use baraff_witkin");
  const auto damping = damping_of(cloth);
  if (angles.any()) forces.push_back(std::make_unique<Shear>(cloth, pattern, angles, damping));
  if (diagonals.any())
    forces.push_back(std::make_unique<DiagonalSprings>(cloth, pattern, diagonals, damping));
}

/// While it is sewn, an edge that is gathered becomes up to half as long as cut, where seams pull with all
/// their force: the cloth beside it folds more finely than the mesh can.
double compression_of(const Case& input) { return input.sewing ? 2 * input.inextensibility.strain : 1.0; }

void add_stretch(const Cloth& cloth, const Pattern& pattern, const Case& input, const Resolved& resolved,
                 Forces& forces) {
  const double compression = compression_of(input);
  std::vector<std::optional<StretchMaterial>> materials;
  for (std::size_t s = 0; s < cloth.sections.size(); ++s) {
    const Material& m = cloth.material_of(cloth.sections[s]);
    const Vec2& k = resolved.stretch[s];
    materials.push_back(k.maxCoeff() > 0 ? std::optional(StretchMaterial{k, m.stretch_target,
                                                                         m.damping.stiffness, compression})
                                         : std::nullopt);
  }
  if (const PerSection<StretchMaterial> of_sections(std::move(materials)); of_sections.any())
    forces.push_back(std::make_unique<Stretch>(cloth, pattern, of_sections));
}

} // namespace

Forces make_forces(const Cloth& cloth, const Obstacles& obstacles, const Pattern& pattern, const Case& input,
                   const Resolved& resolved, std::span<const Vec3> start) {
  Forces forces;
  forces.push_back(std::make_unique<Gravity>(cloth, input.sewing ? config::Gravity(input.sewing->gravity)
                                                                 : input.gravity));
  add_bending(cloth, pattern, input, forces);
  add_twist(cloth, pattern, forces);
  add_shear(cloth, pattern, input, forces);
  add_stretch(cloth, pattern, input, resolved, forces);
  if (input.inextensibility.method == config::InextensibilityMethod::springs)
    forces.push_back(std::make_unique<Springs>(
        cloth, pattern, input.inextensibility.springs.value_or(config::Springs{}).stiffness,
        damping_of(cloth)));
  if (input.sewing) forces.push_back(std::make_unique<SeamForce>(cloth, pattern, *input.sewing));
  if (!input.attachments.empty())
    forces.push_back(std::make_unique<Attachments>(cloth, obstacles, pattern, input, start));
  if (input.air) forces.push_back(std::make_unique<AirDrag>(cloth, *input.air));
  if (input.contact_model() == config::ContactModel::constraint &&
      config::is_filter(input.inextensibility.method))
    forces.push_back(std::make_unique<CarriedContact>(cloth));
  if (input.contact_model() == config::ContactModel::penalty)
    forces.push_back(std::make_unique<PenaltySprings>(cloth, obstacles, input));
  if (input.inextensibility.carried_tension && config::is_filter(input.inextensibility.method))
    forces.push_back(std::make_unique<CarriedTension>(
        cloth, pattern,
        edges_with_pushes(cloth.mesh, config::constrain_of(input, cloth.mesh.has_triangles))));
  return forces;
}

std::vector<std::string> energy_names(const Forces& forces) {
  std::vector<std::string> names;
  for (const auto& force : forces)
    if (std::find(names.begin(), names.end(), force->name()) == names.end())
      names.emplace_back(force->name());
  return names;
}

} // namespace taut
