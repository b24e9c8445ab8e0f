#include "src/contact/body_growth.hpp"

#include "io/hdf5.hpp"
#include "partition/comm.hpp"
#include "src/contact/body_normals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr const char* ways_name = "/ways";

/// m, that a vertex stays back for as much pressure again.
constexpr double give = 0.02;

/// N, of what the cloth presses on each vertex of the obstacles: an equal part of what each contact does.
std::vector<double> forces_on(const Cloth& cloth, const Obstacles& obstacles, const ContactMemory& contacts) {
  const Global total = cloth.mesh.vertices.total; // numbers of the vertices of obstacles come after it
  std::vector<double> forces(std::size_t(obstacles.vertices()), 0.0);
  for (const auto& [key, entry] : contacts) {
    std::vector<Local> touched;
    for (Global n : key) {
      if (n < -1) n = -2 - n;
      if (n >= total) touched.push_back(Local(n - total));
    }
    for (const Local v : touched) forces[v] += entry.pressed.normal / double(touched.size());
  }
  sum_in_place(cloth.mesh.comm, forces);
  return forces;
}

/// m, of the cloth in the mean.
double edge_of(const Cloth& cloth) {
  std::array<double, 2> sums{};
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) {
    sums[0] += cloth.rest_length[e];
    ++sums[1];
  }
  sum_in_place(cloth.mesh.comm, sums);
  return sums[0] / std::max(1.0, sums[1]);
}

/// How many rounds of evening out spread a value over about `reach`, as a walk of so many edges does.
int rounds_for(double reach, double edge) {
  constexpr double most = 200;
  return int(std::clamp(std::pow(reach / edge, 2), 1.0, most));
}

/// Pa, of the vertices of a body, from the forces on all of them.
std::vector<double> pressures_on(const Obstacles& obstacles, int body, std::span<const double> forces,
                                 double reach) {
  const auto triangles = obstacles.triangles_of(body);
  const Local first = obstacles.first_of(body);
  const auto x = obstacles.start().subspan(std::size_t(first));
  std::vector<Vec3> shares; // force, area
  while (std::size_t(first) + shares.size() < forces.size() &&
         obstacles.body_of(first + Local(shares.size())) == body)
    shares.emplace_back(forces[std::size_t(first) + shares.size()], 0, 0);
  double area = 0;
  for (const auto& [a, b, c] : triangles) {
    const double of_triangle = 0.5 * (x[b] - x[a]).cross(x[c] - x[a]).norm();
    for (const Local v : {a, b, c}) shares[v][1] += of_triangle / 3;
    area += of_triangle;
  }
  even_out(shares, triangles,
           rounds_for(reach, std::sqrt(area / double(std::max<std::size_t>(shares.size(), 1)))));
  std::vector<double> pressures;
  for (const Vec3& s : shares) pressures.push_back(s[1] > 0 ? s[0] / s[1] : 0);
  return pressures;
}

} // namespace

BodyGrowth growth_after(const Cloth& cloth, const Obstacles& obstacles, const State& state) {
  const double reach = 2 * edge_of(cloth);
  const auto forces = forces_on(cloth, obstacles, state.multipliers.contacts);
  BodyGrowth growth;
  for (Local v = 0; v < obstacles.vertices(); ++v) {
    growth.slimness.push_back(obstacles.slimness(v, state.time));
    growth.speed.push_back(0);
  }
  for (int body = 0; body < obstacles.bodies(); ++body) {
    const auto& of_body = obstacles.growth_of(body);
    if (!of_body || !std::isfinite(of_body->time)) continue;
    const auto pressures = pressures_on(obstacles, body, forces, reach);
    for (std::size_t v = 0; v < pressures.size(); ++v) {
      const auto vertex = std::size_t(obstacles.first_of(body)) + v;
      const double back = growth.slimness[vertex] * obstacles.way_to_slim(Local(vertex)).norm();
      const double borne = of_body->pressure * (1 + back / give);
      growth.speed[vertex] = -std::clamp(1 - pressures[v] / borne, -1.0, 1.0) / of_body->time;
    }
  }
  return growth;
}

bool has_grown(const Obstacles& obstacles, const State& state) {
  constexpr double slow = 0.05; // of the pace at which nothing presses
  for (Local v = 0; v < obstacles.vertices(); ++v)
    if (const auto& growth = obstacles.growth_of(obstacles.body_of(v)))
      if (obstacles.slimness(v, state.time) > 0 && state.bodies.speed[v] < -slow / growth->time) return false;
  return true;
}

HeldBack held_back(const Obstacles& obstacles, int body, double time) {
  constexpr double told = 1e-4; // m
  HeldBack held;
  std::vector<Vec3> places;
  obstacles.place(time, places);
  for (Local v = 0; v < obstacles.vertices(); ++v) {
    if (obstacles.body_of(v) != body) continue;
    const Vec3 way = obstacles.slimness(v, time) * obstacles.way_to_slim(v);
    held.ways.push_back(way);
    held.vertices += way.norm() > told;
    if (way.norm() > held.farthest) {
      held.farthest = way.norm();
      held.place = places[v];
    }
  }
  return held;
}

void write_ways(MPI_Comm comm, const std::filesystem::path& file, std::span<const Vec3> ways) {
  const auto total = Global(ways.size()), mine = rank_of(comm) == 0 ? total : 0;
  write_whole(comm, file, [&](H5Writer& h5) {
    h5.write(ways_name, ways.first(std::size_t(mine)), {0, mine, total});
  });
}

std::vector<Vec3> read_ways(MPI_Comm comm, const std::filesystem::path& file, std::size_t vertices) {
  const H5Reader h5(comm, file);
  if (h5.rows(ways_name) != Global(vertices))
    throw InputError(
        fmt::format("{}: {}: has {} rows, and the body has {} vertices; it was fitted as another "
                    "body",
                    file.string(), ways_name, h5.rows(ways_name), vertices));
  const auto mine = rank_of(comm) == 0 ? Global(vertices) : 0;
  return gather_to_all<Vec3>(comm, h5.read_vectors(ways_name, {0, mine, Global(vertices)}));
}

} // namespace taut
