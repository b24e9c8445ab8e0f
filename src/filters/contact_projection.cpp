#include "src/filters/contact_projection.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr int most_products = 40;   ///< in one program; what is left waits for the next iteration
constexpr double strain_left = 0.2; ///< of the limit, by a program
constexpr double gap_left = 0.1;    ///< by a program, of what a free vertex falls in a step
constexpr double slip_left = 0.03;  ///< the same
constexpr double slack = 1.0;       ///< of the thickness: how far a target may leave a search
constexpr int patience = 6;         ///< iterations until stuck vertices are let go

SolverOptions solver_options(const config::Inextensibility& options) {
  return {options.solver == config::LinearSolver::mumps ? SolverOptions::Kind::mumps
                                                        : SolverOptions::Kind::cg,
          1000};
}

double shortest_edge(const Cloth& cloth) {
  double shortest = HUGE_VAL;
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) shortest = std::min(shortest, cloth.rest_length[e]);
  return -max_over(cloth.mesh.comm, -shortest);
}

double mean_edge(const Cloth& cloth) {
  double sum = 0;
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) sum += cloth.rest_length[e];
  return sum_over(cloth.mesh.comm, sum) / double(std::max<Global>(1, cloth.mesh.edges.total));
}

/// Names a pair by its vertices, whatever its closest points are.
ContactKey name_of(const Pair& pair, std::span<const Global> keys) {
  ContactKey key;
  for (int i = 0; i < 4; ++i) key[i] = keys[pair.vertices[i]];
  if (pair.kind == PairKind::edge_edge) key[0] = -2 - key[0];
  return key;
}

/// The gap that the safe iterate must keep while it moves.
double floor_of(double gap, double thickness) {
  return gap > 0.25 * thickness ? std::max(0.2 * gap, 0.25 * thickness) : 0.8 * gap;
}

} // namespace

ContactProjection::ContactProjection(const Cloth& cloth, const Case& input, double weight)
    : comm_(cloth.mesh.comm), cloth_(cloth), limits_(input.inextensibility),
      contact_(input.contact.value_or(config::Contact{})), obstacles_(comm_, input),
      search_(cloth, obstacles_), system_(cloth.mesh, solver_options(limits_)), qp_(cloth, search_, system_),
      thickness_(contact_.thickness.value_or(0.1 * mean_edge(cloth))),
      compliance_(
          limits_.compliance.value_or(weight > 0 ? 4.9 * std::pow(0.1 * limits_.strain, 1.5) / weight : 0.0)),
      gravity_(input.gravity.norm()), gradient_(cloth.mesh.edges.size()),
      inverse_mass_(cloth.mesh.vertices.size()), shift_(cloth.mesh.edges.owned),
      residual_(cloth.mesh.edges.owned), tolerance_(cloth.mesh.edges.owned), change_(cloth.mesh.edges.size()),
      mu_(cloth.mesh.edges.size()), pulled_(cloth.mesh.edges.size()), guess_(cloth.mesh.edges.owned) {
  const double most = 0.5 * shortest_edge(cloth);
  if (thickness_ > most)
    throw InputError(
        fmt::format("{}: contact.thickness: {:.4g} m is more than half the shortest edge "
                    "({:.4g} m), so that neighbours would push each other apart; give at most {:.4g}",
                    input.file.string(), thickness_, 2 * most, most));
}

