#include "src/linear/gcr.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

void Gcr::start(std::span<const double> weights) {
  weights_.assign(weights.begin(), weights.end());
  used_ = 0;
  stalled_ = 0;
}

/// Gram and Schmidt's classical way: one sum over ranks for all.
void Gcr::orthogonalise(std::span<double> direction, std::span<double> product) {
  if (used_ == 0) return;
  std::array<double, most_kept> along{};
  for (std::size_t k = 0; k < used_; ++k) {
    const float* const kept = kept_[k].product.data();
    double sum = 0;
    for (std::size_t i = 0; i < size_; ++i) sum += weights_[i] * product[i] * double(kept[i]);
    along[k] = sum;
  }
  sum_in_place(comm_, std::span(along).first(used_));
  for (std::size_t k = 0; k < used_; ++k) {
    const auto& [z, p] = kept_[k];
    for (std::size_t i = 0; i < size_; ++i) direction[i] -= along[k] * double(z[i]);
    for (std::size_t i = 0; i < size_; ++i) product[i] -= along[k] * double(p[i]);
  }
}

double Gcr::step(std::span<double> direction, std::span<double> product, std::span<double> x,
                 std::span<double> r) {
  if (used_ == most_kept) used_ = 0;
  std::array<double, 4> sums{}; // <p, p> as given; <p, p> and <p, r> of what is new; <r, r>
  for (std::size_t i = 0; i < size_; ++i) sums[0] += weights_[i] * product[i] * product[i];
  orthogonalise(direction, product);
  for (std::size_t i = 0; i < size_; ++i) {
    sums[1] += weights_[i] * product[i] * product[i];
    sums[2] += weights_[i] * product[i] * r[i];
    sums[3] += weights_[i] * r[i] * r[i];
  }
  sum_in_place(comm_, sums);
  constexpr double nothing_new = 1e-10; // single precision keeps no more
  if (!(sums[1] > nothing_new * sums[0])) return 0;
  const double alpha = sums[2] / sums[1], scale = 1 / std::sqrt(sums[1]);
  constexpr double hardly = 1e-4; // of <r, r>
  stalled_ = alpha * sums[2] < hardly * sums[3] ? stalled_ + 1 : 0;
  if (kept_.size() == used_) kept_.push_back({std::vector<float>(size_), std::vector<float>(size_)});
  auto& [z, p] = kept_[used_++];
  for (std::size_t i = 0; i < size_; ++i) {
    x[i] += alpha * direction[i];
    r[i] -= alpha * product[i];
    z[i] = float(scale * direction[i]);
    p[i] = float(scale * product[i]);
  }
  return alpha;
}

} // namespace taut
