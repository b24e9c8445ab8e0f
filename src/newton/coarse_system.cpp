#include "src/newton/coarse_system.hpp"

#include "partition/sort_unique.hpp"
#include "src/linear/bounding_box.hpp"

#include <cmath>
#include <unordered_map>

namespace taut {

CoarseSystem::CoarseSystem(const DistributedMesh& mesh, const VertexMultigrid& grids,
                           std::span<const RowEdge> entries, std::span<const RowPlace> places)
    : mesh_(mesh), grids_(grids), row_edges_(entries) {
  choose_level();
  node_unknowns_ = Unknown(3 * grids_.grid(level_).total());
  find_tensions(places);
  find_entries();
  make_pattern();
}

void CoarseSystem::choose_level() {
  while (level_ + 1 < grids_.levels()) {
    const Global nodes = grids_.grid(level_).total();
    if (nodes <= most_nodes && vertices_a_node * nodes <= mesh_.vertices.total) return;
    ++level_;
  }
}

namespace {

/// A box of nodes, in which coarse tensions are told apart by keys.
struct TensionBasis {
  Vec3 origin;
  double spacing;
  std::array<bool, 3> wide;

  struct Part {
    Global key;
    double value;
  };

  /// The tensions that a row has, with the values of their functions there.
  std::vector<Part> of(const RowPlace& row) const {
    int along = 0;
    for (int d = 1; d < 3; ++d)
      if (wide[d] && (!wide[along] || std::abs(row.direction[d]) > std::abs(row.direction[along]))) along = d;
    std::vector<Part> parts{{along, row.multiplier}};
    for (int d = 0; d < 3; ++d) {
      const double s = (row.point[d] - origin[d]) / spacing, whole = std::floor(s);
      std::vector<Part> finer;
      for (const auto& [key, value] : parts) {
        const Global first = (key << 20) + (wide[d] ? Global(whole) + 1 : 0);
        if (!wide[d] || d == along)
          finer.push_back({first, value});
        else {
          finer.push_back({first, value * (1 - (s - whole))});
          finer.push_back({first + 1, value * (s - whole)});
        }
      }
      parts = std::move(finer);
    }
    return parts;
  }
};

/// With cells between the nodes of the grid. Collective.
TensionBasis tension_basis(MPI_Comm comm, std::span<const Vec3> nodes, double spacing) {
  const BoundingBox box = bounding_box(comm, nodes);
  TensionBasis basis{box.lowest, spacing, {}};
  for (int d = 0; d < 3; ++d) basis.wide[d] = box.highest[d] - box.lowest[d] > 0.5 * spacing;
  return basis;
}

/// The global numbers of all nodes by their keys, on every rank. Collective.
std::unordered_map<Global, std::int32_t> numbers_of(MPI_Comm comm, const IndexMap& nodes) {
  struct Numbered {
    Global key, number;
  };
  std::vector<Numbered> mine;
  for (Local i = 0; i < nodes.owned; ++i) mine.push_back({nodes.original[i], nodes.global(i)});
  std::unordered_map<Global, std::int32_t> result;
  for (const auto& [key, number] : gather_to_all<Numbered>(comm, mine)) result[key] = std::int32_t(number);
  return result;
}

} // namespace

void CoarseSystem::find_tensions(std::span<const RowPlace> places) {
  const auto& grid = grids_.grid(level_);
  const TensionBasis basis = tension_basis(mesh_.comm, grid.points(), grids_.spacing(level_));
  std::vector<Global> keys;
  for (const RowPlace& place : places)
    for (const auto& part : basis.of(place)) keys.push_back(part.key);
  sort_unique(keys);
  keys = gather_to_all<Global>(mesh_.comm, keys);
  sort_unique(keys);
  for (const RowPlace& place : places) {
    for (const auto& [key, value] : basis.of(place)) {
      const auto number = std::lower_bound(keys.begin(), keys.end(), key) - keys.begin();
      tensions_.push_back({node_unknowns_ + Unknown(number), value});
    }
    tension_begin_.push_back(tensions_.size());
  }
  unknowns_ = node_unknowns_ + Unknown(keys.size());
}

/// All in which an end of an edge moves with a node and a row holds a tension.
void CoarseSystem::find_entries() {
  const std::unordered_map<Global, Unknown> nodes = numbers_of(mesh_.comm, grids_.grid(level_).nodes());
  for (std::size_t k = 0; k < row_edges_.size(); ++k) {
    const RowEdge& e = row_edges_[k];
    for (int end = 0; end < 2; ++end)
      grids_.for_each_weight(level_, mesh_.edge_vertices[e.edge][end], [&](Global node, double weight) {
        const double factor = (end == 1 ? e.factor : -e.factor) * weight;
        for (const Tension& t : tensions_of(e.row))
          if (factor * t.part != 0)
            entries_.push_back({std::uint32_t(k), char(end), nodes.at(node), t.unknown, factor * t.part, 0});
      });
  }
}

/// The lower triangle, the same on all ranks: of each node the columns of its three unknowns, then those of
/// the tensions, which are diagonal.
void CoarseSystem::make_pattern() {
  struct Coupling {
    Unknown node, row; ///< row: the first unknown of a node, or that of a tension
    auto operator<=>(const Coupling&) const = default;
  };
  const auto& grid = grids_.grid(level_);
  std::vector<Coupling> couplings;
  for (Local i = 0; i < grid.nodes().owned; ++i)
    for (const Local j : grid.rows().columns(i))
      if (const Global row = grid.nodes().global(i), column = grid.nodes().global(j); row >= column)
        couplings.push_back({Unknown(column), Unknown(3 * row)});
  for (const Entry& e : entries_) couplings.push_back({e.node, e.tension});
  sort_unique(couplings);
  couplings = gather_to_all<Coupling>(mesh_.comm, couplings);
  sort_unique(couplings);

  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& [node, row] : couplings)
    for (Unknown column = 3 * node; column < 3 * node + 3; ++column)
      if (row >= node_unknowns_)
        triplets.emplace_back(row, column, 0.0);
      else
        for (Unknown k = std::max(row, column); k < row + 3; ++k) triplets.emplace_back(k, column, 0.0);
  for (Unknown t = node_unknowns_; t < unknowns_; ++t) triplets.emplace_back(t, t, 0.0);
  matrix_.resize(unknowns_, unknowns_);
  matrix_.setFromTriplets(triplets.begin(), triplets.end());
  factor_.analyzePattern(matrix_);

