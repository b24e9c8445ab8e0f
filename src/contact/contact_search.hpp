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
  /// Both must outlive the search. Collective.
  ContactSearch(const Cloth& cloth, const Obstacles& obstacles);

  /// Finds all pairs whose gap can come down to `reach` (m) while all vertices move together along straight
  /// lines from where they are to where the motion ends. Its slack tells how far from there they may be in
  /// `widen`; planes are looked for within all of it. Collective.
  void find(const Motion& motion, double reach);

  /// Adds the pairs that can come within reach on the way to anywhere within `strayed` (m, of local cloth
  /// vertices, ghosts current, at most the slack of the motion) of where the motion ends. True if that are
  /// any, on any rank; then all pairs have new places. Collective.
  bool widen(std::span<const double> strayed);

  std::span<const Pair> pairs() const { return pairs_; }

  /// A number for each place of a contact field that does not depend on the partition; of a cloth vertex, its
  /// original number.
  std::span<const Global> keys() const { return keys_; }

  Local own() const { return own_; }                    ///< cloth vertices of this rank
  Local home() const { return own_ + obstacle_count_; } ///< places before the ghosts
  Local size() const { return Local(keys_.size()); }

  /// Cloth (local vertices) and obstacles as a contact field. Collective over neighbours.
  void gather(std::span<const Vec3> cloth, std::span<const Vec3> obstacles, std::vector<Vec3>& field) const;

  /// Ghosts from their owners. Collective over neighbours.
  void update(std::vector<Vec3>& field) const { plan_.forward<Vec3>(field, field); }

  /// Adds what ghosts hold to their owners. Collective over neighbours.
  void accumulate(std::vector<Vec3>& field) const { plan_.reverse_add<Vec3>(field, field); }

  /// Between own vertices and ghosts; valid until the next search.
  const Plan& plan() const { return plan_; }

  /// Leaves the least of what ghosts hold and their owner holds to the owner. Collective over neighbours.
  void take_least(std::vector<double>& field) const { plan_.reverse_min<double>(field, field); }

private:
  double meet(const BoxPair& elements, double from, double to);
  double spare_of(const Pair& pair, const ElementSearch::Range& range, double apart_across, double to) const;
  void meet_planes(const Motion& motion, double reach);
  void place_in_fields();

  const Cloth& cloth_;
  const Obstacles& obstacles_;
  ElementSearch elements_;
  Local own_, obstacle_count_;
  std::vector<double> spare_; ///< m, for each pair of elements, of its features that are not in `found_`
  std::vector<Pair> found_;   ///< their vertices are places in the fields of `elements_`
  std::vector<Pair> pairs_;   ///< the same as places in contact fields
  std::vector<Global> keys_;
  Plan plan_;
};

} // namespace taut
