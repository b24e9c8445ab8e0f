#include "src/state/start.hpp"

#include "io/mesh_file.hpp"
#include "io/scatter.hpp"
#include "partition/grid.hpp"
#include "partition/mesh_check.hpp"
#include "partition/partitioner.hpp"
#include "src/config/cloths.hpp"
#include "src/config/methods.hpp"
#include "src/config/require_file.hpp"
#include "src/config/suggest.hpp"
#include "src/config/up.hpp"
#include "src/garment/load_garment.hpp"
#include "src/garment/sewn_mesh.hpp"
#include "src/state/ties.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

namespace taut {

namespace {

config::UpAxis up_of(const config::Cloth& cloth) {
  return cloth.up.value_or(cloth.pattern ? config::UpAxis::y : config::UpAxis::z);
}

struct NamedMesh {
  MeshSlab slab;
  garment::NamedParts parts;
  std::vector<std::string> warnings{}; ///< on rank 0
};

/// Of a garment that is not to be sewn: what is elastic is so from the start.
std::vector<Corners2> rest_shape_of(garment::Garment garment,
                                    std::span<const garment::ShorterSides> shorter) {
  garment.mesh.seams.clear();
  return garment::sew(garment.mesh, garment.mesh.positions, garment.name, shorter).rest_shape;
}

NamedMesh load_pattern(MPI_Comm comm, const Case& input, std::size_t k) {
  const config::Cloth& cloth = input.cloths[k];
  const auto garment = garment::load_garment(comm, input, k);
  std::vector<Corners2> rest_shape;
  on_rank_0(comm, [&] {
    const auto shorter = garment::shorter_sides(garment.mesh, input, k);
    if (!shorter.empty()) rest_shape = rest_shape_of(garment, shorter);
  });
  const auto joints = input.sewing ? garment::Joints::of_seams : garment::Joints::none;
  NamedMesh named{garment::share_out(comm, garment, joints),
                  garment::share(comm, garment::parts_of(garment.mesh)), garment.mesh.warnings};
  if (!input.sewing && !cloth.elastic.empty())
    named.slab.rest_shape = scatter_slabs(comm, rest_shape, named.slab.cells);
  return named;
}

NamedMesh load_mesh(MPI_Comm comm, const Case& input, std::size_t k) {
  const config::Cloth& cloth = input.cloths[k];
  const auto require = [&](const char* key, const std::optional<std::filesystem::path>& file) {
    if (file) config::require_file(comm, input, config::key_of_cloth(input, k) + key, *file);
  };
  require(".mesh", cloth.mesh);
  require(".pattern", cloth.pattern);
  require(".start.shape", cloth.start.shape);
  if (cloth.grid)
    return {make_grid(comm, cloth.grid->size, cloth.grid->vertices, GridCells(cloth.grid->cells)), {}};
  if (cloth.line) return {make_line(comm, cloth.line->length, cloth.line->vertices), {}};
  const auto file = input.folder() / cloth.mesh.value_or("");
  NamedMesh mesh = cloth.pattern ? load_pattern(comm, input, k)
                                 : NamedMesh{read_mesh(comm, file, cloth.scale, Polygons::refuse),
                                             garment::read_named_parts(comm, file)};
  config::turn_upright(up_of(cloth), mesh.slab.rest_positions);
  return mesh;
}

/// Sides of triangles where they are averaged over.
ConstrainedEdges constrained_edges(const Case& input) {
  const bool averages = config::constrain_of(input, true) == config::Constrain::vertices;
  return averages ? ConstrainedEdges::all : ConstrainedEdges::threads;
}

/// Makes the texture, in m, the rest shape. Throws InputError for a cell that has none. Collective.
void rest_in_texture(MPI_Comm comm, double unit, MeshSlab& mesh) {
  std::optional<std::string> fault;
  mesh.texture.resize(mesh.cell.size(), {Vec2::Zero(), Vec2::Zero(), Vec2::Zero(), Vec2::Zero()});
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) {
    const int n = mesh.cell[c].size();
    for (Vec2& corner : mesh.texture[c]) corner *= unit;
    const auto& m = mesh.texture[c];
    const Vec2 one = n == 4 ? m[2] - m[0] : m[1] - m[0], two = n == 4 ? m[3] - m[1] : m[2] - m[0];
    const double area = one[0] * two[1] - two[0] * one[1];
    if (!fault && !(std::abs(area) > 1e-9 * one.norm() * two.norm()))
      fault =
          fmt::format("{}: rest: texture needs faces with texture coordinates that span an area; give this "
                      "one some (vt), or leave rest: mesh",
                      place(mesh, mesh.cell_lines.empty() ? 0 : mesh.cell_lines[c]));
  }
  agree(comm, fault);
  mesh.rest_shape = mesh.texture;
}

/// Of the panels that the case has keys for. Throws InputError for one that the cloth does not have.
std::vector<PanelMaterial> own_materials(const Case& input, std::size_t k, const Piece& piece) {
  const auto& panels = piece.parts.panels;
  std::vector<std::string> names;
  for (const auto& panel : panels) names.push_back(panel.name);
  for (const auto& [name, panel] : input.cloths[k].panels)
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      const auto meant = config::nearest(name, names);
      throw InputError(fmt::format(
          "{}: {}.panels.{}: the cloth has no such panel{}; {}", input.file.string(),
          config::key_of_cloth(input, k), name, meant ? fmt::format(" (did you mean '{}'?)", *meant) : "",
          names.empty() ? "it has none" : fmt::format("there are {}", fmt::join(names, ", "))));
    }
  std::vector<PanelMaterial> own;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const auto found = input.cloths[k].panels.find(panels[p].name);
    if (found == input.cloths[k].panels.end()) continue;
    const config::Material material = config::material_of(piece.material, found->second);
    const Global end = p + 1 < panels.size() ? panels[p + 1].first_cell : piece.cells;
    if (material != piece.material)
      own.push_back({panels[p].first_cell, end - panels[p].first_cell, material});
  }
  return own;
}

} // namespace

