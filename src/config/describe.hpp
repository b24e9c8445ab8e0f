#pragma once
#include "src/config/case.hpp"
#include "src/config/fabrics.hpp"
#include "src/config/key.hpp"
#include "src/config/methods.hpp"

#include <algorithm>
#include <concepts>
#include <fmt/format.h>
#include <type_traits>

/// Every key of the case file, once. To add a key:
///
/// 1. give the struct in case.hpp a member with the default as its initial value;
/// 2. add one line here: v("name", c.member, {.unit = ..., .range = ..., .meaning = "one line"}).
///
/// That is all: reading with its errors, writing, the JSON Schema and the table follow. `--set
/// block.name=value` works too. A member may be a double, int, bool, text, path, enumeration with `words_of`,
/// Vec2, Vec3, pair of ints, a struct described here, an optional or a vector of these. To add a struct,
/// write `describe` for it; a new enumeration needs `words_of`, a new unit two lines in units.cpp.
///
/// A visitor `v` is called as
///   v(name, member, Key)         for each key;
///   v.exactly_one({names})       before the keys of which exactly one is to be given (optional members);
///   v.check(name, holds, cure)   after the keys, for what a range cannot say.
namespace taut::config {

/// T is S or const S: the reader changes what it visits, the others do not.
template<class T, class S>
concept Is = std::same_as<std::remove_const_t<T>, S>;

template<class V>
void describe(V& v, Is<Grid> auto& g) {
  v("size", g.size,
    {.unit = Unit::metre,
     .range = positive,
     .presence = Presence::required,
     .meaning = "lengths along x (warp) and y (weft)"});
  v("vertices", g.vertices,
    {.range = at_least(2),
     .presence = Presence::required,
     .meaning = "numbers of vertices along x and y; row i, column j is vertex i*nx + j"});
  v("cells", g.cells,
    {.meaning = "quads; or triangles, all cut along the same diagonal or along both in turn"});
}

template<class V>
void describe(V& v, Is<Line> auto& l) {
  v("length", l.length,
    {.unit = Unit::metre, .range = positive, .presence = Presence::required, .meaning = "length along x"});
  v("vertices", l.vertices,
    {.range = at_least(2), .presence = Presence::required, .meaning = "number of vertices"});
}

template<class V>
void describe(V& v, Is<Rotation> auto& r) {
  v("axis", r.axis, {.meaning = "axis of the rotation, of any length"});
  v("angle", r.angle, {.unit = Unit::radian, .meaning = "angle, by the right-hand rule"});
  v.check("axis", !r.axis.isZero(0), "must not be zero; a rotation needs a direction");
}

template<class V>
void describe(V& v, Is<Start> auto& s) {
  v("shape", s.shape, {.meaning = "OBJ file with the same vertices in other places"});
  v("rotate", s.rotate, {.meaning = "rotation about the origin, done first"});
  v("translate", s.translate, {.unit = Unit::metre, .meaning = "move, done after the rotation"});
}

template<class V>
void describe(V& v, Is<Damping> auto& d) {
  v("mass", d.mass,
    {.unit = Unit::per_second, .range = not_negative, .meaning = "mass-proportional damping"});
  v("stiffness", d.stiffness,
    {.unit = Unit::second, .range = not_negative, .meaning = "stiffness-proportional damping"});
}

template<class V>
void describe(V& v, Is<Material> auto& m) {
  v("density", m.density, {.unit = Unit::cloth_density, .range = positive, .meaning = "mass per area"});
  v("bending", m.bending,
    {.unit = Unit::cloth_bending, .range = not_negative, .meaning = "bending stiffness"});
  v("bending_weft", m.bending_weft,
    {.unit = Unit::cloth_bending,
     .range = not_negative,
     .computed_default = "bending",
     .meaning = "bending stiffness of weft threads"});
  v("bending_model", m.bending_model,
    {.computed_default = "yarn, or isometric on a mesh with triangles",
     .meaning = "what resists bending: curvature of each yarn, or the fold over each edge between faces: its "
                "isometric quadratic form, discrete shells, or the angle of Baraff and Witkin"});
  v("rest_angles", m.rest_angles,
    {.meaning = "angle over an edge that does not bend: none, or that of the mesh (discrete_shells)"});
  v("shear", m.shear,
    {.unit = Unit::newton_per_metre,
     .range = not_negative,
     .meaning = "shear stiffness, per radian of shear angle"});
  v("shear_model", m.shear_model,
    {.meaning = "what resists shear: the angle between warp and weft, or the diagonals of quads as springs"});
  v("stretch", m.stretch,
    {.unit = Unit::cloth_stretch,
     .range = not_negative,
     .computed_default = "0; from the weight, where `inextensibility.constrain` is vertices",
     .meaning = "stretch stiffness of warp and weft, per strain; for cloth without inextensibility"});
  v("stretch_weft", m.stretch_weft,
    {.unit = Unit::cloth_stretch,
     .range = not_negative,
     .computed_default = "stretch",
     .meaning = "stretch stiffness of weft threads"});
  v("stretch_target", m.stretch_target,
    {.range = positive,
     .meaning = "lengths of warp and weft that the stretch stiffness pulls to, over those at rest"});
  v("damping", m.damping, {.meaning = "Rayleigh damping"});
}

template<class V>
void describe(V& v, Is<Cloth> auto& c) {
  v.exactly_one({"grid", "line", "mesh"});
  v("grid", c.grid, {.meaning = "a rectangle of quads in the plane z = 0"});
  v("line", c.line, {.meaning = "a chain of line elements along x"});
  v("mesh", c.mesh, {.meaning = "mesh file (.obj or .h5), relative to the case file"});
  v("scale", c.scale, {.range = positive, .meaning = "metres per unit of the mesh and of start.shape"});
  v("start", c.start, {.meaning = "where the cloth starts"});
  v("fabric", c.fabric, {.words = fabric_names(), .meaning = "fills material; keys given there win"});
  v("material", c.material,
    {.computed_default = "of the fabric, if one is named", .meaning = "what the cloth is made of"});
}

template<class V>
void describe(V& v, Is<Box> auto& b) {
  v("min", b.min, {.unit = Unit::metre, .presence = Presence::required, .meaning = "lowest corner"});
  v("max", b.max, {.unit = Unit::metre, .presence = Presence::required, .meaning = "highest corner"});
  v.check("max", (b.min.array() <= b.max.array()).all(), "must not be below min in any direction");
}

template<class V>
void describe(V& v, Is<PivotRotation> auto& r) {
  v("axis", r.axis, {.meaning = "axis of the rotation, of any length"});
  v("angle", r.angle, {.unit = Unit::radian, .meaning = "angle, by the right-hand rule"});
  v("centre", r.centre, {.unit = Unit::metre, .meaning = "a point on the axis"});
  v.check("axis", !r.axis.isZero(0), "must not be zero; a rotation needs a direction");
}

template<class V>
void describe(V& v, Is<Keyframe> auto& k) {
  v("time", k.time,
    {.unit = Unit::second,
     .range = not_negative,
     .presence = Presence::required,
     .meaning = "when the pin is here"});
  v("translate", k.translate, {.unit = Unit::metre, .meaning = "offset from the start, after the rotation"});
  v("rotate", k.rotate, {.meaning = "rotation of the start position, done first"});
}

/// Times that increase strictly.
inline bool increasing(const std::vector<Keyframe>& motion) {
  for (std::size_t i = 1; i < motion.size(); ++i)
    if (!(motion[i - 1].time < motion[i].time)) return false;
  return true;
}

template<class V>
void describe(V& v, Is<Pin> auto& p) {
  v.exactly_one({"vertices", "box", "near"});
  v("vertices", p.vertices, {.range = not_negative, .meaning = "numbers of the vertices"});
  v("box", p.box, {.meaning = "all vertices whose start position is inside"});
  v("near", p.near, {.unit = Unit::metre, .meaning = "for each point the vertex that starts nearest to it"});
  v("along", p.along, {.meaning = "axis along which the vertices may slide; none: they are held"});
  v("plane", p.plane,
    {.meaning = "normal of the plane in which the vertices may slide; none: they are held"});
  v("motion", p.motion,
    {.meaning = "keyframes; linear between them, constant before and after; none: at rest"});
  v("release", p.release,
    {.unit = Unit::second,
     .range = not_negative,
     .computed_default = "never",
     .meaning = "when the pin lets go"});
  v.check("vertices", !p.vertices || !p.vertices->empty(), "must not be empty; a pin holds something");
  v.check("near", !p.near || !p.near->empty(), "must not be empty; a pin holds something");
  v.check("along", !p.along || !p.along->isZero(0), "must not be zero; a line needs a direction");
  v.check("plane", !p.plane || !p.plane->isZero(0), "must not be zero; a plane needs a normal");
  v.check("plane", !p.plane || !p.along, "must not be given together with along; give one of them");
  v.check("motion", increasing(p.motion), "times must increase from keyframe to keyframe; sort them");
}

template<class V>
void describe(V& v, Is<Plane> auto& p) {
  v("point", p.point, {.unit = Unit::metre, .meaning = "a point on the plane"});
  v("normal", p.normal, {.meaning = "the side on which cloth stays, of any length"});
  v.check("normal", !p.normal.isZero(0), "must not be zero; a plane has two sides");
}

template<class V>
void describe(V& v, Is<Sphere> auto& s) {
  v("centre", s.centre, {.unit = Unit::metre, .presence = Presence::required, .meaning = "its centre"});
  v("radius", s.radius,
    {.unit = Unit::metre, .range = positive, .presence = Presence::required, .meaning = "its radius"});
}

template<class V>
void describe(V& v, Is<Capsule> auto& c) {
  v("from", c.from, {.unit = Unit::metre, .presence = Presence::required, .meaning = "one end of its axis"});
  v("to", c.to, {.unit = Unit::metre, .presence = Presence::required, .meaning = "the other end"});
  v("radius", c.radius,
    {.unit = Unit::metre, .range = positive, .presence = Presence::required, .meaning = "its radius"});
}

template<class V>
void describe(V& v, Is<Obstacle> auto& o) {
  v("name", o.name, {.computed_default = "its number and kind", .meaning = "how messages call it"});
  v.exactly_one({"plane", "sphere", "capsule", "box", "mesh"});
  v("plane", o.plane, {.meaning = "a half-space"});
  v("sphere", o.sphere, {.meaning = "a sphere"});
  v("capsule", o.capsule, {.meaning = "all points near a segment"});
  v("box", o.box, {.meaning = "a box along the axes"});
  v("mesh", o.mesh, {.meaning = "surface of triangles or quads (.obj or .h5), relative to the case file"});
  v("scale", o.scale, {.range = positive, .meaning = "metres per unit of the mesh"});
  v("thickness", o.thickness, {.unit = Unit::metre, .range = not_negative, .meaning = "added all around"});
  v("friction", o.friction,
    {.range = not_negative,
     .computed_default = "`contact.friction`",
     .meaning = "Coulomb coefficient against cloth"});
  v("motion", o.motion, {.meaning = "keyframes, as of pins; none: at rest"});
  v.check("motion", increasing(o.motion), "times must increase from keyframe to keyframe; sort them");
  v.check("motion",
          !o.plane || std::none_of(o.motion.begin(), o.motion.end(),
                                   [](const Keyframe& k) { return k.rotate.angle != 0; }),
          "a plane can be moved but not turned; use a box");
}

template<class V>
void describe(V& v, Is<Contact> auto& c) {
  v("model", c.model, {.meaning = "constraint: within the projection, never an intersection; none: off"});
  v("thickness", c.thickness,
    {.unit = Unit::metre,
     .range = positive,
     .computed_default = "a tenth of the mean edge",
     .meaning = "distance kept between midsurfaces"});
  v("friction", c.friction, {.range = not_negative, .meaning = "Coulomb coefficient of cloth on cloth"});
  v("max_iterations", c.max_iterations,
    {.range = at_least(1), .meaning = "projections with contact before a step is rejected"});
  v("check", c.check, {.meaning = "when the result is tested for intersections"});
}

template<class V>
void describe(V& v, Is<Gust> auto& g) {
  v("speed", g.speed,
    {.unit = Unit::metre_per_second, .range = not_negative, .meaning = "amplitude, added along the wind"});
  v("length", g.length, {.unit = Unit::metre, .range = positive, .meaning = "wave length in space"});
  v("period", g.period, {.unit = Unit::second, .range = positive, .meaning = "period in time"});
}

template<class V>
void describe(V& v, Is<Air> auto& a) {
  v("wind", a.wind, {.unit = Unit::metre_per_second, .meaning = "velocity of the air"});
  v("density", a.density,
    {.unit = Unit::kilogram_per_metre3, .range = not_negative, .meaning = "density of the air"});
  v("drag", a.drag, {.range = not_negative, .meaning = "pressure drag coefficient on the face normal"});
  v("gust", a.gust, {.meaning = "a wave on top of the wind"});
}

template<class V>
void describe(V& v, Is<Time> auto& t) {
  v("integrator", t.integrator,
    {.meaning = "time stepping: first order, second order, or first order with loads taken explicitly"});
  v("end", t.end, {.unit = Unit::second, .range = positive, .meaning = "simulated time to run"});
  v("frame_rate", t.frame_rate,
    {.unit = Unit::hertz, .range = positive, .meaning = "frames written per second"});
  v("max_step", t.max_step, {.unit = Unit::second, .range = positive, .meaning = "longest time step"});
  v("min_step", t.min_step,
    {.unit = Unit::second, .range = positive, .meaning = "shortest time step that is tried"});
  v("max_stretch_change", t.max_stretch_change,
    {.range = positive,
     .computed_default = "any",
     .meaning = "a step in which the stretch of warp or weft changes more anywhere is tried again, shorter"});
  v.check("min_step", t.min_step <= t.max_step,
          fmt::format("{} is above max_step, {}; make it smaller", t.min_step, t.max_step));
  v.check("frame_rate", t.frame_rate * t.min_step <= 1,
          "frames come faster than min_step allows steps; lower it");
  v.check("end", t.end >= t.min_step, "is less than min_step, one step; make it larger");
}

template<class V>
void describe(V& v, Is<Velocity> auto& s) {
  v("solver", s.solver, {.meaning = "linear solver: conjugate gradients, or MUMPS (direct)"});
  v("tolerance", s.tolerance, {.range = fraction, .meaning = "relative residual at which cg stops"});
  v("max_iterations", s.max_iterations,
    {.range = at_least(1), .meaning = "most iterations of cg in a solve"});
  v("constraints", s.constraints,
    {.meaning = "how pins enter cg: the matrix is projected, or its vectors are filtered (modified CG)"});
  v.check("constraints", s.constraints == ConstraintSolver::projected || s.solver == LinearSolver::cg,
          "modified_cg is a form of cg; mumps needs projected");
}

template<class V>
void describe(V& v, Is<Shake> auto& s) {
  v("matrix", s.matrix,
    {.meaning = "newton: made in every iteration; lagged: once a step, and again where convergence fails"});
}

template<class V>
void describe(V& v, Is<Limiting> auto& l) {
  v("max_sweeps", l.max_sweeps, {.range = at_least(1), .meaning = "most sweeps over all edges in a step"});
  v("must_reach_limit", l.must_reach_limit,
    {.meaning = "false: the strain that max_sweeps leave is accepted, and reported"});
}

template<class V>
void describe(V& v, Is<Xpbd> auto& x) {
  v("substeps", x.substeps, {.range = at_least(1), .meaning = "substeps of a step, with one sweep each"});
}

template<class V>
void describe(V& v, Is<Springs> auto& s) {
  v("stiffness", s.stiffness,
    {.unit = Unit::newton, .range = positive, .meaning = "tension of an edge per strain"});
}

/// A key that the method does not use must not be set.
template<class V>
void check_use(V& v, std::string_view name, bool left_alone, bool used, InextensibilityMethod method) {
  v.check(name, left_alone || used,
          fmt::format("method {} does not use it; remove it, or choose another method",
                      words_of(method)[std::size_t(method)]));
}

template<class V>
void describe(V& v, Is<Inextensibility> auto& i) {
  v("method", i.method, {.meaning = "how edges keep their lengths; none lets them stretch freely"});
  v("constrain", i.constrain,
    {.computed_default = "vertices on triangles alone, with fast_projection and no contact; else edges",
     .meaning =
         "what keeps its length: every edge, which locks meshes of triangles, or on these warp and weft "
         "averaged at every vertex"});
  v("strain", i.strain, {.range = fraction, .meaning = "largest strain that is left"});
  v("solver", i.solver, {.meaning = "linear solver of a projection"});
  v("max_iterations", i.max_iterations, {.range = at_least(1), .meaning = "most projections in a step"});
  v("carried_tension", i.carried_tension, {.meaning = "start a step from the tension of the last"});
  v("compliance", i.compliance,
    {.unit = Unit::per_newton,
     .range = not_negative,
     .computed_default = "from the weight of the cloth",
     .meaning = "strain of an edge per newton of its tension; by default that of a taut thread which bears "
                "the whole "
                "cloth is a tenth of the limit; of xpbd: 0"});
  v("shake", i.shake, {.computed_default = "its defaults", .meaning = "options of methods shake and rattle"});
  v("limiting", i.limiting,
    {.computed_default = "its defaults", .meaning = "options of methods jacobi and gauss_seidel"});
  v("xpbd", i.xpbd, {.computed_default = "its defaults", .meaning = "options of method xpbd"});
  v("springs", i.springs, {.computed_default = "its defaults", .meaning = "options of method springs"});
  using enum InextensibilityMethod;
  const Inextensibility standard;
  const bool projects = is_projection(i.method);
  v.check("constrain", i.constrain != Constrain::vertices || i.method == fast_projection,
          "vertices goes with method fast_projection only; choose that method, or edges");
  check_use(v, "solver", i.solver == standard.solver, projects, i.method);
  check_use(v, "max_iterations", i.max_iterations == standard.max_iterations, projects, i.method);
  check_use(v, "carried_tension", i.carried_tension == standard.carried_tension, is_filter(i.method),
            i.method);
  check_use(v, "compliance", !i.compliance, projects || i.method == xpbd, i.method);
  check_use(v, "shake", !i.shake, i.method == shake || i.method == rattle, i.method);
  check_use(v, "limiting", !i.limiting, is_limiting(i.method), i.method);
  check_use(v, "xpbd", !i.xpbd, i.method == xpbd, i.method);
  check_use(v, "springs", !i.springs, i.method == springs, i.method);
}

template<class V>
void describe(V& v, Is<Partition> auto& p) {
  v("method", p.method, {.meaning = "how the cloth is cut for the ranks"});
}

template<class V>
void describe(V& v, Is<Checkpoint> auto& c) {
  v("every_steps", c.every_steps,
    {.range = not_negative, .meaning = "time steps between two; 0: any number"});
  v("every_time", c.every_time,
    {.unit = Unit::second, .range = not_negative, .meaning = "simulated time between two; 0: any"});
  v("every_wall", c.every_wall,
    {.unit = Unit::second, .range = not_negative, .meaning = "time on the clock between two; 0: any"});
}

template<class V>
void describe(V& v, Is<Output> auto& o) {
  v("fields", o.fields, {.meaning = "what a frame holds"});
}

template<class V>
void describe(V& v, Is<Case> auto& c) {
  v("name", c.name, {.computed_default = "folder of the case file", .meaning = "name of the case"});
  v("cloth", c.cloth, {.presence = Presence::required, .meaning = "the cloth; one of grid, line and mesh"});
  v("pins", c.pins, {.meaning = "what holds the cloth"});
  v("gravity", c.gravity, {.unit = Unit::metre_per_second2, .meaning = "acceleration of free fall"});
  v("air", c.air, {.computed_default = "vacuum", .meaning = "air around the cloth"});
  v("obstacles", c.obstacles, {.meaning = "what the cloth collides with"});
  v("contact", c.contact,
    {.computed_default = "its defaults if there are obstacles, otherwise none",
     .meaning = "collisions of the cloth with itself and with obstacles"});
  v("time", c.time, {.meaning = "time and its steps"});
  v("velocity", c.velocity, {.meaning = "the implicit velocity solve"});
  v("inextensibility", c.inextensibility, {.meaning = "what keeps the cloth from stretching"});
  v("partition", c.partition, {.meaning = "distribution over the ranks"});
  v("checkpoint", c.checkpoint,
    {.meaning = "when to write, besides at the end, what `taut resume` goes on from; the last two are kept"});
  v("output", c.output, {.meaning = "what is written"});
  v.check(
      "time",
      c.time.integrator == Integrator::implicit_euler ||
          c.inextensibility.method != InextensibilityMethod::xpbd,
      "integrator is not used by inextensibility.method xpbd, which has its own time stepping; remove it");
  v.check("time", c.time.integrator != Integrator::bdf2 || !c.has_contact(),
          "integrator bdf2 does not go with contact, as its steps begin beside the path of the cloth; choose "
          "implicit_euler or imex");
  v.check("inextensibility",
          c.inextensibility.method == InextensibilityMethod::fast_projection || !c.has_contact(),
          "contact goes with method fast_projection only, of which it is a part; choose that method, or "
          "contact.model: none");
  v.check("inextensibility", c.inextensibility.constrain != Constrain::vertices || !c.has_contact(),
          "contact goes with constrain: edges only; choose that, or contact.model: none");
  v.check(
      "inextensibility",
      c.inextensibility.solver != LinearSolver::mumps ||
          (c.inextensibility.method != InextensibilityMethod::icd &&
           c.inextensibility.method != InextensibilityMethod::sap) ||
          std::none_of(c.pins.begin(), c.pins.end(), [](const Pin& p) { return p.along || p.plane; }),
      "methods icd and sap cannot keep sliding pins (pins.k.along, pins.k.plane) with solver mumps; choose "
      "solver cg");
  v.check("name", !c.name.empty() && c.name.find('/') == std::string::npos && c.name != "." && c.name != "..",
          "must be a word without '/'; it names a folder");
}

} // namespace taut::config
