#pragma once
#include "partition/error.hpp"
#include "partition/types.hpp"
#include "src/config/choices.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The case: what to simulate, as plain data in SI units. The initial value of a member is the default of its
/// key; names, units, ranges and meanings of all keys stand in describe_*.hpp.
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

/// Where the cloth starts: the shape (if any), turned about the origin, then moved.
struct Start {
  std::optional<std::filesystem::path> shape;
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
  std::optional<BendingModel> bending_model; ///< absent: by the mesh, see bending_model_of
  RestAngles rest_angles = RestAngles::flat;
  double shear = 10; ///< N/m
  ShearModel shear_model = ShearModel::baraff_witkin;
  std::optional<double> stretch;      ///< N/m, N on a line; absent: see make_forces
  std::optional<double> stretch_weft; ///< N/m; absent: as `stretch`
  Vec2 stretch_target = Vec2::Ones(); ///< lengths of warp and weft over those of the rest shape
  Damping damping;
  bool operator==(const Material&) const = default;
};

/// One cloth of a case.
struct Cloth {
  std::optional<std::string> name; ///< for messages and pins; absent: its number
  std::optional<Grid> grid;        ///< exactly one of grid, line and mesh is there
  std::optional<Line> line;
  std::optional<std::filesystem::path> mesh; ///< as written: relative to the case file
  double scale = 1;                          ///< m per unit of the mesh and of `start.shape`
  Start start;
  std::optional<std::string> fabric; ///< its values stand in `material` already
  Material material;
  std::optional<double> thickness; ///< m, see Contact; absent: that of `contact`
  bool operator==(const Cloth&) const = default;
};

struct Box {
  Vec3 min = Vec3::Zero(); ///< m
  Vec3 max = Vec3::Zero(); ///< m
  bool operator==(const Box&) const = default;
};

/// A rotation about an axis through a point.
struct PivotRotation {
  Vec3 axis = Vec3::UnitX();  ///< any length but zero
  double angle = 0;           ///< rad
  Vec3 centre = Vec3::Zero(); ///< m
  bool operator==(const PivotRotation&) const = default;
};

/// Where pinned vertices are at a time, as an offset from their start position: turned, then moved.
struct Keyframe {
  double time = 0;               ///< s
  Vec3 translate = Vec3::Zero(); ///< m
  PivotRotation rotate;
  bool operator==(const Keyframe&) const = default;
};

struct Pin {
  std::optional<std::vector<Global>> vertices; ///< exactly one of vertices, range, box and near is there
  std::optional<std::array<int, 2>> range;     ///< the first and the last vertex
  std::optional<Box> box;
  std::optional<std::vector<Vec3>> near; ///< m
  std::optional<std::string> cloth;      ///< name or number of the cloth meant; absent: all of them together
  std::optional<Vec3> along;             ///< free to slide along this axis, of any length
  std::optional<Vec3> plane;             ///< free to slide in the plane with this normal, of any length
  std::vector<Keyframe> motion;          ///< times increase strictly; empty: the pin rests
  std::optional<double> release;         ///< s; absent: never
  bool operator==(const Pin&) const = default;
};

struct Plane {
  Vec3 point = Vec3::Zero();   ///< m
  Vec3 normal = Vec3::UnitZ(); ///< any length but zero; cloth stays on the side it points to
  std::optional<double> reach; ///< m, see Obstacles::add_sheet; absent: a half-space
  bool operator==(const Plane&) const = default;
};

struct Sphere {
  Vec3 centre = Vec3::Zero(); ///< m
  double radius = 1;          ///< m
  bool operator==(const Sphere&) const = default;
};

/// All points within `radius` of a segment.
struct Capsule {
  Vec3 from = Vec3::Zero(); ///< m
  Vec3 to = Vec3::UnitX();  ///< m
  double radius = 1;        ///< m
  bool operator==(const Capsule&) const = default;
};

/// A part of a union.
struct Solid {
  std::optional<Sphere> sphere; ///< exactly one of sphere, capsule and box is there
  std::optional<Capsule> capsule;
  std::optional<Box> box;
  bool operator==(const Solid&) const = default;
};

/// Solids that are one body, see UnionDistance.
struct Union {
  std::vector<Solid> parts;
  double blend = 0;   ///< m, radius of the fillets where parts meet
  double edge = 0.01; ///< m, of the triangles of its surface
  bool operator==(const Union&) const = default;
};

/// Numbered meshes of one body, at equal intervals of time.
struct Sequence {
  double fps = 25; ///< Hz
  int frames = 2;
  bool operator==(const Sequence&) const = default;
};

/// Something that cloth cannot pass.
struct Obstacle {
  std::optional<std::string> name; ///< for messages
  std::optional<Plane> plane;      ///< exactly one of plane, sphere, capsule, box, union and mesh is there
  std::optional<Sphere> sphere;
  std::optional<Capsule> capsule;
  std::optional<Box> box;
  std::optional<Union> joined;               ///< the key `union`
  std::optional<std::filesystem::path> mesh; ///< as written: relative to the case file
  std::optional<Sequence> sequence;          ///< `mesh` is its first
  double scale = 1;                          ///< m per unit of the mesh
  double thickness = 0;                      ///< m added all around
  std::optional<double> friction;            ///< against cloth; absent: that of `contact`
  std::vector<Keyframe> motion;              ///< times increase strictly; empty: at rest
  bool operator==(const Obstacle&) const = default;
};

/// Of model impulse.
struct Impulse {
  FilterOrder order = FilterOrder::contact_last;
  bool operator==(const Impulse&) const = default;
};

/// Of model penalty.
struct Penalty {
  std::optional<double> stiffness; ///< N/m; absent: see PenaltySprings
  double damping = 1e-3;           ///< s, times the stiffness
  bool operator==(const Penalty&) const = default;
};

