#include "partition/mesh_check.hpp"

#include "partition/fetch.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace taut {

namespace {

struct Placed {
  Vec3 position;
  Global line;
};

std::optional<std::string> zero_length(const MeshSlab& mesh, const Cell& cell,
                                       std::span<const Placed> corners) {
  const std::size_t n = corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t a = k, b = (k + 1) % n;
    if ((corners[a].position - corners[b].position).norm() > 0) continue;
    if (cell.vertices[a] > cell.vertices[b]) std::swap(a, b);
    return fmt::format(
        "{}: vertex {} lies exactly on vertex {}{}, with which it shares an edge: the edge has zero "
        "length; merge the two vertices",
        place(mesh, corners[b].line), cell.vertices[b], cell.vertices[a],
        corners[a].line > 0 ? fmt::format(" (line {})", corners[a].line) : "");
  }
  return std::nullopt;
}

std::optional<std::string> no_area(const MeshSlab& mesh, std::size_t cell, std::span<const Placed> corners) {
  if (corners.size() == 2) return std::nullopt;
  const Vec3 &a = corners[0].position, &b = corners[1].position, &c = corners[2].position;
  const bool quad = corners.size() == 4;
  const Vec3 one = quad ? Vec3(c - a) : Vec3(b - a), two = quad ? Vec3(corners[3].position - b) : Vec3(c - a);
  constexpr double round_off = 1e-10;
  if (one.cross(two).norm() > round_off * (b - a).squaredNorm()) return std::nullopt;
  return fmt::format(
      "{}: this face (number {}) has no area: its corners lie on one line, or its sides cross; give its "
      "corners in order around it",
      place(mesh, mesh.cell_lines.empty() ? 0 : mesh.cell_lines[cell]), mesh.cells.first + Global(cell));
}

} // namespace

std::string place(const MeshSlab& mesh, Global line) {
  return line > 0 ? fmt::format("{}:{}", mesh.name, line) : mesh.name;
}

void check_cells(MPI_Comm comm, const MeshSlab& mesh) {
  std::vector<Placed> own(mesh.rest_positions.size());
  for (std::size_t i = 0; i < own.size(); ++i)
    own[i] = {mesh.rest_positions[i], mesh.vertex_lines.empty() ? 0 : mesh.vertex_lines[i]};
  std::vector<Global> wanted;
  for (const Cell& c : mesh.cell)
    wanted.insert(wanted.end(), c.vertices.begin(), c.vertices.begin() + c.size());
  const auto placed = fetch<Placed>(comm, mesh.vertices, own, wanted);

  std::optional<std::string> fault;
  std::size_t first = 0;
  for (std::size_t c = 0; c < mesh.cell.size() && !fault; ++c) {
    const auto corners = std::span(placed).subspan(first, mesh.cell[c].size());
    fault = zero_length(mesh, mesh.cell[c], corners);
    if (!fault) fault = no_area(mesh, c, corners);
    first += corners.size();
  }
  agree(comm, fault);
}

} // namespace taut
