#include "src/linear/kkt_direct.hpp"

#include "src/linear/kkt_schur.hpp"
#include "src/linear/symmetric_matrix.hpp"

namespace taut {

namespace {

SolverOptions indefinite(SolverOptions options) {
  options.matrix = SolverOptions::Matrix::indefinite;
  return options;
}

/// Calls `vertex(i)` for the diagonal block of each owned vertex, `end(i, end)` for each of its edge ends,
/// and `edge(e)` for each owned edge: the order of the entries.
template<class Vertex, class End, class Edge>
void visit(const DistributedMesh& mesh, Vertex&& vertex, End&& end, Edge&& edge) {
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    vertex(i);
    for (const EdgeEnd& e : mesh.star_of(i)) end(i, e);
  }
  for (Local e = 0; e < mesh.edges.owned; ++e) edge(e);
}

} // namespace

KktSystem::Direct::Direct(const DistributedMesh& mesh, const SolverOptions& options)
    : mesh_(mesh), vertex_row_(mesh.vertices.size()), edge_row_(mesh.edges.size()),
      solver_(mesh.comm, "kkt", indefinite(options), PCNONE) {
  const Global rows = 3 * Global(mesh.vertices.owned) + mesh.edges.owned;
  check_unknowns(mesh.comm, rows);
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    vertex_row_[i] = PetscInt(3 * mesh.vertices.global(i) + mesh.edges.first);
  for (Local e = 0; e < mesh.edges.owned; ++e)
    edge_row_[e] = PetscInt(3 * (mesh.vertices.first + mesh.vertices.owned) + mesh.edges.global(e));
  mesh.vertex_halo.update(vertex_row_);
  mesh.edge_halo.update(edge_row_);
  fix_pattern(PetscInt(rows));
  check(MatCreateVecs(matrix_, solution_.address(), rhs_.address()));
  check(KSPSetOperators(solver_, matrix_, matrix_));
  solver_.leave_room_for_pivots();
}

void KktSystem::Direct::fix_pattern(PetscInt rows) {
  EntryPlaces places;
  const auto add = [&](PetscInt row, PetscInt column) { places.add(row, column); };
  visit(
      mesh_,
      [&](Local i) {
        for (int k = 0; k < 3; ++k) add(vertex_row_[i] + k, vertex_row_[i] + k);
      },
      [&](Local i, const EdgeEnd& end) {
        for (int k = 0; k < 3; ++k) add(vertex_row_[i] + k, vertex_row_[end.other] + k);
        for (int k = 0; k < 3; ++k) add(vertex_row_[i] + k, edge_row_[end.edge]);
      },
      [&](Local e) {
        add(edge_row_[e], edge_row_[e]);
        for (const Local v : mesh_.edge_vertices[e])
          for (int k = 0; k < 3; ++k) add(edge_row_[e], vertex_row_[v] + k);
      });
  values_.reserve(places.rows.size());
  matrix_ = make_symmetric_matrix(mesh_.comm, "kkt_", rows, std::move(places));
}

void KktSystem::Direct::assemble(const Terms& t) {
  if (t.freedom->has_sliding())
    throw std::invalid_argument("KktSystem: mumps cannot keep vertices on a line or in a plane");
  terms_ = t;
  values_.clear();
  const auto add = [&](double value) { values_.push_back(value); };
  const auto free = [&](Local i) { return t.freedom->is_free(i); };
  visit(
      mesh_,
      [&](Local i) {
        double diagonal = t.mass[i];
        for (const EdgeEnd& end : mesh_.star_of(i)) diagonal += t.weight[end.edge];
        for (int k = 0; k < 3; ++k) add(free(i) ? diagonal : 1.0);
      },
      [&](Local i, const EdgeEnd& end) {
        for (int k = 0; k < 3; ++k) add(free(i) && free(end.other) ? -t.weight[end.edge] : 0.0);
        for (int k = 0; k < 3; ++k) add(free(i) ? end.sign * t.gradient[end.edge][k] : 0.0);
      },
      [&](Local e) {
        const auto& [a, b] = mesh_.edge_vertices[e];
        add(free(a) || free(b) ? -t.scaled_compliance[e] : -1.0);
        for (int k = 0; k < 3; ++k) add(free(a) ? -t.gradient[e][k] : 0.0);
        for (int k = 0; k < 3; ++k) add(free(b) ? t.gradient[e][k] : 0.0);
      });
  check(MatSetValuesCOO(matrix_, values_.data(), INSERT_VALUES));
}

SolveReport KktSystem::Direct::solve(std::span<const Vec3> f, std::span<const double> c, double tolerance,
                                     std::vector<Vec3>& dx, std::vector<double>& dmu) {
  const Local vertices = mesh_.vertices.owned, edges = mesh_.edges.owned;
  double* out = nullptr;
  check(VecGetArrayWrite(rhs_, &out));
  for (Local i = 0; i < vertices; ++i) Eigen::Map<Vec3>(out + 3 * i) = terms_.freedom->allowed(i, f[i]);
  for (Local e = 0; e < edges; ++e) out[3 * vertices + e] = -c[e];
  check(VecRestoreArrayWrite(rhs_, &out));
  const SolveReport report = solver_.solve(rhs_, solution_, tolerance);
  const double* in = nullptr;
  check(VecGetArrayRead(solution_, &in));
  for (Local i = 0; i < vertices; ++i) dx[i] = Eigen::Map<const Vec3>(in + 3 * i);
  for (Local e = 0; e < edges; ++e) dmu[e] = in[3 * vertices + e];
  check(VecRestoreArrayRead(solution_, &in));
  mesh_.vertex_halo.update(dx);
  mesh_.edge_halo.update(dmu);
  return report;
}

KktSystem::KktSystem(const DistributedMesh& mesh, const Pattern& pattern, const SolverOptions& options) {
  if (options.kind == SolverOptions::Kind::mumps)
    direct_ = std::make_unique<Direct>(mesh, options);
  else
    schur_ = std::make_unique<Schur>(mesh, pattern, options);
}

KktSystem::~KktSystem() = default;

void KktSystem::assemble(const Terms& terms) { direct_ ? direct_->assemble(terms) : schur_->assemble(terms); }

SolveReport KktSystem::solve(std::span<const Vec3> f, std::span<const double> c, double tolerance,
                             std::vector<Vec3>& dx, std::vector<double>& dmu) {
  return direct_ ? direct_->solve(f, c, tolerance, dx, dmu) : schur_->solve(f, c, tolerance, dx, dmu);
}

} // namespace taut
