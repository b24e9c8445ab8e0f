#include "src/garment/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace taut::garment {

namespace {

/// The points of a lattice around an outline: which are clear inside it, and which squares between them are
/// kept.
class Sieve {
public:
  Sieve(std::span<const Vec2> outline, double spacing) : outline_(outline), spacing_(spacing) {
    Vec2 low = outline[0], high = outline[0];
    for (const Vec2& p : outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
    for (int k : {0, 1}) {
      first_[k] = std::int64_t(std::floor(low[k] / spacing));
      count_[k] = int(std::int64_t(std::ceil(high[k] / spacing)) - first_[k] + 1);
    }
    clear_.assign(std::size_t(count_[0]) * count_[1], 0);
    mark_inside();
    for (std::size_t s = 0; s < outline.size(); ++s) drop_near(outline[s], outline[(s + 1) % outline.size()]);
    keep_squares();
    while (part_corners()) {
    }
  }

  Lattice collect() const {
    Lattice lattice;
    std::vector<int> number(clear_.size(), -1);
    for (int j = 0; j < count_[1]; ++j)
      for (int i = 0; i < count_[0]; ++i) {
        if (!clear_[at(i, j)]) continue;
        if (kept(i, j) || kept(i - 1, j) || kept(i, j - 1) || kept(i - 1, j - 1)) {
          number[at(i, j)] = int(lattice.points.size());
          lattice.points.push_back(place(i, j));
        } else {
          lattice.loose.push_back(place(i, j));
        }
      }
    std::vector<int> next(lattice.points.size(), -1); // along the rings
    for (int j = 0; j + 1 < count_[1]; ++j)
      for (int i = 0; i + 1 < count_[0]; ++i) {
        if (!kept(i, j)) continue;
        const int a = number[at(i, j)], b = number[at(i + 1, j)], c = number[at(i + 1, j + 1)],
                  d = number[at(i, j + 1)];
        lattice.quads.push_back({a, b, c, d});
        if (!kept(i, j - 1)) next[a] = b;
        if (!kept(i + 1, j)) next[b] = c;
        if (!kept(i, j + 1)) next[c] = d;
        if (!kept(i - 1, j)) next[d] = a;
      }
    for (int start = 0; start < int(next.size()); ++start) {
      if (next[start] < 0) continue;
      auto& ring = lattice.rings.emplace_back();
      for (int p = start; next[p] >= 0;) {
        ring.push_back(p);
        p = std::exchange(next[p], -1);
      }
    }
    return lattice;
  }

private:
  std::size_t at(int i, int j) const { return std::size_t(j) * count_[0] + i; }
  Vec2 place(int i, int j) const {
    return {double(first_[0] + i) * spacing_, double(first_[1] + j) * spacing_};
  }
  bool kept(int i, int j) const {
    return i >= 0 && j >= 0 && i + 1 < count_[0] && j + 1 < count_[1] && square_[at(i, j)];
  }

  /// A point is inside if a line from it to the left crosses the outline an odd number of times.
  void mark_inside() {
    std::vector<std::vector<double>> crossings(count_[1]);
    for (std::size_t s = 0; s < outline_.size(); ++s) {
      Vec2 a = outline_[s], b = outline_[(s + 1) % outline_.size()];
      if (a[1] > b[1]) std::swap(a, b);
      for (int j = std::max(0, int(std::floor(a[1] / spacing_) - double(first_[1]))); j < count_[1]; ++j) {
        const double y = place(0, j)[1];
        if (y >= b[1]) break;
        if (y >= a[1]) crossings[j].push_back(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
      }
    }
    for (int j = 0; j < count_[1]; ++j) {
      auto& row = crossings[j];
      std::ranges::sort(row);
      std::size_t passed = 0;
      for (int i = 0; i < count_[0]; ++i) {
        while (passed < row.size() && row[passed] < place(i, j)[0]) ++passed;
        clear_[at(i, j)] = passed % 2;
      }
    }
  }

  void drop_near(const Vec2& a, const Vec2& b) {
    const Vec2 run = b - a;
    const double length = run.norm(),
                 clearance = spacing_ * (0.6 + 0.6 * std::max(0.0, 1 - 1.25 * length / spacing_));
    const Vec2 low = a.cwiseMin(b).array() - clearance, high = a.cwiseMax(b).array() + clearance;
    const auto index = [&](const Vec2& p, int k) {
      return int(std::floor(p[k] / spacing_) - double(first_[k]));
    };
    for (int j = std::max(0, index(low, 1)); j <= std::min(count_[1] - 1, index(high, 1) + 1); ++j)
      for (int i = std::max(0, index(low, 0)); i <= std::min(count_[0] - 1, index(high, 0) + 1); ++i) {
        const Vec2 p = place(i, j);
        const double along = std::clamp((p - a).dot(run) / (length * length), 0.0, 1.0);
        if ((a + along * run - p).norm() < clearance) clear_[at(i, j)] = 0;
      }
  }

  void keep_squares() {
    square_.assign(clear_.size(), 0);
    for (int j = 0; j + 1 < count_[1]; ++j)
      for (int i = 0; i + 1 < count_[0]; ++i)
        square_[at(i, j)] =
            clear_[at(i, j)] && clear_[at(i + 1, j)] && clear_[at(i, j + 1)] && clear_[at(i + 1, j + 1)];
  }

  /// Drops one of two squares that share just a corner; says whether there were any.
  bool part_corners() {
    bool parted = false;
    for (int j = 1; j + 1 < count_[1]; ++j)
      for (int i = 1; i + 1 < count_[0]; ++i) {
        const bool a = kept(i - 1, j - 1), b = kept(i, j - 1), c = kept(i, j), d = kept(i - 1, j);
        if (a != c || b != d || a == b) continue;
        square_[a ? at(i, j) : at(i - 1, j)] = 0;
        parted = true;
      }
    return parted;
  }

  std::span<const Vec2> outline_;
  double spacing_;
  std::array<std::int64_t, 2> first_;
  std::array<int, 2> count_;
  std::vector<std::uint8_t> clear_, square_; ///< of each point; of each square, by its lower left corner
};

} // namespace

Lattice lattice_in(std::span<const Vec2> outline, double spacing) {
  return Sieve(outline, spacing).collect();
}

} // namespace taut::garment
