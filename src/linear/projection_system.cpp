#include "src/linear/projection_system.hpp"

#include "partition/sort_unique.hpp"
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
  /// A place in a row of `own`, or if negative, -1 - a place in the row of `ghost`.
  using Place = std::int16_t;
  /// Of each row: the star of its first vertex, then of its second, without itself.
  std::vector<Place> coupling;
  std::vector<Place> diagonal;

  double& value(Local row, Place place) {
    return place >= 0 ? own.values[own.offsets[row] + place] : ghost.values[ghost.offsets[row] - 1 - place];
  }
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
    sort_unique(row);
    part.columns.insert(part.columns.end(), row.begin(), row.end());
    part.offsets.push_back(PetscInt(part.columns.size()));
  };
  append(own, rows.own);
  append(ghost, rows.ghost);
}

SplitRows::Place place_in(const SplitRows::Part& part, Local row, PetscInt column) {
  const auto begin = part.columns.begin() + part.offsets[row],
             end = part.columns.begin() + part.offsets[row + 1];
  const auto place = std::lower_bound(begin, end, column) - begin;
  if (place > std::numeric_limits<SplitRows::Place>::max())
    throw std::runtime_error("an edge of the mesh meets more than 32 767 others");
  return SplitRows::Place(place);
}

/// Of (edge, other).
SplitRows::Place place_of(const DistributedMesh& mesh, const SplitRows& rows, Local edge, Local other) {
  if (mesh.owns_edge(other)) return place_in(rows.own, edge, other);
  return SplitRows::Place(-1 - place_in(rows.ghost, edge, PetscInt(mesh.edges.global(other))));
}

SplitRows pattern_of(const DistributedMesh& mesh) {
  SplitRows rows;
  std::size_t couplings = 0;
  for (Local e = 0; e < mesh.edges.owned; ++e)
    for_each_coupling(mesh, e, [&](Local, Local, double) { ++couplings; });
  rows.coupling.reserve(couplings);
  rows.own.columns.reserve(couplings + std::size_t(mesh.edges.owned));
  for (auto* offsets : {&rows.own.offsets, &rows.ghost.offsets}) offsets->reserve(mesh.edges.owned + 1);
  rows.diagonal.reserve(mesh.edges.owned);
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

/// The couplings along yarns, from segment to segment: where they are in the rows, and where in a
/// YarnTridiagonal. (Inside a segment, edge e - 1 stands before e in the row of e.)
struct YarnLinks {
  struct Link {
    Local row;
    SplitRows::Place place;
    Local knot;
  };
  std::vector<Link> between; ///< to `to_segment_before`
};

YarnLinks links_of(const DistributedMesh& mesh, const Yarns& yarns, const SplitRows& rows) {
  YarnLinks links;
  for (std::size_t k = 0; k < yarns.knots.size(); ++k)
    if (yarns.before_knot[k] >= 0)
      links.between.push_back(
          {yarns.knots[k], place_of(mesh, rows, yarns.knots[k], yarns.before_knot[k]), Local(k)});
  return links;
}

} // namespace

struct ProjectionSystem::Petsc {
  SplitRows rows;
  Yarns yarns;
  YarnLinks links;
  YarnBlocks blocks;
  OwnedMat matrix;
  OwnedMat shell; ///< stands for `operation`; made when it is first needed
  const Operator* operation = nullptr;
  OwnedVec solution;
  OwnedVec rhs, factor, product; ///< without memory of their own
  LinearSolver solver;

  Petsc(const DistributedMesh& mesh, const SolverOptions& options)
      : rows(pattern_of(mesh)), yarns(find_yarns(mesh)),
        links(links_of(mesh, yarns, rows)), blocks{YarnTridiagonal(yarns), YarnFactor(yarns), {}},
        solver(mesh.comm, "projection", options, "yarn") {}

  void fill(const DistributedMesh& mesh, std::span<const Vec3> row_gradient,
            std::span<const Vec3> column_gradient, std::span<const double> inverse_mass,
            const Freedom& freedom, std::span<const double> scaled_compliance);
  SolveReport solve(const DistributedMesh& mesh, Mat system, std::span<const double> b, double tolerance,
                    std::vector<double>& mu);

  void update_blocks(const DistributedMesh& mesh) {
    for (Local e = 0; e < mesh.edges.owned; ++e) blocks.matrix.diagonal[e] = rows.value(e, rows.diagonal[e]);
    for (const YarnSegment& s : yarns.segments)
      for (Local e = s.begin + 1; e < s.end; ++e)
        blocks.matrix.to_previous[e] = rows.value(e, SplitRows::Place(rows.diagonal[e] - 1));
    for (const auto& [row, place, knot] : links.between)
      blocks.matrix.to_segment_before[knot] = rows.value(row, place);
  }

