#include "src/contact/safe_iterate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

/// The gap that must be kept on the way.
double floor_of(double gap, double thickness) {
  return gap > 0.25 * thickness ? std::max(0.2 * gap, 0.25 * thickness) : 0.8 * gap;
}

bool is_finite(const Scene& scene) {
  const auto all = [](const std::vector<Vec3>& x) {
    return std::all_of(x.begin(), x.end(), [](const Vec3& p) { return p.allFinite(); });
  };
  return all(scene.cloth) && all(scene.obstacles);
}

} // namespace

void SafeIterate::begin() {
  here_ = scene_.start();
  blocked_.clear();
}

void SafeIterate::measure_gaps(std::size_t known) {
  scene_.gather(here_, field_);
  approaches_.resize(known);
  for (const Pair& pair : scene_.search.pairs().subspan(known))
    approaches_.push_back(approach(pair, at(pair, field_)));
}

void SafeIterate::keep_pairs(std::size_t known) {
  has_stopped_.resize(known);
  for (const Pair& pair : scene_.search.pairs().subspan(known))
    has_stopped_.push_back(!blocked_.empty() && blocked_.contains(name_of(pair, scene_.search.keys())));
}

double SafeIterate::safe_fraction_to_target() {
  scene_.gather_target();
  stuck_.clear();
  const ContactSearch& search = scene_.search;
  std::vector<Vec3> way(search.size());
  for (std::size_t i = 0; i < way.size(); ++i) way[i] = scene_.target_field()[i] - field_[i];
  double alpha = is_finite(scene_.target) ? 1 : 0;
  for (std::size_t k = 0; k < search.pairs().size(); ++k) {
    const Pair& pair = search.pairs()[k];
    const double part = safe_fraction_of(pair, approaches_[k], at(pair, way));
    if (part < 1) {
      blocked_.insert(name_of(pair, search.keys()));
      has_stopped_[k] = true;
      stuck_.push_back(Local(k));
    }
    alpha = std::min(alpha, part);
  }
  return -max_over(scene_.cloth().mesh.comm, -alpha);
}

/// Most pairs have room enough along the direction between them, whatever their thickness.
double SafeIterate::safe_fraction_of(const Pair& pair, const Approach& here, const Four& way) const {
  const double speed = closing_speed(pair, way, here.normal), most = thickness_.largest();
  if (here.gap > 0.25 * most && here.gap - floor_of(here.gap, most) >= speed) return 1;
  const double thickness = thickness_.of(pair, scene_.search.keys());
  return safe_fraction(pair, at(pair, field_), way, floor_of(here.gap, thickness));
}

/// A gap shrinks by no more than its features close along the direction between them.
double SafeIterate::smallest_gap_at_target() const {
  const ContactSearch& search = scene_.search;
  double least = HUGE_VAL;
  for (std::size_t k = 0; k < search.pairs().size(); ++k) {
    const Pair& pair = search.pairs()[k];
    const Four x = at(pair, field_), y = at(pair, scene_.target_field());
    Four u;
    for (int i = 0; i < 4; ++i) u[i] = y[i] - x[i];
    const Approach& here = approaches_[k];
    if (here.gap - std::max(0.0, closing_speed(pair, u, here.normal)) < least)
      least = std::min(least, approach(pair, y).gap);
  }
  return -max_over(scene_.cloth().mesh.comm, -least);
}

void SafeIterate::move(double fraction) {
  if (fraction == 1.0) {
    here_ = scene_.target;
    return;
  }
  for (std::size_t i = 0; i < here_.cloth.size(); ++i)
    here_.cloth[i] += fraction * (scene_.target.cloth[i] - here_.cloth[i]);
  for (std::size_t i = 0; i < here_.obstacles.size(); ++i)
    here_.obstacles[i] += fraction * (scene_.target.obstacles[i] - here_.obstacles[i]);
}

double SafeIterate::distance_behind() const {
  double farthest = 0;
  for (Local i = 0; i < scene_.search.own(); ++i)
    farthest = std::max(farthest, (scene_.target.cloth[i] - here_.cloth[i]).squaredNorm());
  return std::sqrt(max_over(scene_.cloth().mesh.comm, farthest));
}

void SafeIterate::release_stuck() {
  const ContactSearch& search = scene_.search;
  std::vector<double> is_stuck(search.size(), 0.0);
  for (const Local k : stuck_)
    for (const Local v : search.pairs()[k].vertices) is_stuck[v] = 1;
  search.accumulate(is_stuck);
  for (Local i = 0; i < search.own(); ++i)
    if (is_stuck[i] > 0 && scene_.inverse_mass()[i] > 0) scene_.target.cloth[i] = here_.cloth[i];
  scene_.cloth().mesh.vertex_halo.update(scene_.target.cloth);
}

std::string SafeIterate::what_stopped() const {
  const MPI_Comm comm = scene_.cloth().mesh.comm;
  std::string mine;
  if (!stuck_.empty()) {
    const Pair& pair = scene_.search.pairs()[stuck_.front()];
    const Vec3& x = field_[pair.vertices[0]];
    mine = fmt::format("contact with {} at ({:.4g}, {:.4g}, {:.4g}) m",
                       pair.body >= 0 ? scene_.obstacles().body(pair.body).name : "the cloth itself", x[0],
                       x[1], x[2]);
  }
  const int ranks = size_of(comm);
  const Global speaker = -max_over(comm, Global(mine.empty() ? -ranks : -rank_of(comm)));
  return speaker < ranks ? broadcast_text(comm, mine, int(speaker)) : "";
}

} // namespace taut
