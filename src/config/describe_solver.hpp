#pragma once
#include "src/config/key.hpp"
#include "src/config/methods.hpp"

#include <fmt/format.h>

/// The keys of `time`, `velocity`, `inextensibility`, `partition`, `checkpoint` and `output`; see
/// describe.hpp.
namespace taut::config {

template<class V>
void describe(V& v, Is<Time> auto& t) {
  v("integrator", t.integrator,
    {.meaning = "time stepping: first order, second order, or first order with loads taken explicitly"});
  v("end", t.end, {.unit = Unit::second, .range = positive, .meaning = "simulated time to run"});
  v("frame_rate", t.frame_rate,
    {.unit = Unit::hertz, .range = positive, .meaning = "frames written per second, and one at the end"});
  v("until_rest", t.until_rest,
    {.unit = Unit::metre_per_second,
     .range = positive,
     .computed_default = "until end",
     .meaning = "the run ends with the first frame at whose end no vertex is faster, once pins, attachments, "
                "obstacles and gravity change no more; at the latest at end"});
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
  constexpr double most_frames = 1e9;
  v.check("end", t.end * t.frame_rate <= most_frames,
          fmt::format("makes {:.3g} frames at this frame_rate, of {:g} that can be; make one of them smaller",
                      t.end * t.frame_rate, most_frames));
  v.check("end", t.end >= t.min_step, "is less than min_step, one step; make it larger");
}

template<class V>
void describe(V& v, Is<Velocity> auto& s) {
  v("solver", s.solver, {.meaning = "linear solver: conjugate gradients, or MUMPS (direct)"});
  v("tolerance", s.tolerance,
    {.range = fraction,
     .computed_default = "0.0003; 0.01 where cloth resists stretching, as triangles do by default",
     .meaning = "relative residual at which cg stops"});
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
          fmt::format("method {} does not use it; remove it, or choose another method", word_of(method)));
}

template<class V>
void describe(V& v, Is<Inextensibility> auto& i) {
  v("method", i.method,
    {.computed_default =
         "newton; fast_projection with contact (but of a pattern with time.until_rest), or where velocity, "
         "petsc, solver or faces is given",
     .meaning = "how edges keep their lengths; none lets them stretch freely"});
  v("constrain", i.constrain,
    {.computed_default =
         "vertices on meshes with triangles, with methods fast_projection and newton; else edges",
     .meaning =
         "what keeps its length: edges, all of which lock meshes of triangles, or of triangles warp and weft "
         "averaged at their corners; sides of quads and lines are kept in any case"});
  v("strain", i.strain, {.range = fraction, .meaning = "largest strain that is left"});
  v("faces", i.faces,
    {.range = at_least(1),
     .meaning =
         "with constrain: vertices and method fast_projection, or newton and contact: largest strain of "
         "single triangles along warp and weft, over `strain`"});
  v("solver", i.solver,
    {.computed_default = "cg; mumps with method newton on meshes with triangles of at most 100 000 vertices",
     .meaning = "linear solver of a projection or of Newton's method: iterative, or MUMPS (direct)"});
  v("max_iterations", i.max_iterations, {.range = at_least(1), .meaning = "most projections in a step"});
  v("residual", i.residual,
    {.range = positive,
     .meaning =
         "of method newton: how far what a step leaves of its equations may move the cloth, over how far "
         "gravity (1 m/s^2 where there is none) or a stronger acceleration moves it in the step"});
  v("carried_tension", i.carried_tension, {.meaning = "start a step from the tension of the last"});
  v("compliance", i.compliance,
    {.unit = Unit::per_newton,
     .range = not_negative,
     .computed_default = "from the weight of the cloth",
     .meaning = "strain of an edge per newton of its tension; by default that of a taut thread which bears "
                "the whole cloth, at gravity of 9.81 m/s^2 or more, is a tenth of the limit; of xpbd: 0"});
  v("shake", i.shake, {.computed_default = "its defaults", .meaning = "options of methods shake and rattle"});
  v("limiting", i.limiting,
    {.computed_default = "its defaults", .meaning = "options of methods jacobi and gauss_seidel"});
  v("xpbd", i.xpbd, {.computed_default = "its defaults", .meaning = "options of method xpbd"});
  v("springs", i.springs, {.computed_default = "its defaults", .meaning = "options of method springs"});
  using enum InextensibilityMethod;
  const Inextensibility standard;
  const bool projects = is_projection(i.method);
  v.check("constrain", i.constrain != Constrain::vertices || can_average(i.method),
          "vertices works with methods fast_projection and newton only; choose one of these, or edges");
  check_use(v, "faces", i.faces == standard.faces, i.method == fast_projection || i.method == newton,
            i.method);
  check_use(v, "solver", !i.solver, projects, i.method);
  check_use(v, "max_iterations", i.max_iterations == standard.max_iterations, projects, i.method);
  check_use(v, "residual", i.residual == standard.residual, i.method == newton, i.method);
  check_use(v, "carried_tension", i.carried_tension == standard.carried_tension,
            is_filter(i.method) || i.method == newton, i.method);
  check_use(v, "compliance", !i.compliance, projects || i.method == xpbd, i.method);
  check_use(v, "shake", !i.shake, i.method == shake || i.method == rattle, i.method);
  check_use(v, "limiting", !i.limiting, is_limiting(i.method), i.method);
  check_use(v, "xpbd", !i.xpbd, i.method == xpbd, i.method);
  check_use(v, "springs", !i.springs, i.method == springs, i.method);
}

template<class V>
void describe(V& v, Is<Partition> auto& p) {
  v("method", p.method,
    {.meaning = "how the cloth is cut for the ranks: by METIS on rank 0, by PT-Scotch on all of them "
                "for graphs that do not fit one rank, or in the order of the input"});
}

template<class V>
void describe(V& v, Is<Checkpoint> auto& c) {
  v("every_steps", c.every_steps,
    {.range = not_negative, .meaning = "time steps between two; 0: any number"});
  v("every_time", c.every_time,
    {.unit = Unit::second, .range = not_negative, .meaning = "simulated time between two; 0: any"});
  v("every_wall", c.every_wall,
    {.unit = Unit::second,
     .range = not_negative,
     .computed_default = "60, or 50 times what one took",
     .meaning = "time on the clock between two; 0: any"});
}

template<class V>
void describe(V& v, Is<Output> auto& o) {
  v("fields", o.fields, {.meaning = "what a frame holds, in formats that can hold it"});
  v("formats", o.formats,
    {.meaning = "what frames are written as: HDF5 with XDMF for ParaView, positions alone as a point cache"});
}

} // namespace taut::config
