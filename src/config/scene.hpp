#pragma once
#include "partition/types.hpp"
#include "src/config/choices.hpp"
#include "src/config/cloth.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// What holds, meets and blows on the cloth in a case, see case.hpp.
namespace taut::config {

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
  std::optional<std::vector<Global>> vertices; ///< exactly one of vertices, range, box, near, label
  std::optional<std::array<int, 2>> range;     ///< the first and the last vertex
  std::optional<Box> box;
  std::optional<std::vector<Vec3>> near; ///< m
  std::optional<std::string> label;      ///< of edges and panels of a pattern
  std::optional<std::string> cloth;      ///< name or number of the cloth meant; absent: all of them together
  std::optional<Vec3> along;             ///< free to slide along this axis, of any length
  std::optional<Vec3> plane;             ///< free to slide in the plane with this normal, of any length
  std::vector<Keyframe> motion;          ///< times increase strictly; empty: the pin rests
  std::optional<double> release;         ///< s; absent: never
  bool operator==(const Pin&) const = default;
};

/// Vertices that strings draw to others, as buttons and stitches do, or to a body.
struct Attachment {
  std::optional<std::string> label;           ///< exactly one of label and vertices
  std::optional<std::array<int, 2>> vertices; ///< the two ends of one string
  std::optional<std::string> to;              ///< label; exactly one of to and obstacle with `label`
  std::optional<std::string> obstacle;        ///< its name or number
  double force = 10;                          ///< N, the largest of a string
  double length = 0;                          ///< m, of a string
  double time = 0.5;                          ///< s, in which strings get so short
  std::optional<double> release;              ///< s; absent: never
  bool operator==(const Attachment&) const = default;
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

/// How a body grows from slim (ways_to_slim) to full.
struct Growth {
  double time = 1;        ///< s; infinite: it stays slim
  double pressure = 1000; ///< Pa, of the cloth: where it is more, the body stays back
  bool operator==(const Growth&) const = default;
};

/// Something that cloth cannot pass.
struct Obstacle {
  std::optional<std::string> name; ///< for messages
  std::optional<Plane> plane;      ///< exactly one of plane, sphere, capsule, box, union and mesh is there
  std::optional<Sphere> sphere;
  std::optional<Capsule> capsule;
  std::optional<Box> box;
  std::optional<Union> joined;                 ///< the key `union`
  std::optional<std::filesystem::path> mesh;   ///< as written: relative to the case file
  std::optional<Sequence> sequence;            ///< `mesh` is its first
  double scale = 1;                            ///< m per unit of the mesh
  UpAxis up = UpAxis::z;                       ///< in the file of the mesh
  Placement start;                             ///< of what is given above
  double thickness = 0;                        ///< m added all around
  std::optional<double> friction;              ///< against cloth; absent: that of `contact`
  std::vector<Keyframe> motion;                ///< times increase strictly; empty: at rest
  std::optional<double> room;                  ///< m, see ways_to_room; absent: the body is as given
  std::optional<std::filesystem::path> fitted; ///< read_ways; of a mesh or union; absent: as given
  std::optional<Growth> growth;                ///< absent: it is full. No key, but of stages before the case
  bool operator==(const Obstacle&) const = default;
};

/// How the panels of patterns are brought together before the case begins.
struct Sewing {
  double time = 2;             ///< s, in which seams are drawn together
  double force = 10;           ///< N/m, the largest of a seam on each of its edges
  double limit = 6;            ///< s, by which all seams must be closed
  double growth = 1;           ///< s, in which bodies grow to their size in the sewn garment
  double pressure = 100;       ///< Pa, with which it may press on them
  double damping = 40;         ///< 1/s, times the mass
  Vec3 gravity = Vec3::Zero(); ///< m/s^2
  double bending = 1e-3;       ///< N m, at least
  /// fast_projection or newton; absent: newton, of large garments fast_projection
  std::optional<InextensibilityMethod> method;
  bool operator==(const Sewing&) const = default;
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

} // namespace taut::config
