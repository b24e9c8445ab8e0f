#include "partition/near_vertices.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace taut {

namespace {

using SpaceCell = std::array<std::int64_t, 3>;

/// A vertex in a cell of space that it is in, or so near that vertices there may be near it.
struct Visitor {
  SpaceCell cell;
  Global vertex;
  Vec3 position;
  std::int64_t lives_here;
};

struct NearPair {
  Global vertex, other;
  auto operator<=>(const NearPair&) const = default;
};

/// What is out of all bounds, or no number, is told elsewhere.
std::int64_t whole(double x) { return std::abs(x) < 1e15 ? std::int64_t(std::floor(x)) : 0; }

SpaceCell cell_of(const Vec3& place, double side) {
  return {whole(place[0] / side), whole(place[1] / side), whole(place[2] / side)};
}

int rank_for(const SpaceCell& cell, int ranks) {
  std::uint64_t hash = 0;
  for (const std::int64_t part : cell) hash = (hash ^ std::uint64_t(part)) * 0x9e3779b97f4a7c15u;
  return int((hash ^ hash >> 32) % std::uint64_t(ranks));
}

constexpr double side_of_cells = 4; ///< reaches: a vertex visits eight at most, three on the mean

std::vector<Visitor> visitors(MPI_Comm comm, const Slab& slab, std::span<const Vec3> positions,
                              double reach) {
  std::vector<Visitor> sent;
  std::vector<int> to;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 around = Vec3::Constant(reach);
    const double side = side_of_cells * reach;
    const SpaceCell home = cell_of(positions[i], side), low = cell_of(positions[i] - around, side),
                    high = cell_of(positions[i] + around, side);
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const SpaceCell cell{x, y, z};
          sent.push_back({cell, slab.first + Global(i), positions[i], cell == home});
          to.push_back(rank_for(cell, size_of(comm)));
        }
  }
  return exchange(comm, sent, to).items;
}

void append_pairs(std::span<const Visitor> in_cell, double reach, std::vector<NearPair>& pairs) {
  for (const Visitor& a : in_cell)
    for (const Visitor& b : in_cell)
      if (a.lives_here && a.vertex != b.vertex && (a.position - b.position).squaredNorm() < reach * reach)
        pairs.push_back({a.vertex, b.vertex});
}

} // namespace

NearVertices find_near(MPI_Comm comm, const Slab& slab, std::span<const Vec3> positions, double reach) {
  std::vector<Visitor> here = visitors(comm, slab, positions, reach);
  std::sort(here.begin(), here.end(), [](const Visitor& a, const Visitor& b) { return a.cell < b.cell; });
  std::vector<NearPair> found;
  for (auto first = here.begin(); first != here.end();) {
    const auto last =
        std::find_if(first, here.end(), [&](const Visitor& v) { return v.cell != first->cell; });
    append_pairs({first, last}, reach, found);
    first = last;
  }
  std::vector<int> to;
  for (const NearPair& p : found) to.push_back(slab_rank(slab.total, size_of(comm), p.vertex));
  std::vector<NearPair> mine = exchange(comm, found, to).items;
  std::sort(mine.begin(), mine.end());
  NearVertices near{std::vector<std::size_t>(std::size_t(slab.count) + 1, 0), {}};
  for (const NearPair& p : mine) {
    ++near.begin[p.vertex - slab.first + 1];
    near.others.push_back(p.other);
  }
  std::partial_sum(near.begin.begin(), near.begin.end(), near.begin.begin());
  return near;
}

} // namespace taut
