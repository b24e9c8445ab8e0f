#pragma once
#include "src/constraints/edge_constraints.hpp"
#include "src/linear/yarn_factor.hpp"

namespace taut {

/// What the tension of taut threads does to the metric in which a projection moves vertices.
///
/// Moved along constraint gradients in the metric of masses, x <- x - W J^T d_mu, vertices are pulled the way
/// edges lie before the move. Tension so is an explicit step of diffusion: zigzags of a thread come back as
/// (1 - 8 mu/(l m)) times themselves, and where the tension mu is many times l m, as in a thread between two
/// pins that has no slack, every iteration turns them over and makes them larger. Newton's method for the
/// conditions M (x - x*) + J^T mu = 0 and C = a mu, which knows that edges turn as they are pulled, has the
/// metric
///
///     G = M + B^T D B,  D = 2 mu/l,  G^-1 = W - W B^T (D^-1 + B W B^T)^-1 B W
///
/// instead, where B takes differences along edges (the second derivative of C = |d|^2/l - l is 2/l in all
/// directions). Here D is left out but of edges whose tension outweighs inertia by far, and at every vertex
/// but of the yarn that is pulled most, by what it is pulled more than others there. B W B^T then couples
/// chosen edges along yarns only, and is solved exactly across ranks.
class ThreadStiffness {
public:
  /// Whether the tension of any edge, on any rank, outweighs inertia by far: where it does for none, there is
  /// nothing to choose. Collective.
  static bool is_needed(const EdgeConstraints& constraints, std::span<const double> mu);

  /// Both must outlive it. Collective.
  ThreadStiffness(const Cloth& cloth, const Yarns& yarns);

  /// Chooses the edges for these tensions (local). Collective.
  void choose(const EdgeConstraints& constraints, std::span<const double> mu);

  /// Whether any edge is chosen, on any rank.
  bool acts() const { return acts_; }

  /// D of a local edge, 0 if not chosen; in kg. Not collective.
  double stiffness(Local edge) const { return root_[edge] * root_[edge]; }

  /// D/|g|^2 of owned edges, for the gradients g when they were chosen: what their stiffness adds to the
  /// inverse of J W J^T. Along a straight thread the matrix is (4 |d|^2/l^2) (D + (B W B^T)^-1)^-1.
  std::span<const double> softness() const { return softness_; }

  /// W B^T (D^-1 + B W B^T)^-1 B W J^T mu, for `mu` over owned edges: `held_back` tells it of the ends of
  /// owned edges, in m. Collective.
  void hold_back(const EdgeConstraints& constraints, std::span<const double> mu);
  const Vec3& held_back(Local vertex) const { return held_back_[vertex]; }

  /// product -= J (what is held back), over owned edges. Not collective.
  void subtract(const EdgeConstraints& constraints, std::span<double> product) const;

private:
  void find_lines();
  double across(const EdgeConstraints& constraints, std::span<const double> mu, Local edge) const;
  void note_places();
  void factor(std::span<const double> inverse_mass);

  const Cloth& cloth_;
  const Yarns& yarns_;
  std::vector<std::array<Local, 2>> in_line_; ///< of owned edges, those next to it on its yarn; -1: none
  YarnTridiagonal matrix_;                    ///< I + D^1/2 B W B^T D^1/2
  YarnFactor factor_;
  bool acts_ = false;
  std::vector<double> root_, softness_; ///< D^1/2 of local edges; of owned ones
  std::vector<Local> chosen_, beside_;  ///< owned edges: with D, and with an end that is held back
  std::vector<Local> ends_;             ///< local vertices of chosen edges, those of other ranks included
  std::vector<double> mu_;              ///< of local edges: what is held back
  std::vector<Vec3> pull_, held_back_;  ///< of local edges, of local vertices; 0 where nothing is chosen
};

} // namespace taut
