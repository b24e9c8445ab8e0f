#pragma once
#include "src/linear/solver_options.hpp"
#include "src/linear/vertex_matrix.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// The modified conjugate gradient method of Baraff and Witkin [BW98 section 5.2] for A v = b with the
/// directions that `freedom` denies left as they are in `v`: residuals and search directions pass through the
/// filter S. It starts as Ascher and Boxerman [2003] correct it, from the velocities at hand, and stops when
/// the residual in the norm of the preconditioner, the inverse 3 x 3 diagonal blocks of A, has fallen by the
/// factor `tolerance` from that of the start. (The paper's own measure, filter(b)^T P filter(b), mixes P with
/// its inverse.)
///
/// `v` over local vertices, ghosts current on entry and on exit; `rhs` over owned ones. Collective.
SolveReport modified_cg(const DistributedMesh& mesh, const VertexMatrix& matrix, std::span<const Vec3> rhs,
                        const Freedom& freedom, double tolerance, int max_iterations, std::vector<Vec3>& v);

/// What holds the vertices where they are held: (I - S) (A v - b) over owned vertices, for a solution v with
/// current ghosts. Of a step of h seconds it is the impulse h f of the constraint force f [BW98 section 5.3].
/// Collective over neighbours if the matrix has far terms.
void constraint_impulse(const VertexMatrix& matrix, std::span<const Vec3> rhs, const Freedom& freedom,
                        std::span<const Vec3> v, std::vector<Vec3>& impulse);

} // namespace taut
