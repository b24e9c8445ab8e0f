#include "src/linear/yarn_factor.hpp"

#include <algorithm>

namespace taut {

YarnFactor::YarnFactor(const Yarns& yarns)
    : yarns_(yarns), knots_(yarns.knots.size()), owned_(yarns.owned_knots), knot_values_(yarns.knots.size()),
      owned_values_(yarns.owned_knots) {
  const std::size_t edges = yarns.segments.empty() ? 0 : yarns.segments.back().end;
  lower_.assign(edges, 0.0);
  if (std::any_of(yarns.segments.begin(), yarns.segments.end(), [](const YarnSegment& s) { return s.cut; }))
    to_begin_.assign(edges, 0.0);
  inverse_diagonal_.assign(edges, 0.0);
}

void YarnFactor::factor(const YarnTridiagonal& matrix) {
  std::size_t knot = 0;
  for (const YarnSegment& s : yarns_.segments) {
    if (!s.cut) {
      factor_whole(s, matrix);
      continue;
    }
    const Ends ends = factor_inside(s, matrix);
    knots_[knot] = {s.runs_forward ? ends.first_diagonal : ends.last_diagonal,
                    matrix.to_segment_before[knot]};
    ++knot;
    if (s.size() > 1)
      knots_[knot++] = {s.runs_forward ? ends.last_diagonal : ends.first_diagonal, ends.coupling};
  }
  yarns_.to_owner.forward<KnotEntry>(knots_, owned_);
  factor_knots();
}

void YarnFactor::factor_whole(const YarnSegment& s, const YarnTridiagonal& matrix) {
  for (Local i = s.begin; i < s.end; ++i) {
    const double coupling = i == s.begin ? 0.0 : matrix.to_previous[i];
    lower_[i] = i == s.begin ? 0.0 : coupling * inverse_diagonal_[i - 1];
    inverse_diagonal_[i] = 1.0 / (matrix.diagonal[i] - lower_[i] * coupling);
  }
}

/// Eliminates the edges between the first and the last; returns what that leaves on these two.
YarnFactor::Ends YarnFactor::factor_inside(const YarnSegment& s, const YarnTridiagonal& matrix) {
  const Local last = s.end - 1;
  if (s.size() == 1) return {matrix.diagonal[last], matrix.diagonal[last], 0.0};
  Ends ends{matrix.diagonal[s.begin], matrix.diagonal[last], 0.0};
  double fill = matrix.to_previous[s.begin + 1]; // coupling of the edge in hand to the first
  double diagonal = matrix.diagonal[s.begin + 1];
  for (Local i = s.begin + 1; i < last; ++i) {
    const double inverse = 1.0 / diagonal, onward = matrix.to_previous[i + 1];
    inverse_diagonal_[i] = inverse;
    to_begin_[i] = fill * inverse;
    lower_[i + 1] = onward * inverse;
    ends.first_diagonal -= fill * to_begin_[i];
    diagonal = matrix.diagonal[i + 1] - onward * lower_[i + 1];
    fill = -onward * to_begin_[i];
  }
  ends.last_diagonal = diagonal;
  ends.coupling = fill;
  return ends;
}

void YarnFactor::factor_knots() {
  for (std::size_t k = 0; k < owned_.size(); ++k) {
    KnotEntry& knot = owned_[k];
    const double coupling = yarns_.starts_yarn[k] ? 0.0 : knot.to_previous;
    knot.to_previous = yarns_.starts_yarn[k] ? 0.0 : coupling * owned_[k - 1].diagonal;
    knot.diagonal = 1.0 / (knot.diagonal - knot.to_previous * coupling);
  }
}

void YarnFactor::solve(std::span<const double> b, std::span<double> x) const {
  for (const YarnSegment& s : yarns_.segments) {
    if (!s.cut) continue;
    std::copy(b.begin() + s.begin, b.begin() + s.end, x.begin() + s.begin);
    eliminate_inside(s, x);
  }
  for (std::size_t k = 0; k < knot_values_.size(); ++k) knot_values_[k] = x[yarns_.knots[k]];
  yarns_.to_owner.begin_forward<double>(knot_values_);
  for (const YarnSegment& s : yarns_.segments)
    if (!s.cut) solve_whole(s, b, x);
  yarns_.to_owner.end_forward<double>(owned_values_);
  solve_knots();
  yarns_.to_owner.reverse<double>(owned_values_, knot_values_);
  for (std::size_t k = 0; k < knot_values_.size(); ++k) x[yarns_.knots[k]] = knot_values_[k];
  for (const YarnSegment& s : yarns_.segments)
    if (s.cut) substitute_inside(s, x);
}

void YarnFactor::solve_whole(const YarnSegment& s, std::span<const double> b, std::span<double> x) const {
  double carried = 0;
  for (Local i = s.begin; i < s.end; ++i) x[i] = carried = b[i] - lower_[i] * carried;
  double after = 0;
  for (Local i = s.end; i-- > s.begin;) {
    x[i] = x[i] * inverse_diagonal_[i] - after;
    after = lower_[i] * x[i];
  }
}

void YarnFactor::eliminate_inside(const YarnSegment& s, std::span<double> x) const {
  for (Local i = s.begin + 1; i < s.end - 1; ++i) {
    x[s.begin] -= to_begin_[i] * x[i];
    x[i + 1] -= lower_[i + 1] * x[i];
  }
}

void YarnFactor::substitute_inside(const YarnSegment& s, std::span<double> x) const {
  for (Local i = s.end - 2; i > s.begin; --i)
    x[i] = x[i] * inverse_diagonal_[i] - lower_[i + 1] * x[i + 1] - to_begin_[i] * x[s.begin];
}

void YarnFactor::solve_knots() const {
  double carried = 0;
  for (std::size_t k = 0; k < owned_.size(); ++k)
    owned_values_[k] = carried = owned_values_[k] - owned_[k].to_previous * carried;
  double after = 0;
  for (std::size_t k = owned_.size(); k-- > 0;) {
    owned_values_[k] = owned_values_[k] * owned_[k].diagonal - after;
    after = owned_[k].to_previous * owned_values_[k];
  }
}

} // namespace taut
