#include "src/garment/panel_mesh.hpp"

#include "src/garment/lattice.hpp"
#include "src/garment/plane.hpp"
#include "src/garment/polygon.hpp"
#include "src/garment/triangulation.hpp"

#include <set>
#include <utility>

namespace taut::garment {

namespace {

/// What triangles should not be sharper than; where nothing helps, they are.
constexpr double target_angle = 27 * degree;

/// The triangles that lie outside the rings; nothing if an edge of a ring is none of the triangulation.
std::optional<std::vector<std::array<int, 3>>> outside(const Triangulation& all,
                                                       const std::vector<std::vector<int>>& rings) {
  std::set<std::pair<int, int>> border; // with the inside on the left
  for (const auto& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) border.emplace(ring[i], ring[(i + 1) % ring.size()]);
  const auto side = [&](int t, int k) {
    const auto& v = all.triangles()[t].vertices;
    return std::pair(v[(k + 1) % 3], v[(k + 2) % 3]);
  };
  std::vector<char> inside(all.triangles().size(), 0);
  std::vector<int> front;
  std::size_t found = 0;
  const auto enter = [&](int t) {
    if (!std::exchange(inside[t], 1)) front.push_back(t);
  };
  for (int t = 0; t < int(inside.size()); ++t)
    for (int k = 0; k < 3; ++k)
      if (border.contains(side(t, k))) ++found, enter(t);
  while (!front.empty()) {
    const int t = front.back();
    front.pop_back();
    for (int k = 0; k < 3; ++k)
      if (const int n = all.triangles()[t].neighbours[k]; n >= 0 && !border.contains(side(t, k))) enter(n);
  }
  if (found != border.size()) return std::nullopt;
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t t = 0; t < inside.size(); ++t)
    if (!inside[t]) triangles.push_back(all.triangles()[t].vertices);
  return triangles;
}

/// Between the outline and the squares. Its points: those of the outline, then those of the rings in order,
/// then others. No circle around a square holds a point of the outline, from which its corners keep 0.6 h, so
/// that the sides of all squares are Delaunay edges and come out of their own.
std::optional<Triangulation> fill_band(std::span<const Vec2> outline, const Lattice& lattice) {
  const auto triangles = triangulate({outline.begin(), outline.end()});
  if (!triangles) return std::nullopt;
  Triangulation whole({outline.begin(), outline.end()}, *triangles);
  whole.make_delaunay();
  std::vector<std::vector<int>> rings;
  for (const auto& ring : lattice.rings) {
    rings.emplace_back();
    for (const int p : ring) {
      rings.back().push_back(int(whole.points().size()));
      if (!whole.insert(lattice.points[p], 0)) return std::nullopt;
    }
  }
  const auto left = outside(whole, rings);
  if (!left) return std::nullopt;
  Triangulation band(whole.points(), *left);
  for (const Vec2& p : lattice.loose) band.insert(p, target_angle);
  band.refine(target_angle);
  return band;
}

} // namespace

std::optional<PanelMesh> mesh_panel(std::span<const Vec2> outline, double spacing) {
  const Lattice lattice = lattice_in(outline, spacing);
  const auto band = fill_band(outline, lattice);
  if (!band) return std::nullopt;
  PanelMesh mesh;
  mesh.points.assign(outline.begin(), outline.end());
  const int first = int(outline.size());
  mesh.points.insert(mesh.points.end(), lattice.points.begin(), lattice.points.end());
  std::vector<int> number; // of the points of the band in the mesh
  for (int i = 0; i < first; ++i) number.push_back(i);
  for (const auto& ring : lattice.rings)
    for (const int p : ring) number.push_back(first + p);
  for (std::size_t i = number.size(); i < band->points().size(); ++i) {
    number.push_back(int(mesh.points.size()));
    mesh.points.push_back(band->points()[i]);
  }
  for (const auto& quad : lattice.quads)
    mesh.cells.push_back({first + quad[0], first + quad[1], first + quad[2], first + quad[3]});
  for (const Triangle& t : band->triangles())
    mesh.cells.push_back({number[t.vertices[0]], number[t.vertices[1]], number[t.vertices[2]], -1});
  return mesh;
}

} // namespace taut::garment
