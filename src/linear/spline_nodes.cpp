#include "src/linear/spline_nodes.hpp"

#include "partition/sort_unique.hpp"

#include <algorithm>
#include <numeric>

namespace taut {

namespace {

/// The owner of each node, given by key: the lowest rank that is a `candidate` for it, or, so that owners
/// have some hundreds of nodes and a factor within one is worth something, every second, third, ... rank at
/// or before it. A node is told to the rank its key says, which decides. Collective.
std::vector<int> owners_of(MPI_Comm comm, std::span<const Global> keys, std::span<const char> candidate) {
  struct Claim {
    Global key;
    Global rank; ///< -1 if this rank only asks
  };
  const int ranks = size_of(comm), here = rank_of(comm);
  std::vector<Claim> claims;
  std::vector<int> judge;
  for (std::size_t n = 0; n < keys.size(); ++n) {
    claims.push_back({keys[n], candidate[n] ? here : -1});
    judge.push_back(int(std::uint64_t(keys[n]) * 2654435761 % std::uint64_t(ranks)));
  }
  const auto heard = exchange(comm, claims, judge);
  std::unordered_map<Global, Global> owner;
  for (const Claim& c : heard.items)
    if (c.rank >= 0) owner.try_emplace(c.key, c.rank); // they arrive in the order of ranks
  constexpr Global enough = 500;
  const Global total = sum_over(comm, Global(owner.size())),
               stride = std::clamp<Global>(enough * ranks / total, 1, ranks);
  std::vector<Global> answers;
  std::vector<int> asker;
  for (int r = 0; r < ranks; ++r)
    for (Global i = heard.offsets[r]; i < heard.offsets[r + 1]; ++i) {
      answers.push_back(owner.at(heard.items[i].key) / stride * stride);
      asker.push_back(r);
    }
  const auto answered = exchange(comm, answers, asker);
  std::vector<Global> next(answered.offsets.begin(), answered.offsets.end());
  std::vector<int> owners;
  for (const int j : judge) owners.push_back(int(answered.items[next[j]++]));
  return owners;
}

} // namespace

template<int degree>
SplineNodes<degree>::SplineNodes(MPI_Comm comm, const SparseRows& rows, std::span<const Vec3> points,
                                 double spacing)
    : cells_(comm, points, spacing), per_cell_(SplineBasis<degree>::nodes_of_cell(cells_.dimension())) {
  sort_points(rows);
  find_near_cells(rows);
  std::vector<Coupling> own = couplings();
  number_nodes(comm, own);
  find_reach();
  make_rows(comm, own);
}

template<int degree>
void SplineNodes<degree>::sort_points(const SparseRows& rows) {
  cell_offsets_.assign(std::size_t(cells_.size()) + 1, 0);
  for (Local i = 0; i < rows.size(); ++i) ++cell_offsets_[cells_.cell_of(i) + 1];
  std::partial_sum(cell_offsets_.begin(), cell_offsets_.end(), cell_offsets_.begin());
  std::vector<std::int64_t> next = cell_offsets_;
  cell_points_.resize(rows.size());
  for (Local i = 0; i < rows.size(); ++i) cell_points_[next[cells_.cell_of(i)]++] = i;
}

template<int degree>
void SplineNodes<degree>::find_near_cells(const SparseRows& rows) {
  for (Local cell = 0; cell < cells_.size(); ++cell) {
    const auto begin = std::ptrdiff_t(near_.size());
    for (const Local i : points_in(cell))
      for (const Local j : rows.columns(i))
        if (std::find(near_.begin() + begin, near_.end(), cells_.cell_of(j)) == near_.end())
          near_.push_back(cells_.cell_of(j));
    near_offsets_.push_back(std::int64_t(near_.size()));
  }
}

/// All that this rank adds to. Neighbouring cells name the same ones again and again, five times on a flat
/// sheet: what is there already goes before the list has doubled.
template<int degree>
std::vector<typename SplineNodes<degree>::Coupling> SplineNodes<degree>::couplings() const {
  std::vector<Coupling> result;
  std::size_t distinct = 0;
  std::vector<Global> reached;
  for (Local cell = 0; cell < cells_.size(); ++cell) {
    if (result.size() > 2 * distinct) {
      sort_unique(result);
      distinct = result.size();
    }
    reached.clear();
    for (const Local other : near(cell))
      for (const Global key : cells_.node_keys(other)) reached.push_back(key);
    if (reached.empty()) continue;
    sort_unique(reached);
    for (const Global row : cells_.node_keys(cell))
      for (const Global column : reached) result.emplace_back(row, column);
  }
  sort_unique(result);
  return result;
}

/// Owned nodes, then ghosts by owner, each by key. The ghosts are all columns of owned rows, and what the
/// cells of local points have; `own` couplings, told to the rows' owners, come back with those of others to
/// owned rows.
template<int degree>
void SplineNodes<degree>::number_nodes(MPI_Comm comm, std::vector<Coupling>& own) {
  std::vector<Global> keys;
  for (Local cell = 0; cell < cells_.size(); ++cell)
    for (const Global key : cells_.node_keys(cell)) keys.push_back(key);
  sort_unique(keys);
  std::vector<char> candidate(keys.size(), 0);
  const auto place = [&](Global key) {
    return std::lower_bound(keys.begin(), keys.end(), key) - keys.begin();
  };
  for (const auto& [row, column] : own) candidate[place(row)] = 1;
  const std::vector<int> owner = owners_of(comm, keys, candidate);

  struct Told {
    Global row, column, owner_of_column;
  };
  const int here = rank_of(comm);
  std::vector<Told> told;
  std::vector<int> to;
  for (const auto& [row, column] : own)
    if (owner[place(row)] != here) {
      told.push_back({row, column, owner[place(column)]});
      to.push_back(owner[place(row)]);
    }
  const auto heard = exchange(comm, told, to);

  std::vector<std::pair<int, Global>> ghosts; // owner, key
  for (std::size_t n = 0; n < keys.size(); ++n)
    if (owner[n] == here)
      nodes_.original.push_back(keys[n]);
    else
      ghosts.emplace_back(owner[n], keys[n]);
  for (const Told& t : heard.items) {
    own.emplace_back(t.row, t.column);
    if (t.owner_of_column == here)
      nodes_.original.push_back(t.column);
    else
      ghosts.emplace_back(int(t.owner_of_column), t.column);
  }
  sort_unique(own);
  sort_unique(nodes_.original);
  nodes_.owned = Local(nodes_.original.size());
  sort_unique(ghosts);
  for (const auto& [rank, key] : ghosts) {
    nodes_.original.push_back(key);
    nodes_.ghost_owners.push_back(rank);
  }
  halo_ = Halo(comm, nodes_);
  for (std::size_t n = 0; n < nodes_.original.size(); ++n) {
    local_[nodes_.original[n]] = Local(n);
    points_.push_back(cells_.node_point(nodes_.original[n]));
  }
}

template<int degree>
void SplineNodes<degree>::find_reach() {
  for (Local cell = 0; cell < cells_.size(); ++cell)
    for (const Global key : cells_.node_keys(cell)) cell_nodes_.push_back(local_.at(key));
  std::vector<Local> reached;
  for (Local cell = 0; cell < cells_.size(); ++cell) {
    reached.clear();
    for (const Local other : near(cell))
      for (const Local node : nodes_of(other)) reached.push_back(node);
    sort_unique(reached);
    for (const Local other : near(cell))
      for (const Local node : nodes_of(other))
        near_places_.push_back(
            Local(std::lower_bound(reached.begin(), reached.end(), node) - reached.begin()));
    reach_.insert(reach_.end(), reached.begin(), reached.end());
    reach_offsets_.push_back(std::int64_t(reach_.size()));
  }
}

template<int degree>
void SplineNodes<degree>::make_rows(MPI_Comm comm, const std::vector<Coupling>& own) {
  std::vector<std::pair<Local, Local>> entries;
  for (const auto& [row, column] : own) entries.emplace_back(local_.at(row), local_.at(column));
  std::sort(entries.begin(), entries.end());
  offsets_.assign(nodes_.original.size() + 1, 0);
  for (const auto& [row, column] : entries) {
    ++offsets_[row + 1];
    columns_.push_back(column);
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());

  std::vector<Coupling> sent; // the entries of ghosts' rows, and where they are
  std::vector<int> to;
  std::vector<Local> from;
  for (Local row = nodes_.owned; row < nodes_.size(); ++row)
    for (std::int64_t a = offsets_[row]; a < offsets_[row + 1]; ++a) {
      sent.emplace_back(nodes_.original[row], nodes_.original[columns_[a]]);
      to.push_back(nodes_.ghost_owners[row - nodes_.owned]);
      from.push_back(Local(a));
    }
  std::vector<Local> into;
  for (const auto& [row, column] : exchange(comm, sent, to).items) {
    const auto begin = columns_.begin() + offsets_[local_.at(row)],
               end = columns_.begin() + offsets_[local_.at(row) + 1];
    into.push_back(Local(std::lower_bound(begin, end, local_.at(column)) - columns_.begin()));
  }
  to_owners_ = Plan(comm, to, from, std::move(into));
  local_ = {};
}

template class SplineNodes<1>;
template class SplineNodes<2>;

} // namespace taut