struct Contact {
  ContactModel model = ContactModel::constraint;
  std::optional<double> thickness; ///< m kept between midsurfaces; absent: see ContactProjection
  double friction = 0.3;           ///< Coulomb's coefficient of cloth on cloth
  int max_iterations = 30;
  StartContact start = StartContact::refuse; ///< what to do with a start that intersects
  CheckAt check = CheckAt::frame;
  std::optional<Impulse> impulse; ///< the blocks of single models; absent: their defaults
  std::optional<Penalty> penalty;
  bool operator==(const Contact&) const = default;
};

struct Gust {
  double speed = 0;  ///< m/s
  double length = 1; ///< m
  double period = 1; ///< s
  bool operator==(const Gust&) const = default;
};

struct Air {
  Vec3 wind = Vec3::Zero(); ///< m/s
  double density = 1.2;     ///< kg/m^3
  double drag = 1;
  Gust gust;
  bool operator==(const Air&) const = default;
};

struct Time {
  double end = 1;                             ///< s
  double frame_rate = 30;                     ///< Hz
  double max_step = 0.01;                     ///< s
  double min_step = 1e-6;                     ///< s
  std::optional<double> max_stretch_change{}; ///< absent: any
  Integrator integrator = Integrator::implicit_euler;
  bool operator==(const Time&) const = default;
};

struct Velocity {
  LinearSolver solver = LinearSolver::cg;
  double tolerance = 3e-4;
  int max_iterations = 1000;
  ConstraintSolver constraints = ConstraintSolver::projected;
  bool operator==(const Velocity&) const = default;
};

/// Of methods shake and rattle.
struct Shake {
  ShakeMatrix matrix = ShakeMatrix::newton;
  bool operator==(const Shake&) const = default;
};

/// Of methods jacobi and gauss_seidel.
struct Limiting {
  int max_sweeps = 5000;
  bool must_reach_limit = true;
  bool operator==(const Limiting&) const = default;
};

struct Xpbd {
  int substeps = 20;
  bool operator==(const Xpbd&) const = default;
};

struct Springs {
  double stiffness = 1000; ///< N
  bool operator==(const Springs&) const = default;
};

struct Inextensibility {
  InextensibilityMethod method = InextensibilityMethod::fast_projection;
  std::optional<Constrain> constrain; ///< absent: see constrain_of
  double strain = 0.01;
  LinearSolver solver = LinearSolver::cg;
  int max_iterations = 20;
  bool carried_tension = true;
  std::optional<double> compliance; ///< 1/N; absent: see EdgeConstraints
  std::optional<Shake> shake;       ///< the blocks of single methods; absent: their defaults
  std::optional<Limiting> limiting;
  std::optional<Xpbd> xpbd;
  std::optional<Springs> springs;
  bool operator==(const Inextensibility&) const = default;
};

struct Partition {
  PartitionMethod method = PartitionMethod::metis;
  bool operator==(const Partition&) const = default;
};

/// When to write what a run can be resumed from; 0 is never. The end of a run always is.
struct Checkpoint {
  int every_steps = 0;
  double every_time = 0;   ///< s, simulated
  double every_wall = 600; ///< s, on the clock
  bool operator==(const Checkpoint&) const = default;
};

struct Output {
  std::vector<Field> fields{Field::position, Field::velocity, Field::owner_rank, Field::strain,
                            Field::tension,  Field::reaction, Field::contact,    Field::yarn};
  std::vector<FrameFormat> formats{FrameFormat::xdmf};
  bool operator==(const Output&) const = default;
};

} // namespace taut::config

namespace taut {

struct Case {
  std::string name;
  std::vector<config::Cloth> cloths{1}; ///< at least one; their vertices are numbered one after the other
  std::vector<config::Pin> pins;
  Vec3 gravity{0, 0, -9.81};      ///< m/s^2
  std::optional<config::Air> air; ///< absent: vacuum
  std::vector<config::Obstacle> obstacles;
  std::optional<config::Contact> contact; ///< absent: its defaults if there are obstacles, otherwise none
  config::Time time;
  config::Velocity velocity;
  config::Inextensibility inextensibility;
  config::Partition partition;
  config::Checkpoint checkpoint;
  config::Output output;

  config::ContactModel contact_model() const {
    if (contact) return contact->model;
    return obstacles.empty() ? config::ContactModel::none : config::ContactModel::constraint;
  }
  bool has_contact() const { return contact_model() != config::ContactModel::none; }

  std::filesystem::path file; ///< not a key: the case file, for messages and for the paths in it
  std::filesystem::path folder() const { return file.parent_path(); } ///< empty is the working folder
  bool operator==(const Case&) const = default;
};

/// `--set key=value`: `key` is a path such as "time.max_step" or "pins.0.release", `value` is YAML.
struct Override {
  std::string key;
  std::string value;
};

/// Reads a case from YAML text; `file_name` names it in messages, gives `file` and the default of
/// `name`. Overrides are applied in order. An override that adds `cloth.mesh` takes the place of a
/// `cloth.grid` in the file (likewise for all keys of which exactly one is to be given). Throws `InputError`
/// for the first mistake found: "file:line:column: ...", or "--set key=value: ...".
Case read_case(const std::string& text, const std::string& file_name,
               std::span<const Override> overrides = {});

/// The case as YAML with every default filled in (optional blocks that are absent stay so). Read again under
/// the same file name it gives an equal case.
std::string write_case(const Case& input);

/// JSON Schema (draft 2020-12) of the case file.
std::string case_schema();

/// Markdown table of all keys: key, type, unit, default, meaning.
std::string case_table();

} // namespace taut
