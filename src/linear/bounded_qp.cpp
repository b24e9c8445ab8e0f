#include "src/linear/bounded_qp.hpp"

#include <Eigen/Core>

#include <cmath>

namespace taut {

namespace {

using Vector = std::vector<double>;

double dot(const Vector& a, const Vector& b) {
  return Eigen::Map<const Eigen::VectorXd>(a.data(), Eigen::Index(a.size()))
      .dot(Eigen::Map<const Eigen::VectorXd>(b.data(), Eigen::Index(b.size())));
}

/// The state of an iteration. Directions and displacements are what is taken from z. The loops are few and
/// long: the vectors do not fit into a cache.
class ProjectedGradients {
public:
  ProjectedGradients(MPI_Comm comm, const BoundedQp& qp, std::vector<double>& z)
      : comm_(comm), qp_(qp), size_(z.size()), z_(z), gradient_(size_), slope_(size_), steepest_(size_),
        direction_(size_), moved_(size_), a_moved_(size_) {
    for (std::size_t i = 0; i < size_; ++i) z_[i] = clamped(i, z_[i]);
    multiply(z_, gradient_);
    for (std::size_t i = 0; i < size_; ++i) gradient_[i] -= qp_.rhs[i];
    evaluate();
    redirect(0.0);
  }

  QpReport run(int most_products) {
    while (report_.products < most_products && !report_.solved) {
      propose();
      if (!move()) {
        redirect(0.0); // the bounds have turned the direction uphill
        continue;
      }
      evaluate();
      redirect(conjugation());
    }
    return report_;
  }

private:
  double clamped(std::size_t i, double value) const {
    return std::min(std::max(value, qp_.lower[i]), qp_.upper[i]);
  }

  /// The part of a direction that does not leave the bound the entry is at.
  double kept(std::size_t i, double direction) const {
    const double down = z_[i] > qp_.lower[i] ? std::max(direction, 0.0) : 0.0;
    const double up = z_[i] < qp_.upper[i] ? std::min(direction, 0.0) : 0.0;
    return down + up;
  }

  void multiply(const Vector& x, Vector& y) {
    qp_.multiply(x, y);
    ++report_.products;
  }

  /// `moved_` = z - P(z - length direction), and A times it.
  void propose() {
    double clipped = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double wanted = z_[i] - length_ * direction_[i], there = clamped(i, wanted);
      clipped = std::max(clipped, std::abs(there - wanted));
      moved_[i] = z_[i] - there;
    }
    meets_bound_ = clipped > 0;
    multiply(moved_, a_moved_);
  }

  /// By how much `moved_` can be multiplied until an entry meets a bound.
  double farthest() const {
    double factor = HUGE_VAL;
    for (std::size_t i = 0; i < size_; ++i) {
      if (moved_[i] > 0) factor = std::min(factor, (z_[i] - qp_.lower[i]) / moved_[i]);
      if (moved_[i] < 0) factor = std::min(factor, (z_[i] - qp_.upper[i]) / moved_[i]);
    }
    return -max_over(comm_, -factor);
  }

  /// Goes the best part of the proposal; all of it if it meets a bound and that still lowers the objective
  /// (beyond twice the best part it would not). False if the proposal leads uphill.
  bool move() {
    double sums[] = {dot(moved_, a_moved_), dot(gradient_, moved_), meets_bound_ ? 1.0 : 0.0};
    sum_in_place(comm_, sums);
    if (sums[1] <= 0) return false;
    const double best = sums[0] > 0 ? sums[1] / sums[0] : 1.0;
    double part = best;
    if (sums[2] > 0 && best > 0.6) part = 1.0;
    if (sums[2] == 0 && best > 1.0) part = std::min(best, farthest());
    for (std::size_t i = 0; i < size_; ++i) {
      moved_[i] *= part;
      a_moved_[i] *= part;
      z_[i] = clamped(i, z_[i] - moved_[i]);
      gradient_[i] -= a_moved_[i];
    }
    length_ *= std::clamp(best, 0.1, 10.0);
    return true;
  }

  /// The projected gradient, and the same preconditioned.
  void evaluate() {
    double worst = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      slope_[i] = kept(i, gradient_[i]);
      worst = std::max(worst, std::abs(slope_[i]) / qp_.tolerance[i]);
    }
    report_.solved = max_over(comm_, worst) <= 1.0;
    if (!report_.solved) qp_.precondition(slope_, steepest_);
  }

  /// What makes the steepest direction conjugate to the last displacement.
  double conjugation() const {
    double sums[] = {dot(steepest_, a_moved_), dot(moved_, a_moved_)};
    sum_in_place(comm_, sums);
    return sums[1] > 0 ? sums[0] / sums[1] : 0.0;
  }

  void redirect(double beta) {
    for (std::size_t i = 0; i < size_; ++i) direction_[i] = kept(i, steepest_[i] - beta * moved_[i]);
  }

  MPI_Comm comm_;
  const BoundedQp& qp_;
  std::size_t size_;
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
