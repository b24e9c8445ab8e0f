#pragma once
#include "partition/distributed_mesh.hpp"
#include "src/config/case.hpp"
#include "src/state/contact_memory.hpp"

namespace taut {

/// One of the cloths of a case. No cell has vertices of two of them.
struct Piece {
  config::Material material;
  Global first_vertex = 0; ///< its vertices and cells follow those of the piece before
  Global first_cell = 0;
  Global vertices = 0, cells = 0; ///< how many, over all ranks
  bool triangles_only = false;    ///< no quad and no line in it
};

/// What does not change during a run: the mesh and what the rest shape and the material make of it.
struct Cloth {
  DistributedMesh mesh;
  std::vector<Piece> pieces;       ///< at least one
  std::vector<double> measure;     ///< of local vertices: m^2 of cloth (m of line) that belong to each
  std::vector<double> mass;        ///< kg, of local vertices, lumped
  std::vector<double> rest_length; ///< m, of local edges

  /// The number of the piece that a vertex, by its original number, belongs to.
  std::size_t piece_of_original(Global vertex) const;
  std::size_t piece_of(Local vertex) const {
    return pieces.size() == 1 ? 0 : piece_of_original(mesh.vertices.original[vertex]);
  }
};

/// What changes: fields over [owned | ghosts], ghosts current, and what is remembered of contacts. Fields
/// that a case has no use for are empty.
struct State {
  double time = 0;              ///< s
  Global step = 0;              ///< accepted steps so far
  std::vector<Vec3> positions;  ///< m, of local vertices
  std::vector<Vec3> velocities; ///< m/s
  std::vector<Vec3>
      contact_force; ///< N, of local vertices: what of it lasted through the last step; with contact
  std::vector<double> force_density; ///< N/m, of local edges: the tension of an edge over its length
  std::vector<Vec2> stress{};   ///< N/m, of local vertices: along warp and weft, see MetricRows; with these
  std::vector<double> pulled{}; ///< N, of local edges: by the projections of the last step; with contact
  ContactMemory contacts{};     ///< of the last step, at their homes
  std::vector<Vec3> reaction{}; ///< N, of owned vertices: with what their pin acts on them
  std::vector<Vec3>
      pressing{}; ///< N, of owned vertices: what contacts press and rub, for pictures; with contact

  /// The step before, for bdf2; empty where there was none, and for the other integrators.
  std::vector<Vec3> previous_positions{}, previous_velocities{};
  double previous_dt = 0; ///< s, from there to here; 0: the next step is one of implicit Euler
};

/// Visits every field of the state, with its name in a checkpoint: `visit.on_vertices(name, field)`,
/// `visit.on_edges(name, field)` and `visit.on_contacts(name, memory)`; those of which the case may have no
/// use as `visit.on_vertices_if_any` and `visit.on_edges_if_any`. A new field of the state needs a line here
/// and nothing else.
template<class S, class V>
void visit_fields(S& state, V& visit) {
  visit.on_vertices("positions", state.positions);
  visit.on_vertices("velocities", state.velocities);
  visit.on_vertices_if_any("contact_force", state.contact_force);
  visit.on_edges("force_density", state.force_density);
  visit.on_vertices_if_any("stress", state.stress);
  visit.on_edges_if_any("pulled", state.pulled);
  visit.on_contacts("contacts", state.contacts);
  if (state.previous_dt > 0) {
    visit.on_vertices("previous_positions", state.previous_positions);
    visit.on_vertices("previous_velocities", state.previous_velocities);
  }
}

/// What a step proposes before it is accepted.
struct Candidate {
  std::vector<Vec3> velocities; ///< those that lead from the start of the step to its end
  std::vector<Vec3>
      positions{}; ///< m, at its end: made when all filters are done, and room for them until then
  std::vector<Vec3> contact_force;
  std::vector<double> force_density;
  std::vector<Vec2> stress{};   ///< zero unless a filter says otherwise
  std::vector<double> pulled{}; ///< zero, and no contacts, unless a filter says otherwise
  ContactMemory contacts{};
  std::vector<Vec3> reaction{};       ///< N, of owned vertices: with what their pin acts on them
  std::vector<Vec3> pressing{};       ///< N, of owned vertices; zero unless something presses
  std::vector<Vec3> end_velocities{}; ///< those at the end, where they are others; else empty
};

/// Derives masses and lengths; `pieces` in order. Collective.
Cloth make_cloth(DistributedMesh distributed, std::vector<Piece> pieces);

/// Of one piece. Collective.
Cloth make_cloth(DistributedMesh distributed, const config::Material& material);

/// |d| / l - 1 of an edge.
inline double strain_of(const Cloth& cloth, std::span<const Vec3> positions, Local edge) {
  const auto& [a, b] = cloth.mesh.edge_vertices[edge];
  return (positions[b] - positions[a]).norm() / cloth.rest_length[edge] - 1.0;
}

struct Strain {
  double max = 0; ///< largest |strain| of all that the limit holds for, see StrainGauge
  double rms = 0;
};

/// How far the lowest vertex, in the direction `down`, is below the origin, in m. Collective.
double lowest(const Cloth& cloth, std::span<const Vec3> positions, const Vec3& down);

} // namespace taut
