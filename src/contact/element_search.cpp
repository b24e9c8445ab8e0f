#include "src/contact/element_search.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

namespace taut {

namespace {

constexpr int blocks_per_rank = 32;
constexpr double most_grown = 0.2; ///< of all elements, until the boxes of all are made anew

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

/// Of a segment, nearer to its first vertex.
Vec3 middle(const Element& e, std::span<const Vec3> of_vertices) {
  return (of_vertices[e.vertices[0]] + of_vertices[e.vertices[1]] + of_vertices[e.vertices[2]]) * (1.0 / 3.0);
}

Box around(std::span<const Box> boxes) {
  Box all;
  for (const Box& b : boxes) all.include(b);
  return all;
}

} // namespace

ElementSearch::ElementSearch(const Cloth& cloth, const Obstacles& obstacles, std::span<const Element> strings)
    : cloth_(cloth), obstacles_(obstacles) {
  const DistributedMesh& mesh = cloth.mesh;
  const int me = rank_of(mesh.comm);
  const Local own = mesh.vertices.owned;
  std::vector<Local> place(mesh.vertices.size());
  std::iota(place.begin(), place.end(), 0);
  mesh.vertex_halo.update(place);
  for (Local i = 0; i < mesh.vertices.size(); ++i)
    known_.push_back({mesh.owns_vertex(i) ? me : mesh.vertices.ghost_owners[i - own], place[i],
                      mesh.vertices.original[i], mesh.joint[i]});
  for (Local k = 0; k < obstacles.vertices(); ++k) {
    const Global key = mesh.vertices.total + k;
    known_.push_back({me, own + k, key, key});
  }
  elements_ = cloth_elements(mesh);
  cells_ = Local(elements_.size());
  elements_.insert(elements_.end(), strings.begin(), strings.end());
  own_ = Local(elements_.size());
  for (Element e : obstacles.elements()) {
    for (Local& v : e.vertices) v += mesh.vertices.size();
    elements_.push_back(e);
  }
  known_elements_ = Local(elements_.size());
  for (const Element& e : elements_) {
    auto& joints = joints_.emplace_back();
    for (int k = 0; k < e.corners; ++k) joints[k] = known_[e.vertices[k]].joint;
  }
  ends_.assign(known_.size(), Vec3::Zero());
}

void ElementSearch::find(const Motion& motion, double reach, double slack) {
  const bool is_other = boxes_.empty() || reach != reach_ || slack != slack_;
  reach_ = reach;
  slack_ = slack;
  take_motion(motion);
  std::vector<Local> grown;
  if (!is_other) grown = outgrown();
  if (is_other || double(grown_.size() + grown.size()) > most_grown * known_elements_)
    begin();
  else
    extend(grown);
  find_across();
}

void ElementSearch::follow(const Motion& motion) {
  take_motion(motion);
  extend(outgrown());
  find_across();
}

void ElementSearch::begin() {
  boxes_ = swept_;
  for (Box& box : boxes_) box.inflate(slack_);
  own_tree_.build({boxes_.begin(), boxes_.begin() + own_});
  obstacle_tree_.build({boxes_.begin() + own_, boxes_.end()});
  grown_.clear();
  is_grown_.assign(known_elements_, false);
  pairs_ = own_tree_.pairs();
  if (cells_ < own_) std::erase_if(pairs_, [this](const BoxPair& p) { return !may_meet(p.first, p.second); });
  for (const auto& [i, j] : own_tree_.pairs_with(obstacle_tree_)) pairs_.emplace_back(i, own_ + j);
}

/// Strings pass through cloth.
bool ElementSearch::may_meet(Local i, Local j) const {
  const Element &a = elements_[i], &b = elements_[j];
  return !(a.is_string() && b.body < 0) && !(b.is_string() && a.body < 0);
}

/// The elements that leave their boxes.
std::vector<Local> ElementSearch::outgrown() const {
  std::vector<Local> elements;
  for (Local i = 0; i < known_elements_; ++i)
    if (!boxes_[i].contains(swept_[i])) elements.push_back(i);
  return elements;
}

/// Makes boxes grow. A pair is new where the boxes overlap and those before did not.
void ElementSearch::extend(const std::vector<Local>& grown) {
  if (grown.empty()) return;
  const std::vector<Box> before = boxes_;
  std::vector<Local> earlier;
  std::set_difference(grown_.begin(), grown_.end(), grown.begin(), grown.end(), std::back_inserter(earlier));
  for (const Local i : grown) {
    Box box = swept_[i];
    box.inflate(slack_);
    boxes_[i].include(box);
    is_grown_[i] = true;
  }
  grown_.clear();
  std::merge(earlier.begin(), earlier.end(), grown.begin(), grown.end(), std::back_inserter(grown_));
  const auto add = [&](Local i, Local j) {
    if (std::min(i, j) < own_ && may_meet(i, j) && !before[i].overlaps(before[j]))
      pairs_.push_back(std::minmax(i, j));
  };
  const BoxTree of_grown = tree_of(boxes_at(grown));
  for (const auto& [g, h] : of_grown.pairs()) add(grown[g], grown[h]);
  for (const auto& [g, h] : of_grown.pairs_with(tree_of(boxes_at(earlier)))) add(grown[g], earlier[h]);
  for (const auto& [g, j] : of_grown.pairs_with(own_tree_))
    if (!is_grown_[j]) add(grown[g], j);
  for (const auto& [g, j] : of_grown.pairs_with(obstacle_tree_))
    if (!is_grown_[own_ + j]) add(grown[g], own_ + j);
}

/// Whatever other ranks had sent before is forgotten.
void ElementSearch::find_across() {
  elements_.resize(known_elements_);
  joints_.resize(known_elements_);
  receive_elements();
  balls_.clear();
  for (const Element& e : elements_) balls_.push_back(ball_around(e));
  pairs_across_.clear();
  if (Local(elements_.size()) == known_elements_) return;
  const BoxTree received = tree_of({swept_.begin() + known_elements_, swept_.end()});
  for (const auto& [i, j] : own_tree_.pairs_with(received))
    if (i < cells_ && !is_grown_[i]) pairs_across_.emplace_back(i, known_elements_ + j);
  const std::span<const Local> grown(grown_.begin(), std::lower_bound(grown_.begin(), grown_.end(), cells_));
  for (const auto& [g, j] : tree_of(boxes_at(grown)).pairs_with(received))
    pairs_across_.emplace_back(grown[g], known_elements_ + j);
}

/// What all have in common does not bring anything together: the mean of the cloth is taken out of
/// displacements and boxes.
void ElementSearch::take_motion(const Motion& m) {
  std::array<double, 6> sum{};
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    for (int k = 0; k < 3; ++k) {
      sum[k] += m.cloth_from[i][k];
      sum[3 + k] += m.cloth_to[i][k];
    }
  sum_in_place(cloth_.mesh.comm, sum);
  const double all = double(cloth_.mesh.vertices.total);
  const Vec3 from = Vec3(sum[0], sum[1], sum[2]) / all, to = Vec3(sum[3], sum[4], sum[5]) / all;
  vertices_ = known_;
  x_.clear();
  u_.clear();
  std::vector<Box> boxes;   // of the vertices' ways
  std::vector<Vec3> strays; // of the vertices' ends
  const std::vector<Vec3> were = std::exchange(ends_, {});
  const auto add = [&](std::span<const Vec3> starts, std::span<const Vec3> ends) {
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const Vec3 start = starts[i] - from, end = ends[i] - to;
      x_.push_back(starts[i]);
      u_.emplace_back(end - start);
      strays.emplace_back(end - were[ends_.size()]);
      ends_.push_back(end);
      boxes.emplace_back();
      boxes.back().include(start);
      boxes.back().include(end);
    }
  };
  add(m.cloth_from, m.cloth_to);
  add(m.obstacles_from, m.obstacles_to);
  swept_.clear();
  strays_.clear();
  for (Local i = 0; i < known_elements_; ++i) {
    swept_.push_back(box_around(elements_[i], boxes));
    strays_.push_back(common_to(elements_[i], strays));
  }
}

