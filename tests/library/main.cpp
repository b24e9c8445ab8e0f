// One projection by an installed Taut: a sheet that was pulled a fifth too long.
#include <taut/filters/project.hpp>
#include <taut/linear/session.hpp>
#include <taut/partition/grid.hpp>

#include <cstdio>

int main(int argc, char** argv) {
  const taut::Session session(argc, argv, {});
  const auto slab = taut::make_grid(MPI_COMM_WORLD, {1.0, 1.0}, {11, 11});
  const auto topology = taut::find_topology(MPI_COMM_WORLD, slab);
  const auto owners = taut::partition(MPI_COMM_WORLD, slab, topology, taut::Partitioner::metis);
  const auto mesh = taut::distribute(MPI_COMM_WORLD, slab, topology, owners);
  std::vector<taut::Vec3> pulled = mesh.rest_positions;
  for (taut::Vec3& x : pulled) x *= 1.2;
  const std::vector<double> masses(pulled.size(), 1e-3); // kg
  const auto end = taut::project(mesh, masses, pulled, {.strain = 0.01});
  double strain = 0;
  for (taut::Local e = 0; e < mesh.edges.owned; ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const double rest = (mesh.rest_positions[b] - mesh.rest_positions[a]).norm();
    strain = std::max(strain, std::abs((end[b] - end[a]).norm() / rest - 1));
  }
  strain = taut::max_over(MPI_COMM_WORLD, strain);
  if (taut::rank_of(MPI_COMM_WORLD) == 0) std::printf("largest strain %.4f\n", strain);
  return strain <= 0.01 && strain > 0 ? 0 : 1;
}