  for (Entry& e : entries_) e.place = place_of(e.tension, e.node);
  for (Local i = 0; i < grid.nodes().owned; ++i)
    for (const Local j : grid.rows().columns(i)) {
      const Global row = grid.nodes().global(i), column = grid.nodes().global(j);
      grid_places_.push_back(row >= column ? place_of(Unknown(3 * row), Unknown(column)) : -1);
    }
}

/// Of the entry in the first of a node's three columns, counted from where that begins.
CoarseSystem::Unknown CoarseSystem::place_of(Unknown row, Unknown node) const {
  const Unknown *const begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[3 * node],
                       *const end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[3 * node + 1];
  return Unknown(std::lower_bound(begin, end, row) - begin);
}

void CoarseSystem::set(std::span<const Vec3> gradients, const Freedom& freedom,
                       std::span<const double> compliance) {
  std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
  add_grid();
  add_rows(gradients, freedom, compliance);
  sum_in_place(mesh_.comm, {matrix_.valuePtr(), std::size_t(matrix_.nonZeros())});
  regularise();
  factor_.factorize(matrix_);
}

void CoarseSystem::add_grid() {
  const auto& grid = grids_.grid(level_);
  auto place = grid_places_.begin();
  auto block = grid.values().begin();
  for (Local i = 0; i < grid.nodes().owned; ++i)
    for (const Local j : grid.rows().columns(i)) {
      if (*place >= 0) {
        const auto node = Unknown(grid.nodes().global(j));
        const bool diagonal = i == j;
        for (int b = 0; b < 3; ++b)
          for (int a = diagonal ? b : 0; a < 3; ++a) value(node, *place, a, b) += double((*block)(a, b));
      }
      ++place;
      ++block;
    }
}

void CoarseSystem::add_rows(std::span<const Vec3> gradients, const Freedom& freedom,
                            std::span<const double> compliance) {
  for (const Entry& e : entries_) {
    const Local edge = row_edges_[e.row_edge].edge;
    const Vec3 g = e.factor * freedom.allowed(mesh_.edge_vertices[edge][e.end], gradients[edge]);
    for (int b = 0; b < 3; ++b) value(e.node, e.place, 0, b) += g[b];
  }
  for (std::size_t row = 0; row < compliance.size(); ++row)
    for (const Tension& t : tensions_of(row)) diagonal(t.unknown) -= compliance[row] * t.part * t.part;
}

/// Nodes that only held vertices have get the identity, and every tension yields a little, so that those
/// which others make needless do no harm: the matrix then is quasi-definite, and has a factor in any order.
void CoarseSystem::regularise() {
  constexpr double little = 1e-8;
  double largest = 0;
  for (Unknown k = 0; k < node_unknowns_; ++k) largest = std::max(largest, diagonal(k));
  std::vector<double> yields(std::size_t(unknowns_ - node_unknowns_), 0.0);
  for (Unknown k = 0; k < node_unknowns_; ++k) {
    double& d = diagonal(k);
    d = d > 0 ? d * (1 + little) : std::max(largest, 1.0);
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix_, k); entry; ++entry)
      if (entry.row() >= node_unknowns_)
        yields[entry.row() - node_unknowns_] += entry.value() * entry.value() / d;
  }
  for (Unknown t = node_unknowns_; t < unknowns_; ++t) {
    const double least = little * yields[t - node_unknowns_];
    diagonal(t) = least > 0 ? std::min(diagonal(t), -least) : -1.0;
  }
}

void CoarseSystem::solve(std::span<const Vec3> r, std::span<const double> c, std::vector<Vec3>& u,
                         std::span<double> m) const {
  const auto& nodes = grids_.grid(level_).nodes();
  std::vector<double> rhs(std::size_t(unknowns_), 0.0);
  for (Local i = 0; i < nodes.owned; ++i)
    for (int d = 0; d < 3; ++d) rhs[3 * nodes.global(i) + d] = r[i][d];
  for (std::size_t row = 0; row < c.size(); ++row)
    for (const Tension& t : tensions_of(row)) rhs[t.unknown] += t.part * c[row];
  sum_in_place(mesh_.comm, rhs);
  const Eigen::VectorXd solution = factor_.solve(Eigen::Map<const Eigen::VectorXd>(rhs.data(), unknowns_));
  u.resize(std::size_t(nodes.size()));
  for (Local i = 0; i < nodes.owned; ++i) u[i] = solution.segment<3>(Eigen::Index(3 * nodes.global(i)));
  for (std::size_t row = 0; row < m.size(); ++row) {
    m[row] = 0;
    for (const Tension& t : tensions_of(row)) m[row] += t.part * solution[t.unknown];
  }
}

} // namespace taut
