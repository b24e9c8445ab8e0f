#include "partition/ptscotch.hpp"

#include <cstdint>
#include <cstdio>
#include <limits>

#include <ptscotch.h> // needs MPI and the two above

namespace taut {

namespace {

/// PT-Scotch 7 would otherwise work, and communicate, in several threads of each rank, which MPI was not
/// started for: it then waits for ever.
class SingleThread {
public:
  explicit SingleThread(SCOTCH_Dgraph& graph) {
    SCOTCH_contextInit(&context_);
    SCOTCH_contextThreadSpawn(&context_, 1, nullptr);
    SCOTCH_contextBindDgraph(&context_, &graph, &bound_);
  }
  ~SingleThread() {
    SCOTCH_dgraphExit(&bound_);
    SCOTCH_contextExit(&context_);
  }
  SingleThread(const SingleThread&) = delete;

  SCOTCH_Dgraph* graph() { return &bound_; }

private:
  SCOTCH_Context context_;
  SCOTCH_Dgraph bound_;
};

/// The graph in PT-Scotch's hands; the arrays stay here.
class ScotchGraph {
public:
  ScotchGraph(MPI_Comm comm, const PartitionGraph& graph)
      : begin_(graph.begin.begin(), graph.begin.end()), work_(graph.work.begin(), graph.work.end()) {
    neighbours_.reserve(graph.neighbours.size() + 1); // so that even an empty slab has an address
    neighbours_.assign(graph.neighbours.begin(), graph.neighbours.end());
    const bool is_even = !any_of(comm, !work_.empty());
    work_.reserve(1);
    status_ = SCOTCH_dgraphInit(&graph_, comm);
    if (status_ != 0) return;
    const SCOTCH_Num vertices = SCOTCH_Num(begin_.size()) - 1, ends = SCOTCH_Num(neighbours_.size());
    status_ = SCOTCH_dgraphBuild(&graph_, 0, vertices, vertices, begin_.data(), begin_.data() + 1,
                                 is_even ? nullptr : work_.data(), nullptr, ends, ends, neighbours_.data(),
                                 nullptr, nullptr);
  }
  ~ScotchGraph() { SCOTCH_dgraphExit(&graph_); }
  ScotchGraph(const ScotchGraph&) = delete;

  bool sound() const { return status_ == 0; }

  /// False if PT-Scotch refuses.
  bool cut(int ranks, int parts, std::vector<SCOTCH_Num>& part) {
    constexpr double imbalance = 0.01; // over the mean, as METIS is told
    SCOTCH_Strat strategy;
    SCOTCH_stratInit(&strategy);
    SCOTCH_randomReset(); // the same parts each time
    SingleThread thread(graph_);
    const bool done =
        SCOTCH_stratDgraphMapBuild(&strategy, SCOTCH_STRATBALANCE, ranks, parts, imbalance) == 0 &&
        SCOTCH_dgraphPart(thread.graph(), parts, &strategy, part.data()) == 0;
    SCOTCH_stratExit(&strategy);
    return done;
  }

private:
  SCOTCH_Dgraph graph_;
  int status_ = 0;
  std::vector<SCOTCH_Num> begin_, work_, neighbours_;
};

} // namespace

std::vector<int> ptscotch_parts(MPI_Comm comm, const Slab& vertices, const PartitionGraph& graph, int parts) {
  if (sum_over(comm, Global(graph.neighbours.size())) > std::numeric_limits<SCOTCH_Num>::max())
    throw InputError("the mesh has more edges than this PT-Scotch can number; link one that was built with "
                     "64-bit integers, or try partition.method: stripes");
  ScotchGraph in_scotch(comm, graph);
  std::vector<SCOTCH_Num> part(std::size_t(vertices.count) + 1);
  const bool refused =
      any_of(comm, !in_scotch.sound()) || any_of(comm, !in_scotch.cut(size_of(comm), parts, part));
  if (refused)
    throw InputError("PT-Scotch could not partition the mesh; try partition.method: metis or stripes");
  return {part.begin(), part.end() - 1};
}

} // namespace taut
