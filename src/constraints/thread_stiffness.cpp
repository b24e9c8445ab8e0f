#include "src/constraints/thread_stiffness.hpp"

#include "partition/sort_unique.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

/// Times the mass of the ends of an edge: from where D is kept. Zigzags come back larger from 2 on, but only
/// what tension a projection adds moves them; the more edges are chosen, the more iterations CG needs. At
/// 1e2 two-pins with 281 x 281 vertices takes twice the CG iterations a projection; at 1e4 with 141 x 141
/// nearly twice the projections, with 561 x 561 half the CG iterations but as long.
constexpr double far = 1e3;

double force_per_length(const EdgeConstraints& constraints, std::span<const double> mu, Local edge) {
  return 2 * mu[edge] / constraints.cloth().rest_length[edge];
}

/// D of an owned edge, if it were not for the edges across; negative where tension does not outweigh inertia.
double stiffness_alone(const EdgeConstraints& constraints, std::span<const double> mu, Local edge) {
  const auto& [a, b] = constraints.cloth().mesh.edge_vertices[edge];
  const double inverse_masses = constraints.inverse_mass()[a] + constraints.inverse_mass()[b];
  return inverse_masses > 0 ? force_per_length(constraints, mu, edge) - far / inverse_masses : -1.0;
}

} // namespace

bool ThreadStiffness::is_needed(const EdgeConstraints& constraints, std::span<const double> mu) {
  const DistributedMesh& mesh = constraints.cloth().mesh;
  bool needed = false;
  for (Local e = 0; e < mesh.edges.owned && !needed; ++e) needed = stiffness_alone(constraints, mu, e) > 0;
  return any_of(mesh.comm, needed);
}

ThreadStiffness::ThreadStiffness(const Cloth& cloth, const Yarns& yarns)
    : cloth_(cloth), yarns_(yarns), matrix_(yarns), factor_(yarns), root_(cloth.mesh.edges.size()),
      softness_(cloth.mesh.edges.owned), mu_(cloth.mesh.edges.size()),
      pull_(cloth.mesh.edges.size(), Vec3::Zero()), held_back_(cloth.mesh.vertices.size(), Vec3::Zero()) {
  find_lines();
}

/// Where a segment ends, the next edge is the one that knows the last to be before it.
void ThreadStiffness::find_lines() {
  const DistributedMesh& mesh = cloth_.mesh;
  in_line_.assign(mesh.edges.owned, {-1, -1});
  for (const YarnSegment& s : yarns_.segments)
    for (Local e = s.begin + 1; e < s.end; ++e) in_line_[e][0] = e - 1, in_line_[e - 1][1] = e;
  const auto link = [&](Local edge, Local other) {
    auto& places = in_line_[edge];
    *std::find(places.begin(), places.end(), -1) = other;
  };
  std::vector<Global> after(mesh.edges.size(), 0); // 1 + original number
  for (std::size_t k = 0; k < yarns_.knots.size(); ++k)
    if (const Local before = yarns_.before_knot[k]; before >= 0) {
      link(yarns_.knots[k], before);
      after[before] = 1 + mesh.edges.original[yarns_.knots[k]];
    }
  mesh.edge_halo.accumulate(after);
  const auto beside = [&](Local edge, Global original) {
    for (const Local v : mesh.edge_vertices[edge])
      for (const EdgeEnd& end : mesh.star_of(v))
        if (mesh.edges.original[end.edge] == original) return end.edge;
    return Local(-1);
  };
  for (Local e = 0; e < mesh.edges.owned; ++e)
    if (after[e] > 0) link(e, beside(e, after[e] - 1));
}

