#pragma once
#include "src/config/cloths.hpp"
#include "src/config/describe_attachment.hpp"
#include "src/config/describe_cloth.hpp"
#include "src/config/describe_scene.hpp"
#include "src/config/describe_solver.hpp"

#include <algorithm>

/// Every key of the case file, once. To add a key:
///
/// 1. give the struct in case.hpp a member with the default as its initial value;
/// 2. add one line in describe_cloth.hpp, describe_scene.hpp or describe_solver.hpp: v("name", c.member,
/// {.unit = ..., .range = ..., .meaning = "one line"}).
///
/// That is all: reading with its errors, writing, the JSON Schema and the table follow. `--set
/// block.name=value` works too. A member may be a double, int, bool, text, path, enumeration with `words_of`,
/// Vec2, Vec3, pair of ints, a struct described here, an optional or a vector of these. To add a struct,
/// write `describe` for it; a new enumeration needs `words_of`, a new unit two lines in units.cpp.
///
/// A visitor `v` is called as
///   v(name, member, Key)         for each key;
///   v.one_or_list("one", "list", member, Key)   for a vector that is given as one block or as a list of
///   them; v.exactly_one({names})       before the keys of which exactly one is to be given (optional
///   members); v.check(name, holds, cure)   after the keys, for what a range cannot say; the name may be a
///   path below.
namespace taut::config {

/// What holds for keys on their own.
template<class V>
void check_single_keys(V& v, Is<Case> auto& c) {
  constexpr double most_gravity = 1e6;
  v.check(
      "gravity", c.gravity.largest() <= most_gravity,
      fmt::format("is more than {:g} m/s^2; give one that steps of this length can follow", most_gravity));
  v.check("gravity", increasing(c.gravity.keyframes),
          "times must increase from keyframe to keyframe; sort them");
  v.check("name", !c.name.empty() && c.name.find('/') == std::string::npos && c.name != "." && c.name != "..",
          "must be a word without '/'; it names a folder");
}

/// What goes with which linear solver.
template<class V>
void check_solvers(V& v, const Case& c) {
  v.check("velocity", c.velocity.solver != LinearSolver::mumps || c.contact_model() != ContactModel::penalty,
          "solver mumps knows nothing of the springs of contact.model penalty; choose cg");
  v.check(
      "inextensibility",
      c.inextensibility.solver != LinearSolver::mumps ||
          (c.inextensibility.method != InextensibilityMethod::icd &&
           c.inextensibility.method != InextensibilityMethod::sap) ||
          std::none_of(c.pins.begin(), c.pins.end(), [](const Pin& p) { return p.along || p.plane; }),
      "methods icd and sap cannot keep sliding pins (pins.k.along, pins.k.plane) with solver mumps; choose "
      "solver cg");
}

/// Of cloths, and of what names them or obstacles.
template<class V>
void check_names(V& v, const Case& c) {
  v.check("cloths", !c.cloths.empty(), "must not be empty; give at least one cloth");
  if (const auto fault = fault_of_cloths(c)) v.check(fault->key, false, fault->cure);
  if (const auto fault = fault_of_attachments(c)) v.check(fault->key, false, fault->cure);
}

/// What all cloths have alike.
template<class V>
void check_likeness(V& v, const Case& c) {
  const auto all = [&](auto&& is_like_the_first) {
    return std::all_of(c.cloths.begin(), c.cloths.end(), is_like_the_first);
  };
  v.check("cloths", all([&](const Cloth& k) { return k.rest == c.cloths.front().rest; }),
          "rest: texture is of all cloths or of none; give it to each, or to none");
  v.check("cloths", all([&](const Cloth& k) {
            return k.start.run.has_value() == c.cloths.front().start.run.has_value();
          }),
          "start.run is of all cloths or of none; give it to each, or to none");
}

/// Of a case that begins with panels.
template<class V>
void check_sewing(V& v, const Case& c) {
  v.check("sewing",
          !c.sewing || std::all_of(c.cloths.begin(), c.cloths.end(),
                                   [](const Cloth& cloth) { return cloth.pattern.has_value(); }),
          "is for patterns; remove it, or give every cloth as a pattern");
  v.check("sewing", !c.sewing || c.sewing->method != InextensibilityMethod::newton || newton_knows_contact(c),
          "method newton works with contact.model constraint or none only; choose one of these, or method "
          "fast_projection");
  v.check("pins",
          !c.sewing ||
              std::all_of(c.pins.begin(), c.pins.end(), [](const Pin& p) { return p.label.has_value(); }),
          "must name what they hold by label where there is sewing, which numbers and moves vertices anew; "
          "in the pattern `label` of a panel or edge gives one, `points` one at a place");
  v.check("attachments",
          !c.sewing || std::all_of(c.attachments.begin(), c.attachments.end(),
                                   [](const Attachment& a) { return a.label.has_value(); }),
          "must name what they hold by label where there is sewing, which numbers vertices anew; in the "
          "pattern `label` of a panel or edge gives one, `points` one at a place");
}

template<class V>
void describe(V& v, Is<Case> auto& c) {
  v("name", c.name, {.computed_default = "folder of the case file", .meaning = "name of the case"});
  v.one_or_list("cloth", "cloths", c.cloths, {.meaning = "the cloth; one of grid, line, mesh and pattern"});
  v("pins", c.pins, {.meaning = "what holds the cloth"});
  v("attachments", c.attachments, {.meaning = "what is fastened: buttons, stitches, edges on a body"});
  v("gravity", c.gravity,
    {.unit = Unit::metre_per_second2,
     .meaning =
         "acceleration of free fall; or keyframes of it: linear between them, constant before and after"});
  v("air", c.air, {.computed_default = "vacuum", .meaning = "air around the cloth"});
  v("obstacles", c.obstacles, {.meaning = "what the cloth collides with"});
  v("sewing", c.sewing,
    {.computed_default = "none: panels stay apart",
     .meaning =
         "the panels of patterns are sewn together before the case begins; pins and obstacles are until "
         "then as at time 0"});
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
  v("petsc", c.petsc,
    {.meaning =
         "PETSc options of the linear solvers, such as '-velocity_ksp_rtol 1e-6'; what stands behind -- "
         "on the command line is added"});
  check_names(v, c);
  check_sewing(v, c);
  v.check(
      "time",
      c.time.integrator == Integrator::implicit_euler ||
          c.inextensibility.method != InextensibilityMethod::xpbd,
      "integrator is not used by inextensibility.method xpbd, which has its own time stepping; remove it");
  v.check(
      "time", c.time.integrator != Integrator::bdf2 || !c.has_contact(),
      "integrator bdf2 does not work with contact, as its steps begin beside the path of the cloth; choose "
      "implicit_euler or imex");
  v.check(
      "inextensibility",
      can_average(c.inextensibility.method) || c.contact_model() != ContactModel::constraint,
      "contact.model constraint works with methods fast_projection and newton only; choose one of these, or "
      "contact.model: impulse, penalty or none");
  v.check("inextensibility",
          c.inextensibility.method != InextensibilityMethod::newton || newton_knows_contact(c),
          "method newton works with contact.model constraint or none only; choose one of these, or method "
          "fast_projection");
  v.check("inextensibility", c.inextensibility.method != InextensibilityMethod::xpbd || !c.has_contact(),
          "method xpbd knows no contact; choose another, or contact.model: none");
  check_likeness(v, c);
  check_solvers(v, c);
  check_single_keys(v, c);
}

} // namespace taut::config
