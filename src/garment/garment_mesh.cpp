#include "src/garment/garment_mesh.hpp"

#include "io/scatter.hpp"
#include "partition/error.hpp"
#include "partition/sort_unique.hpp"
#include "src/garment/panel_mesh.hpp"
#include "src/garment/plane.hpp"
#include "src/garment/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace taut::garment {

namespace {

constexpr double least_angle = 15 * degree;

/// Panel and material coordinates.
class MaterialFrame {
public:
  explicit MaterialFrame(const Panel& panel)
      : origin_(start_of(panel.edges[0].curve)), warp_(-std::sin(panel.grain), std::cos(panel.grain)),
        weft_(warp_[1], -warp_[0]) {
    if (signed_area(panel) < 0) weft_ = -weft_; // seen from the other side
  }
  Vec2 to_material(const Vec2& p) const { return {(p - origin_).dot(weft_), (p - origin_).dot(warp_)}; }
  Vec2 to_panel(const Vec2& m) const { return origin_ + m[0] * weft_ + m[1] * warp_; }

private:
  Vec2 origin_, warp_, weft_;
};

[[noreturn]] void fail(const Panel& panel, const std::string& what) {
  throw InputError(fmt::format("{}: panel '{}' {}", panel.place, panel.name, what));
}

std::string at(const Vec2& place) {
  return fmt::format("at ({:.4f}, {:.4f}) m of its plane", place[0], place[1]);
}

/// Before anything is made that would not fit.
void check_size(const SewingPattern& pattern, const EdgeLengths& lengths) {
  constexpr double most = 2e8;
  double vertices = 0;
  for (const Panel& p : pattern.panels) {
    const double h = edge_length_of(lengths, p);
    vertices += std::abs(signed_area(p)) / (h * h);
    for (const PatternEdge& e : p.edges) vertices += length_of(e.curve) / h;
  }
  if (!(vertices < most))
    throw InputError(
        fmt::format("{}: its mesh would have about {:.2g} vertices, more than one rank can make ({:.0g}); "
                    "give longer edges",
                    pattern.name, vertices, most));
}

/// Widths are measured on the polygon that is meshed.
void check_outline(const Panel& panel, const Outline& outline, double h) {
  if (const auto fault = fault_of_ring(outline.points))
    fail(panel,
         fmt::format(
             "is too narrow, or curves too tightly, for edges of {:.4g} mm: cut into such, its outline "
             "crosses itself {}; give it shorter ones, e.g. edge: {:.3g} mm",
             1000 * h, at(fault->place), 500 * h));
  const double width = 2 * inscribed_radius(outline.points, h / 50);
  if (width < h * 0.95)
    fail(panel, fmt::format(
                    "is thinner than an edge: nowhere wider than {:.3g} mm, with edges of {:.4g} mm; give it "
                    "shorter ones, e.g. edge: {:.3g} mm",
                    1000 * width, 1000 * h, 500 * width));
}

void add_panel(GarmentMesh& all, const Panel& panel, const Outline& outline, double h) {
  check_outline(panel, outline, h);
  const MaterialFrame frame(panel);
  std::vector<Vec2> ring;
  for (const Vec2& p : outline.points) ring.push_back(frame.to_material(p));
  const auto mesh = mesh_panel(ring, h);
  if (!mesh)
    fail(panel, fmt::format("cannot be meshed with edges of {:.4g} mm; give it shorter ones", 1000 * h));
  MeshedPanel made{panel.name, h, std::abs(signed_area(panel))};
  made.outline = outline;
  made.first_vertex = Global(all.positions.size());
  made.first_cell = Global(all.cells.size());
  made.vertices = Global(mesh->points.size());
  made.cells = Global(mesh->cells.size());
  for (const Vec2& m : mesh->points) {
    const Vec2 p = frame.to_panel(m);
    all.material.push_back(m);
    all.positions.push_back(panel.rotation * Vec3(p[0], p[1], 0) + panel.translation);
  }
  for (const auto& c : mesh->cells) {
    Cell& cell = all.cells.emplace_back();
    for (int k = 0; k < 4 && c[k] >= 0; ++k) cell.vertices[k] = made.first_vertex + c[k];
    made.triangles += cell.size() == 3;
  }
  const auto [all_places, elsewhere] = sharpness_of(*mesh, ring.size(), outline.first, h);
  if (elsewhere.angle < least_angle)
    fail(panel, fmt::format(
                    "is too narrow for edges of {:.4g} mm {}, where a triangle would have an angle of {:.1f} "
                    "degrees; widen it there, or give it shorter edges, e.g. edge: {:.2g} mm",
                    1000 * h, at(frame.to_panel(elsewhere.place)), elsewhere.angle / degree, 300 * h));
  made.sharpest = {all_places.angle, frame.to_panel(all_places.place)};
  all.panels.push_back(std::move(made));
}

/// Of edges that were too short for the mesh (short_edges.hpp).
void warn_of_points(GarmentMesh& all, const SewingPattern& pattern) {
  std::vector<SeamSide> points;
  for (int p = 0; p < int(pattern.panels.size()); ++p)
    for (int e = 0; e < int(pattern.panels[p].edges.size()); ++e)
      if (all.panels[p].outline.of_edge(e).size() == 1) points.push_back({p, e});
  if (points.empty()) return;
  const auto [panel, edge] = points.front();
  const bool many = points.size() > 1;
  all.warnings.push_back(fmt::format(
      "{}: {} ({:.2g} mm){} shorter than a quarter of the mesh's edges and {} of it; shorter edges keep {}",
      pattern.name, name_of(pattern, points.front()),
      1000 * length_of(pattern.panels[panel].edges[edge].curve),
      many ? fmt::format(" and {} more are", points.size() - 1) : " is",
      many ? "become points" : "becomes a point", many ? "them" : "it"));
}

void add_seams(GarmentMesh& all, const SewingPattern& pattern) {
  for (const Seam& seam : pattern.seams) {
    MeshedSeam made{name_of(pattern, seam), {}, {}};
    std::array<std::vector<int>, 2> sides;
    for (int k : {0, 1}) {
      const auto [panel, edge] = seam.sides[k];
      made.lengths[k] = length_of(pattern.panels[panel].edges[edge].curve);
      sides[k] = all.panels[panel].outline.of_edge(edge);
    }
    if (seam.direction == SeamDirection::start_to_end) std::ranges::reverse(sides[1]);
    for (std::size_t i = 0; i < sides[0].size(); ++i) {
      const Global a = all.panels[seam.sides[0].panel].first_vertex + sides[0][i],
                   b = all.panels[seam.sides[1].panel].first_vertex + sides[1][i];
      if (a != b) made.pairs.push_back({a, b}); // the tip of a dart is one vertex
    }
    const auto [shorter, longer] = std::minmax(made.lengths[0], made.lengths[1]);
    if (longer > 2 * shorter)
      all.warnings.push_back(
          fmt::format("{}: seam {} joins edges of {:.4g} m and {:.4g} m, gathered {:.1f} : 1; if that "
                      "is not meant, correct panel or edge of the stitch",
                      seam.place, made.name, made.lengths[0], made.lengths[1], longer / shorter));
    all.seams.push_back(std::move(made));
  }
}

/// The vertex nearest to a point of the pattern.
Global vertex_at(const GarmentMesh& mesh, const MeshedPanel& meshed, const Panel& panel,
                 const PatternPoint& point) {
  const Vec2 place = MaterialFrame(panel).to_material(point.at);
  Global nearest = meshed.first_vertex;
  const auto distance = [&](Global v) { return (mesh.material[v] - place).norm(); };
  for (Global v = meshed.first_vertex; v < meshed.first_vertex + meshed.vertices; ++v)
    if (distance(v) < distance(nearest)) nearest = v;
  if (distance(nearest) > meshed.edge_length)
    throw InputError(
        fmt::format("{}: panel '{}': point '{}' lies {:.3g} mm outside of the panel; move it into the "
                    "panel",
                    point.place, panel.name, point.label, 1000 * distance(nearest)));
  return nearest;
}

void add_labels(GarmentMesh& all, const SewingPattern& pattern) {
  std::map<std::string, std::set<Global>> labels;
  for (std::size_t p = 0; p < pattern.panels.size(); ++p) {
    const Panel& panel = pattern.panels[p];
    const MeshedPanel& meshed = all.panels[p];
    for (std::size_t e = 0; e < panel.edges.size(); ++e)
      if (const std::string& label = panel.edges[e].label; !label.empty())
        for (const int v : meshed.outline.of_edge(int(e))) labels[label].insert(meshed.first_vertex + v);
    for (const PatternPoint& point : panel.points)
      labels[point.label].insert(vertex_at(all, meshed, panel, point));
    if (!panel.label.empty())
      for (Global v = 0; v < meshed.vertices; ++v) labels[panel.label].insert(meshed.first_vertex + v);
  }
  for (const auto& [label, vertices] : labels) all.labels[label].assign(vertices.begin(), vertices.end());
}

} // namespace

