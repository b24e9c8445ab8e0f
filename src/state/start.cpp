#include "src/state/start.hpp"

#include "io/mesh_file.hpp"
#include "io/obj.hpp"
#include "partition/grid.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace taut {

namespace {

MeshSlab load_mesh(MPI_Comm comm, const Case& input) {
  const config::Cloth& cloth = input.cloth;
  if (cloth.grid)
    return make_grid(comm, cloth.grid->size, cloth.grid->vertices, GridCells(cloth.grid->cells));
  if (cloth.line) return make_line(comm, cloth.line->length, cloth.line->vertices);
  return read_mesh(comm, input.folder() / *cloth.mesh, cloth.scale);
}

bool has_triangles(MPI_Comm comm, const MeshSlab& mesh) {
  return any_of(comm,
                std::any_of(mesh.cell.begin(), mesh.cell.end(), [](const Cell& c) { return c.size() == 3; }));
}

} // namespace

UndistributedCloth read_cloth(MPI_Comm comm, const Case& input) {
  UndistributedCloth cloth{load_mesh(comm, input), {}, input.cloth.material};
  cloth.topology = find_topology(comm, cloth.slab);
  auto& model = cloth.material.bending_model;
  if (!model)
    model = has_triangles(comm, cloth.slab) ? config::BendingModel::isometric : config::BendingModel::yarn;
  if (model == config::BendingModel::yarn) cloth.topology.hinges.clear(); // nobody asks for them
  return cloth;
}

Cloth load_cloth(MPI_Comm comm, const Case& input) {
  const auto [slab, topology, material] = read_cloth(comm, input);
  const auto owners = partition(comm, slab, topology, Partitioner(input.partition.method));
  return make_cloth(distribute(comm, slab, topology, owners), material);
}

State start_state(const Cloth& cloth, const Case& input) {
  const DistributedMesh& mesh = cloth.mesh;
  const config::Start& start = input.cloth.start;
  State state;
  state.positions = mesh.rest_positions;
  if (start.shape) {
    const auto rows = read_obj_positions(mesh.comm, input.folder() / *start.shape, input.cloth.scale,
                                         mesh.vertex_order.slab());
    mesh.vertex_order.from_slab<Vec3>(rows, state.positions);
    mesh.vertex_halo.update(state.positions);
  }
  const Eigen::AngleAxisd turn(start.rotate.angle, start.rotate.axis.normalized());
  for (Vec3& x : state.positions) x = turn * x + start.translate;
  state.velocities.assign(mesh.vertices.size(), Vec3::Zero());
  state.contact_force.assign(mesh.vertices.size(), Vec3::Zero());
  state.force_density.assign(mesh.edges.size(), 0.0);
  state.stress.assign(mesh.vertices.size(), Vec2::Zero());
  state.pulled.assign(mesh.edges.size(), 0.0);
  state.reaction.assign(mesh.vertices.owned, Vec3::Zero());
  state.pressing.assign(mesh.vertices.owned, Vec3::Zero());
  return state;
}

} // namespace taut
