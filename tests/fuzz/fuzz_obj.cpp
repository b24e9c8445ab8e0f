// OBJ files, up to the mesh as a run has it.
#include "io/obj.hpp"
#include "partition/distributed_mesh.hpp"
#include "tests/fuzz/target.hpp"

void taut::fuzz::read_input(std::string_view bytes) {
  const MeshSlab slab = read_obj(MPI_COMM_SELF, write_input("mesh.obj", bytes), 1.0);
  const Topology topology = find_topology(MPI_COMM_SELF, slab);
  distribute(MPI_COMM_SELF, slab, topology, std::vector<int>(slab.vertices.total, 0));
}
