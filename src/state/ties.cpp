#include "src/state/ties.hpp"

#include "partition/fetch.hpp"
#include "src/state/labelled.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut {

namespace {

/// To each of `from` the nearest of `to` in the rest shape.
std::vector<std::array<Global, 2>> nearest_pairs(MPI_Comm comm, const MeshSlab& mesh,
                                                 const std::vector<Global>& from,
                                                 const std::vector<Global>& to) {
  const auto from_places = fetch<Vec3>(comm, mesh.vertices, mesh.rest_positions, from),
             to_places = fetch<Vec3>(comm, mesh.vertices, mesh.rest_positions, to);
  std::vector<std::array<Global, 2>> pairs;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto nearest =
        std::min_element(to_places.begin(), to_places.end(), [&](const Vec3& a, const Vec3& b) {
          return (a - from_places[i]).squaredNorm() < (b - from_places[i]).squaredNorm();
        });
    pairs.push_back({from[i], to[std::size_t(nearest - to_places.begin())]});
  }
  return pairs;
}

} // namespace

void find_ties(MPI_Comm comm, const Case& input, UndistributedCloth& cloth) {
  const MeshSlab& mesh = cloth.mesh.slab;
  for (std::size_t k = 0; k < input.attachments.size(); ++k) {
    const config::Attachment& a = input.attachments[k];
    const auto key = [&](const char* name) {
      return fmt::format("{}: attachments.{}.{}", input.file.string(), k, name);
    };
    std::vector<std::array<Global, 2>> pairs;
    if (a.vertices) pairs.push_back({(*a.vertices)[0], (*a.vertices)[1]});
    if (a.to)
      pairs = nearest_pairs(comm, mesh, labelled(cloth.pieces, *a.label, key("label")),
                            labelled(cloth.pieces, *a.to, key("to")));
    for (const auto& [one, two] : pairs) {
      if (std::max(one, two) >= mesh.vertices.total)
        throw InputError(fmt::format("{}: there is no vertex {}: the cloth has {} vertices, numbered from 0",
                                     key("vertices"), std::max(one, two), mesh.vertices.total));
      if (one == two)
        throw InputError(fmt::format("{}: vertex {} has this label too, and cannot be drawn to itself; give "
                                     "labels that share no vertex",
                                     key("to"), one));
      cloth.ties.push_back({{one, two}, k});
    }
  }
}

} // namespace taut
