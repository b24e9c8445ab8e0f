#include "src/linear/projection_system.hpp"

#include "src/linear/krylov.hpp"
#include "src/linear/yarn_preconditioner.hpp"

#include <algorithm>
#include <limits>

namespace taut {

namespace {

/// Rows of owned edges, split into columns of owned and of ghost edges as PETSc stores them, and for every coupling, in
/// the order in which assembly meets it, where its value goes.
struct SplitRows {
  struct Part {
    std::vector<PetscInt> offsets{0}, columns;
    std::vector<double> values;
  };
  Part own, ghost;
  /// Of each row: the star of its first vertex, then of its second, without itself. A place in `own.values`, or if
  /// negative, -1 - a place in `ghost.values`.
  std::vector<PetscInt> coupling;
  std::vector<PetscInt> diagonal;

  double& value(PetscInt place) { return place >= 0 ? own.values[place] : ghost.values[-1 - place]; }
};

PetscInt checked(Global number) {
  if (number > std::numeric_limits<PetscInt>::max())
    throw std::runtime_error("the mesh has more edges than this PETSc can number: use one built with 64-bit indices");
  return PetscInt(number);
}

template <class Visit>
void for_each_coupling(const DistributedMesh& mesh, Local edge, Visit&& visit) {
  const auto& [first, second] = mesh.edge_vertices[edge];
  for (const auto& [vertex, sign] : {std::pair{first, -1.0}, std::pair{second, +1.0}})
    for (const EdgeEnd& end : mesh.star_of(vertex))
      if (end.edge != edge) visit(vertex, end.edge, sign * end.sign);
}

/// Columns of one row in ascending global order; couplings that meet twice (a two-edge loop) share a place.
void append_row(const DistributedMesh& mesh, Local edge, SplitRows& rows) {
  std::vector<PetscInt> own{edge}, ghost;
  for_each_coupling(mesh, edge, [&](Local, Local other, double) {
    if (mesh.owns_edge(other)) own.push_back(other);
    else ghost.push_back(checked(mesh.edges.global(other)));
  });
  const auto append = [](std::vector<PetscInt>& row, SplitRows::Part& part) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    part.columns.insert(part.columns.end(), row.begin(), row.end());
    part.offsets.push_back(PetscInt(part.columns.size()));
  };
  append(own, rows.own);
  append(ghost, rows.ghost);
}

PetscInt place_in(const SplitRows::Part& part, Local row, PetscInt column) {
  const auto begin = part.columns.begin() + part.offsets[row], end = part.columns.begin() + part.offsets[row + 1];
  return PetscInt(std::lower_bound(begin, end, column) - part.columns.begin());
}

SplitRows pattern_of(const DistributedMesh& mesh) {
  SplitRows rows;
  for (Local e = 0; e < mesh.edges.owned; ++e) append_row(mesh, e, rows);
  rows.own.values.assign(rows.own.columns.size(), 0.0);
  rows.ghost.values.assign(rows.ghost.columns.size(), 0.0);
  for (Local e = 0; e < mesh.edges.owned; ++e) {
    rows.diagonal.push_back(place_in(rows.own, e, e));
    for_each_coupling(mesh, e, [&](Local, Local other, double) {
      rows.coupling.push_back(mesh.owns_edge(other) ? place_in(rows.own, e, other)
                                                    : -1 - place_in(rows.ghost, e, PetscInt(mesh.edges.global(other))));
    });
  }
  return rows;
}

/// The yarn links of the pattern: the coupling of each owned edge to its predecessor, -1 where a yarn starts.
std::vector<PetscInt> links_of(const DistributedMesh& mesh, const SplitRows& rows) {
  std::vector<PetscInt> links(mesh.edges.owned, -1);
  for (Local e = 0; e < mesh.edges.owned; ++e)
    if (mesh.continues_yarn[e]) links[e] = place_in(rows.own, e, e - 1);
  return links;
}

} // namespace

