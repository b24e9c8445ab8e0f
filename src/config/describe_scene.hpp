#pragma once
#include "src/config/case.hpp"
#include "src/config/describe_cloth.hpp"
#include "src/config/key.hpp"
#include "src/config/solids.hpp"

#include <algorithm>

/// The keys of `pins`, `obstacles`, `contact` and `air`; see describe.hpp.
namespace taut::config {

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
     .meaning = "when it is here"});
  v("translate", k.translate, {.unit = Unit::metre, .meaning = "offset from the start, after the rotation"});
  v("rotate", k.rotate, {.meaning = "rotation of the start position, done first"});
}

/// Times that increase strictly.
template<class T>
bool increasing(const std::vector<T>& keyframes) {
  for (std::size_t i = 1; i < keyframes.size(); ++i)
    if (!(keyframes[i - 1].time < keyframes[i].time)) return false;
  return true;
}

template<class V>
void describe(V& v, Is<Pin> auto& p) {
  v.exactly_one({"vertices", "range", "box", "near", "label"});
  v("vertices", p.vertices, {.range = not_negative, .meaning = "numbers of the vertices"});
  v("range", p.range, {.range = not_negative, .meaning = "numbers of the first and the last vertex"});
  v("box", p.box, {.meaning = "all vertices whose start position is inside"});
  v("near", p.near, {.unit = Unit::metre, .meaning = "for each point the vertex that starts nearest to it"});
  v("label", p.label, {.meaning = "label of edges and panels of a pattern: all their vertices"});
  v("cloth", p.cloth,
    {.computed_default = "all cloths together",
     .meaning = "name or number of the cloth that is meant, in which vertices are then numbered"});
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
  v.check("range", !p.range || (*p.range)[0] <= (*p.range)[1], "must rise: the first vertex, then the last");
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
  v("reach", p.reach,
    {.unit = Unit::metre,
     .range = positive,
     .computed_default = "a half-space",
     .meaning = "makes it a triangle, which has two sides and may turn: around the circle of this radius "
                "about the point, with a level side"});
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
void describe(V& v, Is<Solid> auto& s) {
  v.exactly_one({"sphere", "capsule", "box"});
  v("sphere", s.sphere, {.meaning = "a sphere"});
  v("capsule", s.capsule, {.meaning = "all points near a segment"});
  v("box", s.box, {.meaning = "a box along the axes"});
}

template<class V>
void describe(V& v, Is<Union> auto& u) {
  v("parts", u.parts,
    {.presence = Presence::required, .meaning = "what it is made of, each a sphere, a capsule or a box"});
  v("blend", u.blend,
    {.unit = Unit::metre,
     .range = not_negative,
     .meaning = "radius with which it is rounded where its parts meet"});
  v("edge", u.edge,
    {.unit = Unit::metre,
     .range = positive,
     .presence = Presence::required,
     .meaning = "about the length of the edges of the triangles that its surface is made of"});
  v.check("parts", !u.parts.empty(), "must not be empty; a union has parts");
  v.check("edge",
          std::all_of(u.parts.begin(), u.parts.end(),
                      [&](const Solid& s) { return 2 * u.edge <= half_width(s); }),
          "is too coarse for its parts; give at most half the smallest radius, and a quarter of the shortest "
          "side of a box");
  v.check("edge", u.parts.empty() || 1000 * u.edge >= (around(u).max - around(u).min).maxCoeff(),
          "is too fine for its parts, which would have millions of triangles; give at least a thousandth of "
          "their extent");
}

template<class V>
void describe(V& v, Is<Sequence> auto& s) {
  v("fps", s.fps,
    {.unit = Unit::hertz, .range = positive, .presence = Presence::required, .meaning = "meshes a second"});
  v("frames", s.frames,
    {.range = at_least(2), .presence = Presence::required, .meaning = "number of meshes"});
}

template<class V>
void describe(V& v, Is<Obstacle> auto& o) {
  v("name", o.name, {.computed_default = "its number and kind", .meaning = "how messages call it"});
  v.exactly_one({"plane", "sphere", "capsule", "box", "union", "mesh"});
  v("plane", o.plane, {.meaning = "a half-space, or a triangle"});
  v("sphere", o.sphere, {.meaning = "a sphere"});
  v("capsule", o.capsule, {.meaning = "all points near a segment"});
  v("box", o.box, {.meaning = "a box along the axes"});
  v("union", o.joined, {.meaning = "spheres, capsules and boxes as one body, rounded where they meet"});
  v("mesh", o.mesh,
    {.meaning = "surface of triangles or quads (.obj, .ply, .stl or .h5), relative to the case file"});
  v("sequence", o.sequence,
    {.computed_default = "none",
     .meaning =
         "the mesh is the first of numbered files with the same faces, body_0001.obj, body_0002.obj, ...: "
         "linear between them, the last is held"});
  v("scale", o.scale, {.range = positive, .meaning = "metres per unit of the mesh"});
  v("up", o.up, {.meaning = "axis that points up in the mesh file; y is turned to z, as of `cloth`"});
  v("start", o.start, {.meaning = "where it starts, moved as `cloth.start` moves cloth"});
  v("thickness", o.thickness, {.unit = Unit::metre, .range = not_negative, .meaning = "added all around"});
  v("room", o.room,
    {.unit = Unit::metre,
     .range = positive,
     .computed_default = "with `sewing` 1.5 edges of the finest pattern; otherwise the mesh is as given",
     .meaning =
         "of a mesh: what parts of it that face each other, as in armpits, leave between them; they give "
         "way by what is missing"});
  v("fitted", o.fitted,
    {.computed_default = "none",
     .meaning =
         "of a mesh or union: file that `sewing` wrote, by how much it stays back where a garment is too "
         "tight for it, relative to the case file"});
  v("friction", o.friction,
    {.range = not_negative,
     .computed_default = "`contact.friction`",
     .meaning = "Coulomb coefficient against cloth"});
  v("motion", o.motion, {.meaning = "keyframes, relative to the start, as of pins; none: at rest"});
  v.check("sequence", !o.sequence || o.mesh, "is of meshes; give the first as mesh");
  v.check("motion", increasing(o.motion), "times must increase from keyframe to keyframe; sort them");
  v.check("motion",
          !o.plane || o.plane->reach ||
              std::none_of(o.motion.begin(), o.motion.end(),
                           [](const Keyframe& k) { return k.rotate.angle != 0; }),
          "a half-space can be moved but not turned; give plane.reach, which makes it a triangle");
}

template<class V>
void describe(V& v, Is<Sewing> auto& s) {
  v("time", s.time,
    {.unit = Unit::second,
     .range = positive,
     .meaning = "in which the two edges of every seam come together"});
  v("force", s.force,
    {.unit = Unit::newton_per_metre,
     .range = positive,
     .meaning = "largest pull of a seam, per length: a seam that needs more stays open"});
  v("limit", s.limit,
    {.unit = Unit::second,
     .range = positive,
     .meaning = "time by which all seams must have closed; those that have not are named"});
  v("growth", s.growth,
    {.unit = Unit::second,
     .range = positive,
     .meaning = "in which bodies, slim until all seams are closed, grow to their size in the garment"});
  v("pressure", s.pressure,
    {.unit = Unit::pascal,
     .range = positive,
     .meaning =
         "of the garment on a body that grows: where it is too tight for more, the body stays back, by 2 cm "
         "for as much again, and by how much is told"});
  v("damping", s.damping,
    {.unit = Unit::per_second, .range = not_negative, .meaning = "of all motion until then"});
  v("gravity", s.gravity,
    {.unit = Unit::metre_per_second2, .meaning = "acceleration of free fall until then"});
  v("bending", s.bending,
    {.unit = Unit::cloth_bending,
     .range = not_negative,
     .meaning = "bending stiffness until then, of cloth that is softer: panels that stay smooth do not get "
                "caught on one another"});
  v("method", s.method,
    {.computed_default = "newton for at most 20 000 vertices, otherwise fast_projection",
     .meaning = "what keeps the panels from stretching until then: fast_projection, or newton with MUMPS, by "
                "which seams do not open one another"});
  using enum InextensibilityMethod;
  v.check("method", !s.method || s.method == fast_projection || s.method == newton,
          "is fast_projection or newton");
  v.check("limit", s.limit >= s.time, "is less than time; seams need that long to close");
}

template<class V>
void describe(V& v, Is<Impulse> auto& i) {
  v("order", i.order,
    {.meaning =
         "which filter has the last word: with contact_last no intersection comes about, and strain is "
         "what it comes to be; with contact_first the other way round"});
}

template<class V>
void describe(V& v, Is<Penalty> auto& p) {
  v("stiffness", p.stiffness,
    {.unit = Unit::newton_per_metre,
     .range = positive,
     .computed_default = "500 times the weight of a vertex over the thickness",
     .meaning = "of a spring between two features nearer than the thickness"});
  v("damping", p.damping,
    {.unit = Unit::second, .range = not_negative, .meaning = "of these springs, times their stiffness"});
}

template<class V>
void describe(V& v, Is<Contact> auto& c) {
  v("model", c.model,
    {.meaning =
         "constraint: within the projection, never an intersection; impulse: repulsions, impulses and "
         "impact zones, a filter of its own; penalty: stiff springs between what comes too near; none: off"});
  v("thickness", c.thickness,
    {.unit = Unit::metre,
     .range = positive,
     .computed_default = "a tenth of the mean edge of each cloth, at most half its shortest",
     .meaning = "distance kept between midsurfaces"});
  v("friction", c.friction, {.range = not_negative, .meaning = "Coulomb coefficient of cloth on cloth"});
  v("max_iterations", c.max_iterations,
    {.range = at_least(1), .meaning = "projections with contact before a step is rejected"});
  v("start", c.start,
    {.meaning =
         "what becomes of a start that intersects: it is refused, or shallow intersections are untangled "
         "before the first step"});
  v("check", c.check, {.meaning = "when the result is tested for intersections"});
  v("impulse", c.impulse, {.computed_default = "its defaults", .meaning = "of model impulse"});
  v("penalty", c.penalty, {.computed_default = "its defaults", .meaning = "of model penalty"});
  v.check("impulse", !c.impulse || c.model == ContactModel::impulse, "is of model impulse only; remove it");
  v.check("penalty", !c.penalty || c.model == ContactModel::penalty, "is of model penalty only; remove it");
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

} // namespace taut::config
