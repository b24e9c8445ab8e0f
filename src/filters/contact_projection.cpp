#include "src/filters/contact_projection.hpp"

#include "partition/traffic.hpp"
#include "src/filters/edge_constraints.hpp"
#include "src/state/strain_gauge.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double strain_left = 0.2; ///< of the limit, by a program

/// Of a program; what is left waits for the next iteration. While the largest strain is `far` limits, the
/// edges' curvature leaves more of it than so few products do. Nearer, the step is done if no edge is left
/// beyond the limit.
constexpr QpEffort effort_far{20}, effort_near{40, 80, 0.8 / strain_left};
constexpr double far = 10.0;

constexpr double slack = 1.0;      ///< of the thickness: how far cloth may stray before a search is extended
constexpr int patience = 6;        ///< iterations until stuck vertices are let go
constexpr double most_strain = 30; ///< of a prediction; what moves farther could not be searched

/// Of the longest step: the time in which what strain and overlap a step leaves are corrected. Within a much
/// shorter step that would throw the cloth about.
constexpr double settling = 0.25;
constexpr double most_inherited = 0.6; ///< of the limit; with what a program leaves, clearly below it

/// So much of what an edge yields by its masses its compliance may add, so that halving a step in which
/// something strikes hard does not soften the edges.
constexpr double most_scaled_compliance = 1e-3;

SolverOptions solver_options(const config::Inextensibility& options) {
  return {options.solver == config::LinearSolver::mumps ? SolverOptions::Kind::mumps
                                                        : SolverOptions::Kind::cg,
          1000};
}

/// The gap that the safe iterate must keep while it moves.
double floor_of(double gap, double thickness) {
  return gap > 0.25 * thickness ? std::max(0.2 * gap, 0.25 * thickness) : 0.8 * gap;
}

} // namespace

ContactProjection::ContactProjection(const Cloth& cloth, const Obstacles& obstacles, const Case& input,
                                     double weight)
    : comm_(cloth.mesh.comm), cloth_(cloth), limits_(input.inextensibility),
      contact_(input.contact.value_or(config::Contact{})), obstacles_(obstacles), search_(cloth, obstacles_),
      system_(cloth.mesh, solver_options(limits_)), qp_(cloth, search_), thickness_(cloth, input),
      cones_(obstacles), compliance_(compliance_of(limits_, weight)), gravity_(input.gravity.norm()),
      settling_time_(settling * input.time.max_step), gradient_(cloth.mesh.edges.size()),
      inverse_mass_(cloth.mesh.vertices.size()), scaled_compliance_(cloth.mesh.edges.owned),
      residual_(cloth.mesh.edges.owned), tolerance_(cloth.mesh.edges.owned), change_(cloth.mesh.edges.size()),
      mu_(cloth.mesh.edges.size()), pulled_(cloth.mesh.edges.size()), guess_(cloth.mesh.edges.owned) {}

FilterReport ContactProjection::apply(const State& start, double dt, const Freedom& freedom,
                                      Candidate& candidate) {
  FilterReport report;
  const auto timed = [&](auto&& part) {
    const PhaseScope phase(Phase::contact);
    const double began = MPI_Wtime();
    part();
    report.contact_seconds += MPI_Wtime() - began;
  };
  begin(start, dt, freedom, candidate);
  if (const double strain = measure_strain(cloth_, target_.cloth).max; !(strain <= most_strain)) {
    report.failure = fmt::format("without projection edges would strain by {:.3g}", strain);
    return report;
  }
  double behind = HUGE_VAL; // m, how far the safe iterate was from the target
  timed([&] {
    search_.find(motion(), thickness_.largest_near(), slack * thickness_.largest());
    update_pairs(0);
  });
  for (iteration_ = 1;; ++iteration_) {
    make_rows();
    const double strain = strain_at_target(freedom);
    if (!std::isfinite(strain)) {
      report.failure = "the positions are no longer finite";
      break;
    }
    project(strain, report);
    note_contact_forces(candidate); // before another search renumbers what the rows refer to
    if (contact_count_ > report.contacts) {
      report.contacts = contact_count_;
      report.contacts_if_even = size_of(comm_) * max_over(comm_, Global(contacts_.size()));
    }
    ++report.iterations;
    if (!report.failure.empty()) break;
    double alpha = 1;
    timed([&] {
      if (search_.follow(motion())) update_pairs(search_.kept());
      alpha = step_length();
    });
    advance_safe(alpha);
    const double reached = measure_strain(cloth_, safe_.cloth).max;
    if (alpha == 1.0 && reached <= limits_.strain) break;
    if (iteration_ == contact_.max_iterations) {
      report.failure =
          fmt::format("projection with contact left a strain of {:.4g} (limit {:g}) after {} iterations{}",
                      reached, limits_.strain, iteration_, what_stopped());
      break;
    }
    timed([&] { measure_gaps(0); });
    const double was_behind = std::exchange(behind, distance_behind());
    if (alpha < 1 && iteration_ >= patience && behind > 0.5 * was_behind) free_stuck();
  }
  propose(candidate);
  return report;
}

