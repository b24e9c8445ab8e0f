#pragma once
#include "partition/partitioner.hpp"

namespace taut {

/// Over all parts.
struct Spread {
  Global min = 0, max = 0;
  double mean = 0;
};

/// What a partition would cost those who run on it, one rank a part.
struct PartitionFigures {
  int parts = 1;
  Spread vertices;      ///< owned by a part
  double imbalance = 1; ///< most vertices of a part over the mean
  Global edge_cut = 0;  ///< constrained edges whose ends lie in different parts
  Spread ghosts;        ///< vertices of other parts that a part stores
  Spread ghost_edges;   ///< constrained edges of other parts that a part stores
  Spread neighbours;    ///< parts from which a part receives vertices
  Spread yarn_segments; ///< runs of edges of one yarn within a part
  Global yarns = 0;     ///< over all parts
  Global cut_yarns = 0; ///< those that lie in more than one part
};

/// The figures of the partition that gives vertex i of this rank's slab to part `owners[i]`, as `distribute`
/// would make of it on `parts` ranks, without making it: any number of ranks can compute them. Collective.
PartitionFigures partition_figures(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                                   const std::vector<int>& owners, int parts);

} // namespace taut