FilterReport ContactProjection::apply(const State& start, double dt, const Freedom& freedom,
                                      Candidate& candidate) {
  FilterReport report;
  const auto timed = [&](auto&& part) {
    const double began = MPI_Wtime();
    part();
    report.contact_seconds += MPI_Wtime() - began;
  };
  begin(start, dt, freedom, candidate);
  double behind = HUGE_VAL; // m, how far the safe iterate was from the target
  timed([&] { search(); });
  for (iteration_ = 1;; ++iteration_) {
    make_rows();
    const double strain = strain_at_target(freedom);
    if (!std::isfinite(strain)) {
      report.failure = "the positions are no longer finite";
      break;
    }
    project(strain, report);
    note_contact_forces(candidate); // before another search renumbers what the rows refer to
    report.contacts = std::max(report.contacts, contacts_);
    ++report.iterations;
    if (!report.failure.empty()) break;
    double alpha = 1;
    timed([&] {
      if (target_left_search()) search();
      alpha = step_length();
    });
    advance_safe(alpha);
    const double reached = measure_strain(cloth_, safe_.cloth).max;
    if (alpha == 1.0 && reached <= limits_.strain) break;
    if (iteration_ == contact_.max_iterations) {
      report.failure =
          fmt::format("projection with contact left a strain of {:.3g} (limit {:g}) after {} iterations{}",
                      reached, limits_.strain, iteration_, what_stopped());
      break;
    }
    if (alpha < 1) timed([&] { look(); });
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
    candidate.force_density[e] = 2.0 * mu_[e] / (cloth_.rest_length[e] * dt_ * dt_);
    candidate.pulled[e] = pulled_[e] / (dt_ * dt_);
  }
  candidate.contacts = bring_home(cloth_.mesh, noted_);
}

void ContactProjection::begin(const State& start, double dt, const Freedom& freedom,
                              const Candidate& candidate) {
  dt_ = dt;
  fall_ = gravity_ > 0 ? std::min(thickness_, gravity_ * dt * dt) : thickness_;
  for (std::size_t e = 0; e < guess_.size(); ++e) guess_[e] = start.pulled[e] * dt * dt;
  std::fill(pulled_.begin(), pulled_.end(), 0.0);
  at_home_ = start.contacts;
  noted_.clear();
  pressed_.clear();
  pressed_before_.clear();
  blocked_.clear();
  start_.cloth = start.positions;
  obstacles_.place(start.time, start_.obstacles);
  safe_ = start_;
  target_.cloth.resize(start_.cloth.size());
  for (std::size_t i = 0; i < start_.cloth.size(); ++i)
    target_.cloth[i] = start.positions[i] + dt * candidate.velocities[i];
  obstacles_.place(start.time + dt, target_.obstacles);
  freedom_ = &freedom;
  for (Local i = 0; i < Local(inverse_mass_.size()); ++i)
    inverse_mass_[i] = freedom.is_held(i) ? 0.0 : 1.0 / cloth_.mass[i];
  for (std::size_t e = 0; e < shift_.size(); ++e) {
    shift_[e] = 4.0 * cloth_.rest_length[e] * compliance_ / (dt * dt);
    tolerance_[e] = strain_left * limits_.strain * 2.0 * cloth_.rest_length[e];
  }
  for (std::size_t e = 0; e < mu_.size(); ++e)
    mu_[e] = 0.5 * candidate.force_density[e] * cloth_.rest_length[e] * dt * dt;
}

void ContactProjection::search() {
  search_.find({safe_.cloth, target_.cloth, safe_.obstacles, target_.obstacles}, 2.0 * thickness_,
               slack * thickness_);
  searched_ = target_;
  search_.gather(start_.cloth, start_.obstacles, start_field_);
  mobility_.assign(search_.size(), Vec3::Zero());
  for (Local i = 0; i < search_.own(); ++i) mobility_[i][0] = inverse_mass_[i];
  search_.update(mobility_);
  look();
}

/// Distances and directions of all pairs at the safe iterate.
void ContactProjection::look() {
  search_.gather(safe_.cloth, safe_.obstacles, safe_field_);
  approaches_.clear();
  for (const Pair& pair : search_.pairs()) approaches_.push_back(approach(pair, at(pair, safe_field_)));
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
    // |d|^2 / l - l, but under contact an edge that is too short asks for no more than its missing length
    const double value =
        length > l || contacts_ == 0 ? length * length / l - l : 2 * (length / l) * (length - l);
    residual_[e] = freedom.is_held(a) && freedom.is_held(b) ? 0.0 : value - shift_[e] * mu_[e];
    const double strain = length / l - 1.0;
    max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
  }
  return max_over(mesh.comm, max);
}

