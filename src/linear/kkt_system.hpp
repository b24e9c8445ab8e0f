#pragma once
#include "src/linear/solver_options.hpp"
#include "src/linear/vertex_matrix.hpp"
#include "src/state/freedom.hpp"

#include <memory>

namespace taut {

/// The saddle-point system of a step in which positions and tensions are unknown together,
///
///     [ A   J^T ] [ dx  ]   [ f ]
///     [ J   -a  ] [ dmu ] = [ -c ],      A = M + L(w),
///
/// where L(w) is the Laplacian of the edges with weights w: the geometric stiffness of their tensions. 3 rows
/// a vertex and one a constrained edge; vertices move only in the directions S_i in which they are free, dx =
/// S dx, which takes S A S and J S in place of A and J.
///
/// `mumps` factorises the whole matrix (L D L^T; PETSc prefix `-kkt_`). `cg` eliminates the vertices:
///
///     (J A^-1 J^T + a) dmu = c + J A^-1 f,   A dx = f - J^T dmu,
///
/// by conjugate gradients on the edges (prefix `-projection_`, preconditioned with J diag(A)^-1 J^T) around
/// conjugate gradients on the vertices (prefix `-stiffness_`); it asks for a positive definite A.
class KktSystem {
public:
  /// `mesh` and `pattern` must outlive the system. Collective.
  KktSystem(const DistributedMesh& mesh, const Pattern& pattern, const SolverOptions& options);
  ~KktSystem();

  /// What the matrix is made of. All of it must outlive the next solve.
  struct Terms {
    std::span<const double> mass;   ///< M, kg, of local vertices
    std::span<const double> weight; ///< w, kg, of local edges
    std::span<const Vec3>
        gradient; ///< J, of local edges: by the second vertex of an edge, minus that by its first
    std::span<const double> scaled_compliance; ///< a, of owned edges
    const Freedom* freedom;                    ///< of local vertices
  };

  /// With mumps vertices can only be free or held: throws std::invalid_argument for others. Collective.
  void assemble(const Terms& terms);

  /// Solves for `dx` and `dmu` over local vertices and edges, ghosts current, given f and c of owned ones; to
  /// the relative tolerance given. c is 0 on an edge between two held vertices. Collective.
  SolveReport solve(std::span<const Vec3> f, std::span<const double> c, double tolerance,
                    std::vector<Vec3>& dx, std::vector<double>& dmu);

private:
  struct Direct;
  struct Schur;
  std::unique_ptr<Direct> direct_; ///< one of the two
  std::unique_ptr<Schur> schur_;
};

/// A = M + L(w) as a matrix between vertices. `slots` are those of `edge_slots`.
std::vector<std::int32_t> edge_slots(const DistributedMesh& mesh, const Pattern& pattern);
void fill_stiffened_mass(const DistributedMesh& mesh, std::span<const std::int32_t> slots,
                         std::span<const double> mass, std::span<const double> weight, VertexMatrix& matrix);

} // namespace taut
