#include "src/constraints/triangle_bounds.hpp"

#include "src/state/material_coordinates.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double near_bound = 0.5;                        ///< part of it from which triangles have rows
constexpr double most_of_bound = 0.6, all_of_bound = 0.9; ///< between which targets are
constexpr double nearly_all_of_bound = 0.97;              ///< the latter of very short steps
constexpr double far = 10;                                ///< limits of the averages, from where none has

/// Of what a row yields: triangles that share sides depend on one another, and on the averages.
constexpr double softness = 0.005;

bool is_sliver(const Corners2& m) {
  constexpr double least_sine = 0.17; // of 10 degrees
  const std::array<Vec2, 3> sides{m[1] - m[0], m[2] - m[1], m[0] - m[2]};
  const double double_area = std::abs(sides[0][0] * sides[1][1] - sides[1][0] * sides[0][1]);
  for (int k = 0; k < 3; ++k)
    if (double_area < least_sine * sides[k].norm() * sides[(k + 1) % 3].norm()) return true;
  return false;
}

} // namespace

std::vector<Tangent> bounded_tangents(const Cloth& cloth, std::span<const Local> cells) {
  std::vector<Tangent> tangents;
  for (const Local c : cells) {
    if (cloth.mesh.cells[c].size() != 3) continue;
    if (!is_sliver(material_coordinates(cloth.mesh, std::size_t(c))))
      append_tangents(cloth, std::size_t(c), tangents);
  }
  return tangents;
}

TriangleBounds::TriangleBounds(const Cloth& cloth, const config::Inextensibility& options)
    : cloth_(cloth), bound_(options.faces * options.strain), pull_(cloth.mesh.vertices.size(), Vec3::Zero()),
      change_(pull_) {
  for (const Tangent& t : bounded_tangents(cloth, cloth.mesh.owned_cells))
    directions_.push_back({t.stencil, std::sqrt(t.measure)});
}

void TriangleBounds::start(std::span<const Vec3> positions, std::span<const double> inverse_mass,
                           const Freedom& freedom) {
  start_ = positions;
  inverse_mass_ = inverse_mass;
  freedom_ = &freedom;
  for (Direction& d : directions_) d.mu = 0;
}

double TriangleBounds::most() const {
  return all_of_bound + strain_kept_ * (nearly_all_of_bound - all_of_bound);
}

/// Pulls and pushes have opposite signs; what a triangle has been pulled by in this step may be taken back.
double TriangleBounds::side(const Direction& direction, double length) const {
  if (direction.mu != 0) return direction.mu > 0 ? 1 : -1;
  return length > 1 ? 1 : -1;
}

double TriangleBounds::evaluate(std::span<const Vec3> x, double of_others) {
  rows_.clear();
  double largest = 0;
  bool acts = false;
  for (Direction& d : directions_) {
    const Vec3 w = tangent(d.stencil, x);
    const double length = w.norm(), strain = std::abs(length - 1);
    largest = std::max(largest, std::isfinite(strain) ? strain : HUGE_VAL);
    if (of_others > far || !(strain > near_bound * bound_ || d.mu != 0)) continue;
    const double side = this->side(d, length), at_start = side * (tangent(d.stencil, start_).norm() - 1);
    const double target = 1 + side * std::clamp(at_start, most_of_bound * bound_, most() * bound_);
    rows_.push_back({&d, 2 * d.scale * w, length, target, side});
    acts = acts || d.mu != 0 || side * (length - target) > 0;
  }
  std::array<double, 2> over_ranks{largest / bound_, acts ? 1.0 : 0.0};
  max_in_place(cloth_.mesh.comm, over_ranks);
  any_ = over_ranks[1] > 0;
  if (!any_) rows_.clear();
  factor(inverse_mass_);
  return over_ranks[0];
}

double TriangleBounds::strain(std::span<const Vec3> x) const {
  double most = 0;
  for (const Direction& d : directions_) {
    const double strain = std::abs(tangent(d.stencil, x).norm() - 1);
    most = std::max(most, std::isfinite(strain) ? strain : HUGE_VAL);
  }
  return max_over(cloth_.mesh.comm, most / bound_);
}

void TriangleBounds::residual(std::span<double> rows) const {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Row& row = rows_[r];
    rows[r] = row.of->scale * (row.length * row.length - row.target * row.target);
  }
}

void TriangleBounds::program_residual(std::span<double> rows) const {
  for (std::size_t r = 0; r < rows.size(); ++r)
    rows[r] = 2 * rows_[r].of->scale * rows_[r].length * (rows_[r].length - rows_[r].target);
}

void TriangleBounds::program_tolerance(double part_of_room, std::span<double> tolerance) const {
  for (std::size_t r = 0; r < tolerance.size(); ++r)
    tolerance[r] = part_of_room * (1 - most()) * bound_ * 2 * rows_[r].of->scale;
}

void TriangleBounds::program_bounds(std::span<double> lower, std::span<double> upper) const {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const double back = -rows_[r].of->mu;
    lower[r] = rows_[r].side > 0 ? back : -HUGE_VAL;
    upper[r] = rows_[r].side > 0 ? HUGE_VAL : back;
  }
}

/// Rows of triangles that nothing can move have a compliance of 1.
void TriangleBounds::factor(std::span<const double> metric) {
  compliance_.clear();
  diagonal_.clear();
  for (const Row& row : rows_) {
    double yields = 0;
    for (int k = 0; k < 3; ++k) {
      const Local v = row.of->stencil.vertices[k];
      const double c = row.of->stencil.c[k];
      yields += metric[v] * c * c * freedom_->allowed(v, row.gradient).squaredNorm();
    }
    compliance_.push_back(yields > 0 ? softness * yields : 1.0);
    diagonal_.push_back(yields + compliance_.back());
  }
}

void TriangleBounds::precondition(std::span<const double> r, std::span<double> s) const {
  for (std::size_t k = 0; k < diagonal_.size(); ++k) s[k] = r[k] / diagonal_[k];
}

/// J^T z into `pull_`, on owned vertices. A triangle's owner knows its share at vertices of others.
void TriangleBounds::pull(std::span<const double> z) {
  std::fill(pull_.begin(), pull_.end(), Vec3::Zero());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const TangentStencil& s = rows_[r].of->stencil;
    for (int k = 0; k < 3; ++k) pull_[s.vertices[k]] += z[r] * s.c[k] * rows_[r].gradient;
  }
  cloth_.mesh.vertex_halo.accumulate(pull_);
}

void TriangleBounds::spread(std::span<const double> z, std::span<Vec3> field) {
  if (!any_) return;
  pull(z);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) field[i] -= pull_[i];
}

void TriangleBounds::subtract_difference(std::span<const Vec3> u, std::span<double> rows) const {
  for (std::size_t r = 0; r < rows.size(); ++r)
    rows[r] -= rows_[r].gradient.dot(tangent(rows_[r].of->stencil, u));
}

void TriangleBounds::add(std::span<const double> d_mu) {
  for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r].of->mu += d_mu[r];
  if (any_)
    pull(d_mu);
  else
    std::fill(pull_.begin(), pull_.end(), Vec3::Zero());
  change_ = pull_;
}

Vec3 TriangleBounds::displacement(Local vertex) const {
  return inverse_mass_[vertex] * freedom_->allowed(vertex, change_[vertex]);
}

} // namespace taut
