#pragma once
#include "partition/distributed_mesh.hpp"
#include "src/linear/solver_options.hpp"
#include "src/state/freedom.hpp"

#include <memory>

namespace taut {

/// The system of one projection onto two constraints a vertex, (S + diag a) mu = b with S = J W J^T: rows of
/// warp and weft at each vertex, which depend on the vertex and its neighbours. Every rank adds what the
/// motion of its own vertices brings about, J_p W_p J_p^T, to rows of its own and of others.
///
/// PETSc prefix `-projection_`. `mumps` factorises, `cg` is preconditioned as is said.
class MetricSystem {
public:
  enum class Preconditioner {
    multigrid, ///< algebraic, for solves
    sweep      ///< of Gauss-Seidel, there and back: for programs, which end after some tens of products
  };

  /// The rows (local vertices) that owned vertex p has a part in are rows[begin[p] .. begin[p + 1]). `mesh`
  /// must outlive the system. Collective.
  MetricSystem(const DistributedMesh& mesh, std::span<const std::size_t> begin, std::span<const Local> rows,
               const SolverOptions& options, Preconditioner preconditioner);
  ~MetricSystem();

  /// W = S_i / m_i. `columns`: for each of `rows`, the derivatives by x_p of its two constraints;
  /// `inverse_mass` as in ProjectionSystem; `scaled_compliance` is a, of owned vertices. Collective.
  void assemble(std::span<const std::array<Vec3, 2>> columns, std::span<const double> inverse_mass,
                const Freedom& freedom, std::span<const Vec2> scaled_compliance);

  /// Solves for `mu` (owned part; ghosts are updated) to the relative tolerance given. Collective.
  SolveReport solve(std::span<const Vec2> rhs, double tolerance, std::vector<Vec2>& mu);

  /// s, an approximate solution for r, by the preconditioner of the solver; rows as [warp, weft] of owned
  /// vertices. Collective.
  void precondition(std::span<const double> r, std::span<double> s) const;

  /// product = (J W J^T + a) mu; rows as in `precondition`. Collective.
  void multiply(std::span<const double> mu, std::span<double> product) const;

private:
  struct Petsc;
  const DistributedMesh& mesh_;
  std::vector<std::size_t> begin_;
  std::vector<double> values_; ///< in the order of the coordinates given to PETSc
  std::unique_ptr<Petsc> petsc_;
};

} // namespace taut
