#pragma once
#include "src/config/case.hpp"
#include "src/config/fabrics.hpp"
#include "src/config/key.hpp"

/// The keys of `cloth`; see describe.hpp.
namespace taut::config {

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
void describe(V& v, Is<Placement> auto& p) {
  v("rotate", p.rotate, {.meaning = "rotation about the origin, done first"});
  v("translate", p.translate, {.unit = Unit::metre, .meaning = "move, done after the rotation"});
}

template<class V>
void describe(V& v, Is<Start> auto& s) {
  v("shape", s.shape,
    {.meaning = "file with the same vertices in other places: OBJ, PLY, or a frame of a run (.h5)"});
  v("run", s.run,
    {.meaning = "of a pattern: folder of a run of the same pattern, of any edge length; it begins, sewn, as "
                "that ended"});
  v("rotate", s.rotate, {.meaning = "rotation about the origin, done first"});
  v("translate", s.translate, {.unit = Unit::metre, .meaning = "move, done after the rotation"});
  v.check("run", !s.run || (!s.shape && s.rotate == Rotation{} && s.translate.isZero(0)),
          "says where the cloth is: remove shape, rotate and translate, or give taut run --from FOLDER");
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
  v("density", m.density,
    {.unit = Unit::cloth_density, .range = at_least(1e-6), .meaning = "mass per area; on a line per length"});
  v("bending", m.bending,
    {.unit = Unit::cloth_bending, .range = not_negative, .meaning = "bending stiffness"});
  v("bending_weft", m.bending_weft,
    {.unit = Unit::cloth_bending,
     .range = not_negative,
     .computed_default = "bending",
     .meaning = "bending stiffness of weft threads; not with bending_model: yarn"});
  v("seam_bending", m.seam_bending,
    {.unit = Unit::cloth_bending,
     .range = not_negative,
     .computed_default = "as elsewhere",
     .meaning = "bending stiffness over the seams of a garment, if it is larger than that of the cloth"});
  v("twist", m.twist,
    {.unit = Unit::cloth_bending,
     .range = not_negative,
     .computed_default = "bending; with `bending_weft`, the geometric mean of both",
     .meaning = "twist stiffness of quads: that of an isotropic sheet is its bending stiffness"});
  v("bending_model", m.bending_model,
    {.computed_default = "yarn; isometric on a mesh with triangles, or with bending_weft",
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
     .computed_default =
         "0; from the weight, where `inextensibility.constrain` is vertices, but not of newton with contact",
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
void describe(V& v, Is<Elastic> auto& e) {
  v("label", e.label,
    {.presence = Presence::required, .meaning = "label of edges, or of panels, of the pattern"});
  v("length", e.length,
    {.range = {.low = 0.3, .high = 1},
     .presence = Presence::required,
     .meaning = "how long it is at rest, over its length as cut: what it holds is gathered to it"});
}

template<class V>
void describe(V& v, Is<PanelMaterial> auto& m) {
  const auto add = [&](std::string_view name, auto& value, Unit unit, const Range& range,
                       std::string_view meaning) {
    v(name, value, {.unit = unit, .range = range, .computed_default = "of the cloth", .meaning = meaning});
  };
  add("density", m.density, Unit::cloth_density, at_least(1e-6), "mass per area");
  add("bending", m.bending, Unit::cloth_bending, not_negative, "bending stiffness");
  add("bending_weft", m.bending_weft, Unit::cloth_bending, not_negative, "bending stiffness of weft threads");
  add("twist", m.twist, Unit::cloth_bending, not_negative, "twist stiffness of quads");
  add("shear", m.shear, Unit::newton_per_metre, not_negative, "shear stiffness, per radian of shear angle");
  add("stretch", m.stretch, Unit::cloth_stretch, not_negative,
      "stretch stiffness of warp and weft, per strain");
  add("stretch_weft", m.stretch_weft, Unit::cloth_stretch, not_negative, "stretch stiffness of weft threads");
}

template<class V>
void describe(V& v, Is<Panel> auto& p) {
  v("edge", p.edge,
    {.unit = Unit::metre,
     .range = positive,
     .computed_default = "of the pattern, or `edge` of the cloth",
     .meaning = "length of the edges of its mesh"});
  v("fabric", p.fabric,
    {.words = fabric_names(),
     .meaning = "fills its material; keys given there win; else it is as the cloth"});
  v("material", p.material, {.meaning = "what the panel is made of, where it differs from the cloth"});
}

template<class V>
void describe(V& v, Is<Cloth> auto& c) {
  v("name", c.name, {.computed_default = "its number", .meaning = "how pins and messages call it"});
  v.exactly_one({"grid", "line", "mesh", "pattern"});
  v("grid", c.grid, {.meaning = "a rectangle of quads in the plane z = 0"});
  v("line", c.line, {.meaning = "a chain of line elements along x"});
  v("mesh", c.mesh, {.meaning = "mesh file (.obj, .ply, .stl or .h5), relative to the case file"});
  v("pattern", c.pattern,
    {.meaning =
         "sewing pattern (.json or .yaml), relative to the case file; its panels are placed, and sewn if "
         "there is `sewing`"});
  v("edge", c.edge,
    {.unit = Unit::metre,
     .range = positive,
     .computed_default = "none; a pattern needs it",
     .meaning = "length of the edges of its mesh, where the pattern gives no other"});
  v("elastic", c.elastic, {.meaning = "edges of a pattern that are shorter at rest than they are cut"});
  v("panels", c.panels, {.meaning = "by name, panels of a pattern that have edges or a fabric of their own"});
  v("scale", c.scale, {.range = positive, .meaning = "metres per unit of the mesh and of start.shape"});
  v("rest", c.rest,
    {.meaning = "where faces have their lengths, warp and weft at rest: the mesh, or its texture coordinates "
                "(as a garment is cut); folds take those of the mesh"});
  v("texture_unit", c.texture_unit,
    {.unit = Unit::metre,
     .range = positive,
     .meaning = "length of a unit of the texture coordinates, with rest: texture"});
  v("up", c.up,
    {.computed_default = "y of a pattern, else z",
     .meaning = "axis that points up in the file; y is turned to z (x, y, z become x, -z, y)"});
  v("start", c.start, {.meaning = "where the cloth starts"});
  v("fabric", c.fabric, {.words = fabric_names(), .meaning = "fills material; keys given there win"});
  v("material", c.material,
    {.computed_default = "of the fabric, if one is named", .meaning = "what the cloth is made of"});
  v("thickness", c.thickness,
    {.unit = Unit::metre,
     .range = positive,
     .computed_default = "`contact.thickness`",
     .meaning = "distance kept between two layers of it; to another cloth, the mean of both is kept"});
  v.check("scale", c.scale == 1 || c.mesh || c.start.shape,
          "is for cloth.mesh and start.shape; remove it, and give lengths in metres or with a unit");
  v.check("edge", !c.pattern || c.edge,
          "is missing; a pattern needs the length of the edges of its mesh, e.g. 5 mm");
  v.check("rest", c.rest == RestShape::mesh || c.mesh, "texture is of a mesh file; give cloth.mesh");
  v.check("texture_unit", c.rest == RestShape::texture || c.texture_unit == 1,
          "is for rest: texture; remove it");
  v.check("start", !c.start.run || c.pattern,
          "run is for a pattern; for a mesh give taut run --from FOLDER, or mesh and start.shape");
  v.check("elastic", c.elastic.empty() || c.pattern,
          "is for a pattern; remove it: a mesh that was made with it has it in its rest shape");
  v.check("panels", c.panels.empty() || c.pattern || c.mesh,
          "are those of a pattern; remove it, or give cloth.pattern");
  for (const auto& [name, panel] : c.panels)
    v.check("panels." + name + ".edge", c.pattern || !panel.edge,
            "is for a pattern; remove it: the mesh has its edges already");
  v.check("edge", c.pattern || !c.edge, "is for a pattern; remove it, or give cloth.pattern");
}

} // namespace taut::config
