#include "src/contact/thickness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

double shortest_edge(const Cloth& cloth) {
  double shortest = HUGE_VAL;
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) shortest = std::min(shortest, cloth.rest_length[e]);
  return -max_over(cloth.mesh.comm, -shortest);
}

double mean_edge(const Cloth& cloth) {
  double sum = 0;
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) sum += cloth.rest_length[e];
  return sum_over(cloth.mesh.comm, sum) / double(std::max<Global>(1, cloth.mesh.edges.total));
}

} // namespace

double contact_thickness(const Cloth& cloth, const Case& input) {
  const config::Contact contact = input.contact.value_or(config::Contact{});
  const double thickness = contact.thickness.value_or(0.1 * mean_edge(cloth));
  const double most = 0.5 * shortest_edge(cloth);
  if (thickness > most)
    throw InputError(
        fmt::format("{}: contact.thickness: {:.4g} m is more than half the shortest edge "
                    "({:.4g} m), so that neighbours would push each other apart; give at most {:.4g}",
                    input.file.string(), thickness, 2 * most, most));
  return thickness;
}

} // namespace taut
