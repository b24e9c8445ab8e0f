#pragma once
#include "src/linear/vertex_matrix.hpp"

#include <cmath>

namespace taut {

/// The linear system of one implicit-Euler step for the new velocities v',
///
///     (M + h D + h^2 K) v' = M v + h f,
///
/// which is [BW98 eq. 6] with D v and K v taken to the left: f is the force at the positions of the step's
/// start and for velocity zero, K = -df/dx and D = -df/dv. Forces add what they are made of; the factors h
/// are put in here. Rows of owned vertices; what is added to ghosts is dropped. Nothing here is collective.
///
/// Started as explicit, it leaves out K, and gives the impulse h (f - D v) of forces taken at the step's
/// start.
class StepSystem {
public:
  /// `pattern` must outlive the system; `vertices` is the number of local vertices.
  StepSystem(const Pattern& pattern, Local vertices) : matrix_(pattern), rhs_(vertices, Vec3::Zero()) {}

  /// Starts over, for a step of h = dt seconds.
  void start(double dt) {
    dt_ = dt;
    stiffness_factor_ = dt * dt;
    matrix_.clear();
    alteration_ = {};
    std::fill(rhs_.begin(), rhs_.end(), Vec3::Zero());
  }

  /// For a step that moves positions by h v' + y [BW98 section 6, position alteration]: stiffness acts on y
  /// too, so h K y is taken off the right-hand side for all stiffness added from now on, up to the next
  /// start. `y` in m over local vertices; it must live as long.
  void alter_positions(std::span<const Vec3> y) { alteration_ = y; }
  /// As `start`, for forces taken at the step's start.
  void start_explicit(double dt) {
    start(dt);
    stiffness_factor_ = 0;
  }

  double dt() const { return dt_; }

  /// Inertia: `mass` in kg, `velocity` at the step's start; owned vertices only.
  void add_inertia(Local vertex, double mass, const Vec3& velocity) {
    matrix_.add_diagonal(vertex, mass);
    rhs_[vertex] += mass * velocity;
  }

  void add_force(Local vertex, const Vec3& newtons) { rhs_[vertex] += dt_ * newtons; }

  /// D += d I at an owned vertex; d in N s/m.
  void add_damping(Local vertex, double d) { matrix_.add_diagonal(vertex, dt_ * d); }

  /// K(i, i) += k I and K(i, j) -= k I for an owned vertex i and its neighbour j: its row of a weighted
  /// Laplacian. `slot` is that of (i, j).
  void add_laplacian(Local vertex, Local other, std::int32_t slot, double k) {
    matrix_.add_diagonal(vertex, stiffness_factor_ * k);
    matrix_.add_entry(slot, -stiffness_factor_ * k);
    if (!alteration_.empty()) rhs_[vertex] -= dt_ * k * (alteration_[vertex] - alteration_[other]);
  }

  /// K += k w w^T (x) I_3 and D += d w w^T (x) I_3 over a stencil of vertices with their slots; k in N/m, d
  /// in N s/m, for w without a unit.
  template<std::size_t n>
  void add_outer(const std::array<Local, n>& vertices, const Pattern::Slots<n>& slots,
                 const std::array<double, n>& w, double k, double d) {
    matrix_.add_outer<n>(vertices, slots, w, stiffness_factor_ * k + dt_ * d);
    if (alteration_.empty()) return;
    Vec3 sum = Vec3::Zero();
    for (std::size_t a = 0; a < n; ++a) sum += w[a] * alteration_[vertices[a]];
    for (std::size_t a = 0; a < n; ++a) rhs_[vertices[a]] -= dt_ * k * w[a] * sum;
  }

  /// K += k g g^T and D += d g g^T over a stencil of up to four, or six, vertices (see
  /// VertexMatrix::RankOneOver).
  template<std::size_t n>
  void add_rank_one(const std::array<Local, n>& vertices, std::array<Vec3, n> gradient, double k, double d) {
    alter(vertices, gradient, k);
    const double scale = std::sqrt(stiffness_factor_ * k + dt_ * d);
    for (Vec3& g : gradient) g *= scale;
    matrix_.add_rank_one(vertices, gradient);
  }

  /// A(i, i) += w I and A(i, j) -= w I for an owned vertex i and its neighbour j, w in kg; nothing of it on
  /// the right-hand side.
  void stiffen(Local vertex, std::int32_t slot, double w) {
    matrix_.add_diagonal(vertex, w);
    matrix_.add_entry(slot, -w);
  }

  /// A += the terms, whose gradients hold the factors of the step already.
  void set_far(ContactCouplings terms) { matrix_.set_far(std::move(terms)); }
  void set_near(std::vector<VertexMatrix::RankOne> terms) { matrix_.set_near(std::move(terms)); }

  /// h (f - D v) of owned vertices, of what was added since `start_explicit`; inertia must not have been. `v`
  /// over local vertices, ghosts current; `impulse` too, of which the owned part is meaningful.
  void explicit_impulse(std::span<const Vec3> v, std::span<Vec3> impulse) const {
    matrix_.multiply(v, impulse);
    for (Local i = 0; i < matrix_.pattern().rows(); ++i) impulse[i] = rhs_[i] - impulse[i];
  }

  const VertexMatrix& matrix() const { return matrix_; }
  std::span<const Vec3> rhs() const { return rhs_; }

private:
  template<std::size_t n>
  void alter(const std::array<Local, n>& vertices, const std::array<Vec3, n>& gradient, double k) {
    if (alteration_.empty()) return;
    double sum = 0;
    for (std::size_t a = 0; a < n; ++a) sum += gradient[a].dot(alteration_[vertices[a]]);
    for (std::size_t a = 0; a < n; ++a) rhs_[vertices[a]] -= dt_ * k * sum * gradient[a];
  }

  double dt_ = 0;
  std::span<const Vec3> alteration_;
  double stiffness_factor_ = 0; ///< dt^2, or 0 for an explicit step
  VertexMatrix matrix_;
  std::vector<Vec3> rhs_;
};

} // namespace taut
