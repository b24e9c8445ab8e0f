#pragma once
#include "partition/plan.hpp"

#include <boost/container/static_vector.hpp>

namespace taut {

/// Terms sum_k g_k g_k^T of a velocity matrix between vertices that need not be neighbours in the mesh, as
/// contact couples them. Each term is held by one rank; its vertices are places in a field over
/// [own vertices | ... | ghosts], of which a plan fetches and returns the ghosts.
class ContactCouplings {
public:
  struct Term {
    std::array<Local, 4> places;
    std::array<Vec3, 4> gradient; ///< zero where a place is not of the cloth
  };

  /// `plan` must outlive the terms; `own` is the number of own vertices, `size` that of the places.
  /// Collective over neighbours.
  ContactCouplings(const Plan& plan, Local own, Local size, std::vector<Term> terms);

  /// y += sum_k g_k g_k^T x over own vertices. Collective over neighbours.
  void add_product(std::span<const Vec3> x, std::span<Vec3> y) const;

  std::span<const Mat3> diagonal_blocks() const { return diagonal_; } ///< of own vertices

  /// A part of a term: what of its gradient a vertex may follow.
  struct Part {
    Global number;
    Vec3 gradient;
  };

  /// Calls visit(parts) for each term of this rank, with numbers and projectors that own vertices have; parts
  /// that are zero are left out. Collective over neighbours.
  template<class Visit>
  void for_each(std::span<const Global> numbers, std::span<const Mat3> projectors, Visit&& visit) const {
    std::vector<Global> number(from_.size());
    std::vector<Mat3> projector(from_.size());
    std::copy_n(numbers.begin(), own_, number.begin());
    std::copy_n(projectors.begin(), own_, projector.begin());
    plan_->forward<Global>(number, number);
    plan_->forward<Mat3>(projector, projector);
    for (const Term& t : terms_) {
      boost::container::static_vector<Part, 4> parts;
      for (std::size_t i = 0; i < 4; ++i)
        if (!t.gradient[i].isZero())
          parts.push_back({number[t.places[i]], projector[t.places[i]] * t.gradient[i]});
      visit(std::span<const Part>(parts.data(), parts.size()));
    }
  }

private:
  const Plan* plan_;
  Local own_;
  std::vector<Term> terms_;
  std::vector<Mat3> diagonal_;
  mutable std::vector<Vec3> from_, to_;
};

} // namespace taut
