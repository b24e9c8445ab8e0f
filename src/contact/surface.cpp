#include "src/contact/surface.hpp"

#include <algorithm>
#include <tuple>

namespace taut {

namespace {

/// An element that could represent a feature: the vertex `low`, or the edge from `low` to `high`.
struct Claim {
  Global low, high; ///< original numbers; high = -1 for a vertex
  Global element;   ///< a number that does not depend on the partition
  Local local;      ///< the element's place on its rank
  std::int32_t bit; ///< in `represents`

  auto order() const { return std::tie(low, high, element); }
  bool same_feature(const Claim& other) const { return low == other.low && high == other.high; }
};

std::vector<Element> cut_into_elements(const DistributedMesh& mesh, std::vector<Global>& numbers) {
  std::vector<Element> elements;
  for (std::size_t c = 0; c < mesh.owned_cells.size(); ++c) {
    const LocalCell& cell = mesh.cells[mesh.owned_cells[c]];
    const auto& v = cell.vertices;
    const Global number = 2 * mesh.owned_cell_originals[c];
    if (cell.size() == 2)
      elements.push_back({{v[0], v[1], v[0]}, 2, 0, -1});
    else
      elements.push_back({{v[0], v[1], v[2]}, 3, 0, -1});
    numbers.push_back(number);
    if (cell.size() < 4) continue;
    elements.push_back({{v[0], v[2], v[3]}, 3, 0, -1});
    numbers.push_back(number + 1);
  }
  return elements;
}

void claim_features(const DistributedMesh& mesh, const Element& element, Global number, Local place,
                    std::vector<Claim>& claims) {
  const auto original = [&](Local v) { return mesh.vertices.original[v]; };
  for (int k = 0; k < element.corners; ++k)
    claims.push_back({original(element.vertices[k]), -1, number, place, k});
  for (int k = 0; k < (element.is_triangle() ? 3 : 1); ++k) {
    const Global a = original(element.vertices[k]), b = original(element.edge_end(k));
    claims.push_back({std::min(a, b), std::max(a, b), number, place, 3 + k});
  }
}

/// Of the claims to each feature the one of the lowest element is granted.
std::vector<Claim> granted(MPI_Comm comm, Global vertices, const std::vector<Claim>& claims) {
  std::vector<int> judge, claimant;
  for (const Claim& c : claims) judge.push_back(slab_rank(vertices, size_of(comm), c.low));
  const auto received = exchange(comm, claims, judge);

  std::vector<std::pair<Claim, int>> all;
  for (int r = 0; r < size_of(comm); ++r)
    for (Global i = received.offsets[r]; i < received.offsets[r + 1]; ++i)
      all.emplace_back(received.items[i], r);
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.first.order() < b.first.order(); });
  std::vector<Claim> winners;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i > 0 && all[i].first.same_feature(all[i - 1].first)) continue;
    winners.push_back(all[i].first);
    claimant.push_back(all[i].second);
  }
  return exchange(comm, winners, claimant).items;
}

} // namespace

std::vector<Element> cloth_elements(const DistributedMesh& mesh) {
  std::vector<Global> numbers;
  std::vector<Element> elements = cut_into_elements(mesh, numbers);
  std::vector<Claim> claims;
  for (std::size_t i = 0; i < elements.size(); ++i)
    claim_features(mesh, elements[i], numbers[i], Local(i), claims);
  for (const Claim& c : granted(mesh.comm, mesh.vertices.total, claims))
    elements[c.local].represents |= std::uint8_t(1u << c.bit);
  std::stable_sort(elements.begin(), elements.end(),
                   [](const Element& a, const Element& b) { return a.vertices[0] < b.vertices[0]; });
  return elements;
}

} // namespace taut
