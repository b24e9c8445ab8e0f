#pragma once
#include "src/config/case.hpp"
#include "src/config/key.hpp"

/// The keys of `attachments` and of keyframes of `gravity`; see describe.hpp.
namespace taut::config {

template<class V>
void describe(V& v, Is<GravityKeyframe> auto& k) {
  v("time", k.time,
    {.unit = Unit::second,
     .range = not_negative,
     .presence = Presence::required,
     .meaning = "when gravity is this"});
  v("value", k.value,
    {.unit = Unit::metre_per_second2,
     .presence = Presence::required,
     .meaning = "acceleration of free fall"});
}

template<class V>
void describe(V& v, Is<Attachment> auto& a) {
  v.exactly_one({"label", "vertices"});
  v("label", a.label, {.meaning = "label of edges, panels or points of a pattern: a string at each vertex"});
  v("vertices", a.vertices, {.range = not_negative, .meaning = "numbers of two vertices: one string"});
  v("to", a.to, {.meaning = "label that those of `label` are drawn to, each vertex to the nearest of it"});
  v("obstacle", a.obstacle,
    {.meaning =
         "name or number of the obstacle that the vertices of `label` move with, from where they start"});
  v("force", a.force, {.unit = Unit::newton, .range = positive, .meaning = "largest pull of a string"});
  v("length", a.length, {.unit = Unit::metre, .range = not_negative, .meaning = "length of a string"});
  v("time", a.time,
    {.unit = Unit::second, .range = not_negative, .meaning = "in which strings become as short as that"});
  v("release", a.release,
    {.unit = Unit::second,
     .range = not_negative,
     .computed_default = "never",
     .meaning = "when strings let go"});
  v.check("label", !a.label || a.to.has_value() != a.obstacle.has_value(),
          "needs one of to and obstacle: what it is drawn to");
  v.check("vertices", !a.vertices || (!a.to && !a.obstacle),
          "are both ends of a string; remove to and obstacle, or give a label");
  v.check("vertices", !a.vertices || (*a.vertices)[0] != (*a.vertices)[1], "must be two different ones");
}

} // namespace taut::config