void attach(Mat matrix, YarnTridiagonal* yarns); // yarn_preconditioner.cpp

struct ProjectionSystem::Petsc {
  SplitRows rows;
  std::vector<PetscInt> links;
  YarnTridiagonal yarns;
  OwnedMat matrix;
  OwnedVec rhs, solution;
  LinearSolver solver;

  Petsc(MPI_Comm comm, const SolverOptions& options) : solver(comm, "projection", options, "yarn") {}
};

ProjectionSystem::ProjectionSystem(const DistributedMesh& mesh, const SolverOptions& options)
    : mesh_(mesh), petsc_(std::make_unique<Petsc>(mesh.comm, options)) {
  Petsc& p = *petsc_;
  p.rows = pattern_of(mesh);
  p.links = links_of(mesh, p.rows);
  p.yarns.diagonal.resize(mesh.edges.owned);
  p.yarns.to_previous.resize(mesh.edges.owned);
  const PetscInt owned = mesh.edges.owned, total = checked(mesh.edges.total);
  auto &own = p.rows.own, &ghost = p.rows.ghost;
  check(MatCreateMPIAIJWithSplitArrays(mesh.comm, owned, owned, total, total, own.offsets.data(), own.columns.data(),
                                       own.values.data(), ghost.offsets.data(), ghost.columns.data(),
                                       ghost.values.data(), p.matrix.address()));
  check(MatSetOption(p.matrix, MAT_SPD, PETSC_TRUE));
  check(MatCreateVecs(p.matrix, p.solution.address(), p.rhs.address()));
  attach(p.matrix, &p.yarns);
  check(KSPSetOperators(p.solver, p.matrix, p.matrix));
}

ProjectionSystem::~ProjectionSystem() = default;

void ProjectionSystem::assemble(std::span<const Vec3> gradient, std::span<const double> inverse_mass,
                                std::span<const double> shift) {
  Petsc& p = *petsc_;
  std::fill(p.rows.own.values.begin(), p.rows.own.values.end(), 0.0);
  std::fill(p.rows.ghost.values.begin(), p.rows.ghost.values.end(), 0.0);
  auto coupling = p.rows.coupling.begin();
  for (Local e = 0; e < mesh_.edges.owned; ++e) {
    const auto& [a, b] = mesh_.edge_vertices[e];
    const Vec3& g = gradient[e];
    const double mobility = inverse_mass[a] + inverse_mass[b];
    p.yarns.diagonal[e] = mobility > 0 ? mobility * g.squaredNorm() + shift[e] : 1.0;
    p.rows.value(p.rows.diagonal[e]) = p.yarns.diagonal[e];
    for_each_coupling(mesh_, e, [&](Local vertex, Local other, double sign) {
      p.rows.value(*coupling++) += sign * inverse_mass[vertex] * g.dot(gradient[other]);
    });
    p.yarns.to_previous[e] = p.links[e] >= 0 ? p.rows.own.values[p.links[e]] : 0.0;
  }
  Mat own = nullptr, ghost = nullptr;
  check(MatMPIAIJGetSeqAIJ(p.matrix, &own, &ghost, nullptr));
  for (Mat m : {own, ghost, Mat(p.matrix)}) mark_changed(m);
}

SolveReport ProjectionSystem::solve(std::span<const double> rhs, double tolerance, std::vector<double>& mu) {
  Petsc& p = *petsc_;
  double* values = nullptr;
  check(VecGetArrayWrite(p.rhs, &values));
  std::copy(rhs.begin(), rhs.begin() + mesh_.edges.owned, values);
  check(VecRestoreArrayWrite(p.rhs, &values));
  const SolveReport report = p.solver.solve(p.rhs, p.solution, tolerance);
  const double* solved = nullptr;
  check(VecGetArrayRead(p.solution, &solved));
  std::copy(solved, solved + mesh_.edges.owned, mu.begin());
  check(VecRestoreArrayRead(p.solution, &solved));
  mesh_.edge_halo.update(mu);
  return report;
}

} // namespace taut