void ContactProjection::propose(Candidate& candidate) const {
  for (std::size_t i = 0; i < candidate.velocities.size(); ++i)
    candidate.velocities[i] = (safe_.cloth[i] - start_.cloth[i]) / dt_;
  for (std::size_t e = 0; e < mu_.size(); ++e) {
    candidate.multipliers.force_density[e] = 2.0 * mu_[e] / (cloth_.rest_length[e] * dt_ * dt_);
    candidate.multipliers.projection_tension[e] = pulled_[e] / (dt_ * dt_);
  }
  candidate.multipliers.contacts = bring_home(cloth_.mesh, pressed_contacts());
}

void ContactProjection::begin(const State& start, double dt, const Freedom& freedom,
                              const Candidate& candidate) {
  dt_ = dt;
  violation_fraction_kept_ = std::max(0.0, 1 - dt / settling_time_);
  fall_ = gravity_ > 0 ? std::min(thickness_.smallest(), gravity_ * dt * dt) : thickness_.smallest();
  for (std::size_t e = 0; e < guess_.size(); ++e)
    guess_[e] = start.multipliers.projection_tension[e] * dt * dt;
  std::fill(pulled_.begin(), pulled_.end(), 0.0);
  at_home_ = start.multipliers.contacts;
  touched_.clear();
  blocked_.clear();
  start_.cloth = start.positions;
  obstacles_.place(start.time, start_.obstacles);
  safe_ = start_;
  target_.cloth.resize(start_.cloth.size());
  for (std::size_t i = 0; i < start_.cloth.size(); ++i)
    target_.cloth[i] = start.positions[i] + dt * candidate.velocities[i];
  obstacles_.place(start.time + dt, target_.obstacles);
  spins_ = obstacles_.spins(start.time, start.time + dt);
  freedom_ = &freedom;
  for (Local i = 0; i < Local(inverse_mass_.size()); ++i)
    inverse_mass_[i] = freedom.is_held(i) ? 0.0 : 1.0 / cloth_.mass[i];
  for (std::size_t e = 0; e < scaled_compliance_.size(); ++e) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    scaled_compliance_[e] = std::min(4.0 * cloth_.rest_length[e] * compliance_ / (dt * dt),
                                     4.0 * most_scaled_compliance * (inverse_mass_[a] + inverse_mass_[b]));
    tolerance_[e] = strain_left * limits_.strain * 2.0 * cloth_.rest_length[e];
  }
  for (std::size_t e = 0; e < mu_.size(); ++e)
    mu_[e] = 0.5 * candidate.multipliers.force_density[e] * cloth_.rest_length[e] * dt * dt;
}

/// Of which the first `known` were there when last looked at.
void ContactProjection::update_pairs(std::size_t known) {
  search_.gather(start_.cloth, start_.obstacles, start_field_);
  inverse_effective_mass_.assign(search_.size(), Vec3::Zero());
  for (Local i = 0; i < search_.own(); ++i) inverse_effective_mass_[i][0] = inverse_mass_[i];
  search_.update(inverse_effective_mass_);
  measure_gaps(known);
}

/// Distances and directions at the safe iterate, of all pairs but the first `known`.
void ContactProjection::measure_gaps(std::size_t known) {
  search_.gather(safe_.cloth, safe_.obstacles, safe_field_);
  approaches_.resize(known);
  for (const Pair& pair : search_.pairs().subspan(known))
    approaches_.push_back(approach(pair, at(pair, safe_field_)));
}

/// Gradients and right-hand side of the edges at the target; returns the largest |strain| there.
double ContactProjection::strain_at_target(const Freedom& freedom) {
  const DistributedMesh& mesh = cloth_.mesh;
  double max = 0;
  for (Local e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const double l = cloth_.rest_length[e];
    const Vec3 d = target_.cloth[b] - target_.cloth[a];
    gradient_[e] = (2.0 / l) * d;
    if (!mesh.owns_edge(e)) continue;
    const double length = d.norm();
    // |d|^2 / l - l [G07]; under contact what moves the edge to its length if it keeps its direction, which
    // leaves only the turning of edges to further iterations
    const double value =
        contact_count_ == 0 ? length * length / l - l : 2 * (length / l) * (length - l - stretch_to_leave(e));
    residual_[e] = freedom.is_held(a) && freedom.is_held(b) ? 0.0 : value - scaled_compliance_[e] * mu_[e];
    const double strain = length / l - 1.0;
    max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
  }
  return max_over(mesh.comm, max);
}

/// m, of what the last step left.
double ContactProjection::stretch_to_leave(Local edge) const {
  if (violation_fraction_kept_ == 0) return 0;
  const auto& [a, b] = cloth_.mesh.edge_vertices[edge];
  const double l = cloth_.rest_length[edge], most = most_inherited * limits_.strain * l;
  return violation_fraction_kept_ * std::clamp((start_.cloth[b] - start_.cloth[a]).norm() - l, -most, most);
}

