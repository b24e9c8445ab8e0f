#include "src/garment/sewn_mesh.hpp"

#include "partition/error.hpp"
#include "src/config/cloths.hpp"
#include "src/garment/turn_panels.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <set>

namespace taut::garment {

namespace {

/// The side of a cell from corner k on, by the numbers of its ends.
std::pair<Global, Global> side_of(const Cell& cell, int k) {
  return std::minmax(cell.vertices[k], cell.vertices[(k + 1) % cell.size()]);
}

double length_of_side(const Corners2& shape, int corners, int k) {
  return (shape[(k + 1) % corners] - shape[k]).norm();
}

using Lengths = std::map<std::pair<Global, Global>, double>;

/// The lengths of all sides of the sewn mesh, the shorter where its cells disagree.
Lengths lengths_of_sides(const SewnMesh& sewn) {
  Lengths lengths;
  for (std::size_t c = 0; c < sewn.cells.size(); ++c)
    for (int k = 0, n = sewn.cells[c].size(); k < n; ++k) {
      const double length = length_of_side(sewn.texture[c], n, k);
      const auto [entry, is_new] = lengths.try_emplace(side_of(sewn.cells[c], k), length);
      if (!is_new) entry->second = std::min(entry->second, length);
    }
  return lengths;
}

/// `vertices` in the numbers of the sewn mesh.
void shorten(const std::vector<Global>& vertices, double part, Lengths& lengths) {
  const auto has = [&](Global v) { return std::binary_search(vertices.begin(), vertices.end(), v); };
  for (auto& [ends, length] : lengths)
    if (has(ends.first) && has(ends.second)) length *= part;
}

/// A triangle with these sides, from its first corner on, along the first axis. Where the third cannot
/// reach, as in gathers that are tight at a sharp corner, it is a little longer.
Corners2 triangle_of(double first, double second, double third) {
  constexpr double flattest = 0.2; // height over the first side
  const double along = (first * first + third * third - second * second) / (2 * first);
  const double height = std::max(std::sqrt(std::max(third * third - along * along, 0.0)), flattest * first);
  return {Vec2::Zero(), Vec2(first, 0), Vec2(along, height), Vec2::Zero()};
}

/// Counter-clockwise, also of a cell of a panel that was turned round.
Corners2 shape_as_cut(const Corners2& texture, int corners) {
  Corners2 shape = texture;
  const Vec2 one = shape[1] - shape[0], two = shape[corners - 1] - shape[0];
  if (one[0] * two[1] < two[0] * one[1])
    for (Vec2& corner : shape) corner[1] = -corner[1];
  return shape;
}

/// Cells stay as they were cut unless a side of theirs is gathered or elastic; only triangles lie at an
/// outline, and quads are within a panel that is elastic as a whole.
void find_rest_shapes(SewnMesh& sewn, const Lengths& lengths) {
  for (std::size_t c = 0; c < sewn.cells.size(); ++c)
    sewn.rest_shape.push_back(shape_as_cut(sewn.texture[c], sewn.cells[c].size()));
  for (std::size_t c = 0; c < sewn.cells.size(); ++c) {
    if (sewn.cells[c].size() == 4) {
      const double part = lengths.at(side_of(sewn.cells[c], 0)) / length_of_side(sewn.texture[c], 4, 0);
      for (Vec2& corner : sewn.rest_shape[c]) corner *= part;
      continue;
    }
    std::array<double, 3> length;
    bool same = true;
    for (int k = 0; k < 3; ++k) {
      length[k] = lengths.at(side_of(sewn.cells[c], k));
      same = same && length[k] == length_of_side(sewn.texture[c], 3, k);
    }
    if (!same) sewn.rest_shape[c] = triangle_of(length[0], length[1], length[2]);
  }
}

/// Of the panel that has a cell.
const MeshedPanel& panel_of(const GarmentMesh& mesh, std::size_t cell) {
  return *std::find_if(mesh.panels.begin(), mesh.panels.end(),
                       [&](const MeshedPanel& p) { return Global(cell) < p.first_cell + p.cells; });
}

void join_cells(const GarmentMesh& mesh, const std::string& name, SewnMesh& sewn) {
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    Cell cell = mesh.cells[c];
    sewn.texture.push_back(texture_of(mesh, cell));
    const auto used = std::span(cell.vertices).first(std::size_t(cell.size()));
    for (Global& v : used) v = sewn.number[v];
    if (std::set<Global>(used.begin(), used.end()).size() < used.size())
      throw InputError(
          fmt::format("{}: panel '{}': two corners of one cell of its mesh are sewn to each other; "
                      "give it shorter edges",
                      name, panel_of(mesh, c).name));
    sewn.cells.push_back(cell);
  }
}

/// The numbers of `vertices`, each once.
std::vector<Global> numbers_of(const SewnMesh& sewn, std::span<const Global> vertices) {
  std::set<Global> numbers;
  for (const Global v : vertices) numbers.insert(sewn.number[v]);
  return {numbers.begin(), numbers.end()};
}

} // namespace

