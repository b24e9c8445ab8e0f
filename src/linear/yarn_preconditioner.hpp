#pragma once
#include "partition/types.hpp"

#include <span>
#include <vector>

namespace taut {

/// The part of the projection matrix that lies along yarns: for each owned edge its diagonal entry and its coupling to
/// the edge before it on the same yarn (0 where a yarn starts).
struct YarnTridiagonal {
  std::vector<double> diagonal;
  std::vector<double> to_previous;
};

/// Factor of all tridiagonal yarn blocks at once (L D L^T; couplings of 0 separate the blocks).
class YarnFactor {
 public:
  void factor(const YarnTridiagonal& matrix);

  /// x = T^-1 b. Not collective.
  void solve(std::span<const double> b, std::span<double> x) const;

 private:
  std::vector<double> lower_;            ///< of L
  std::vector<double> inverse_diagonal_; ///< of D
};

/// Makes `-projection_pc_type yarn` known to PETSc. Once a program.
void register_yarn_preconditioner();

} // namespace taut
