#include "src/constraints/edge_set.hpp"

#include "src/constraints/projection_options.hpp"

#include <algorithm>

namespace taut {

EdgeSet::EdgeSet(const Cloth& cloth, const config::Inextensibility& options, ConstraintUse use,
                 std::vector<char> constrained)
    : constraints_(cloth, options, compliance_bounds(options, use), std::move(constrained)),
      options_(options), use_(use), yarns_(cloth.mesh), change_(cloth.mesh.edges.size()),
      mu_(cloth.mesh.edges.size()), slopes_(cloth.mesh.edges.owned),
      program_compliance_(cloth.mesh.edges.owned) {}

EdgeSet::EdgeSet(const Cloth& cloth, const config::Inextensibility& options, ConstraintUse use)
    : constraints_(cloth, options, compliance_bounds(options, use)), options_(options), use_(use),
      change_(cloth.mesh.edges.size()), mu_(cloth.mesh.edges.size()), slopes_(cloth.mesh.edges.owned) {
  if (use != ConstraintUse::with_contact) system_.emplace(cloth.mesh, solver_options(options));
  if (use == ConstraintUse::alone) return;
  yarns_.emplace(cloth.mesh);
  program_compliance_.resize(cloth.mesh.edges.owned);
}

void EdgeSet::start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate) {
  start_ = &start;
  dt_ = dt;
  constraints_.start(dt, freedom);
  constraints_.to_mu(candidate.multipliers.force_density, mu_);
  if (use_ == ConstraintUse::with_contact) added_.assign(mu_.size(), 0.0);
}

double EdgeSet::evaluate(std::span<const Vec3> x) {
  const double strain = use_ == ConstraintUse::with_contact ? constraints_.evaluate(x, start_->positions)
                                                            : constraints_.evaluate(x);
  for (std::size_t e = 0; e < slopes_.size(); ++e) slopes_[e] = constraints_.yield_to(mu_[e], Local(e)).slope;
  for (std::size_t e = 0; e < program_compliance_.size(); ++e)
    program_compliance_[e] = constraints_.can_change(Local(e)) ? slopes_[e] : 1.0;
  return strain;
}

void EdgeSet::subtract_force_densities(std::span<const double> of_others) {
  std::vector<double> mu(mu_.size());
  constraints_.to_mu(of_others, mu);
  for (std::size_t e = 0; e < mu.size(); ++e) mu_[e] -= mu[e];
}

void EdgeSet::finish(Candidate& candidate) const {
  constraints_.to_force_density(mu_, candidate.multipliers.force_density);
  for (std::size_t e = 0; e < added_.size(); ++e)
    candidate.multipliers.projection_tension[e] = added_[e] / (dt_ * dt_);
}

SolveReport EdgeSet::solve(double tolerance) {
  system_->assemble(constraints_.gradients(), inverse_mass(), freedom(), slopes_);
  constraints_.residual(mu_, change_);
  const bool may_use_threads = use_ == ConstraintUse::alone && options_.solver != config::LinearSolver::mumps;
  if (!threads_ && may_use_threads && ThreadStiffness::is_needed(constraints_, mu_))
    threads_.emplace(constraints_.cloth(), system_->yarns());
  if (threads_) threads_->choose(constraints_, mu_);
  SolveReport report =
      uses_threads() ? solve_with_threads(tolerance) : system_->solve(change_, tolerance, change_);
  if (report.failure.empty()) add_change();
  return report;
}

SolveReport EdgeSet::solve_with_threads(double tolerance) {
  const auto product_with = [this](std::span<const double> mu, std::span<double> product) {
    system_->multiply(mu, product);
    threads_->hold_back(constraints_, mu);
    threads_->subtract(constraints_, product);
  };
  const SolveReport report = system_->solve(product_with, change_, tolerance, change_, threads_->softness());
  threads_->hold_back(constraints_, change_);
  return report;
}

