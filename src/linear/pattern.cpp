#include "src/linear/pattern.hpp"

#include "partition/sort_unique.hpp"
#include "partition/triangle_hinges.hpp"

#include <limits>
#include <stdexcept>

namespace taut {

namespace {

using Coupling = std::pair<Local, Local>; ///< row, column

void append_pairs(std::span<const Local> vertices, Local owned, std::vector<Coupling>& couplings) {
  for (const Local a : vertices)
    if (a < owned)
      for (const Local b : vertices) couplings.emplace_back(a, b);
}

} // namespace

Pattern::Pattern(const DistributedMesh& mesh) {
  const Local owned = mesh.vertices.owned;
  std::vector<Coupling> couplings;
  couplings.reserve(16 * mesh.cells.size() + 9 * mesh.triples.size());
  for (const LocalCell& c : mesh.cells)
    append_pairs({c.vertices.data(), std::size_t(c.size())}, owned, couplings);
  if (!mesh.triangles_only) // where they are yarns, and bend
    for (const auto& t : mesh.triples) append_pairs(t, owned, couplings);
  for (const Hinge& h : mesh.hinges) append_pairs(vertices_of(h), owned, couplings);
  for (const TrianglePatch& p : triangle_patches(mesh)) append_pairs(p.vertices, owned, couplings);
  for (const auto* pairs : {&mesh.seams, &mesh.ties})
    for (const auto& pair : *pairs) append_pairs(pair, owned, couplings);
  sort_unique(couplings);
  if (couplings.size() > std::size_t(std::numeric_limits<std::int32_t>::max()))
    throw std::runtime_error("this rank's part of the mesh is too large: use more ranks");

  columns_.reserve(couplings.size());
  offsets_.reserve(owned + 1);
  auto next = couplings.begin();
  for (Local row = 0; row < owned; ++row) {
    for (; next != couplings.end() && next->first == row; ++next) columns_.push_back(next->second);
    offsets_.push_back(std::int64_t(columns_.size()));
    diagonal_.push_back(std::int32_t(slot(row, row)));
  }
}

std::int64_t Pattern::slot(Local row, Local column) const {
  if (row + 1 >= Local(offsets_.size())) return -1;
  const auto begin = columns_.begin() + offsets_[row], end = columns_.begin() + offsets_[row + 1];
  return std::lower_bound(begin, end, column) - columns_.begin();
}

std::uint16_t Pattern::slot_in_row(Local row, Local column) const {
  const std::int64_t place = slot(row, column) - offsets_[row];
  if (place > std::numeric_limits<std::uint16_t>::max())
    throw std::runtime_error("a vertex of the mesh has more than 65 535 neighbours");
  return std::uint16_t(place);
}

} // namespace taut
