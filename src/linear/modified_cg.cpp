#include "src/linear/modified_cg.hpp"

#include <Eigen/LU>

namespace taut {

namespace {

using Field = std::vector<Vec3>;

double dot(const DistributedMesh& mesh, const Field& a, const Field& b) {
  double sum = 0;
  for (Local i = 0; i < mesh.vertices.owned; ++i) sum += a[i].dot(b[i]);
  return sum_over(mesh.comm, sum);
}

std::vector<Mat3> inverse_diagonal(const VertexMatrix& matrix) {
  std::vector<Mat3> blocks(matrix.pattern().rows());
  matrix.diagonal_blocks(blocks);
  for (Mat3& block : blocks) block = block.inverse().eval();
  return blocks;
}

} // namespace

SolveReport modified_cg(const DistributedMesh& mesh, const VertexMatrix& matrix, std::span<const Vec3> rhs,
                        const Freedom& freedom, double tolerance, int max_iterations, std::vector<Vec3>& v) {
  const Local owned = mesh.vertices.owned;
  const auto preconditioner = inverse_diagonal(matrix);
  Field r(owned), s(owned), c(v.size()), q(v.size());
  const auto precondition = [&] {
    for (Local i = 0; i < owned; ++i) s[i] = preconditioner[i] * r[i];
  };
  matrix.multiply(v, q);
  for (Local i = 0; i < owned; ++i) r[i] = freedom.allowed(i, rhs[i] - q[i]);
  precondition();
  for (Local i = 0; i < owned; ++i) c[i] = freedom.allowed(i, s[i]);
  double delta = dot(mesh, r, s);
  const double goal = tolerance * tolerance * delta;

  SolveReport report;
  for (; delta > goal; ++report.iterations) {
    if (report.iterations == max_iterations) {
      report.failure = "out of iterations";
      break;
    }
    mesh.vertex_halo.update(c);
    matrix.multiply(c, q);
    for (Local i = 0; i < owned; ++i) q[i] = freedom.allowed(i, q[i]);
    const double alpha = delta / dot(mesh, c, q);
    for (Local i = 0; i < owned; ++i) {
      v[i] += alpha * c[i];
      r[i] -= alpha * q[i];
    }
    precondition();
    const double old = std::exchange(delta, dot(mesh, r, s));
    for (Local i = 0; i < owned; ++i) c[i] = freedom.allowed(i, s[i] + delta / old * c[i]);
  }
  mesh.vertex_halo.update(v);
  return report;
}

void constraint_impulse(const VertexMatrix& matrix, std::span<const Vec3> rhs, const Freedom& freedom,
                        std::span<const Vec3> v, std::vector<Vec3>& impulse) {
  impulse.resize(v.size());
  matrix.multiply(v, impulse);
  impulse.resize(matrix.pattern().rows());
  for (Local i = 0; i < Local(impulse.size()); ++i) impulse[i] = freedom.denied(i, impulse[i] - rhs[i]);
}

} // namespace taut
