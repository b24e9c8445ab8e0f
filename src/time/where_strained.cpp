#include "src/time/where_strained.hpp"

#include <fmt/format.h>

#include <cmath>

namespace taut {

std::string where_strained(const Cloth& cloth, const StrainGauge& gauge, const Obstacles& obstacles,
                           std::span<const Vec3> positions, double time) {
  const MPI_Comm comm = cloth.mesh.comm;
  double most = -1;
  Vec3 place = Vec3::Zero();
  gauge.for_each(positions, [&](double strain, std::span<const Local> vertices) {
    const double size = std::isfinite(strain) ? std::abs(strain) : HUGE_VAL;
    if (size <= most) return;
    most = size;
    place = 0.5 * (positions[vertices.front()] + positions[vertices.back()]);
  });
  const double largest = max_over(comm, most);
  if (!std::isfinite(largest)) return "";
  const int speaker = int(-max_over(comm, Global(most == largest ? -rank_of(comm) : -size_of(comm))));
  std::string words =
      fmt::format("strained most at ({:.4g}, {:.4g}, {:.4g}) m", place[0], place[1], place[2]);
  if (!obstacles.empty()) {
    std::vector<Vec3> bodies;
    obstacles.place(time, bodies);
    const auto [body, distance] = obstacles.nearest(place, bodies);
    words += fmt::format(", {:.3g} m from {}", distance, obstacles.body(body).name);
  }
  return broadcast_text(comm, words, speaker);
}

} // namespace taut
