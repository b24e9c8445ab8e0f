#pragma once
#include "src/contact/pair.hpp"
#include "src/state/cloth.hpp"

namespace taut {

/// The distance that contact keeps between the midsurface of cloth and whatever it touches: half the
/// thickness of each of two cloths, the whole of one against an obstacle (to which that adds its own).
///
/// Where two edges of cloth cross it is a fifth less. Layers that lie flat on each other are held apart by
/// vertices and faces then, and edges count only where cloth folds: they would be half of all contacts, and
/// say the same.
class Thickness {
public:
  /// Of a piece without a thickness of its own that of `contact`; without that, a tenth of its mean edge.
  /// Throws InputError for one that the mesh cannot have. Collective.
  Thickness(const Cloth& cloth, const Case& input);

  double largest() const { return largest_; }   ///< m, of all pairs
  double smallest() const { return smallest_; } ///< m

  /// In m, of a pair whose vertices have these keys (ContactSearch::keys).
  double of(const Pair& pair, std::span<const Global> keys) const {
    const double of_surfaces =
        of_piece_.size() == 1 ? largest_ : of_features(keys[pair.vertices[0]], keys[pair.vertices[3]]);
    return part_of(pair) * of_surfaces;
  }

  /// m, what comes nearer counts as in contact: one and a half times the thickness, but of one piece less
  /// than its features are from each other when it is flat.
  double near(const Pair& pair, std::span<const Global> keys) const;
  double largest_near() const { return near_thicknesses * largest_; } ///< m, of all pairs

private:
  static constexpr double near_thicknesses = 1.5, part_of_edges = 0.8;

  double part_of(const Pair& pair) const {
    return has_faces_ && pair.kind == PairKind::edge_edge && pair.body < 0 ? part_of_edges : 1.0;
  }

  double of_features(Global first, Global second) const;

  const Cloth& cloth_;
  std::vector<double> of_piece_; ///< m
  std::vector<double> own_near_; ///< m, of a piece and itself
  double largest_, smallest_;
  bool has_faces_; ///< all pieces
};

} // namespace taut
