#include "src/linear/bounded_qp.hpp"

#include <Eigen/Core>

#include <cmath>

namespace taut {

namespace {

using Array = Eigen::ArrayXd;

std::span<const double> view(const Array& a) { return {a.data(), std::size_t(a.size())}; }
std::span<double> view(Array& a) { return {a.data(), std::size_t(a.size())}; }

/// The state of an iteration. Directions and proposals are what is taken from z. Entries without bounds
/// come first and are kept out of the loops over bounds, which cost more than the rest.
class ProjectedGradients {
public:
  ProjectedGradients(MPI_Comm comm, const BoundedQp& qp, std::vector<double>& z)
      : comm_(comm), qp_(qp), size_(Eigen::Index(z.size())), free_(Eigen::Index(qp.unbounded)),
        bounded_(size_ - free_), z_(z.data(), size_), gradient_(size_), slope_(size_),
        steepest_(Array::Zero(size_)), direction_(size_), moved_(Array::Zero(size_)), a_moved_(size_),
        per_tolerance_(1.0 / Eigen::Map<const Array>(qp.tolerance.data(), size_)) {
    double* bounded = z_.data() + free_;
    for (Eigen::Index i = 0; i < bounded_; ++i) bounded[i] = clamped(i, bounded[i]);
    multiply(z, view(gradient_));
    gradient_ -= Eigen::Map<const Array>(qp.rhs.data(), size_);
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
  double clamped(Eigen::Index i, double value) const {
    return std::min(std::max(value, qp_.lower[i]), qp_.upper[i]);
  }

  /// kept = the part of a direction that does not leave the bounds entries are at.
  void keep(const double* direction, double* kept) const {
    const double *z = z_.data() + free_, *lower = qp_.lower.data(), *upper = qp_.upper.data();
    for (Eigen::Index i = 0; i < bounded_; ++i) {
      const double down = z[i] > lower[i] ? std::max(direction[i], 0.0) : 0.0;
      const double up = z[i] < upper[i] ? std::min(direction[i], 0.0) : 0.0;
      kept[i] = down + up;
    }
  }

  void multiply(std::span<const double> x, std::span<double> y) {
    qp_.multiply(x, y);
    ++report_.products;
  }

  /// `moved_` = z - P(z - length direction), and A times it.
  void propose() {
    moved_ = length_ * direction_;
    double clipped = 0;
    const double* z = z_.data() + free_;
    double* moved = moved_.data() + free_;
    for (Eigen::Index i = 0; i < bounded_; ++i) {
      const double wanted = z[i] - moved[i], there = clamped(i, wanted);
      clipped += there != wanted ? 1.0 : 0.0;
      moved[i] = z[i] - there;
    }
    meets_bound_ = clipped > 0;
    multiply(view(std::as_const(moved_)), view(a_moved_));
  }

  /// By how much `moved_` can be multiplied until an entry meets a bound.
  double farthest() const {
    double factor = HUGE_VAL;
    const double *z = z_.data() + free_, *moved = moved_.data() + free_;
    for (Eigen::Index i = 0; i < bounded_; ++i) {
      if (moved[i] > 0) factor = std::min(factor, (z[i] - qp_.lower[i]) / moved[i]);
      if (moved[i] < 0) factor = std::min(factor, (z[i] - qp_.upper[i]) / moved[i]);
    }
    return -max_over(comm_, -factor);
  }

  /// Goes the best part of the proposal; all of it if it meets a bound and that still lowers the objective
  /// (beyond twice the best part it would not). False if the proposal leads uphill.
  bool move() {
    double sums[] = {(moved_ * a_moved_).sum(), (gradient_ * moved_).sum(), meets_bound_ ? 1.0 : 0.0};
    sum_in_place(comm_, sums);
    if (sums[1] <= 0) return false;
    const double best = sums[0] > 0 ? sums[1] / sums[0] : 1.0;
    double part = best;
    if (sums[2] > 0 && best > 0.6) part = 1.0;
    if (sums[2] == 0 && best > 1.0) part = std::min(best, farthest());
    curvature_ = sums[0];
    z_.head(free_) -= part * moved_.head(free_);
    double* z = z_.data() + free_;
    const double* moved = moved_.data() + free_;
    for (Eigen::Index i = 0; i < bounded_; ++i) z[i] = clamped(i, z[i] - part * moved[i]);
    gradient_ -= part * a_moved_;
    length_ *= std::clamp(best, 0.1, 10.0);
    return true;
  }

  /// The projected gradient, and the same preconditioned.
  void evaluate() {
    slope_.head(free_) = gradient_.head(free_);
    keep(gradient_.data() + free_, slope_.data() + free_);
    const double worst = size_ > 0 ? (slope_.abs() * per_tolerance_).maxCoeff() : 0.0;
    report_.solved = max_over(comm_, worst) <= 1.0;
    if (!report_.solved) qp_.precondition(view(std::as_const(slope_)), view(steepest_));
  }

  /// What makes the steepest direction conjugate to the last proposal.
  double conjugation() const {
    const double along = sum_over(comm_, (steepest_ * a_moved_).sum());
    return curvature_ > 0 ? along / curvature_ : 0.0;
  }

  void redirect(double beta) {
    direction_ = steepest_ - beta * moved_;
    keep(direction_.data() + free_, direction_.data() + free_);
  }

  MPI_Comm comm_;
  const BoundedQp& qp_;
  Eigen::Index size_, free_, bounded_;
  Eigen::Map<Array> z_;
  Array gradient_, slope_, steepest_, direction_, moved_, a_moved_, per_tolerance_;
  double length_ = 1;
  double curvature_ = 0; ///< moved' A moved, over all ranks
  bool meets_bound_ = false;
  QpReport report_;
};

} // namespace

QpReport solve(MPI_Comm comm, const BoundedQp& qp, int most_products, std::vector<double>& z) {
  return ProjectedGradients(comm, qp, z).run(most_products);
}

} // namespace taut
