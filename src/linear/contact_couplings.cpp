#include "src/linear/contact_couplings.hpp"

namespace taut {

ContactCouplings::ContactCouplings(const Plan& plan, Local own, Local size, std::vector<Term> terms)
    : plan_(&plan), own_(own), terms_(std::move(terms)), diagonal_(size, Mat3::Zero()),
      from_(size, Vec3::Zero()), to_(size, Vec3::Zero()) {
  for (const Term& t : terms_)
    for (std::size_t i = 0; i < 4; ++i) diagonal_[t.places[i]] += t.gradient[i] * t.gradient[i].transpose();
  plan_->reverse_add<Mat3>(diagonal_, diagonal_);
  diagonal_.resize(own_);
}

void ContactCouplings::add_product(std::span<const Vec3> x, std::span<Vec3> y) const {
  std::copy_n(x.begin(), own_, from_.begin());
  plan_->forward<Vec3>(from_, from_);
  std::fill(to_.begin(), to_.end(), Vec3::Zero());
  for (const Term& t : terms_) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += t.gradient[i].dot(from_[t.places[i]]);
    for (std::size_t i = 0; i < 4; ++i) to_[t.places[i]] += sum * t.gradient[i];
  }
  plan_->reverse_add<Vec3>(to_, to_);
  for (Local i = 0; i < own_; ++i) y[i] += to_[i];
}

} // namespace taut