UndistributedCloth read_cloth(MPI_Comm comm, const Case& input) {
  UndistributedCloth all;
  std::vector<ListedMesh> meshes;
  Global vertices = 0, cells = 0;
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    const config::Cloth& cloth = input.cloths[k];
    auto [slab, parts, warnings] = load_mesh(comm, input, k);
    ListedMesh& mesh = meshes.emplace_back(ListedMesh{std::move(slab), {}});
    if (cloth.rest == config::RestShape::texture) rest_in_texture(comm, cloth.texture_unit, mesh.slab);
    mesh.topology = find_topology(comm, mesh.slab, constrained_edges(input));
    const Slab &v = mesh.slab.vertices, &c = mesh.slab.cells;
    Piece& piece = all.pieces.emplace_back(Piece{cloth.material, vertices, cells, v.total, c.total,
                                                 mesh.topology.triangles_only, parts, warnings});
    vertices += v.total;
    cells += c.total;
    auto& model = piece.material.bending_model;
    const bool folds = any_of(comm, !mesh.topology.hinges.empty());
    if (!model)
      model = mesh.topology.has_triangles || (folds && (piece.material.bending_weft || !cloth.panels.empty()))
                  ? config::BendingModel::isometric
                  : config::BendingModel::yarn;
    if (model == config::BendingModel::yarn) mesh.topology.hinges.clear(); // nobody asks for them
    piece.own = own_materials(input, k, piece);
  }
  all.mesh = meshes.size() == 1 ? std::move(meshes.front()) : join(comm, meshes);
  find_ties(comm, input, all);
  for (const Tie& tie : all.ties) all.mesh.slab.ties.push_back(tie.vertices);
  return all;
}

namespace {

/// Of the vertices of one piece, as its file has them, to this rank's slab of all; others stay.
void take_shape(MPI_Comm comm, const Slab& all, const Piece& piece, const Case& input, std::size_t k,
                std::vector<Vec3>& rows) {
  const config::Cloth& given = input.cloths[k];
  const int ranks = size_of(comm);
  const Slab mine = slab_of(piece.vertices, ranks, rank_of(comm));
  auto shape = read_positions(comm, input.folder() / *given.start.shape, given.scale, mine);
  config::turn_upright(up_of(given), shape);
  std::vector<int> to;
  for (Global i = 0; i < mine.count; ++i)
    to.push_back(slab_rank(all.total, ranks, piece.first_vertex + mine.first + i));
  const auto received = exchange(comm, shape, to).items; // in order
  const Global first = std::max(all.first, piece.first_vertex);
  std::copy(received.begin(), received.end(), rows.begin() + (received.empty() ? 0 : first - all.first));
}

/// Where the vertices of this rank's slab, which are at `rows` at rest, are at the start.
std::vector<Vec3> at_start(MPI_Comm comm, const Slab& slab, std::span<const Piece> pieces, const Case& input,
                           std::vector<Vec3> rows) {
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    const config::Start& start = input.cloths[k].start;
    if (start.shape) take_shape(comm, slab, pieces[k], input, k, rows);
    const Eigen::AngleAxisd turn(start.rotate.angle, start.rotate.axis.normalized());
    const Global first = std::max(slab.first, pieces[k].first_vertex),
                 end = std::min(slab.first + slab.count, pieces[k].first_vertex + pieces[k].vertices);
    for (Global i = first; i < end; ++i) rows[i - slab.first] = turn * rows[i - slab.first] + start.translate;
  }
  return rows;
}

} // namespace

std::vector<int> cut_by_places(MPI_Comm comm, const UndistributedCloth& cloth, const Case& input,
                               const Places& places, int parts) {
  constexpr double near = 1.2; // edges
  const auto& [slab, topology] = cloth.mesh;
  const auto method = Partitioner(input.partition.method);
  if (!input.has_contact() || !needs_graph(slab.vertices, method, parts))
    return partition(comm, slab, topology, method, parts);
  const double reach = near * mean_edge(comm, slab, topology); // there is an edge at every vertex
  const NearVertices others = find_near(comm, slab.vertices, places(), reach);
  return partition(comm, slab.vertices, graph_of(topology, others), method, parts);
}