  void mark() {
    Mat own = nullptr, ghost = nullptr;
    check(MatMPIAIJGetSeqAIJ(matrix, &own, &ghost, nullptr));
    for (Mat m : {own, ghost, Mat(matrix)}) mark_changed(m);
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
  if (options.matrix == SolverOptions::Matrix::positive_definite)
    check(MatSetOption(p.matrix, MAT_SPD, PETSC_TRUE));
  check(MatCreateVecs(p.matrix, p.solution.address(), nullptr));
  for (OwnedVec* v : {&p.rhs, &p.factor, &p.product})
    check(VecCreateMPIWithArray(mesh.comm, 1, owned, total, nullptr, v->address()));
  attach(p.matrix, p.blocks);
}

ProjectionSystem::~ProjectionSystem() = default;

void ProjectionSystem::Petsc::fill(const DistributedMesh& mesh, std::span<const Vec3> row_gradient,
                                   std::span<const Vec3> column_gradient,
                                   std::span<const double> inverse_mass, const Freedom& freedom,
                                   std::span<const double> scaled_compliance) {
  std::fill(rows.own.values.begin(), rows.own.values.end(), 0.0);
  std::fill(rows.ghost.values.begin(), rows.ghost.values.end(), 0.0);
  auto coupling = rows.coupling.begin();
  for (Local e = 0; e < mesh.edges.owned; ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const Vec3 at_a = inverse_mass[a] * freedom.allowed(a, row_gradient[e]),
               at_b = inverse_mass[b] * freedom.allowed(b, row_gradient[e]); // a row of J W
    const bool can_change = !at_a.isZero(0) || !at_b.isZero(0);
    rows.value(e, rows.diagonal[e]) =
        can_change ? (at_a + at_b).dot(column_gradient[e]) + scaled_compliance[e] : 1.0;
    for_each_coupling(mesh, e, [&, a = a](Local vertex, Local other, double sign) {
      rows.value(e, *coupling++) += sign * (vertex == a ? at_a : at_b).dot(column_gradient[other]);
    });
  }
}

void ProjectionSystem::assemble(std::span<const Vec3> gradient, std::span<const double> inverse_mass,
                                std::span<const double> scaled_compliance) {
  assemble(gradient, inverse_mass, Freedom(inverse_mass.size()), scaled_compliance);
}

void ProjectionSystem::assemble(std::span<const Vec3> gradient, std::span<const double> inverse_mass,
                                const Freedom& freedom, std::span<const double> scaled_compliance) {
  Petsc& p = *petsc_;
  p.fill(mesh_, gradient, gradient, inverse_mass, freedom, scaled_compliance);
  p.update_blocks(mesh_);
  p.mark();
}

void ProjectionSystem::assemble(std::span<const Vec3> rows, std::span<const Vec3> columns,
                                std::span<const double> inverse_mass, const Freedom& freedom,
                                std::span<const double> scaled_compliance) {
  Petsc& p = *petsc_;
  p.fill(mesh_, columns, columns, inverse_mass, freedom, scaled_compliance);
  p.update_blocks(mesh_);
  p.fill(mesh_, rows, columns, inverse_mass, freedom, scaled_compliance);
  p.mark();
}

SolveReport ProjectionSystem::Petsc::solve(const DistributedMesh& mesh, Mat system, std::span<const double> b,
                                           double tolerance, std::vector<double>& mu) {
  check(KSPSetOperators(solver, system, matrix));
  check(VecPlaceArray(rhs, b.data()));
  const SolveReport report = solver.solve(rhs, solution, tolerance);
  check(VecResetArray(rhs));
  take(solution, std::span(mu).first(std::size_t(mesh.edges.owned)));
  mesh.edge_halo.update(mu);
  return report;
}

SolveReport ProjectionSystem::solve(std::span<const double> rhs, double tolerance, std::vector<double>& mu) {
  return petsc_->solve(mesh_, petsc_->matrix, rhs, tolerance, mu);
}

namespace {

PetscErrorCode apply_operation(Mat shell, Vec x, Vec y) {
  void* operation = nullptr;
  MatShellGetContext(shell, &operation);
  return on_arrays(x, y, [operation](std::span<const double> from, std::span<double> to) {
    (**static_cast<const ProjectionSystem::Operator**>(operation))(from, to);
  });
}

} // namespace

SolveReport ProjectionSystem::solve(const Operator& a, std::span<const double> rhs, double tolerance,
                                    std::vector<double>& mu, std::span<const double> added_to_inverse) {
  Petsc& p = *petsc_;
  p.operation = &a;
  if (!p.shell) {
    const PetscInt owned = mesh_.edges.owned;
    check(MatCreateShell(mesh_.comm, owned, owned, PETSC_DETERMINE, PETSC_DETERMINE, &p.operation,
                         p.shell.address()));
    check(MatShellSetOperation(p.shell, MATOP_MULT, reinterpret_cast<void (*)()>(apply_operation)));
    check(MatSetOption(p.shell, MAT_SPD, PETSC_TRUE));
  }
  p.blocks.added_to_inverse = added_to_inverse;
  const SolveReport report = p.solve(mesh_, p.shell, rhs, tolerance, mu);
  p.blocks.added_to_inverse = {};
  return report;
}

const Yarns& ProjectionSystem::yarns() const { return petsc_->yarns; }

void ProjectionSystem::multiply(std::span<const double> mu, std::span<double> product) {
  Petsc& p = *petsc_;
  check(VecPlaceArray(p.factor, mu.data()));
  check(VecPlaceArray(p.product, product.data()));
  check(MatMult(p.matrix, p.factor, p.product));
  check(VecResetArray(p.product));
  check(VecResetArray(p.factor));
}

} // namespace taut
