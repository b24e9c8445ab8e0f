#include "src/contact/seam_strings.hpp"

#include "src/contact/box_tree.hpp"
#include "src/contact/closest.hpp"

namespace taut {

namespace {

/// m: where elements of obstacles are at time 0, if none is slim.
std::vector<std::array<Vec3, 3>> full_elements(const Obstacles& obstacles) {
  std::vector<std::array<Vec3, 3>> elements;
  for (const Element& e : obstacles.elements()) {
    auto& of_element = elements.emplace_back();
    for (int k = 0; k < 3; ++k) of_element[k] = obstacles.moved(e.body, obstacles.start()[e.vertices[k]], 0);
  }
  return elements;
}

BoxTree tree_of(std::span<const std::array<Vec3, 3>> elements) {
  std::vector<Box> boxes(elements.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (const Vec3& p : elements[i]) boxes[i].include(p);
  BoxTree tree;
  tree.build(std::move(boxes));
  return tree;
}

} // namespace

std::vector<Element> strings_clear_of(const Obstacles& obstacles, const Cloth& cloth,
                                      std::span<const Vec3> positions) {
  constexpr std::uint8_t its_edge = 1u << 3;
  std::vector<Element> strings;
  std::vector<std::array<Vec3, 3>> ways;
  for (const auto& [a, b] : cloth.mesh.seams) {
    if (!cloth.mesh.owns_vertex(a)) continue;
    strings.push_back({{a, b, a}, 2, its_edge, Element::string});
    ways.push_back({positions[a], positions[b], positions[a]});
  }
  if (ways.empty()) return {};
  const auto elements = full_elements(obstacles);
  std::vector<bool> passes_body(ways.size(), false);
  for (const auto& [i, j] : tree_of(ways).pairs_with(tree_of(elements)))
    if (!passes_body[i]) passes_body[i] = passes(ways[i][0], ways[i][1], elements[j]);
  std::vector<Element> clear;
  for (std::size_t i = 0; i < strings.size(); ++i)
    if (!passes_body[i]) clear.push_back(strings[i]);
  return clear;
}

} // namespace taut