Places places_at_start(MPI_Comm comm, const UndistributedCloth& cloth, const Case& input) {
  return [comm, &cloth, &input, &mesh = cloth.mesh.slab] {
    return at_start(comm, mesh.vertices, cloth.pieces, input, mesh.rest_positions);
  };
}

std::vector<int> cut_at_start(MPI_Comm comm, const UndistributedCloth& cloth, const Case& input) {
  return cut_by_places(comm, cloth, input, places_at_start(comm, cloth, input), size_of(comm));
}

Cloth load_cloth(MPI_Comm comm, const Case& input, const Cut& cut) {
  UndistributedCloth given = read_cloth(comm, input);
  const std::vector<int> owners = cut(comm, given, input);
  Cloth cloth =
      make_cloth(distribute(comm, given.mesh.slab, given.mesh.topology, owners), std::move(given.pieces));
  cloth.ties = std::move(given.ties);
  return cloth;
}

namespace {

std::vector<Vec3> start_positions(const Cloth& cloth, const Case& input) {
  const DistributedMesh& mesh = cloth.mesh;
  std::vector<Vec3> positions = mesh.rest_positions;
  const auto rows = at_start(mesh.comm, mesh.vertex_order.slab(), cloth.pieces, input,
                             mesh.vertex_order.to_slab<Vec3>(positions));
  mesh.vertex_order.from_slab<Vec3>(rows, positions);
  mesh.vertex_halo.update(positions);
  return positions;
}

constexpr double most = 1e9; ///< m from the origin

/// Pins and obstacles stay where cloth can be.
void check_motion(const Case& input, std::string_view key, const std::vector<config::Keyframe>& motion) {
  for (std::size_t k = 0; k < motion.size(); ++k)
    if (const double way = motion[k].translate.lpNorm<Eigen::Infinity>(); !(way <= most))
      throw InputError(
          fmt::format("{}: {}.motion.{}.translate: {:.3g} m are more than {:g} m; correct it, or "
                      "its unit",
                      input.file.string(), key, k, way, most));
}

/// Where squares overflow, or a coordinate is rounded by more than the strain limit leaves an edge, nothing
/// could be computed.
void check_scale(const Cloth& cloth, const Case& input, std::span<const Vec3> positions) {
  double farthest = 0, shortest = HUGE_VAL;
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (const Vec3& x : {positions[i], cloth.mesh.rest_positions[i]})
      farthest = std::max(farthest, x.allFinite() ? x.lpNorm<Eigen::Infinity>() : HUGE_VAL);
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) shortest = std::min(shortest, cloth.rest_length[e]);
  farthest = max_over(cloth.mesh.comm, farthest);
  shortest = -max_over(cloth.mesh.comm, -shortest);
  const std::string where =
      fmt::format("{}: the cloth reaches {:.3g} m from the origin", input.file.string(), farthest);
  if (!(farthest <= most))
    throw InputError(fmt::format("{}, farther than {:g} m; correct `start` or its mesh, or give `scale`, the "
                                 "metres per unit of the mesh",
                                 where, most));
  const double limit = config::holds_limit(input) ? input.inextensibility.strain : 0.01;
  const double rounding = std::numeric_limits<double>::epsilon() * farthest;
  if (10 * rounding > limit * shortest)
    throw InputError(
        fmt::format("{}, where coordinates are rounded by {:.1g} m: too much for a strain of {:g} of "
                    "an edge of {:.3g} m; move the cloth near the origin",
                    where, rounding, limit, shortest));
}

} // namespace

State start_state(const Cloth& cloth, const Case& input) {
  const DistributedMesh& mesh = cloth.mesh;
  State state;
  state.positions = start_positions(cloth, input);
  check_scale(cloth, input, state.positions);
  for (std::size_t k = 0; k < input.pins.size(); ++k)
    check_motion(input, fmt::format("pins.{}", k), input.pins[k].motion);
  for (std::size_t k = 0; k < input.obstacles.size(); ++k)
    check_motion(input, fmt::format("obstacles.{}", k), input.obstacles[k].motion);
  state.velocities.assign(mesh.vertices.size(), Vec3::Zero());
  state.multipliers.force_density.assign(mesh.edges.size(), 0.0);
  state.reported.reaction.assign(mesh.vertices.owned, Vec3::Zero());
  if (config::constrain_of(input, mesh.has_triangles) == config::Constrain::vertices)
    state.multipliers.stress.assign(mesh.vertices.size(), Vec2::Zero());
  if (!input.has_contact()) return state;
  state.multipliers.carried_contact_force.assign(mesh.vertices.size(), Vec3::Zero());
  state.reported.contact_force.assign(mesh.vertices.owned, Vec3::Zero());
  state.multipliers.projection_tension.assign(mesh.edges.size(), 0.0);
  return state;
}

} // namespace taut
