#pragma once
#include "partition/yarns.hpp"

#include <array>
#include <tuple>

namespace taut {

/// The part of a matrix over edges that lies along yarns.
struct YarnTridiagonal {
  YarnTridiagonal() = default;
  /// Of zeros.
  explicit YarnTridiagonal(const Yarns& yarns);

  /// From the entries `on_diagonal(e)` of owned edges and `coupling(e, f)` of an owned edge to one before it.
  template<class OnDiagonal, class Coupling>
  void fill(const Yarns& yarns, OnDiagonal&& on_diagonal, Coupling&& coupling) {
    for (const YarnSegment& s : yarns.segments)
      for (Local e = s.begin; e < s.end; ++e) {
        diagonal[e] = on_diagonal(e);
        if (e > s.begin) to_previous[e] = coupling(e, e - 1);
      }
    for (std::size_t k = 0; k < yarns.knots.size(); ++k)
      if (yarns.before_knot[k] >= 0) to_segment_before[k] = coupling(yarns.knots[k], yarns.before_knot[k]);
  }

  std::vector<double> diagonal; ///< of owned edges
  std::vector<double>
      to_previous; ///< coupling of an owned edge to the edge before it in its segment; 0 where one begins
  std::vector<double>
      to_segment_before; ///< coupling of each knot to `Yarns::before_knot`; 0 where there is none
};

/// The entry (e, f) of a matrix that two edges have because they share vertices: the sum of `value(v)` over
/// these, negative where one edge begins and the other ends.
template<class Value>
double sum_over_shared(const DistributedMesh& mesh, Local e, Local f, Value&& value) {
  double sum = 0;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const Local v = mesh.edge_vertices[e][i];
      if (v == mesh.edge_vertices[f][j]) sum += (i == j ? 1 : -1) * value(v);
    }
  return sum;
}

/// Exact factorisation of the tridiagonal blocks of all yarns, across ranks. Each rank eliminates the inside
/// of its segments of a cut yarn; what is left couples the knots of the yarn in one small tridiagonal system,
/// which the yarn's owner solves. One exchange with neighbours each way, during which the uncut yarns are
/// solved.
class YarnFactor {
public:
  /// `yarns` must outlive the factor.
  explicit YarnFactor(const Yarns& yarns);

  /// Collective over neighbours.
  void factor(const YarnTridiagonal& matrix);

  /// x = T^-1 b over owned edges, of numbers or of vectors in space; both may be the same. Collective over
  /// neighbours.
  void solve(std::span<const double> b, std::span<double> x) const { solve_any(b, x); }
  void solve(std::span<const Vec3> b, std::span<Vec3> x) const { solve_any(b, x); }

private:
  struct KnotEntry {
    double diagonal, to_previous;
  };
  struct Ends {
    double first_diagonal, last_diagonal, coupling;
  };

  void factor_whole(const YarnSegment& s, const YarnTridiagonal& matrix);
  Ends factor_inside(const YarnSegment& s, const YarnTridiagonal& matrix);
  void factor_knots();
  template<class T>
  void solve_any(std::span<const T> b, std::span<T> x) const;
  template<class T>
  void solve_uncut(std::span<const T> b, std::span<T> x) const;
  template<class T, std::size_t n>
  void solve_together(const std::array<YarnSegment, n>& segments, std::span<const T> b, std::span<T> x) const;
  template<class T>
  void eliminate_inside(const YarnSegment& s, std::span<T> x) const;
  template<class T>
  void substitute_inside(const YarnSegment& s, std::span<T> x) const;
  template<class T>
  void solve_knots(std::span<T> values) const;

  template<class T>
  struct KnotValues {
    std::vector<T> here, owned;
  };

  const Yarns& yarns_;
  std::vector<char> is_identity_;        ///< of segments: an uncut one on which there is nothing to do
  std::vector<double> lower_;            ///< of L: to the edge before
  std::vector<double> to_begin_;         ///< of L: of the inside of a cut segment to its first edge
  std::vector<double> inverse_diagonal_; ///< of D
  std::vector<KnotEntry> knots_;         ///< of this rank's segments, then
  std::vector<KnotEntry> owned_;         ///< of the yarns it owns: factored, with 1/D and L
  mutable std::tuple<KnotValues<double>, KnotValues<Vec3>> knot_values_;
};

} // namespace taut