void ThreadStiffness::choose(const EdgeConstraints& constraints, std::span<const double> mu) {
  const DistributedMesh& mesh = cloth_.mesh;
  for (const Local e : chosen_) pull_[e] = Vec3::Zero();
  for (const Local v : ends_) held_back_[v] = Vec3::Zero();
  chosen_.clear();
  for (Local e = 0; e < mesh.edges.owned; ++e) {
    double d = stiffness_alone(constraints, mu, e);
    if (d > 0) d -= across(constraints, mu, e);
    if (d > 0) chosen_.push_back(e);
    root_[e] = d > 0 ? std::sqrt(d) : 0.0;
    softness_[e] = d > 0 ? d / constraints.gradients()[e].squaredNorm() : 0.0;
  }
  acts_ = any_of(mesh.comm, !chosen_.empty());
  if (!acts_) return;
  mesh.edge_halo.update(root_);
  note_places();
  factor(constraints.inverse_mass());
}

/// The largest force per length of the edges at the ends of an owned one that do not go on from it.
double ThreadStiffness::across(const EdgeConstraints& constraints, std::span<const double> mu,
                               Local edge) const {
  double most = 0;
  for (const Local v : cloth_.mesh.edge_vertices[edge])
    for (const EdgeEnd& end : cloth_.mesh.star_of(v))
      if (end.edge != edge && end.edge != in_line_[edge][0] && end.edge != in_line_[edge][1])
        most = std::max(most, force_per_length(constraints, mu, end.edge));
  return most;
}

void ThreadStiffness::note_places() {
  const DistributedMesh& mesh = cloth_.mesh;
  ends_.clear();
  beside_.clear();
  for (Local e = 0; e < mesh.edges.size(); ++e)
    if (root_[e] > 0)
      for (const Local v : mesh.edge_vertices[e]) ends_.push_back(v);
  sort_unique(ends_);
  for (const Local v : ends_)
    for (const EdgeEnd& end : mesh.star_of(v))
      if (mesh.owns_edge(end.edge)) beside_.push_back(end.edge);
  sort_unique(beside_);
}

void ThreadStiffness::factor(std::span<const double> inverse_mass) {
  const DistributedMesh& mesh = cloth_.mesh;
  const auto on_diagonal = [&](Local e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    return 1.0 + stiffness(e) * (inverse_mass[a] + inverse_mass[b]);
  };
  const auto coupling = [&](Local e, Local f) {
    const double roots = root_[e] * root_[f];
    return roots > 0 ? roots * sum_over_shared(mesh, e, f, [&](Local v) { return inverse_mass[v]; }) : 0.0;
  };
  matrix_.fill(yarns_, on_diagonal, coupling);
  factor_.factor(matrix_);
}

void ThreadStiffness::hold_back(const EdgeConstraints& constraints, std::span<const double> mu) {
  const DistributedMesh& mesh = cloth_.mesh;
  const auto w = constraints.inverse_mass();
  std::copy_n(mu.begin(), mesh.edges.owned, mu_.begin());
  mesh.edge_halo.update(mu_);
  for (const Local v : ends_) held_back_[v] = w[v] * constraints.pull(v, constraints.gradients(), mu_);
  for (const Local e : chosen_) {
    const auto& [a, b] = mesh.edge_vertices[e];
    pull_[e] = root_[e] * (held_back_[b] - held_back_[a]);
  }
  const auto owned = std::span(pull_).first(std::size_t(mesh.edges.owned));
  factor_.solve(std::span<const Vec3>(owned), owned);
  for (const Local e : chosen_) pull_[e] *= root_[e];
  mesh.edge_halo.update(pull_);
  for (const Local v : ends_) {
    Vec3 pull = Vec3::Zero();
    for (const EdgeEnd& end : mesh.star_of(v)) pull += end.sign * pull_[end.edge];
    held_back_[v] = w[v] * constraints.freedom().allowed(v, pull);
  }
}

void ThreadStiffness::subtract(const EdgeConstraints& constraints, std::span<double> product) const {
  for (const Local e : beside_) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    product[e] -= constraints.gradients()[e].dot(held_back_[b] - held_back_[a]);
  }
}

} // namespace taut
