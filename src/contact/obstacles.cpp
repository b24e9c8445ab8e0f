#include "src/contact/obstacles.hpp"

#include "io/mesh_file.hpp"
#include "src/state/pins.hpp"

#include <fmt/format.h>

#include <set>

namespace taut {

namespace {

/// All of `slab`, on every rank.
template<class T>
std::vector<T> everywhere(MPI_Comm comm, const std::vector<T>& slab) {
  std::vector<T> copies;
  std::vector<int> destinations;
  for (int r = 0; r < size_of(comm); ++r) {
    copies.insert(copies.end(), slab.begin(), slab.end());
    destinations.insert(destinations.end(), slab.size(), r);
  }
  return exchange(comm, copies, destinations).items;
}

std::string name_of(const config::Obstacle& o, int body) {
  const char* kind = o.plane ? "plane" : o.sphere ? "sphere" : o.capsule ? "capsule" : o.box ? "box" : "mesh";
  return o.name ? *o.name : fmt::format("obstacles.{} ({})", body, kind);
}

} // namespace

Obstacles::Obstacles(MPI_Comm comm, const Case& input) : inputs_(input.obstacles) {
  const config::Contact contact = input.contact.value_or(config::Contact{});
  for (int body = 0; body < int(inputs_.size()); ++body) {
    const config::Obstacle& o = inputs_[body];
    const double inside = o.sphere ? o.sphere->radius : o.capsule ? o.capsule->radius : 0.0;
    bodies_.push_back({name_of(o, body), inside + o.thickness, o.friction.value_or(contact.friction)});
    add(comm, input, body);
  }
}

void Obstacles::add(MPI_Comm comm, const Case& input, int body) {
  const config::Obstacle& o = inputs_[body];
  if (o.plane) {
    planes_.push_back({add_vertex(body, o.plane->point), o.plane->normal.normalized(), body});
  } else if (o.sphere) {
    elements_.push_back({{add_vertex(body, o.sphere->centre), -1, -1}, 1, 0b000001, std::int16_t(body)});
  } else if (o.capsule) {
    const Local a = add_vertex(body, o.capsule->from), b = add_vertex(body, o.capsule->to);
    elements_.push_back({{a, b, -1}, 2, 0b001011, std::int16_t(body)});
  } else if (o.box) {
    const Local first = vertices();
    for (int k = 0; k < 8; ++k)
      add_vertex(body, {(k & 1 ? o.box->max : o.box->min)[0], (k & 2 ? o.box->max : o.box->min)[1],
                        (k & 4 ? o.box->max : o.box->min)[2]});
    std::vector<std::array<Local, 3>> triangles;
    constexpr int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                 {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& s : sides) {
      triangles.push_back({first + s[0], first + s[1], first + s[2]});
      triangles.push_back({first + s[0], first + s[2], first + s[3]});
    }
    add_triangles(triangles, body);
  } else {
    const MeshSlab slab = read_mesh(comm, input.folder() / *o.mesh, o.scale);
    const Local first = vertices();
    for (const Vec3& x : everywhere(comm, slab.rest_positions)) add_vertex(body, x);
    std::vector<std::array<Local, 3>> triangles;
    for (const Cell& cell : everywhere(comm, slab.cell)) {
      for (int k = 2; k < cell.size(); ++k)
        triangles.push_back({first + Local(cell.vertices[0]), first + Local(cell.vertices[k - 1]),
                             first + Local(cell.vertices[k])});
    }
    if (triangles.empty())
      throw InputError(fmt::format("{}: an obstacle needs faces, and this mesh has none", slab.name));
    add_triangles(triangles, body);
  }
}

Local Obstacles::add_vertex(int body, const Vec3& position) {
  start_.push_back(position);
  body_of_.push_back(body);
  return vertices() - 1;
}

/// The first triangle that has a vertex or an edge represents it.
void Obstacles::add_triangles(std::span<const std::array<Local, 3>> triangles, int body) {
  std::set<std::pair<Local, Local>> taken; // (v, v) for a vertex
  for (const auto& t : triangles) {
    Element element{t, 3, 0, std::int16_t(body)};
    for (int k = 0; k < 3; ++k) {
      const Local a = t[k], b = t[(k + 1) % 3];
      if (taken.insert({a, a}).second) element.represents |= std::uint8_t(1u << k);
      if (taken.insert({std::min(a, b), std::max(a, b)}).second)
        element.represents |= std::uint8_t(1u << (3 + k));
    }
    elements_.push_back(element);
  }
}

Vec3 Obstacles::moved(int body, const Vec3& start, double time) const {
  return place_at(inputs_[body].motion, start, time);
}

void Obstacles::place(double time, std::vector<Vec3>& positions) const {
  positions.resize(start_.size());
  for (std::size_t v = 0; v < start_.size(); ++v) positions[v] = moved(body_of_[v], start_[v], time);
}

} // namespace taut
