// HDF5 meshes, byte by byte.
#include "io/mesh_file.hpp"
#include "partition/topology.hpp"
#include "tests/fuzz/target.hpp"

void taut::fuzz::read_input(std::string_view bytes) {
  const MeshSlab slab = read_mesh_h5(MPI_COMM_SELF, write_input("mesh.h5", bytes), 1.0);
  find_topology(MPI_COMM_SELF, slab);
}
