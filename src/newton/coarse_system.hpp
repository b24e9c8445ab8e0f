#pragma once
#include "src/constraints/constraint_set.hpp"
#include "src/linear/vertex_multigrid.hpp"

#include <Eigen/SparseCholesky>

namespace taut {

/// The saddle-point system of a step on one of the grids of a VertexMultigrid: displacements that the splines
/// of its nodes can tell, and multipliers that are smooth,
///
///     [ P^T H P   (Q^T J P)^T ] [ u ]   [ P^T r ]
///     [ Q^T J P   -Q^T a Q    ] [ m ] = [ Q^T c ].
///
/// Q makes rows of coarse tensions. There is one kind of them for each axis of the grid, for the rows that
/// run along it; a tension is constant along that axis within a cell and linear from node to node across it,
/// so that tensions stand between the nodes whose distance they keep. No rank holds more than such a grid has
/// nodes, and each of them factors it.
class CoarseSystem {
public:
  /// Chooses the grid: the finest with no more than `most_nodes` of them and with `vertices_a_node` or more;
  /// of small meshes the coarsest. All must outlive the system. Collective.
  CoarseSystem(const DistributedMesh& mesh, const VertexMultigrid& grids, std::span<const RowEdge> entries,
               std::span<const RowPlace> places);

  static constexpr Global most_nodes = 5000, vertices_a_node = 40;

  std::size_t level() const { return level_; } ///< of the grid

  /// Takes the matrix of the grid, the gradients of local edges, and a of owned rows. Collective.
  void set(std::span<const Vec3> gradients, const Freedom& freedom, std::span<const double> compliance);

  /// `u` over owned nodes of the grid, `m` over owned rows, from P^T r over owned nodes and c over owned
  /// rows. Collective.
  void solve(std::span<const Vec3> r, std::span<const double> c, std::vector<Vec3>& u,
             std::span<double> m) const;

private:
  using Unknown = std::int32_t; ///< a number in the replicated system: three a node, then one a tension
  struct Tension {              ///< what a row has of it
    Unknown unknown;
    double part;
  };
  struct Entry { ///< the part of an edge's end in Q^T J P
    std::uint32_t row_edge;
    char end;
    Unknown node, tension;
    double factor;
    Unknown place; ///< see place_of
  };

  void choose_level();
  void find_tensions(std::span<const RowPlace> places);
  void find_entries();
  void make_pattern();
  std::span<const Tension> tensions_of(std::size_t row) const {
    return std::span(tensions_).subspan(tension_begin_[row], tension_begin_[row + 1] - tension_begin_[row]);
  }
  Unknown place_of(Unknown row, Unknown node) const;
  /// The entry `a` rows below that at `place`, in column `b` of a node: columns begin at their diagonal.
  double& value(Unknown node, Unknown place, int a, int b) {
    return matrix_.valuePtr()[matrix_.outerIndexPtr()[3 * node + b] + place + a - b];
  }
  double& diagonal(Unknown k) { return matrix_.valuePtr()[matrix_.outerIndexPtr()[k]]; }
  void add_grid();
  void add_rows(std::span<const Vec3> gradients, const Freedom& freedom, std::span<const double> compliance);
  void regularise();

  const DistributedMesh& mesh_;
  const VertexMultigrid& grids_;
  std::span<const RowEdge> row_edges_;
  std::size_t level_ = 0;
  Unknown node_unknowns_ = 0, unknowns_ = 0;
  std::vector<std::size_t> tension_begin_{0};
  std::vector<Tension> tensions_;
  std::vector<Entry> entries_;
  std::vector<Unknown> grid_places_;   ///< of the grid's entries at or below the diagonal; -1: above it
  Eigen::SparseMatrix<double> matrix_; ///< its lower triangle
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

} // namespace taut
