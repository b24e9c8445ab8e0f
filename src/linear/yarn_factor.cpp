#include "src/linear/yarn_factor.hpp"

#include <algorithm>
#include <array>

namespace taut {

YarnTridiagonal::YarnTridiagonal(const Yarns& yarns)
    : diagonal(yarns.edges()), to_previous(yarns.edges()), to_segment_before(yarns.knots.size()) {}

YarnFactor::YarnFactor(const Yarns& yarns)
    : yarns_(yarns), is_identity_(yarns.segments.size(), 0), knots_(yarns.knots.size()),
      owned_(yarns.owned_knots) {
  lower_.assign(yarns.edges(), 0.0);
  if (std::any_of(yarns.segments.begin(), yarns.segments.end(), [](const YarnSegment& s) { return s.cut; }))
    to_begin_.assign(yarns.edges(), 0.0);
  inverse_diagonal_.assign(yarns.edges(), 0.0);
}

namespace {

bool is_identity(const YarnSegment& s, const YarnTridiagonal& matrix) {
  for (Local i = s.begin; i < s.end; ++i)
    if (matrix.diagonal[i] != 1.0 || (i > s.begin && matrix.to_previous[i] != 0.0)) return false;
  return true;
}

} // namespace

void YarnFactor::factor(const YarnTridiagonal& matrix) {
  std::size_t knot = 0;
  for (std::size_t k = 0; k < yarns_.segments.size(); ++k) {
    const YarnSegment& s = yarns_.segments[k];
    if (!s.cut) {
      is_identity_[k] = is_identity(s, matrix);
      if (!is_identity_[k]) factor_whole(s, matrix);
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

template<class T>
void YarnFactor::solve_any(std::span<const T> b, std::span<T> x) const {
  auto& [here, owned] = std::get<KnotValues<T>>(knot_values_);
  here.resize(knots_.size());
  owned.resize(owned_.size());
  for (const YarnSegment& s : yarns_.segments) {
    if (!s.cut) continue;
    std::copy(b.begin() + s.begin, b.begin() + s.end, x.begin() + s.begin);
    eliminate_inside(s, x);
  }
  for (std::size_t k = 0; k < here.size(); ++k) here[k] = x[yarns_.knots[k]];
  yarns_.to_owner.begin_forward<T>(here);
  solve_uncut(b, x);
  yarns_.to_owner.end_forward<T>(owned);
  solve_knots<T>(owned);
  yarns_.to_owner.reverse<T>(owned, here);
  for (std::size_t k = 0; k < here.size(); ++k) x[yarns_.knots[k]] = here[k];
  for (const YarnSegment& s : yarns_.segments)
    if (s.cut) substitute_inside(s, x);
}

template<class T>
void YarnFactor::solve_uncut(std::span<const T> b, std::span<T> x) const {
  std::array<YarnSegment, 4> some; // more at a time are no faster
  std::size_t n = 0;
  for (std::size_t k = 0; k < yarns_.segments.size(); ++k) {
    const YarnSegment& s = yarns_.segments[k];
    if (is_identity_[k] && b.data() != x.data())
      std::copy(b.begin() + s.begin, b.begin() + s.end, x.begin() + s.begin);
    if (s.cut || is_identity_[k]) continue;
    some[n++] = s;
    if (n < some.size()) continue;
    solve_together(some, b, x);
    n = 0;
  }
  for (const YarnSegment& s : std::span(some).first(n)) solve_together(std::array{s}, b, x);
}

/// Edge by edge in turn: along one segment, every number has to wait for the one before it.
template<class T, std::size_t n>
void YarnFactor::solve_together(const std::array<YarnSegment, n>& segments, std::span<const T> b,
                                std::span<T> x) const {
  std::array<T, n> carried;
  const auto eliminate = [&](std::size_t j, Local i) { x[i] = carried[j] = b[i] - lower_[i] * carried[j]; };
  const auto substitute = [&](std::size_t j, Local i) {
    x[i] = carried[j] = x[i] * inverse_diagonal_[i] - lower_[i + 1] * carried[j];
  };
  Local shortest = segments[0].size();
  for (const YarnSegment& s : segments) shortest = std::min(shortest, s.size());

  for (std::size_t j = 0; j < n; ++j) x[segments[j].begin] = carried[j] = b[segments[j].begin];
  for (Local k = 1; k < shortest; ++k)
    for (std::size_t j = 0; j < n; ++j) eliminate(j, segments[j].begin + k);
  for (std::size_t j = 0; j < n; ++j)
    for (Local i = segments[j].begin + shortest; i < segments[j].end; ++i) eliminate(j, i);

  for (std::size_t j = 0; j < n; ++j) {
    const Local last = segments[j].end - 1;
    x[last] = carried[j] = x[last] * inverse_diagonal_[last];
  }
  for (Local k = 2; k <= shortest; ++k)
    for (std::size_t j = 0; j < n; ++j) substitute(j, segments[j].end - k);
  for (std::size_t j = 0; j < n; ++j)
    for (Local i = segments[j].end - shortest; i-- > segments[j].begin;) substitute(j, i);
}

template<class T>
void YarnFactor::eliminate_inside(const YarnSegment& s, std::span<T> x) const {
  for (Local i = s.begin + 1; i < s.end - 1; ++i) {
    x[s.begin] -= to_begin_[i] * x[i];
    x[i + 1] -= lower_[i + 1] * x[i];
  }
}

template<class T>
void YarnFactor::substitute_inside(const YarnSegment& s, std::span<T> x) const {
  for (Local i = s.end - 2; i > s.begin; --i)
    x[i] = x[i] * inverse_diagonal_[i] - lower_[i + 1] * x[i + 1] - to_begin_[i] * x[s.begin];
}

template<class T>
void YarnFactor::solve_knots(std::span<T> values) const {
  if (values.empty()) return;
  for (std::size_t k = 1; k < values.size(); ++k) values[k] -= owned_[k].to_previous * values[k - 1];
  values.back() *= owned_.back().diagonal;
  for (std::size_t k = values.size() - 1; k-- > 0;)
    values[k] = values[k] * owned_[k].diagonal - owned_[k + 1].to_previous * values[k + 1];
}

template void YarnFactor::solve_any(std::span<const double> b, std::span<double> x) const;
template void YarnFactor::solve_any(std::span<const Vec3> b, std::span<Vec3> x) const;

} // namespace taut
