#include "src/linear/projection_system.hpp"

#include "src/linear/krylov.hpp"
#include "src/linear/yarn_preconditioner.hpp"

#include <algorithm>
#include <limits>

namespace taut {

namespace {

/// Rows of owned edges, split into columns of owned and of ghost edges as PETSc stores them, and for every
/// coupling, in the order in which assembly meets it, where its value goes.
struct SplitRows {
  struct Part {
    std::vector<PetscInt> offsets{0}, columns;
    std::vector<double> values;
  };
  Part own, ghost;
  /// Of each row: the star of its first vertex, then of its second, without itself. A place in `own.values`,
  /// or if negative, -1 - a place in `ghost.values`.
  std::vector<PetscInt> coupling;
  std::vector<PetscInt> diagonal;

  double& value(PetscInt place) { return place >= 0 ? own.values[place] : ghost.values[-1 - place]; }
};

PetscInt checked(Global number) {
  if (number > std::numeric_limits<PetscInt>::max())
    throw std::runtime_error(
        "the mesh has more edges than this PETSc can number: use one built with 64-bit indices");
  return PetscInt(number);
}

template<class Visit>
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
    if (mesh.owns_edge(other))
      own.push_back(other);
    else
      ghost.push_back(checked(mesh.edges.global(other)));
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
  const auto begin = part.columns.begin() + part.offsets[row],
             end = part.columns.begin() + part.offsets[row + 1];
  return PetscInt(std::lower_bound(begin, end, column) - part.columns.begin());
}

/// The place of (edge, other) as in SplitRows::coupling.
PetscInt place_of(const DistributedMesh& mesh, const SplitRows& rows, Local edge, Local other) {
  return mesh.owns_edge(other) ? place_in(rows.own, edge, other)
                               : -1 - place_in(rows.ghost, edge, PetscInt(mesh.edges.global(other)));
}

SplitRows pattern_of(const DistributedMesh& mesh) {
  SplitRows rows;
  for (Local e = 0; e < mesh.edges.owned; ++e) append_row(mesh, e, rows);
  rows.own.values.assign(rows.own.columns.size(), 0.0);
  rows.ghost.values.assign(rows.ghost.columns.size(), 0.0);
  for (Local e = 0; e < mesh.edges.owned; ++e) {
    rows.diagonal.push_back(place_in(rows.own, e, e));
    for_each_coupling(mesh, e, [&](Local, Local other, double) {
      rows.coupling.push_back(place_of(mesh, rows, e, other));
    });
  }
  return rows;
}

/// The couplings along yarns: where they are in the rows, and where in a YarnTridiagonal.
struct YarnLinks {
  struct Link {
    PetscInt place;
    Local target;
  };
  std::vector<Link> inside, between; ///< to `to_previous`, to `to_segment_before`
};

YarnLinks links_of(const DistributedMesh& mesh, const Yarns& yarns, const SplitRows& rows) {
  YarnLinks links;
  for (Local e = 0; e < mesh.edges.owned; ++e)
    if (mesh.continues_yarn[e]) links.inside.push_back({place_in(rows.own, e, e - 1), e});
  for (std::size_t k = 0; k < yarns.knots.size(); ++k)
    if (yarns.before_knot[k] >= 0)
      links.between.push_back({place_of(mesh, rows, yarns.knots[k], yarns.before_knot[k]), Local(k)});
  return links;
}

} // namespace

struct ProjectionSystem::Petsc {
  SplitRows rows;
  Yarns yarns;
  YarnLinks links;
  YarnBlocks blocks;
  OwnedMat matrix;
  OwnedVec rhs, solution;
  LinearSolver solver;
  bool yarns_are_factored = false; ///< by solve_yarns

  Petsc(const DistributedMesh& mesh, const SolverOptions& options)
      : rows(pattern_of(mesh)), yarns(find_yarns(mesh)),
        links(links_of(mesh, yarns, rows)), blocks{{}, YarnFactor(yarns)},
        solver(mesh.comm, "projection", options, "yarn") {
    blocks.matrix.diagonal.assign(mesh.edges.owned, 0.0);
    blocks.matrix.to_previous.assign(mesh.edges.owned, 0.0);
    blocks.matrix.to_segment_before.assign(yarns.knots.size(), 0.0);
  }

  void update_blocks() {
    yarns_are_factored = false;
    for (std::size_t e = 0; e < rows.diagonal.size(); ++e)
      blocks.matrix.diagonal[e] = rows.value(rows.diagonal[e]);
    for (const auto& [place, edge] : links.inside) blocks.matrix.to_previous[edge] = rows.value(place);
    for (const auto& [place, knot] : links.between) blocks.matrix.to_segment_before[knot] = rows.value(place);
  }
};

ProjectionSystem::ProjectionSystem(const DistributedMesh& mesh, const SolverOptions& options)
    : mesh_(mesh), petsc_(std::make_unique<Petsc>(mesh, options)) {
  Petsc& p = *petsc_;
  const PetscInt owned = mesh.edges.owned, total = checked(mesh.edges.total);
  auto &own = p.rows.own, &ghost = p.rows.ghost;
  check(MatCreateMPIAIJWithSplitArrays(mesh.comm, owned, owned, total, total, own.offsets.data(),
                                       own.columns.data(), own.values.data(), ghost.offsets.data(),
                                       ghost.columns.data(), ghost.values.data(), p.matrix.address()));
  check(MatSetOption(p.matrix, MAT_SPD, PETSC_TRUE));
  check(MatCreateVecs(p.matrix, p.solution.address(), p.rhs.address()));
  attach(p.matrix, p.blocks);
  check(KSPSetOperators(p.solver, p.matrix, p.matrix));
}

ProjectionSystem::~ProjectionSystem() = default;

void ProjectionSystem::assemble(std::span<const Vec3> gradient, std::span<const double> inverse_mass,
                                std::span<const double> shift) {
  assemble(gradient, inverse_mass, Freedom(inverse_mass.size()), shift);
}

void ProjectionSystem::assemble(std::span<const Vec3> gradient, std::span<const double> inverse_mass,
                                const Freedom& freedom, std::span<const double> shift) {
  Petsc& p = *petsc_;
  std::fill(p.rows.own.values.begin(), p.rows.own.values.end(), 0.0);
  std::fill(p.rows.ghost.values.begin(), p.rows.ghost.values.end(), 0.0);
  auto coupling = p.rows.coupling.begin();
  for (Local e = 0; e < mesh_.edges.owned; ++e) {
    const auto& [a, b] = mesh_.edge_vertices[e];
    const Vec3& g = gradient[e];
    const double mobility = inverse_mass[a] * freedom.allowed(a, g).squaredNorm() +
                            inverse_mass[b] * freedom.allowed(b, g).squaredNorm();
    p.rows.value(p.rows.diagonal[e]) = mobility > 0 ? mobility + shift[e] : 1.0;
    for_each_coupling(mesh_, e, [&](Local vertex, Local other, double sign) {
      p.rows.value(*coupling++) +=
          sign * inverse_mass[vertex] * freedom.allowed(vertex, g).dot(gradient[other]);
    });
  }
  p.update_blocks();
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

void ProjectionSystem::solve_yarns(std::span<const double> b, std::span<double> x) {
  Petsc& p = *petsc_;
  if (!p.yarns_are_factored) p.blocks.factor.factor(p.blocks.matrix);
  p.yarns_are_factored = true;
  p.blocks.factor.solve(b, x);
}

} // namespace taut
