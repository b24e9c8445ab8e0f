#include "src/contact/search_slack.hpp"

#include <algorithm>

namespace taut {

namespace {

constexpr double of_strayed = 2.0; ///< in the last step
constexpr int rings = 2;           ///< so far a wave goes in a step
constexpr double of_edge = 1.0;    ///< at most

} // namespace

SearchSlack::SearchSlack(const Cloth& cloth, double least)
    : mesh_(cloth.mesh), least_(least), most_(mesh_.vertices.size(), HUGE_VAL),
      slack_(mesh_.vertices.size(), least), strayed_(mesh_.vertices.size(), 0.0),
      before_(mesh_.vertices.size(), 0.0) {
  for (Local i = 0; i < mesh_.vertices.owned; ++i)
    for (const EdgeEnd& end : mesh_.star_of(i))
      most_[i] = std::min(most_[i], of_edge * cloth.rest_length[end.edge]);
  mesh_.vertex_halo.update(most_);
}

void SearchSlack::begin_step() {
  std::vector<double> needed(strayed_.size());
  for (std::size_t i = 0; i < needed.size(); ++i) needed[i] = std::max(strayed_[i], before_[i]);
  for (int ring = 0; ring < rings; ++ring) needed = largest_around(needed);
  for (std::size_t i = 0; i < needed.size(); ++i)
    slack_[i] = std::max(least_, std::min(of_strayed * needed[i], most_[i]));
  std::fill(strayed_.begin(), strayed_.end(), 0.0);
  std::fill(before_.begin(), before_.end(), 0.0);
}

/// Of a value of every local vertex, the largest of it and its neighbours along edges.
std::vector<double> SearchSlack::largest_around(std::span<const double> values) const {
  std::vector<double> largest(values.begin(), values.end());
  for (Local i = 0; i < mesh_.vertices.owned; ++i)
    for (const EdgeEnd& end : mesh_.star_of(i))
      for (const Local v : mesh_.edge_vertices[end.edge]) largest[i] = std::max(largest[i], values[v]);
  mesh_.vertex_halo.update(largest);
  return largest;
}

void SearchSlack::note_search(std::span<const Vec3> target) {
  searched_.assign(target.begin(), target.end());
  for (std::size_t i = 0; i < strayed_.size(); ++i)
    before_[i] = std::max(before_[i], std::exchange(strayed_[i], 0.0));
}

bool SearchSlack::holds(std::span<const Vec3> target) {
  bool left = false;
  for (std::size_t i = 0; i < strayed_.size(); ++i) {
    const double distance = (target[i] - searched_[i]).norm();
    strayed_[i] = std::max(strayed_[i], distance);
    left = left || !(distance <= slack_[i]);
  }
  return !any_of(mesh_.comm, left);
}

} // namespace taut
