#pragma once
#include "partition/yarns.hpp"

#include <tuple>

namespace taut {

/// The part of the projection matrix that lies along yarns.
struct YarnTridiagonal {
  std::vector<double> diagonal; ///< of owned edges
  std::vector<double>
      to_previous; ///< coupling of an owned edge to the edge before it in its segment; 0 where one begins
  std::vector<double>
      to_segment_before; ///< coupling of each knot to `Yarns::before_knot`; 0 where there is none
};

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
  void solve_whole(const YarnSegment& s, std::span<const T> b, std::span<T> x) const;
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
