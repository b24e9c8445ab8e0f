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
  own_.elements = cloth_elements(mesh);
  for (Element e : obstacles.elements()) {
    for (int k = 0; k < e.corners; ++k) e.vertices[k] += mesh.vertices.size();
    bodies_.elements.push_back(e);
  }
}

void ElementSearch::find(const Motion& motion, double reach) {
  reach_ = reach;
  take_positions(motion);
  bound(own_);
  own_pairs_ = own_.tree.pairs();
  bound(bodies_);
  body_pairs_ = own_.tree.pairs_with(bodies_.tree);
  receive_elements();
  bound(received_);
  received_pairs_ = own_.tree.pairs_with(received_.tree);
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
  const Vec3 mean = Vec3(sum[0], sum[1], sum[2]) / double(cloth_.mesh.vertices.total);
  for (Vec3& u : u_) u -= mean;
}

void ElementSearch::bound(Group& group) const {
  group.boxes.assign(group.elements.size(), Box{});
  group.balls.assign(group.elements.size(), Ball{});
  for (std::size_t i = 0; i < group.elements.size(); ++i) {
    const Element& e = group.elements[i];
    const double radius = 0.5 * reach_ + (e.body < 0 ? 0.0 : obstacles_.body(e.body).radius);
    for (int k = 0; k < e.corners; ++k) {
      group.boxes[i].include(x_[e.vertices[k]], radius);
      group.boxes[i].include(x_[e.vertices[k]] + u_[e.vertices[k]], radius);
    }
    group.balls[i] = ball_around(e);
  }
  group.tree.build(group.boxes);
}

ElementSearch::Ball ElementSearch::ball_around(const Element& e) const {
  Ball ball{Vec3::Zero(), Vec3::Zero(), 0, 0, e.body < 0 ? 0.0 : obstacles_.body(e.body).radius};
  for (int k = 0; k < e.corners; ++k) {
    ball.centre += x_[e.vertices[k]] / e.corners;
    ball.motion += u_[e.vertices[k]] / e.corners;
  }
  for (int k = 0; k < e.corners; ++k) {
    ball.radius = std::max(ball.radius, (x_[e.vertices[k]] - ball.centre).norm());
    ball.spread = std::max(ball.spread, (u_[e.vertices[k]] - ball.motion).norm());
  }
  return ball;
}

/// The elements of other ranks that this one has to compare with its own.
void ElementSearch::receive_elements() {
  const MPI_Comm comm = cloth_.mesh.comm;
  const int ranks = size_of(comm), me = rank_of(comm);
  received_.elements.clear();
  if (ranks == 1) return;
  const std::vector<Box> mine = blocks_of(own_.boxes);
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
    }
    received_.elements.push_back(element);
  }
}

void ElementSearch::append_elements_near(std::span<const Box> blocks, std::vector<SentElement>& found) const {
  const Box around_blocks = around(blocks);
  for (std::size_t i = 0; i < own_.elements.size(); ++i) {
    const Box& box = own_.boxes[i];
    if (!around_blocks.overlaps(box) ||
        std::none_of(blocks.begin(), blocks.end(), [&](const Box& b) { return b.overlaps(box); }))
      continue;
    SentElement& s = found.emplace_back();
    s.element = own_.elements[i];
    for (int k = 0; k < s.element.corners; ++k) {
      const Local v = s.element.vertices[k];
      s.vertices[k] = vertices_[v];
      s.x[k] = x_[v];
      s.u[k] = u_[v];
    }
  }
}

} // namespace taut
