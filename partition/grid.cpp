#include "partition/grid.hpp"

namespace taut {

namespace {

MeshSlab slabs(MPI_Comm comm, const char* name, Global vertices, Global cells) {
  MeshSlab mesh;
  mesh.name = name;
  mesh.vertices = slab_of(vertices, size_of(comm), rank_of(comm));
  mesh.cells = slab_of(cells, size_of(comm), rank_of(comm));
  mesh.rest_positions.reserve(mesh.vertices.count);
  mesh.cell.reserve(mesh.cells.count);
  return mesh;
}

/// The first (0) or second (1) triangle of a rectangle.
Cell triangle_of(const std::array<Global, 4>& corners, Global half, GridCells cells, bool odd) {
  const bool from_second = cells == GridCells::alternating_triangles && odd; // the diagonal's first corner
  const auto& c = corners;
  if (from_second) return half == 0 ? Cell{{c[0], c[1], c[3], -1}} : Cell{{c[1], c[2], c[3], -1}};
  return half == 0 ? Cell{{c[0], c[1], c[2], -1}} : Cell{{c[0], c[2], c[3], -1}};
}

} // namespace

MeshSlab make_grid(MPI_Comm comm, Vec2 size, std::array<int, 2> vertices, GridCells cells) {
  const Global nx = vertices[0], ny = vertices[1], halves = cells == GridCells::quads ? 1 : 2;
  MeshSlab mesh = slabs(comm, "grid", nx * ny, halves * (nx - 1) * (ny - 1));
  const double dx = size[0] / double(nx - 1), dy = size[1] / double(ny - 1);
  for (Global v = mesh.vertices.first; v < mesh.vertices.first + mesh.vertices.count; ++v) {
    const Global row = v / nx, column = v % nx;
    mesh.rest_positions.emplace_back(double(column) * dx, double(row) * dy, 0.0);
  }
  for (Global c = mesh.cells.first; c < mesh.cells.first + mesh.cells.count; ++c) {
    const Global row = c / halves / (nx - 1), column = c / halves % (nx - 1), corner = row * nx + column;
    const std::array<Global, 4> corners{corner, corner + 1, corner + nx + 1, corner + nx};
    mesh.cell.push_back(halves == 1 ? Cell{corners}
                                    : triangle_of(corners, c % 2, cells, (row + column) % 2 == 1));
  }
  return mesh;
}

MeshSlab make_line(MPI_Comm comm, double length, Global vertices) {
  MeshSlab mesh = slabs(comm, "line", vertices, vertices - 1);
  const double dx = length / double(vertices - 1);
  for (Global v = mesh.vertices.first; v < mesh.vertices.first + mesh.vertices.count; ++v)
    mesh.rest_positions.emplace_back(double(v) * dx, 0.0, 0.0);
  for (Global c = mesh.cells.first; c < mesh.cells.first + mesh.cells.count; ++c)
    mesh.cell.push_back({{c, c + 1, -1, -1}});
  return mesh;
}

} // namespace taut
