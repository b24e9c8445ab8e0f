#pragma once
#include "src/time/observer.hpp"

namespace taut {

/// Watches how evenly contact is shared out among the ranks, and how much of it goes across them. A mesh is
/// cut by what is near each other when it is cut; as cloth falls and folds, that changes.
///
/// What a step wastes is told as a part of its work: contacts that the rank with most has more than the mean,
/// and some times those across ranks, which cost more to find and to solve for.
class ContactBalance : public Observer {
public:
  /// Part of what determines how a run goes on.
  struct Memory {
    Global steps = 0; ///< seen since the mesh was cut
    double waste = 0; ///< of the last steps, on the mean
    double least = 0; ///< of those means, since the mesh was cut
    bool operator==(const Memory&) const = default;
  };

  ContactBalance(Global vertices, const Memory& memory) : vertices_(vertices), memory_(memory) {}

  void after_step(const State& state, const StepRecord& record) override;

  /// Whether cutting anew may pay: much more is wasted than once it was with this cut. The same on all ranks.
  bool wants_another_cut() const;

  const Memory& memory() const { return memory_; }

private:
  Global vertices_;
  Memory memory_;
};

} // namespace taut
