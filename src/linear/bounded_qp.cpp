#include "src/linear/bounded_qp.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

using Vector = std::vector<double>;

double dot(const Vector& a, const Vector& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The state of an iteration. Directions and displacements are what is taken from z.
class ProjectedGradients {
public:
  ProjectedGradients(MPI_Comm comm, const BoundedQp& qp, Vector& z)
      : comm_(comm), qp_(qp), z_(z), gradient_(z.size()), slope_(z.size()), steepest_(z.size()),
        direction_(z.size()), moved_(z.size()), a_moved_(z.size()) {
    for (std::size_t i = 0; i < z.size(); ++i) z_[i] = clamped(i, z_[i]);
    multiply(z_, gradient_);
    for (std::size_t i = 0; i < z.size(); ++i) gradient_[i] -= qp_.rhs[i];
    evaluate();
    descend_steepest();
  }

  QpReport run(int most_products) {
    while (report_.products < most_products && !report_.solved) {
      propose();
      move();
      evaluate();
      conjugate();
    }
    return report_;
  }

private:
  double clamped(std::size_t i, double value) const { return std::clamp(value, qp_.lower[i], qp_.upper[i]); }

  void multiply(const Vector& x, Vector& y) {
    qp_.multiply(x, y);
    ++report_.products;
  }

  bool can_move(std::size_t i, double direction) const {
    return direction > 0 ? z_[i] > qp_.lower[i] : z_[i] < qp_.upper[i];
  }

  /// `moved_` = z - P(z - length direction), and A times it.
  void propose() {
    meets_bound_ = false;
    for (std::size_t i = 0; i < z_.size(); ++i) {
      const double wanted = z_[i] - length_ * direction_[i], there = clamped(i, wanted);
      meets_bound_ = meets_bound_ || there != wanted;
      moved_[i] = z_[i] - there;
    }
    multiply(moved_, a_moved_);
  }

  /// The best part of the proposal; all of it if it meets a bound and has at least three fifths of the
  /// objective's descent left (at one half it would not descend at all).
  void move() {
    double sums[] = {dot(moved_, a_moved_), dot(gradient_, moved_), meets_bound_ ? 1.0 : 0.0};
    sum_in_place(comm_, sums);
    const double best = sums[0] > 0 ? sums[1] / sums[0] : 1.0;
    const bool whole = sums[2] > 0 && best > 0.6;
    for (std::size_t i = 0; i < z_.size(); ++i) {
      if (!whole) moved_[i] *= best, a_moved_[i] *= best;
      z_[i] = clamped(i, z_[i] - moved_[i]);
      gradient_[i] -= a_moved_[i];
    }
    length_ *= std::clamp(best, 0.1, 10.0);
  }

  /// The projected gradient, and the same preconditioned.
  void evaluate() {
    double worst = 0;
    for (std::size_t i = 0; i < z_.size(); ++i) {
      slope_[i] = can_move(i, gradient_[i]) ? gradient_[i] : 0.0;
      worst = std::max(worst, std::isfinite(slope_[i]) ? std::abs(slope_[i]) / qp_.tolerance[i] : HUGE_VAL);
    }
    report_.solved = max_over(comm_, worst) <= 1.0;
    if (!report_.solved) qp_.precondition(slope_, steepest_);
  }

  void descend_steepest() {
    for (std::size_t i = 0; i < z_.size(); ++i)
      direction_[i] = can_move(i, steepest_[i]) ? steepest_[i] : 0.0;
  }

  /// The next direction, conjugate to the last displacement as far as the bounds let it.
  void conjugate() {
    double sums[] = {dot(steepest_, a_moved_), dot(moved_, a_moved_)};
    sum_in_place(comm_, sums);
    const double beta = sums[1] > 0 ? sums[0] / sums[1] : 0.0;
    double descent = 0;
    for (std::size_t i = 0; i < z_.size(); ++i) {
      const double d = steepest_[i] - beta * moved_[i];
      direction_[i] = can_move(i, d) ? d : 0.0;
      descent += direction_[i] * gradient_[i];
    }
    if (sum_over(comm_, descent) <= 0) descend_steepest();
  }

  MPI_Comm comm_;
  const BoundedQp& qp_;
  Vector& z_;
  Vector gradient_, slope_, steepest_, direction_, moved_, a_moved_;
  double length_ = 1;
  bool meets_bound_ = false;
  QpReport report_;
};

} // namespace

QpReport solve(MPI_Comm comm, const BoundedQp& qp, int most_products, std::vector<double>& z) {
  return ProjectedGradients(comm, qp, z).run(most_products);
}

} // namespace taut
