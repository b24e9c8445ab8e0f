#include "src/contact/search_slack.hpp"

#include <algorithm>

namespace taut {

SearchSlack::SearchSlack(const Cloth& cloth, double slack)
    : mesh_(cloth.mesh), slack_(mesh_.vertices.size(), slack), strayed_(mesh_.vertices.size(), 0.0) {}

void SearchSlack::note_search(std::span<const Vec3> target) {
  searched_.assign(target.begin(), target.end());
  std::fill(strayed_.begin(), strayed_.end(), 0.0);
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
