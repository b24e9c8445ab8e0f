#pragma once
#include "src/contact/union_distance.hpp"

namespace taut {

/// A closed surface of triangles, their corners counterclockwise from outside.
struct UnionMesh {
  std::vector<Vec3> positions; ///< m
  std::vector<std::array<Local, 3>> triangles;
};

/// The surface of a union, in triangles whose edges are about `input.edge` long.
///
/// Marching tetrahedra on a body-centred cubic lattice, whose tetrahedra are all alike: where the function
/// changes its sign along an edge of the lattice there is a vertex, and the surface in each tetrahedron is
/// one triangle or two, which makes it closed and a manifold whatever the function. Only cells near the
/// surface are looked at, found by an octree. Then vertices go to the middle of their neighbours and back to
/// the surface, several times: that evens out the slivers where the surface passes close by a point of the
/// lattice [Labelle and Shewchuk 2007 instead move the lattice]. Convex sharp edges are cut off by a part of
/// `edge`, as nothing puts vertices on them.
UnionMesh mesh_union(const config::Union& input);

} // namespace taut