/// What the step before pressed, for the present step size.
Pressed ContactProjection::before(const ContactKey& key) const {
  const auto found = pressed_before_.find(key);
  return found == pressed_before_.end() ? Pressed{} : found->second.scaled(dt_ * dt_);
}

/// Of the contacts with rows: what has pressed them so far, and what of it lasts (per dt^2, newtons); the
/// latter also as forces on vertices.
void ContactProjection::note_contact_forces(Candidate& candidate) {
  noted_.clear();
  candidate.contact_force.assign(candidate.contact_force.size(), Vec3::Zero());
  if (contacts_ == 0) return;
  std::vector<Vec3> forces(search_.size(), Vec3::Zero());
  for (const ContactRow& row : rows_) {
    if (!row.is_normal) continue;
    const Pressed now = pressed_[row.key].scaled(1 / (dt_ * dt_));
    if (now.normal <= 0) continue;
    const auto found = pressed_before_.find(row.key);
    const Pressed carried = found == pressed_before_.end() ? Pressed{} : lasting(found->second, now);
    noted_[row.key] = {now, carried};
    for (int i = 0; i < 4; ++i)
      forces[row.vertices[i]] += row.weights[i] * (carried.normal * row.direction + carried.tangent);
  }
  search_.accumulate(forces);
  std::copy(forces.begin(), forces.begin() + search_.own(), candidate.contact_force.begin());
  cloth_.mesh.vertex_halo.update(candidate.contact_force);
}

/// Fetches what the last step left of contacts that have their first row in this one, and lets all start from
/// it.
void ContactProjection::recall_contacts() {
  std::vector<ContactKey> keys;
  for (const ContactRow& row : rows_)
    if (!pressed_.contains(row.key)) keys.push_back(row.key);
  for (const auto& [key, entry] : hand_out(cloth_.mesh, at_home_, keys)) {
    pressed_before_[key] = entry.pressed;
    pressed_[key] = entry.carried.scaled(dt_ * dt_);
  }
  for (ContactRow& row : rows_) {
    const double so_far = pressed_[row.key].normal;
    row.lower = -so_far;
    if (iteration_ == 1) row.guess = std::max(-so_far, before(row.key).normal - so_far);
  }
}