std::vector<Global> joints_of(const GarmentMesh& mesh) {
  std::vector<Global> first(mesh.positions.size());
  std::iota(first.begin(), first.end(), 0);
  const auto find = [&](Global v) {
    while (first[v] != v) v = first[v] = first[first[v]];
    return v;
  };
  for (const MeshedSeam& seam : mesh.seams)
    for (const auto& [a, b] : seam.pairs) {
      const Global one = find(a), two = find(b);
      first[std::max(one, two)] = std::min(one, two);
    }
  for (Global v = 0; v < Global(first.size()); ++v) first[v] = find(v);
  return first;
}

std::vector<ShorterSides> shorter_sides(const GarmentMesh& mesh, const Case& input, std::size_t k) {
  std::vector<ShorterSides> shorter;
  for (const config::Elastic& elastic : input.cloths[k].elastic) {
    const auto found = mesh.labels.find(elastic.label);
    if (found == mesh.labels.end())
      throw InputError(fmt::format("{}: {}.elastic.{}.label: {}", input.file.string(),
                                   config::key_of_cloth(input, k), shorter.size(),
                                   no_such_label(mesh.labels, elastic.label)));
    shorter.push_back({found->first, found->second, elastic.length});
  }
  return shorter;
}

SewnMesh sew(const GarmentMesh& mesh, std::span<const Vec3> positions, const std::string& name,
             std::span<const ShorterSides> shorter) {
  const std::vector<Global> joint = joints_of(mesh);
  SewnMesh sewn;
  std::vector<int> count;
  for (std::size_t v = 0; v < joint.size(); ++v) {
    const bool is_first = joint[v] == Global(v);
    sewn.number.push_back(is_first ? Global(count.size()) : sewn.number[joint[v]]);
    if (is_first) {
      sewn.positions.emplace_back(Vec3::Zero());
      count.push_back(0);
    }
    sewn.positions[sewn.number[v]] += positions[v];
    ++count[sewn.number[v]];
  }
  for (std::size_t v = 0; v < count.size(); ++v) sewn.positions[v] /= count[v];
  join_cells(mesh, name, sewn);
  turn_panels(mesh, name, sewn);
  Lengths lengths = lengths_of_sides(sewn);
  for (const ShorterSides& sides : shorter) shorten(numbers_of(sewn, sides.vertices), sides.part, lengths);
  find_rest_shapes(sewn, lengths);
  for (const MeshedSeam& seam : mesh.seams) {
    std::vector<Global> side;
    for (const auto& pair : seam.pairs) side.push_back(pair[0]);
    sewn.seam.push_back(numbers_of(sewn, side));
  }
  for (const auto& [label, vertices] : mesh.labels) sewn.labels[label] = numbers_of(sewn, vertices);
  return sewn;
}

NamedParts parts_of(const GarmentMesh& mesh, const SewnMesh& sewn) {
  NamedParts parts = parts_of(mesh);
  parts.labels = sewn.labels;
  for (std::size_t s = 0; s < sewn.seam.size(); ++s) parts.seams[s].vertices = sewn.seam[s];
  return parts;
}

} // namespace taut::garment
