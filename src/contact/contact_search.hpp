#pragma once
#include "src/contact/element_search.hpp"
#include "src/contact/pair.hpp"

namespace taut {

/// Finds the pairs of features that can meet, over all ranks. Each pair is found by one rank, by a rule that
/// depends on the partition only.
///
/// Pairs refer to *contact fields*: arrays over [own cloth vertices | obstacle vertices | ghosts], where
/// ghosts are whatever cloth vertices of other ranks the pairs of this one need.
class ContactSearch {
public:
  /// Both must outlive the search; see ElementSearch. Collective.
  ContactSearch(const Cloth& cloth, const Obstacles& obstacles, std::span<const Element> strings = {});

  /// Finds all pairs whose gap can come down to `reach` (m) while all vertices move together along straight
  /// lines from where they are to where the motion ends. Costs least if elements stray by less than `slack`
  /// (m) from motion to motion; what is found, and its order, do not depend on the motions before.
  /// Collective.
  void find(const Motion& motion, double reach, double slack = 0.0);

  /// The motion goes on from somewhere on its way, and ends elsewhere: adds the pairs that can come within
  /// reach now, and keeps those that could before and need no other rank. True if all pairs have new places.
  /// Collective.
  bool follow(const Motion& motion);

  /// So many leading pairs were there before the last `follow`, in the same order.
  std::size_t kept() const { return kept_; }

  std::span<const Pair> pairs() const { return pairs_; }

  /// A number for each place of a contact field that does not depend on the partition; of a cloth vertex, its
  /// original number.
  std::span<const Global> keys() const { return keys_; }

  Local own() const { return own_; }                    ///< cloth vertices of this rank
  Local home() const { return own_ + obstacle_count_; } ///< places before the ghosts

  /// Whether features have a vertex of another rank.
  bool is_across(const std::array<Local, 4>& places) const {
    return std::ranges::any_of(places, [this](Local v) { return v >= home(); });
  }
  Local size() const { return Local(keys_.size()); }

  /// Cloth (local vertices) and obstacles as a contact field. Collective over neighbours.
  void gather(std::span<const Vec3> cloth, std::span<const Vec3> obstacles, std::vector<Vec3>& field) const;

  /// Ghosts from their owners. Collective over neighbours.
  template<class T>
  void update(std::vector<T>& field) const {
    plan_.forward<T>(field, field);
  }

  /// Adds what ghosts hold to their owners. Collective over neighbours.
  template<class T>
  void accumulate(std::vector<T>& field) const {
    plan_.reverse_add<T>(field, field);
  }

  /// Between own vertices and ghosts; valid until the next search.
  const Plan& plan() const { return plan_; }

  /// Leaves the least of what ghosts hold and their owner holds to the owner. Collective over neighbours.
  void take_least(std::vector<double>& field) const { plan_.reverse_min<double>(field, field); }

private:
  /// Of pairs of elements, what their features do.
  struct Near {
    std::vector<double> spare;       ///< m, until another pair of their features is near, at least
    std::vector<std::uint16_t> held; ///< which of them are in `found`, a bit for each
    std::vector<Pair> found;         ///< their vertices are places in the fields of `elements_`
  };

  void measure_gaps();
  void look_at(std::span<const BoxPair> pairs, Near& near) const;
  double meet(const BoxPair& elements, std::uint16_t& held, std::vector<Pair>& found) const;
  double spare_of(const Pair& pair, const ElementSearch::Range& range, double apart_across) const;
  void look_at_planes();
  void place_in_fields();

  const Cloth& cloth_;
  const Obstacles& obstacles_;
  ElementSearch elements_;
  Local own_, obstacle_count_;
  double reach_ = 0;
  Near near_, across_; ///< of this rank, and with elements of others
  std::size_t kept_ = 0;
  std::vector<bool> plane_held_; ///< for every plane and own vertex
  std::vector<Pair> pairs_;      ///< all found, as places in contact fields
  std::vector<Global> keys_;
  Plan plan_;
};

} // namespace taut
