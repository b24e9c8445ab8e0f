#pragma once
#include "partition/plan.hpp"

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

  std::span<const Term> terms() const { return terms_; }
  std::span<const Mat3> diagonal_blocks() const { return diagonal_; } ///< of own vertices

private:
  const Plan* plan_;
  Local own_;
  std::vector<Term> terms_;
  std::vector<Mat3> diagonal_;
  mutable std::vector<Vec3> from_, to_;
};

} // namespace taut