void EdgeSet::add_change() {
  for (std::size_t e = 0; e < mu_.size(); ++e) mu_[e] += change_[e];
  for (std::size_t e = 0; e < added_.size(); ++e) added_[e] += change_[e];
}

void EdgeSet::keep_strain(double part) { strain_kept_ = part; }

void EdgeSet::program_residual(std::span<double> residual) const {
  constexpr double most_kept = 0.6; // of the limit; with what a program leaves, clearly below it
  const Cloth& cloth = constraints_.cloth();
  const auto lengths = constraints_.lengths();
  for (Local e = 0; e < Local(residual.size()); ++e) {
    residual[e] = 0;
    if (!constraints_.can_change(e)) continue;
    const double l = cloth.rest_length[e], length = lengths[e];
    double kept = 0; // m
    if (strain_kept_ > 0) {
      const auto& [a, b] = cloth.mesh.edge_vertices[e];
      const double most = most_kept * options_.strain * l;
      kept = strain_kept_ * std::clamp((start_->positions[b] - start_->positions[a]).norm() - l, -most, most);
    }
    residual[e] =
        constraints_.gradients()[e].norm() * (length - l - kept) - constraints_.yield_to(mu_[e], e).length;
  }
}

void EdgeSet::program_tolerance(double part_of_limit, std::span<double> tolerance) const {
  for (std::size_t e = 0; e < tolerance.size(); ++e)
    tolerance[e] = part_of_limit * options_.strain * 2.0 * constraints_.cloth().rest_length[e];
}

void EdgeSet::program_guess(std::span<double> guess) const {
  for (std::size_t e = 0; e < guess.size(); ++e)
    guess[e] = start_->multipliers.projection_tension[e] * dt_ * dt_;
}

void EdgeSet::factor(std::span<const double> metric) {
  yarns_->factor(constraints_.gradients(), metric, freedom(), slopes_);
  if (use_ == ConstraintUse::in_newton && system_)
    system_->assemble(constraints_.gradients(), metric, freedom(), slopes_);
}

void EdgeSet::begin_spread(std::span<const double> z) {
  std::copy(z.begin(), z.end(), change_.begin());
  mesh().edge_halo.begin_update(change_);
}

void EdgeSet::end_spread(std::span<Vec3> field) {
  mesh().edge_halo.end_update(change_);
  subtract_spread(mesh(), constraints_.gradients(), change_, field);
}

void EdgeSet::subtract_difference(std::span<const Vec3> u, std::span<double> rows) const {
  for (std::size_t e = 0; e < rows.size(); ++e) rows[e] -= difference(mesh(), constraints_.gradients(), u, e);
}

void EdgeSet::tension_weights(std::span<double> weights) const {
  for (std::size_t e = 0; e < weights.size(); ++e)
    weights[e] = 2.0 * std::abs(mu_[e]) / constraints_.cloth().rest_length[e];
}

void EdgeSet::multipliers(std::span<double> rows) const {
  std::copy_n(mu_.begin(), rows.size(), rows.begin());
}

std::vector<RowEdge> EdgeSet::row_edges() const {
  std::vector<RowEdge> result;
  for (Local e = 0; e < mesh().edges.owned; ++e) result.push_back({std::size_t(e), e, 1.0});
  return result;
}

std::vector<RowPlace> EdgeSet::row_places() const {
  std::vector<RowPlace> result;
  for (Local e = 0; e < mesh().edges.owned; ++e) {
    const Vec3 &a = mesh().rest_positions[mesh().edge_vertices[e][0]],
               &b = mesh().rest_positions[mesh().edge_vertices[e][1]];
    result.push_back({0.5 * (a + b), (b - a).normalized(), constraints_.has(e) ? 1.0 : 0.0});
  }
  return result;
}

void EdgeSet::add(std::span<const double> z) {
  std::copy(z.begin(), z.end(), change_.begin());
  mesh().edge_halo.update(change_);
  add_change();
}

} // namespace taut
