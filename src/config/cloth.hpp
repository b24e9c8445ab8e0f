#pragma once
#include "partition/types.hpp"
#include "src/config/choices.hpp"

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// The cloths of a case, see case.hpp.
namespace taut::config {

/// A rectangle in the plane z = 0: row i, column j is vertex i * vertices[0] + j; columns along x (warp),
/// rows along y (weft).
struct Grid {
  Vec2 size = Vec2::Ones();          ///< m
  std::array<int, 2> vertices{2, 2}; ///< along x, along y
  GridCells cells = GridCells::quads;
  bool operator==(const Grid&) const = default;
};

/// A chain of line elements along x.
struct Line {
  double length = 1; ///< m
  int vertices = 2;
  bool operator==(const Line&) const = default;
};

struct Rotation {
  Vec3 axis = Vec3::UnitX(); ///< any length but zero
  double angle = 0;          ///< rad
  bool operator==(const Rotation&) const = default;
};

/// Where something starts: turned about the origin, then moved.
struct Placement {
  Rotation rotate;
  Vec3 translate = Vec3::Zero(); ///< m
  bool operator==(const Placement&) const = default;
};

/// Where the cloth starts: the shape (if any), turned about the origin, then moved.
struct Start {
  std::optional<std::filesystem::path> shape;
  std::optional<std::filesystem::path> run; ///< of a pattern: a folder; then nothing is turned nor moved
  Rotation rotate;
  Vec3 translate = Vec3::Zero(); ///< m
  bool operator==(const Start&) const = default;
};

/// Rayleigh damping.
struct Damping {
  double mass = 0;      ///< 1/s
  double stiffness = 0; ///< s
  bool operator==(const Damping&) const = default;
};

struct Material {
  double density = 0.2;                      ///< kg/m^2, kg/m on a line
  double bending = 1e-5;                     ///< N m, N m^2 on a line
  std::optional<double> bending_weft;        ///< N m, of weft threads; absent: as `bending`
  std::optional<double> seam_bending;        ///< N m, over seams; absent: as elsewhere
  std::optional<double> twist;               ///< N m, of quads; absent: see make_forces
  std::optional<BendingModel> bending_model; ///< absent: by the mesh, see bending_model_of
  RestAngles rest_angles = RestAngles::flat;
  double shear = 10; ///< N/m
  ShearModel shear_model = ShearModel::baraff_witkin;
  std::optional<double> stretch;      ///< N/m, N on a line; absent: see resolve
  std::optional<double> stretch_weft; ///< N/m; absent: as `stretch`
  Vec2 stretch_target = Vec2::Ones(); ///< lengths of warp and weft over those of the rest shape
  Damping damping;
  bool operator==(const Material&) const = default;
};

/// An edge of a pattern that is shorter at rest than it was cut, as by a band of rubber in it.
struct Elastic {
  std::string label; ///< of edges, or panels
  double length = 1; ///< over that as cut
  bool operator==(const Elastic&) const = default;
};

/// What a panel has of its own; what is absent is that of its cloth.
struct PanelMaterial {
  std::optional<double> density;                      ///< kg/m^2
  std::optional<double> bending, bending_weft, twist; ///< N m
  std::optional<double> shear, stretch, stretch_weft; ///< N/m
  bool operator==(const PanelMaterial&) const = default;
};

/// One panel of a pattern.
struct Panel {
  std::optional<double> edge;        ///< m, of its mesh; absent: that of the pattern, or of the cloth
  std::optional<std::string> fabric; ///< its values stand in `material` already
  PanelMaterial material;
  bool operator==(const Panel&) const = default;
};

/// One cloth of a case.
struct Cloth {
  std::optional<std::string> name; ///< for messages and pins; absent: its number
  std::optional<Grid> grid;        ///< exactly one of grid, line, mesh and pattern is there
  std::optional<Line> line;
  std::optional<std::filesystem::path> mesh;    ///< as written: relative to the case file
  std::optional<std::filesystem::path> pattern; ///< as written
  std::optional<double> edge;                   ///< m, of the mesh of the pattern; there if that is
  std::vector<Elastic> elastic;                 ///< of the pattern
  std::map<std::string, Panel> panels;          ///< by name
  double scale = 1;                             ///< m per unit of the mesh and of `start.shape`
  RestShape rest = RestShape::mesh;             ///< of faces
  double texture_unit = 1;                      ///< m per unit of texture, where that is the rest shape
  std::optional<UpAxis> up; ///< in the file; absent: y of a pattern, z of a mesh. z is up in the case.
  Start start;
  std::optional<std::string> fabric; ///< its values stand in `material` already
  Material material;
  std::optional<double> thickness; ///< m, see Contact; absent: that of `contact`
  bool operator==(const Cloth&) const = default;
};

} // namespace taut::config
