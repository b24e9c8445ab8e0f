#include "src/contact/element_search.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace taut {

namespace {

constexpr int blocks_per_rank = 32;
constexpr double ample = 1.5; ///< of what its vertices strayed: the new slack of an element

/// Of two ranks, whether `rank` sends its elements to `other` and leaves the search to it; evenly shared.
bool sends_to(int rank, int other) { return ((rank + other) % 2 == 0) == (rank < other) && rank != other; }

/// The boxes of consecutive runs of elements; always the same number of them.
std::vector<Box> blocks_of(std::span<const Box> boxes) {
  std::vector<Box> blocks(blocks_per_rank);
  for (std::size_t i = 0; i < boxes.size(); ++i) blocks[i * blocks_per_rank / boxes.size()].include(boxes[i]);
  return blocks;
}

BoxTree tree_of(std::vector<Box> boxes) {
  BoxTree tree;
  tree.build(std::move(boxes));
  return tree;
}

Box around(std::span<const Box> boxes) {
  Box all;
  for (const Box& b : boxes) all.include(b);
  return all;
}

} // namespace

std::vector<double> distances(std::span<const Vec3> was, std::span<const Vec3> is) {
  std::vector<double> distance(was.size());
  for (std::size_t i = 0; i < was.size(); ++i) distance[i] = (is[i] - was[i]).norm();
  return distance;
}

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
  for (const Element& e : elements_) {
    auto& keys = keys_.emplace_back();
    for (int k = 0; k < e.corners; ++k) keys[k] = known_[e.vertices[k]].key;
  }
}

void ElementSearch::find(const Motion& motion, double reach, double slack) {
  reach_ = reach;
  take_positions(motion);
  ends_.assign(motion.cloth_to.begin(), motion.cloth_to.end());
  slack_.assign(own_, slack);
  boxes_.clear();
  for (Local i = 0; i < known_elements_; ++i) boxes_.push_back(box_around(i));
  own_tree_.build({boxes_.begin(), boxes_.begin() + own_});
  obstacle_tree_.build({boxes_.begin() + own_, boxes_.end()});
  grown_.clear();
  is_grown_.assign(own_, false);
  pairs_ = own_tree_.pairs();
  for (const auto& [i, j] : own_tree_.pairs_with(obstacle_tree_)) pairs_.emplace_back(i, own_ + j);
  find_across();
}

void ElementSearch::follow(const Motion& motion) {
  take_positions(motion);
  extend(motion.cloth_to);
  find_across();
}

/// A pair is new where the boxes overlap and those before did not.
void ElementSearch::extend(std::span<const Vec3> cloth_to) {
  const std::vector<double> wanted = largest(distances(ends_, cloth_to));
  if (std::equal(slack_.begin(), slack_.end(), wanted.begin(), std::greater_equal())) return;
  const std::vector<Box> before(boxes_.begin(), boxes_.begin() + own_);
  const std::vector<Local> grown = grow(wanted);
  std::vector<bool> grew(own_, false);
  for (const Local i : grown) grew[i] = true;
  const BoxTree of_grown = tree_of_grown(grown);
  for (const auto& [g, j] : of_grown.pairs_with(own_tree_))
    if (!is_grown_[j] && !before[grown[g]].overlaps(boxes_[j])) pairs_.push_back(std::minmax(grown[g], j));
  for (const auto& [g, h] : of_grown.pairs_with(tree_of_grown(grown_))) {
    const Local i = grown[g], j = grown_[h];
    const bool is_other = grew[j] ? i < j : i != j; // two that grew now meet twice
    if (is_other && !before[i].overlaps(before[j])) pairs_.push_back(std::minmax(i, j));
  }
  for (const auto& [g, j] : of_grown.pairs_with(obstacle_tree_))
    if (!before[grown[g]].overlaps(boxes_[own_ + j])) pairs_.emplace_back(grown[g], own_ + j);
}

/// Gives the elements that want more slack than they have more than they want; returns which.
std::vector<Local> ElementSearch::grow(std::span<const double> wanted) {
  std::vector<Local> grown;
  for (Local i = 0; i < own_; ++i) {
    if (wanted[i] <= slack_[i]) continue;
    boxes_[i].inflate(ample * wanted[i] - slack_[i]);
    slack_[i] = ample * wanted[i];
    grown.push_back(i);
    if (!is_grown_[i]) grown_.push_back(i);
    is_grown_[i] = true;
  }
  return grown;
}

/// Whatever other ranks had sent before is forgotten.
void ElementSearch::find_across() {
  elements_.resize(known_elements_);
  boxes_.resize(known_elements_);
  keys_.resize(known_elements_);
  receive_elements();
  balls_.clear();
  for (const Element& e : elements_) balls_.push_back(ball_around(e));
  pairs_across_.clear();
  if (Local(elements_.size()) == known_elements_) return;
  const BoxTree received = tree_of({boxes_.begin() + known_elements_, boxes_.end()});
  for (const auto& [i, j] : own_tree_.pairs_with(received))
    if (!is_grown_[i]) pairs_across_.emplace_back(i, known_elements_ + j);
  for (const auto& [g, j] : tree_of_grown(grown_).pairs_with(received))
    pairs_across_.emplace_back(grown_[g], known_elements_ + j);
}

std::vector<double> ElementSearch::largest(std::span<const double> cloth) const {
  std::vector<double> most(elements_.size(), 0.0);
  for (Local i = 0; i < own_; ++i)
    for (int k = 0; k < elements_[i].corners; ++k)
      most[i] = std::max(most[i], cloth[elements_[i].vertices[k]]);
  return most;
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

Box ElementSearch::box_around(Local element) const {
  const Element& e = elements_[element];
  const double radius = 0.5 * reach_ + (e.body < 0 ? slack_[element] : obstacles_.body(e.body).radius);
  Box box;
  for (int k = 0; k < e.corners; ++k) {
    box.include(x_[e.vertices[k]], radius);
    box.include(x_[e.vertices[k]] + u_[e.vertices[k]], radius);
  }
  return box;
}

BoxTree ElementSearch::tree_of_grown(std::span<const Local> elements) const {
  std::vector<Box> boxes;
  for (const Local i : elements) boxes.push_back(boxes_[i]);
  return tree_of(std::move(boxes));
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
    auto& keys = keys_.emplace_back();
    for (int k = 0; k < element.corners; ++k) {
      keys[k] = s.vertices[k].key;
      element.vertices[k] = Local(vertices_.size());
      vertices_.push_back(s.vertices[k]);
      x_.push_back(s.x[k]);
      u_.push_back(s.u[k]);
    }
    elements_.push_back(element);
    boxes_.push_back(s.box);
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
    s.box = boxes_[i];
    for (int k = 0; k < s.element.corners; ++k) {
      const Local v = s.element.vertices[k];
      s.vertices[k] = vertices_[v];
      s.x[k] = x_[v];
      s.u[k] = u_[v];
    }
  }
}

} // namespace taut
