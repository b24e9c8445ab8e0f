#pragma once
#include "partition/comm.hpp"

namespace taut {

/// The generalised conjugate residual method [Eisenstat, Elman, Schultz 1983] for A x = b with a
/// preconditioner that may change from iteration to iteration and need be neither symmetric nor linear: each
/// iteration the caller gives a direction z and its product A z; they are made orthogonal to those before,
/// and x moves along z as far as makes the residual smallest in the norm sum_i weight_i r_i^2.
///
/// Directions and products are kept in single precision, which changes nothing of what is told of the
/// residual: it is updated with the very product of the direction taken.
class Gcr {
public:
  /// For vectors of which this rank holds `size` numbers. Not collective.
  Gcr(MPI_Comm comm, std::size_t size) : comm_(comm), size_(size) {}

  /// Starts over: a new system, or what is left of the same one. `weights` are positive. Not collective.
  void start(std::span<const double> weights);

  /// Makes `direction` and `product` orthogonal to those before, then x += alpha direction, r -= alpha
  /// product; returns alpha, 0 if the direction brings nothing new. Forgets all directions when it has
  /// `most_kept`. Collective.
  double step(std::span<double> direction, std::span<double> product, std::span<double> x,
              std::span<double> r);

  /// How many of the last steps, in a row, left the residual as it was. What the preconditioner makes of it
  /// is then no new direction, but what it makes of the last product is [Orthodir: Young, Jea 1980].
  int stalled() const { return stalled_; }

  static constexpr std::size_t most_kept = 30;

private:
  struct Kept {
    std::vector<float> direction, product; ///< the product has the norm 1
  };

  void orthogonalise(std::span<double> direction, std::span<double> product);

  MPI_Comm comm_;
  std::size_t size_, used_ = 0;
  int stalled_ = 0;
  std::vector<double> weights_;
  std::vector<Kept> kept_; ///< of these the first `used_`; memory is taken when it is first needed
};

} // namespace taut