/// Moves the target to where edges and contacts want it.
void ContactProjection::project(double strain, FilterReport& report) {
  if (contact_count_ == 0) {
    system_.assemble(gradient_, inverse_mass_, *freedom_, scaled_compliance_);
    const double forcing = std::clamp(0.1 * limits_.strain / strain, 1e-4, 1e-2);
    const SolveReport solved = system_.solve(residual_, forcing, change_);
    report.linear_iterations += solved.iterations;
    report.failure = solved.failure;
    const DistributedMesh& mesh = cloth_.mesh;
    for (Local i = 0; i < mesh.vertices.owned; ++i) {
      Vec3 pull = Vec3::Zero();
      for (const EdgeEnd& end : mesh.star_of(i)) pull += end.sign * change_[end.edge] * gradient_[end.edge];
      target_.cloth[i] -= inverse_mass_[i] * freedom_->allowed(i, pull);
    }
    mesh.vertex_halo.update(target_.cloth);
  } else {
    if (iteration_ > 1) std::fill(guess_.begin(), guess_.end(), 0.0);
    const EdgeEquations edges{gradient_, inverse_mass_, *freedom_, scaled_compliance_,
                              residual_, tolerance_,    guess_};
    const QpEffort& effort = strain > far * limits_.strain ? effort_far : effort_near;
    report.linear_iterations += qp_.solve(edges, contacts_, rows_, effort).products;
    const auto push = qp_.push();
    for (std::size_t i = 0; i < push.size(); ++i) target_.cloth[i] += push[i];
    std::copy(qp_.edge_part().begin(), qp_.edge_part().end(), change_.begin());
    cloth_.mesh.edge_halo.update(change_);
    note_multipliers();
  }
  for (std::size_t e = 0; e < mu_.size(); ++e) mu_[e] += change_[e];
  for (std::size_t e = 0; e < pulled_.size(); ++e) pulled_[e] += change_[e];
}

/// The fraction of the way to the target on which no pair comes too near. It is the same for all vertices:
/// what moves together would come as near as it moves if some of it stayed behind, and the search does not
/// look so far.
double ContactProjection::step_length() {
  search_.gather(target_.cloth, target_.obstacles, target_field_);
  stuck_.clear();
  double alpha = 1;
  for (std::size_t k = 0; k < search_.pairs().size(); ++k) {
    const Pair& pair = search_.pairs()[k];
    const Four x = at(pair, safe_field_);
    Four u = at(pair, target_field_);
    for (int i = 0; i < 4; ++i) u[i] -= x[i];
    const double gap = approaches_[k].gap;
    const double part = safe_fraction(pair, x, u, floor_of(gap, thickness_.of(pair, search_.keys())));
    if (part < 1) {
      blocked_.insert(name_of(pair, search_.keys()));
      stuck_.push_back(Local(k));
    }
    alpha = std::min(alpha, part);
  }
  return -max_over(comm_, -alpha);
}

double ContactProjection::distance_behind() const {
  double farthest = 0;
  for (Local i = 0; i < search_.own(); ++i)
    farthest = std::max(farthest, (target_.cloth[i] - safe_.cloth[i]).squaredNorm());
  return std::sqrt(max_over(comm_, farthest));
}

/// The first of the pairs that stopped the safe iterate, in words.
std::string ContactProjection::what_stopped() const {
  std::string mine;
  if (!stuck_.empty()) {
    const Pair& pair = search_.pairs()[stuck_.front()];
    const Vec3& x = safe_field_[pair.vertices[0]];
    mine =
        fmt::format(" and was stopped by contact with {} at ({:.4g}, {:.4g}, {:.4g}) m",
                    pair.body >= 0 ? obstacles_.body(pair.body).name : "the cloth itself", x[0], x[1], x[2]);
  }
  const int ranks = size_of(comm_);
  const Global speaker = -max_over(comm_, Global(mine.empty() ? -ranks : -rank_of(comm_)));
  return speaker < ranks ? broadcast_text(comm_, mine, int(speaker)) : "";
}

/// Gives up the way of the vertices that hold up all others: their target is where they are.
void ContactProjection::free_stuck() {
  std::vector<Vec3> mark(search_.size(), Vec3::Zero());
  for (const Local k : stuck_)
    for (const Local v : search_.pairs()[k].vertices) mark[v][0] = 1;
  search_.accumulate(mark);
  for (Local i = 0; i < search_.own(); ++i)
    if (mark[i][0] > 0 && inverse_mass_[i] > 0) target_.cloth[i] = safe_.cloth[i];
  cloth_.mesh.vertex_halo.update(target_.cloth);
}

void ContactProjection::advance_safe(double alpha) {
  if (alpha == 1.0) {
    safe_ = target_;
    return;
  }
  for (std::size_t i = 0; i < safe_.cloth.size(); ++i)
    safe_.cloth[i] += alpha * (target_.cloth[i] - safe_.cloth[i]);
  for (std::size_t i = 0; i < safe_.obstacles.size(); ++i)
    safe_.obstacles[i] += alpha * (target_.obstacles[i] - safe_.obstacles[i]);
}

} // namespace taut