GarmentMesh mesh_garment(const SewingPattern& pattern, const EdgeLengths& lengths) {
  check_edge_lengths(lengths, pattern);
  check_size(pattern, lengths);
  const auto outlines = sample_outlines(pattern, lengths);
  GarmentMesh mesh;
  for (std::size_t p = 0; p < pattern.panels.size(); ++p)
    add_panel(mesh, pattern.panels[p], outlines[p], edge_length_of(lengths, pattern.panels[p]));
  warn_of_points(mesh, pattern);
  add_seams(mesh, pattern);
  add_labels(mesh, pattern);
  return mesh;
}

Corners2 texture_of(const GarmentMesh& mesh, const Cell& cell) {
  Corners2 corners;
  for (int k = 0; k < 4; ++k) {
    const Global v = cell.vertices[k];
    corners[k] = v < 0 ? Vec2::Zero().eval() : Vec2(mesh.material[v][1], -mesh.material[v][0]);
  }
  return corners;
}

NamedParts parts_of(const GarmentMesh& mesh) {
  NamedParts parts{{}, {}, mesh.labels};
  for (const MeshedPanel& p : mesh.panels) parts.panels.push_back({p.name, p.first_cell});
  for (const MeshedSeam& seam : mesh.seams) {
    auto& [name, vertices] = parts.seams.emplace_back(NamedSeam{seam.name, {}});
    for (const auto& pair : seam.pairs) vertices.insert(vertices.end(), pair.begin(), pair.end());
    sort_unique(vertices);
  }
  return parts;
}

MeshSlab share_out(MPI_Comm comm, const GarmentMesh& mesh, const std::string& name) {
  std::array<Global, 2> totals{Global(mesh.positions.size()), Global(mesh.cells.size())};
  MPI_Bcast(totals.data(), 2, MPI_INT64_T, 0, comm);
  const bool root = rank_of(comm) == 0;
  std::vector<Corners2> texture;
  if (root)
    for (const Cell& c : mesh.cells) texture.push_back(texture_of(mesh, c));
  MeshSlab slab;
  slab.name = name;
  slab.vertices = slab_of(totals[0], size_of(comm), rank_of(comm));
  slab.cells = slab_of(totals[1], size_of(comm), rank_of(comm));
  slab.rest_positions = scatter_slabs(comm, root ? mesh.positions : std::vector<Vec3>(), slab.vertices);
  slab.cell = scatter_slabs(comm, root ? mesh.cells : std::vector<Cell>(), slab.cells);
  slab.texture = scatter_slabs(comm, texture, slab.cells);
  return slab;
}

} // namespace taut::garment