/// With half of the reach around it: what two elements sweep overlaps if they come within reach.
Box ElementSearch::box_around(const Element& e, std::span<const Box> of_vertices) const {
  Box box;
  for (const Local v : e.vertices) box.include(of_vertices[v]);
  box.inflate(0.5 * reach_ + radius_of(e));
  return box;
}

ElementSearch::Common ElementSearch::common_to(const Element& e, std::span<const Vec3> of_vertices) {
  const Vec3 mean = middle(e, of_vertices);
  double spread = 0; // squared
  for (const Local v : e.vertices) spread = std::max(spread, (of_vertices[v] - mean).squaredNorm());
  return {mean, std::sqrt(spread)};
}

std::vector<Box> ElementSearch::boxes_at(std::span<const Local> elements) const {
  std::vector<Box> boxes;
  for (const Local i : elements) boxes.push_back(boxes_[i]);
  return boxes;
}

ElementSearch::Ball ElementSearch::ball_around(const Element& e) const {
  return {middle(e, x_), common_to(e, u_), radius_of(e)};
}

double ElementSearch::radius_of(const Element& e) const {
  return e.body < 0 ? 0.0 : obstacles_.body(e.body).radius;
}

/// The elements of other ranks that this one has to compare with its own.
void ElementSearch::receive_elements() {
  const MPI_Comm comm = cloth_.mesh.comm;
  const int ranks = size_of(comm), me = rank_of(comm);
  if (ranks == 1) return;
  const std::vector<Box> mine = blocks_of(std::span(swept_).first(cells_));
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
    auto& joints = joints_.emplace_back();
    for (int k = 0; k < element.corners; ++k) {
      joints[k] = s.vertices[k].joint;
      element.vertices[k] = Local(vertices_.size());
      vertices_.push_back(s.vertices[k]);
      x_.push_back(s.x[k]);
      u_.push_back(s.u[k]);
    }
    std::fill(element.vertices.begin() + element.corners, element.vertices.end(), element.vertices[0]);
    elements_.push_back(element);
    swept_.push_back(s.box);
    strays_.push_back({Vec3::Zero(), 0}); // their pairs are new each time
  }
}

void ElementSearch::append_elements_near(std::span<const Box> blocks, std::vector<SentElement>& found) const {
  const Box around_blocks = around(blocks);
  for (Local i = 0; i < cells_; ++i) {
    const Box& box = swept_[i];
    if (!around_blocks.overlaps(box) ||
        std::none_of(blocks.begin(), blocks.end(), [&](const Box& b) { return b.overlaps(box); }))
      continue;
    SentElement& s = found.emplace_back();
    s.element = elements_[i];
    s.box = box;
    for (int k = 0; k < s.element.corners; ++k) {
      const Local v = s.element.vertices[k];
      s.vertices[k] = vertices_[v];
      s.x[k] = x_[v];
      s.u[k] = u_[v];
    }
  }
}

} // namespace taut
