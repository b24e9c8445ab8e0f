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
    std::fill(rhs_.begin(), rhs_.end(), Vec3::Zero());
  }

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

  /// K(i, i) += k I and K(i, j) -= k I for an owned vertex i: its row of a weighted Laplacian. `slot` is that
  /// of (i, j).
  void add_laplacian(Local vertex, std::int32_t slot, double k) {
    matrix_.add_diagonal(vertex, stiffness_factor_ * k);
    matrix_.add_entry(slot, -stiffness_factor_ * k);
  }

  /// K += k w w^T (x) I_3 and D += d w w^T (x) I_3 over a stencil; k in N/m, d in N s/m, for w without a
  /// unit.
  template<std::size_t n>
  void add_outer(const std::array<std::int32_t, n * n>& slots, const std::array<double, n>& w, double k,
                 double d) {
    matrix_.add_outer<n>(slots, w, stiffness_factor_ * k + dt_ * d);
  }

  /// K += k g g^T and D += d g g^T over a stencil of up to four vertices (see VertexMatrix::RankOne).
  void add_rank_one(const std::array<Local, 4>& vertices, std::array<Vec3, 4> gradient, double k, double d) {
    const double scale = std::sqrt(stiffness_factor_ * k + dt_ * d);
    for (Vec3& g : gradient) g *= scale;
    matrix_.add_rank_one(vertices, gradient);
  }

  /// h (f - D v) of owned vertices, of what was added since `start_explicit`; inertia must not have been. `v`
  /// over local vertices, ghosts current; `impulse` too, of which the owned part is meaningful.
  void explicit_impulse(std::span<const Vec3> v, std::span<Vec3> impulse) const {
    matrix_.multiply(v, impulse);
    for (Local i = 0; i < matrix_.pattern().rows(); ++i) impulse[i] = rhs_[i] - impulse[i];
  }

  const VertexMatrix& matrix() const { return matrix_; }
  std::span<const Vec3> rhs() const { return rhs_; }

private:
  double dt_ = 0;
  double stiffness_factor_ = 0; ///< dt^2, or 0 for an explicit step
  VertexMatrix matrix_;
  std::vector<Vec3> rhs_;
};

} // namespace taut
