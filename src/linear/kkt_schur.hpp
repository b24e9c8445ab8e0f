#pragma once
#include "src/linear/kkt_system.hpp"
#include "src/linear/projection_system.hpp"
#include "src/linear/velocity_system.hpp"

namespace taut {

/// KktSystem by elimination of the vertices.
struct KktSystem::Schur {
  Schur(const DistributedMesh& mesh, const Pattern& pattern, const SolverOptions& options);

  void assemble(const Terms& terms);
  SolveReport solve(std::span<const Vec3> f, std::span<const double> c, double tolerance,
                    std::vector<Vec3>& dx, std::vector<double>& dmu);

private:
  /// x = A^-1 b, 0 where vertices may not move; a failure is kept in `failure_`.
  void solve_vertices(std::span<const Vec3> b, double tolerance, std::vector<Vec3>& x);
  void apply(std::span<const double> mu, std::span<double> product, double tolerance);
  void gather(std::span<const double> mu, std::span<Vec3> pull) const;       ///< J^T mu, mu over local edges
  void differences(std::span<const Vec3> x, std::span<double> result) const; ///< J x

  const DistributedMesh& mesh_;
  std::vector<std::int32_t> slots_;
  VertexMatrix stiffened_mass_;
  VelocitySystem vertices_;
  ProjectionSystem edges_;
  Terms terms_{};
  std::string failure_;
  std::vector<Vec3> b_, x_;
  std::vector<double> mu_, rhs_, inverse_;
};

} // namespace taut
