#pragma once

namespace taut {

/// What became of a start that was strained beyond the limit, see Simulation::relax.
struct Relaxed {
  double strain_before = 0, strain = 0; ///< largest over the limit, of single triangles too
  int steps = 0;                        ///< that it took; 0: it was within the limit

  bool succeeded() const { return strain <= 1; }
};

} // namespace taut
