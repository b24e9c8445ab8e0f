#include "src/contact/body_meshes.hpp"

#include "io/mesh_file.hpp"
#include "src/config/require_file.hpp"
#include "src/config/up.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut {

namespace {

namespace fs = std::filesystem;

/// body_0001.obj, 3 -> body_0004.obj: the digits at the end of the name count on and keep their width. Empty
/// if there are none.
fs::path counted_on(const fs::path& first, int steps) {
  const std::string stem = first.stem().string();
  const std::size_t letters = stem.find_last_not_of("0123456789") + 1; // 0 if there are none
  const std::string digits = stem.substr(letters);
  if (digits.empty() || digits.size() > 9) return {};
  return first.parent_path() / fmt::format("{}{:0{}}{}", stem.substr(0, letters), std::stol(digits) + steps,
                                           digits.size(), first.extension().string());
}

bool same_faces(const WholeMesh& a, const WholeMesh& b) {
  return a.positions.size() == b.positions.size() &&
         std::equal(a.cells.begin(), a.cells.end(), b.cells.begin(), b.cells.end(),
                    [](const Cell& s, const Cell& t) { return s.vertices == t.vertices; });
}

} // namespace

std::vector<WholeMesh> meshes_of(MPI_Comm comm, const Case& input, int body) {
  const config::Obstacle& o = input.obstacles[body];
  std::vector<WholeMesh> meshes;
  for (int k = 0; k < (o.sequence ? o.sequence->frames : 1); ++k) {
    const fs::path file = o.sequence ? counted_on(*o.mesh, k) : *o.mesh;
    if (file.empty())
      throw InputError(
          fmt::format("{}: obstacles.{}.mesh: the first mesh of a sequence needs a name that ends in a "
                      "number, such as body_0001.obj; found '{}'",
                      input.file.string(), body, o.mesh->string()));
    config::require_file(comm, input, fmt::format("obstacles.{}.mesh", body), file);
    MeshSlab slab = read_mesh(comm, input.folder() / file, o.scale, Polygons::triangulate);
    config::turn_upright(o.up, slab.rest_positions);
    meshes.push_back(
        {slab.name, gather_to_all<Vec3>(comm, slab.rest_positions), gather_to_all<Cell>(comm, slab.cell)});
    if (!same_faces(meshes.front(), meshes.back()))
      throw InputError(
          fmt::format("{}: its vertices and faces are not those of {}; all meshes of a sequence need the "
                      "same, only in other places",
                      meshes.back().name, meshes.front().name));
  }
  return meshes;
}

} // namespace taut
