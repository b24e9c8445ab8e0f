#include "src/contact/element_search.hpp"

#include <algorithm>
#include <numeric>

namespace taut {

namespace {

constexpr int blocks_per_rank = 32;

/// Of two ranks, whether `rank` sends its elements to `other` and leaves the search to it; evenly shared.
bool sends_to(int rank, int other) { return ((rank + other) % 2 == 0) == (rank < other) && rank != other; }

/// The boxes of consecutive runs of elements; always the same number of them.
std::vector<Box> blocks_of(std::span<const Box> boxes) {
  std::vector<Box> blocks(blocks_per_rank);
  for (std::size_t i = 0; i < boxes.size(); ++i) blocks[i * blocks_per_rank / boxes.size()].include(boxes[i]);
  return blocks;
}

Box around(std::span<const Box> boxes) {
  Box all;
  for (const Box& b : boxes) all.include(b);
  return all;
}

} // namespace

ElementSearch::ElementSearch(const Cloth& cloth, const Obstacles& obstacles)
    : cloth_(cloth), obstacles_(obstacles) {
  const DistributedMesh& mesh = cloth.mesh;
  const int me = rank_of(mesh.comm);
  const Local own = mesh.vertices.owned;
  std::vector<Local> place(mesh.vertices.size());
  std::iota(place.begin(), place.end(), 0);
  mesh.vertex_halo.update(place);
  for (Local i = 0; i < mesh.vertices.size(); ++i)
    known_.push_back({mesh.owns_vertex(i) ? me : mesh.vertices.ghost_owners[i - own], place[i],
                      mesh.vertices.original[i]});
  for (Local k = 0; k < obstacles.vertices(); ++k) known_.push_back({me, own + k, mesh.vertices.total + k});
  elements_ = cloth_elements(mesh);
  own_ = Local(elements_.size());
  for (Element e : obstacles.elements()) {
    for (int k = 0; k < e.corners; ++k) e.vertices[k] += mesh.vertices.size();
    elements_.push_back(e);
  }
  known_elements_ = Local(elements_.size());
}

void ElementSearch::find(const Motion& motion, double reach) {
  reach_ = reach;
  take_positions(motion);
  elements_.resize(known_elements_);
  boxes_.clear();
  balls_.clear();
  pairs_.clear();
  const BoxTree own = bound(0, own_), bodies = bound(own_, known_elements_);
  append_pairs(own.pairs(), 0);
  append_pairs(own.pairs_with(bodies), own_);
  receive_elements();
  append_pairs(own.pairs_with(bound(known_elements_, Local(elements_.size()))), known_elements_);
}

void ElementSearch::append_pairs(std::span<const BoxPair> found, Local first) {
  for (const auto& [i, j] : found) pairs_.emplace_back(i, first + j);
}

void ElementSearch::largest_of_elements(std::span<const double> cloth, double elsewhere,
                                        std::vector<double>& largest) const {
  largest.assign(elements_.size(), 0.0);
  for (Local i = 0; i < own_; ++i)
    for (int k = 0; k < elements_[i].corners; ++k)
      largest[i] = std::max(largest[i], cloth[elements_[i].vertices[k]]);
  std::fill(largest.begin() + known_elements_, largest.end(), elsewhere);
}

/// Positions and displacements of the known vertices. What all have in common does not bring anything
/// together: the mean motion is taken out.
void ElementSearch::take_positions(const Motion& m) {
  vertices_ = known_;
  x_.assign(m.cloth_from.begin(), m.cloth_from.end());
  x_.insert(x_.end(), m.obstacles_from.begin(), m.obstacles_from.end());
  std::array<double, 3> sum{};
  u_.clear();
  for (std::size_t i = 0; i < m.cloth_from.size(); ++i) u_.emplace_back(m.cloth_to[i] - m.cloth_from[i]);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    for (int k = 0; k < 3; ++k) sum[k] += u_[i][k];
  sum_in_place(cloth_.mesh.comm, sum);
  for (std::size_t i = 0; i < m.obstacles_from.size(); ++i)
    u_.emplace_back(m.obstacles_to[i] - m.obstacles_from[i]);
  slack_.assign(m.cloth_slack.begin(), m.cloth_slack.end());
  slack_.resize(x_.size(), 0.0);
  const Vec3 mean = Vec3(sum[0], sum[1], sum[2]) / double(cloth_.mesh.vertices.total);
  for (Vec3& u : u_) u -= mean;
}

/// Boxes and balls around the elements from `first` to `last`, and a tree of the boxes.
BoxTree ElementSearch::bound(Local first, Local last) {
  for (Local i = first; i < last; ++i) {
    const Element& e = elements_[i];
    balls_.push_back(ball_around(e));
    Box& box = boxes_.emplace_back();
    for (int k = 0; k < e.corners; ++k) {
      const Local v = e.vertices[k];
      const double radius = 0.5 * reach_ + slack_[v] + balls_.back().thickness;
      box.include(x_[v], radius);
      box.include(x_[v] + u_[v], radius);
    }
  }
  BoxTree tree;
  tree.build({boxes_.begin() + first, boxes_.begin() + last});
  return tree;
}

ElementSearch::Ball ElementSearch::ball_around(const Element& e) const {
  Ball ball{Vec3::Zero(), Vec3::Zero(), 0, e.body < 0 ? 0.0 : obstacles_.body(e.body).radius};
  for (int k = 0; k < e.corners; ++k) {
    ball.centre += x_[e.vertices[k]] / e.corners;
    ball.motion += u_[e.vertices[k]] / e.corners;
  }
  for (int k = 0; k < e.corners; ++k)
    ball.spread = std::max(ball.spread, (u_[e.vertices[k]] - ball.motion).norm());
  return ball;
}

/// The elements of other ranks that this one has to compare with its own.
void ElementSearch::receive_elements() {
  const MPI_Comm comm = cloth_.mesh.comm;
  const int ranks = size_of(comm), me = rank_of(comm);
  if (ranks == 1) return;
  const std::vector<Box> mine = blocks_of(std::span(boxes_).first(own_));
  std::vector<Box> all(std::size_t(ranks) * blocks_per_rank);
  constexpr int bytes = blocks_per_rank * sizeof(Box);
  MPI_Allgather(mine.data(), bytes, MPI_BYTE, all.data(), bytes, MPI_BYTE, comm);

  std::vector<SentElement> sent;
  std::vector<int> destinations;
  for (int r = 0; r < ranks; ++r) {
    if (sends_to(me, r))
      append_elements_near(std::span(all).subspan(std::size_t(r) * blocks_per_rank, blocks_per_rank), sent);
    destinations.resize(sent.size(), r);
  }
  for (const SentElement& s : exchange(comm, sent, destinations).items) {
    Element element = s.element;
    for (int k = 0; k < element.corners; ++k) {
      element.vertices[k] = Local(vertices_.size());
      vertices_.push_back(s.vertices[k]);
      x_.push_back(s.x[k]);
      u_.push_back(s.u[k]);
      slack_.push_back(s.slack[k]);
    }
    elements_.push_back(element);
  }
}

void ElementSearch::append_elements_near(std::span<const Box> blocks, std::vector<SentElement>& found) const {
  const Box around_blocks = around(blocks);
  for (Local i = 0; i < own_; ++i) {
    const Box& box = boxes_[i];
    if (!around_blocks.overlaps(box) ||
        std::none_of(blocks.begin(), blocks.end(), [&](const Box& b) { return b.overlaps(box); }))
      continue;
    SentElement& s = found.emplace_back();
    s.element = elements_[i];
    for (int k = 0; k < s.element.corners; ++k) {
      const Local v = s.element.vertices[k];
      s.vertices[k] = vertices_[v];
      s.x[k] = x_[v];
      s.u[k] = u_[v];
      s.slack[k] = slack_[v];
    }
  }
}

} // namespace taut
