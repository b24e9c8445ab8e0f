#include "src/linear/bounded_qp.hpp"

#include <Eigen/Core>

#include <cmath>

namespace taut {

namespace {

using Array = Eigen::ArrayXd;

std::span<const double> view(const Array& a) { return {a.data(), std::size_t(a.size())}; }
std::span<double> view(Array& a) { return {a.data(), std::size_t(a.size())}; }

/// The state of an iteration. Proposals are what is taken from z. Entries without bounds come first and are
/// kept out of what concerns bounds. Nothing here branches by entry: nobody could predict which are at
/// bounds.
class ProjectedGradients {
public:
  ProjectedGradients(MPI_Comm comm, const BoundedQp& qp, const QpEffort& effort, std::vector<double>& z)
      : comm_(comm), qp_(qp), effort_(effort), size_(Eigen::Index(z.size())),
        free_(Eigen::Index(qp.unbounded)), lower_(qp.lower.data(), size_ - free_),
        upper_(qp.upper.data(), size_ - free_), z_(z.data(), size_), gradient_(size_), slope_(size_),
        steepest_(size_), moved_(Array::Zero(size_)), a_moved_(Array::Zero(size_)), wanted_(size_ - free_),
        per_tolerance_(1.0 / Eigen::Map<const Array>(qp.tolerance.data(), size_)) {
    z_.tail(size_ - free_) = z_.tail(size_ - free_).max(lower_).min(upper_);
    multiply(z, view(gradient_));
    gradient_ -= Eigen::Map<const Array>(qp.rhs.data(), size_);
    evaluate();
  }

  QpReport run() {
    while (!report_.solved && report_.products < (is_good_ ? effort_.products : effort_.most_products)) {
      propose();
      if (move())
        evaluate();
      else
        beta_ = 0; // the bounds have turned the direction uphill
    }
    return report_;
  }

private:
  template<class T>
  auto bounded(T& entries) const {
    return entries.tail(size_ - free_);
  }
  template<class T>
  auto unbounded(T& entries) const {
    return entries.head(free_);
  }

  /// The part of a direction that does not leave the bounds entries are at. (z - bound) huge is 0 at the
  /// bound, and elsewhere too large to limit anything.
  template<class T>
  auto kept(const T& direction) const {
    constexpr double huge = 1e300;
    return direction.max((bounded(z_) - upper_) * huge).min((bounded(z_) - lower_) * huge);
  }

  template<class T>
  static double largest(const T& entries) {
    return entries.size() > 0 ? entries.maxCoeff() : 0.0;
  }

  void multiply(std::span<const double> x, std::span<double> y) {
    qp_.multiply(x, y);
    ++report_.products;
  }

  /// `moved_` = z - P(z - length direction), and A times it; the direction is the steepest, made conjugate to
  /// the last proposal.
  void propose() {
    unbounded(moved_) = length_ * (unbounded(steepest_) - beta_ * unbounded(moved_));
    wanted_ = bounded(steepest_) - beta_ * bounded(moved_);
    wanted_ = bounded(z_) - length_ * kept(wanted_);
    bounded(moved_) = bounded(z_) - wanted_.max(lower_).min(upper_);
    meets_bound_ = (wanted_ < lower_ || wanted_ > upper_).any();
    multiply(view(std::as_const(moved_)), view(a_moved_));
  }

  /// By how much `moved_` can be multiplied until an entry meets a bound.
  double farthest() const {
    double factor = HUGE_VAL;
    for (Eigen::Index i = 0; i < size_ - free_; ++i) {
      const double z = z_[free_ + i], moved = moved_[free_ + i];
      if (moved > 0) factor = std::min(factor, (z - lower_[i]) / moved);
      if (moved < 0) factor = std::min(factor, (z - upper_[i]) / moved);
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
    unbounded(z_) -= part * unbounded(moved_);
    bounded(z_) = (bounded(z_) - part * bounded(moved_)).max(lower_).min(upper_);
    gradient_ -= part * a_moved_;
    length_ *= std::clamp(best, 0.1, 10.0);
    return true;
  }

  /// The projected gradient, whether it is within the tolerance, the same preconditioned, and what makes that
  /// conjugate to the last proposal. (Preconditioned even if within the tolerance, for one reduction less.)
  void evaluate() {
    unbounded(slope_) = unbounded(gradient_);
    bounded(slope_) = kept(bounded(gradient_));
    const double equations_left = largest(unbounded(slope_).abs() * unbounded(per_tolerance_));
    const double rest_left = largest(bounded(slope_).abs() * bounded(per_tolerance_));
    const bool is_solved = equations_left <= 1.0 && rest_left <= 1.0;
    qp_.precondition(view(std::as_const(slope_)), view(steepest_));
    double sums[] = {(steepest_ * a_moved_).sum(), is_solved ? 0.0 : 1.0,
                     equations_left <= effort_.good_enough ? 0.0 : 1.0};
    sum_in_place(comm_, sums);
    beta_ = curvature_ > 0 ? sums[0] / curvature_ : 0.0;
    report_.solved = sums[1] == 0;
    is_good_ = sums[2] == 0;
  }

  MPI_Comm comm_;
  const BoundedQp& qp_;
  const QpEffort& effort_;
  Eigen::Index size_, free_;
  Eigen::Map<const Array> lower_, upper_;
  Eigen::Map<Array> z_;
  Array gradient_, slope_, steepest_, moved_, a_moved_;
  Array wanted_; ///< where a proposal leads entries with bounds if they may leave them
  Array per_tolerance_;
  double length_ = 1, beta_ = 0;
  double curvature_ = 0; ///< moved' A moved, over all ranks
  bool meets_bound_ = false, is_good_ = false;
  QpReport report_;
};

} // namespace

QpReport solve(MPI_Comm comm, const BoundedQp& qp, const QpEffort& effort, std::vector<double>& z) {
  return ProjectedGradients(comm, qp, effort, z).run();
}

} // namespace taut
