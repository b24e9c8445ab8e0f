#include "src/command/sewing_cases.hpp"

#include "src/config/methods.hpp"

#include <algorithm>
#include <cmath>

namespace taut::command {

namespace fs = std::filesystem;

namespace {

/// Where keyframes are at time 0.
void hold_first(std::vector<config::Keyframe>& motion) {
  if (!motion.empty()) motion.resize(1);
}

/// Another method than that of the case itself does without the options that were chosen for that.
void use(config::InextensibilityMethod method, config::Inextensibility& i) {
  if (i.method == method) return;
  i.method = method;
  i.solver.reset();
  i.residual = config::Inextensibility{}.residual;
}

/// Fast Projection comes back in the metric of masses from where strings have drawn the cloth. So seams of
/// heavy skirts open those of the light straps that hold them.
void sew_by(config::InextensibilityMethod method, config::Inextensibility& i) {
  if (!config::can_average(i.method)) return;
  use(method, i);
  if (method == config::InextensibilityMethod::newton) i.solver = config::LinearSolver::mumps;
}

/// What both stages have: no motion but that of sewing.
Case in_peace(Case input) {
  const config::Sewing& sewing = *input.sewing;
  input.air.reset();
  input.attachments.clear();
  input.time.until_rest.reset();
  if (input.contact) input.contact->friction = 0;
  for (config::Cloth& c : input.cloths) {
    c.material.damping.mass += sewing.damping;
    c.material.bending = std::max(c.material.bending, sewing.bending);
    if (auto& weft = c.material.bending_weft) weft = std::max(*weft, sewing.bending);
    for (auto& [name, panel] : c.panels)
      for (auto* bending : {&panel.material.bending, &panel.material.bending_weft})
        if (*bending) *bending = std::max(**bending, sewing.bending);
  }
  for (config::Pin& pin : input.pins) {
    hold_first(pin.motion);
    pin.release.reset();
  }
  for (config::Obstacle& o : input.obstacles) {
    make_mesh(o);
    hold_first(o.motion);
    o.sequence.reset();
    o.friction = 0;
  }
  return input;
}

void let_grow(Case& input, const config::Growth& growth) {
  for (config::Obstacle& o : input.obstacles) o.growth = growth;
}

} // namespace

void make_mesh(config::Obstacle& o) {
  constexpr double fine = 0.2; // edges over radius
  if (!o.sphere && !o.capsule) return;
  o.joined =
      config::Union{{{o.sphere, o.capsule, {}}}, 0, fine * (o.sphere ? o.sphere->radius : o.capsule->radius)};
  o.sphere.reset();
  o.capsule.reset();
}

Case with_meshes(Case input, std::span<const fs::path> meshes) {
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    config::Cloth& cloth = input.cloths[k];
    cloth.mesh = meshes[k];
    cloth.pattern.reset();
    cloth.edge.reset();
    cloth.elastic.clear();
    for (auto& [name, panel] : cloth.panels) panel.edge.reset();
    cloth.up.reset();
    cloth.scale = 1;
    cloth.start = {};
  }
  return input;
}

config::InextensibilityMethod seam_method(const Case& input, Global vertices) {
  using enum config::InextensibilityMethod;
  constexpr Global most = 20000; // beyond, steps of ten solves and more are dear
  return config::newton_knows_contact(input) && vertices <= most ? newton : fast_projection;
}

void fill_in(Case& input, std::span<const double> shortest) {
  constexpr double room = 1.5, thickness = 0.03; // edges
  constexpr double most = 0.3;                   // of the shortest edge, which elastic may shorten
  double finest = HUGE_VAL;                      // m
  for (const config::Cloth& c : input.cloths) finest = std::min(finest, *c.edge);
  for (config::Obstacle& o : input.obstacles)
    if ((o.mesh || o.joined) && !o.room) o.room = room * finest;
  if (!input.has_contact()) return;
  if (!input.contact) input.contact.emplace();
  for (std::size_t k = 0; k < input.cloths.size(); ++k)
    if (config::Cloth& c = input.cloths[k]; !input.contact->thickness && !c.thickness)
      c.thickness = std::min(thickness * *c.edge, most * shortest[k]);
}

Case sewing_case(const Case& input) {
  Case stage = in_peace(input);
  stage.time.end = input.sewing->limit;
  // Averages over triangles are pulled at one side of a panel harder than the prediction knows, and would
  // keep seams open: the triangles at outlines stretch by the limit where a seam pulls with all its force.
  stage.inextensibility.constrain = config::Constrain::edges;
  sew_by(input.sewing->method.value_or(config::InextensibilityMethod::fast_projection),
         stage.inextensibility);
  const double stretch = input.sewing->force / input.inextensibility.strain;
  for (config::Cloth& c : stage.cloths) {
    c.material.stretch = std::max(c.material.stretch.value_or(0), stretch);
    for (auto& [name, panel] : c.panels)
      if (auto& own = panel.material.stretch) own = std::max(*own, stretch);
  }
  let_grow(stage, {HUGE_VAL});
  return stage;
}

Case fitting_case(const Case& input, std::span<const fs::path> sewn) {
  Case stage = with_meshes(in_peace(input), sewn);
  // By Newton's method steps are never rejected, but three times as dear; and a body stays back by 3 to 12 mm
  // at the shoulders of a shirt that is wide enough for it (garment/README.md).
  if (input.has_contact() && config::can_average(stage.inextensibility.method))
    use(config::InextensibilityMethod::fast_projection, stage.inextensibility);
  constexpr double most_time = 3; // times that of a body on which nothing presses
  stage.time.end = most_time * input.sewing->growth;
  // Sinks by a few centimetres at most: onto shoulders, above which it was sewn, and not off the hips.
  constexpr double sinking = 0.06, damping = 15; // m/s, 1/s
  stage.gravity = Vec3(sinking * damping * input.gravity.at(0).stableNormalized());
  for (config::Cloth& c : stage.cloths) c.material.damping.mass += damping;
  stage.sewing.reset();
  let_grow(stage, {input.sewing->growth, input.sewing->pressure});
  return stage;
}

} // namespace taut::command