void ContactProjection::make_rows() {
  rows_.clear();
  search_.gather(target_.cloth, target_.obstacles, target_field_);
  for (std::size_t k = 0; k < search_.pairs().size(); ++k) add_normal_row(search_.pairs()[k], approaches_[k]);
  // several pairs may have found the same contact
  std::sort(rows_.begin(), rows_.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  rows_.erase(
      std::unique(rows_.begin(), rows_.end(), [](const auto& a, const auto& b) { return a.key == b.key; }),
      rows_.end());
  const std::size_t normals = rows_.size();
  contacts_ = sum_over(comm_, Global(normals));
  if (contacts_ > 0) recall_contacts();
  for (std::size_t k = 0; k < normals; ++k) add_friction_rows(ContactRow(rows_[k]));
}

void ContactProjection::add_normal_row(const Pair& pair, const Approach& here) {
  Vec3 ahead = Vec3::Zero();
  for (int i = 0; i < 4; ++i) ahead += here.weights[i] * target_field_[pair.vertices[i]];
  const double gap = here.normal.dot(ahead) - pair.radius;
  const bool blocked = !blocked_.empty() && blocked_.contains(name_of(pair, search_.keys()));
  if (std::min(gap, here.gap) >= 2.0 * thickness_ && !blocked) return;
  const bool inside =
      here.weights[0] != 0 && here.weights[1] != 0 && here.weights[2] != 0 && here.weights[3] != 0;
  if (pair.kind == PairKind::edge_edge && !inside && !blocked) return; // vertices against faces have it
  double mobility = 0;
  for (int i = 0; i < 4; ++i) mobility += here.weights[i] * here.weights[i] * mobility_[pair.vertices[i]][0];
  if (mobility == 0) return; // nothing here can be moved
  const ContactKey key = key_of(pair, here, search_.keys());
  rows_.push_back({pair.vertices, here.weights, here.normal, mobility, thickness_ - gap, 0.0, HUGE_VAL,
                   gap_left * fall_, 0.0, key, true});
  rows_.back().friction = pair.body >= 0 ? obstacles_.body(pair.body).friction : contact_.friction;
}

/// The force that pressed a contact before this iteration, position-level.
double ContactProjection::pressing(const ContactRow& normal) const {
  if (iteration_ > 1) {
    const auto now = pressed_.find(normal.key);
    return now == pressed_.end() ? 0.0 : now->second.normal;
  }
  // a new contact is going to be pressed by what it takes to stop it
  return pressed_before_.contains(normal.key) ? before(normal.key).normal
                                              : std::max(0.0, normal.missing) / normal.mobility;
}

/// Two tangents of a contact that is pressed: no slip over the step, by no more than Coulomb's force. The
/// first is along the force that it would take; the second gets what that leaves of Coulomb's cone, which is
/// nothing where the contact slides.
void ContactProjection::add_friction_rows(const ContactRow& normal) {
  const double most = normal.friction * pressing(normal);
  if (most <= 0) return;
  Vec3 slip = Vec3::Zero();
  for (int i = 0; i < 4; ++i)
    slip += normal.weights[i] * (target_field_[normal.vertices[i]] - start_field_[normal.vertices[i]]);
  slip -= normal.direction.dot(slip) * normal.direction;
  const auto now = pressed_.find(normal.key);
  const Vec3 rubbed = now == pressed_.end() ? Vec3(Vec3::Zero()) : now->second.tangent;
  const Vec3 needed = rubbed - slip / normal.mobility;
  const Vec3 first =
      needed.norm() * normal.mobility > 1e-12 ? Vec3(needed.normalized()) : normal.direction.unitOrthogonal();
  const double rest = std::sqrt(std::max(0.0, most * most - needed.squaredNorm()));
  for (const auto& [tangent, bound] : {std::pair{first, most}, {Vec3(normal.direction.cross(first)), rest}}) {
    const double so_far = tangent.dot(rubbed);
    const double guess = iteration_ == 1 ? tangent.dot(before(normal.key).tangent) - so_far : 0.0;
    if (bound > 0 || so_far != 0)
      rows_.push_back({normal.vertices, normal.weights, tangent, normal.mobility, -tangent.dot(slip),
                       -bound - so_far, bound - so_far, slip_left * fall_, guess, normal.key, false});
  }
}

/// Moves the target to where edges and contacts want it.
void ContactProjection::project(double strain, FilterReport& report) {
  system_.assemble(gradient_, inverse_mass_, *freedom_, shift_);
  if (contacts_ == 0) {
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
    const EdgeRows edges{gradient_, inverse_mass_, *freedom_, shift_, residual_, tolerance_, guess_};
    report.linear_iterations += qp_.solve(edges, rows_, most_products).products;
    const auto push = qp_.push();
    for (std::size_t i = 0; i < push.size(); ++i) target_.cloth[i] += push[i];
    std::copy(qp_.edge_part().begin(), qp_.edge_part().end(), change_.begin());
    cloth_.mesh.edge_halo.update(change_);
    note_multipliers();
  }
  for (std::size_t e = 0; e < mu_.size(); ++e) mu_[e] += change_[e];
  for (std::size_t e = 0; e < pulled_.size(); ++e) pulled_[e] += change_[e];
}

void ContactProjection::note_multipliers() {
  const auto z = qp_.row_part();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    Pressed& p = pressed_[rows_[k].key];
    if (rows_[k].is_normal)
      p.normal = std::max(0.0, p.normal + z[k]);
    else
      p.tangent += z[k] * rows_[k].direction;
  }
}

bool ContactProjection::target_left_search() const {
  double farthest = 0;
  for (Local i = 0; i < search_.own(); ++i)
    farthest = std::max(farthest, (target_.cloth[i] - searched_.cloth[i]).squaredNorm());
  return std::sqrt(max_over(comm_, farthest)) > slack * thickness_;
}

/// The fraction of the way to the target on which no pair comes too near.
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
    const double part = advance(pair, x, u, floor_of(gap, thickness_));
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
