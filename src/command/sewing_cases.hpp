#pragma once
#include "src/config/case.hpp"

#include <filesystem>
#include <span>

/// The cases of the stages in which a garment is sewn (sewing.hpp).
namespace taut::command {

/// Fills in what a case leaves to the edges of its patterns. Folds of cloth take some room where a body faces
/// itself; layers as thick as in other cases would be pinched there. `shortest`: m, of the edges of each
/// cloth.
void fill_in(Case& input, std::span<const double> shortest);

/// By which garments of so many vertices are sewn: Newton's method, if it has what the case asks of contact,
/// and as long as its matrix is cheap to factor.
config::InextensibilityMethod seam_method(const Case& input, Global vertices);

/// Makes a sphere or capsule a body of triangles, whose vertices can be moved.
void make_mesh(config::Obstacle& o);

/// The case with these meshes, one a cloth, in the place of its patterns.
Case with_meshes(Case input, std::span<const std::filesystem::path> meshes);

/// Panels are drawn together around bodies that are slim. In this stage and the next there is no motion but
/// that of sewing; pins and obstacles are as at time 0. Without a method of sewing, by Fast Projection.
Case sewing_case(const Case& input);

/// Bodies grow to their size in the garments that are `sewn`.
Case fitting_case(const Case& input, std::span<const std::filesystem::path> sewn);

} // namespace taut::command
