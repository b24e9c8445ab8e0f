#include "src/linear/bounded_qp.hpp"

#include <Eigen/Core>

#include <algorithm>
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
      : comm_(comm), qp_(qp), effort_(effort), size_(Index(z.size())), free_(Index(qp.unbounded)),
        lower_(qp.lower.data(), size_ - free_), upper_(qp.upper.data(), size_ - free_), z_(z.data(), size_),
        gradient_(size_), slope_(size_), steepest_(size_), moved_(Array::Zero(size_)),
        a_moved_(Array::Zero(size_)),
        per_tolerance_(1.0 / Eigen::Map<const Array>(qp.tolerance.data(), size_)) {
    z_.tail(size_ - free_) = z_.tail(size_ - free_).max(lower_).min(upper_);
    multiply(z, view(gradient_));
    gradient_ -= Eigen::Map<const Array>(qp.rhs.data(), size_);
    go(0);
  }

  QpReport run() {
    while (!report_.solved && report_.products < (is_good_ ? effort_.products : effort_.most_products)) {
      propose();
      const double part = part_to_go();
      if (part != 0)
        go(part);
      else
        beta_ = 0; // the bounds have turned the direction uphill
    }
    return report_;
  }

private:
  using Index = Eigen::Index;
  static constexpr Index longest_run = 512;

  /// Some consecutive entries: few enough to stay in the nearest cache while several expressions need them.
  /// (Whole vectors, read from memory by each expression, took 1.6 times as long.)
  struct Run {
    Index begin, length;
    template<class T>
    auto of(T& entries) const {
      return entries.segment(begin, length);
    }
    Run less(Index before) const { return {begin - before, length}; }
  };
  template<class Visit>
  static void for_each_run(Index begin, Index end, Visit&& visit) {
    for (; begin < end; begin += longest_run) visit(Run{begin, std::min(longest_run, end - begin)});
  }
  template<class Visit>
  void for_unbounded(Visit&& visit) const {
    for_each_run(0, free_, visit);
  }
  /// visit(run, lower, upper)
  template<class Visit>
  void for_bounded(Visit&& visit) const {
    for_each_run(free_, size_, [&](const Run& run) {
      const Run bounds = run.less(free_);
      visit(run, bounds.of(lower_), bounds.of(upper_));
    });
  }

  /// The part of a direction that does not leave the bounds entries z are at. (z - bound) huge is 0 at the
  /// bound, and elsewhere too large to limit anything.
  template<class T, class Z, class Bounds>
  static auto kept(const T& direction, const Z& z, const Bounds& lower, const Bounds& upper) {
    constexpr double huge = 1e300;
    return direction.max((z - upper) * huge).min((z - lower) * huge);
  }

  void multiply(std::span<const double> x, std::span<double> y) {
    qp_.multiply(x, y);
    ++report_.products;
  }

  /// `moved_` = z - P(z - length direction), and A times it; the direction is the steepest, made conjugate to
  /// the last proposal.
  void propose() {
    meets_bound_ = false;
    for_unbounded(
        [&](const Run& run) { run.of(moved_) = length_ * (run.of(steepest_) - beta_ * run.of(moved_)); });
    Eigen::Array<double, Eigen::Dynamic, 1, 0, longest_run, 1> direction,
        wanted; // if entries may leave bounds
    for_bounded([&](const Run& run, const auto& lower, const auto& upper) {
      const auto z = run.of(z_);
      direction = run.of(steepest_) - beta_ * run.of(moved_);
      wanted = z - length_ * kept(direction, z, lower, upper);
      run.of(moved_) = z - wanted.max(lower).min(upper);
      meets_bound_ = meets_bound_ || (wanted < lower || wanted > upper).any();
    });
    multiply(view(std::as_const(moved_)), view(a_moved_));
  }

  /// By how much `moved_` can be multiplied until an entry meets a bound.
  double farthest() const {
    double factor = HUGE_VAL;
    for (Index i = 0; i < size_ - free_; ++i) {
      const double z = z_[free_ + i], moved = moved_[free_ + i];
      if (moved > 0) factor = std::min(factor, (z - lower_[i]) / moved);
      if (moved < 0) factor = std::min(factor, (z - upper_[i]) / moved);
    }
    return -max_over(comm_, -factor);
  }

  /// The best part of the proposal; all of it if it meets a bound and that still lowers the objective (beyond
  /// twice the best part it would not); 0 if the proposal leads uphill.
  double part_to_go() {
    double sums[] = {0, 0, meets_bound_ ? 1.0 : 0.0};
    for_each_run(0, size_, [&](const Run& run) {
      sums[0] += (run.of(moved_) * run.of(a_moved_)).sum();
      sums[1] += (run.of(moved_) * run.of(gradient_)).sum();
    });
    sum_in_place(comm_, sums);
    if (sums[1] <= 0) return 0;
    const double best = sums[0] > 0 ? sums[1] / sums[0] : 1.0;
    curvature_ = sums[0];
    length_ *= std::clamp(best, 0.1, 10.0);
    if (sums[2] > 0 && best > 0.6) return 1.0;
    return sums[2] == 0 && best > 1.0 ? std::min(best, farthest()) : best;
  }

  /// Goes a part of the proposal. Then the projected gradient, whether it is within the tolerance, the same
  /// preconditioned, and what makes that conjugate to the proposal. (Preconditioned even if within the
  /// tolerance, for one reduction less.)
  void go(double part) {
    double equations_left = 0, rest_left = 0;
    const auto left = [&](const Run& run) {
      return (run.of(slope_).abs() * run.of(per_tolerance_)).maxCoeff();
    };
    for_unbounded([&](const Run& run) {
      run.of(z_) -= part * run.of(moved_);
      run.of(gradient_) -= part * run.of(a_moved_);
      run.of(slope_) = run.of(gradient_);
      equations_left = std::max(equations_left, left(run));
    });
    for_bounded([&](const Run& run, const auto& lower, const auto& upper) {
      run.of(z_) = (run.of(z_) - part * run.of(moved_)).max(lower).min(upper);
      run.of(gradient_) -= part * run.of(a_moved_);
      run.of(slope_) = kept(run.of(gradient_), run.of(z_), lower, upper);
      rest_left = std::max(rest_left, left(run));
    });
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
  Index size_, free_;
  Eigen::Map<const Array> lower_, upper_;
  Eigen::Map<Array> z_;
  Array gradient_, slope_, steepest_, moved_, a_moved_, per_tolerance_;
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
