#include "src/contact/obstacles.hpp"

#include "partition/comm.hpp"
#include "src/contact/body_growth.hpp"
#include "src/contact/body_meshes.hpp"
#include "src/contact/body_normals.hpp"
#include "src/contact/closest.hpp"
#include "src/contact/slim_body.hpp"
#include "src/contact/union_mesh.hpp"
#include "src/contact/yielding_body.hpp"
#include "src/state/pins.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace taut {

namespace {

/// How `start` turns a body.
Mat3 turn_of(const config::Obstacle& o) {
  return Eigen::AngleAxisd(o.start.rotate.angle, o.start.rotate.axis.normalized()).toRotationMatrix();
}

std::string name_of(const config::Obstacle& o, int body) {
  const char* kind = o.plane     ? "plane"
                     : o.sphere  ? "sphere"
                     : o.capsule ? "capsule"
                     : o.box     ? "box"
                     : o.joined  ? "union"
                                 : "mesh";
  return o.name ? *o.name : fmt::format("obstacles.{} ({})", body, kind);
}

} // namespace

Obstacles::Obstacles(MPI_Comm comm, const Case& input) : inputs_(input.obstacles) {
  const config::Contact contact = input.contact.value_or(config::Contact{});
  for (int body = 0; body < int(inputs_.size()); ++body) {
    const config::Obstacle& o = inputs_[body];
    const double inside = o.sphere ? o.sphere->radius : o.capsule ? o.capsule->radius : 0.0;
    bodies_.push_back({name_of(o, body), inside + o.thickness, o.friction.value_or(contact.friction),
                       o.sphere || o.capsule});
    add(comm, input, body);
    if (o.room) make_room(body);
    if (o.fitted) hold_back(comm, input, body);
    if (o.growth) make_slim(comm, body);
  }
}

void Obstacles::add(MPI_Comm comm, const Case& input, int body) {
  const config::Obstacle& o = inputs_[body];
  if (o.plane && o.plane->reach) {
    add_sheet(*o.plane, body);
  } else if (o.plane) {
    planes_.push_back({add_vertex(body, o.plane->point), turn_of(o) * o.plane->normal.normalized(), body});
  } else if (o.sphere) {
    const Local c = add_vertex(body, o.sphere->centre);
    elements_.push_back({{c, c, c}, 1, 0b000001, std::int16_t(body)});
  } else if (o.capsule) {
    const Local a = add_vertex(body, o.capsule->from), b = add_vertex(body, o.capsule->to);
    elements_.push_back({{a, b, a}, 2, 0b001011, std::int16_t(body)});
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
  } else if (o.joined) {
    add_union(comm, input, body);
  } else {
    add_mesh(comm, input, body);
  }
}

/// A half-space is seen by its normal, which must stay as it is during a step. What turns is a triangle
/// instead, with equal sides and one of them level: the smallest shape without an edge inside, at which
/// sliding cloth would catch. Its corners are as fast as it is large, so it is not made larger than asked
/// for.
void Obstacles::add_sheet(const config::Plane& plane, int body) {
  const Vec3 normal = plane.normal.normalized(), level = Vec3::UnitZ().cross(normal);
  const Vec3 x = level.isZero() ? Vec3(Vec3::UnitX()) : Vec3(level.normalized()), y = normal.cross(x);
  const double reach = *plane.reach;
  const Local a = add_vertex(body, plane.point - reach * (std::sqrt(3.0) * x + y));
  const Local b = add_vertex(body, plane.point + reach * (std::sqrt(3.0) * x - y));
  const Local c = add_vertex(body, plane.point + 2 * reach * y);
  add_triangles(std::vector<std::array<Local, 3>>{{a, b, c}}, body);
}

/// Made by rank 0 for all, which so have the same to the last digit.
void Obstacles::add_union(MPI_Comm comm, const Case& input, int body) {
  const config::Union& joined = *input.obstacles[body].joined;
  const double off_surface = 1e-3 * joined.edge;
  UnionMesh mesh;
  std::optional<std::string> fault;
  if (rank_of(comm) == 0) {
    mesh = mesh_union(joined);
    const UnionDistance distance(joined);
    for (const Vec3& x : mesh.positions)
      if (!(std::abs(distance.at(x).distance) <= off_surface))
        fault = fmt::format("{}: obstacles.{}.union: its surface could not be followed near ({:.4g}, {:.4g}, "
                            "{:.4g}) m, where parts nearly touch; change edge or blend a little",
                            input.file.string(), body, x[0], x[1], x[2]);
  }
  agree(comm, fault);
  const Local first = vertices();
  for (const Vec3& x : gather_to_all<Vec3>(comm, mesh.positions)) add_vertex(body, x);
  std::vector<std::array<Local, 3>> triangles = gather_to_all<std::array<Local, 3>>(comm, mesh.triangles);
  for (auto& triangle : triangles)
    for (Local& v : triangle) v += first;
  add_triangles(triangles, body);
}

std::vector<std::array<Local, 3>> Obstacles::triangles_of(int body) const {
  const Local first = first_of(body);
  std::vector<std::array<Local, 3>> triangles;
  for (const Element& e : elements_)
    if (e.body == body && e.is_triangle())
      triangles.push_back({e.vertices[0] - first, e.vertices[1] - first, e.vertices[2] - first});
  return triangles;
}

/// The body, the last so far, is there already.
void Obstacles::make_room(int body) {
  const auto triangles = triangles_of(body);
  const auto yield = [&](std::span<Vec3> positions) {
    const std::vector<Vec3> ways = ways_to_room(positions, triangles, *inputs_[body].room);
    for (std::size_t v = 0; v < ways.size(); ++v) {
      positions[v] += ways[v];
      bodies_[body].yields = std::max(bodies_[body].yields, ways[v].norm());
    }
    return std::count_if(ways.begin(), ways.end(), [](const Vec3& w) { return !w.isZero(); });
  };
  bodies_[body].yielding = yield(std::span(start_).subspan(std::size_t(first_of(body))));
  if (const auto frames = frames_.find(body); frames != frames_.end())
    for (auto& positions : frames->second.positions) yield(positions);
}

/// The body, the last so far, is there already.
void Obstacles::make_slim(MPI_Comm comm, int body) {
  const auto first = std::size_t(first_of(body));
  const auto ways = ways_to_slim(comm, std::span(start_).subspan(first), triangles_of(body));
  slim_.resize(first, Vec3::Zero());
  slim_.insert(slim_.end(), ways.begin(), ways.end());
}

bool Obstacles::grow() const {
  return std::any_of(inputs_.begin(), inputs_.end(),
                     [](const config::Obstacle& o) { return o.growth && std::isfinite(o.growth->time); });
}

void Obstacles::set_growth(BodyGrowth growth, double since) {
  growth_ = std::move(growth);
  grown_since_ = since;
}

Vec3 Obstacles::way_to_slim(Local vertex) const {
  return inputs_[body_of_[vertex]].growth ? slim_[vertex] : Vec3(Vec3::Zero());
}

/// Without a word on its vertices a body that grows is slim.
double Obstacles::slimness(Local vertex, double time) const {
  const auto& growth = inputs_[body_of_[vertex]].growth;
  if (!growth) return 0;
  if (growth_.slimness.empty()) return 1;
  return std::clamp(growth_.slimness[vertex] + growth_.speed[vertex] * (time - grown_since_), 0.0, 1.0);
}

/// The body, the last so far, is there already. In each mesh of a sequence the way is turned with the
/// surface.
void Obstacles::hold_back(MPI_Comm comm, const Case& input, int body) {
  const auto file = input.folder() / *inputs_[body].fitted;
  const auto first = std::size_t(first_of(body));
  const std::span<Vec3> start = std::span(start_).subspan(first);
  const std::vector<Vec3> ways = read_ways(comm, file, start.size());
  const auto triangles = triangles_of(body);
  const std::vector<Vec3> normals = outward_normals(start, triangles);
  if (const auto frames = frames_.find(body); frames != frames_.end())
    for (auto& positions : frames->second.positions) {
      const std::vector<Vec3> turned = outward_normals(positions, triangles);
      for (std::size_t v = 0; v < ways.size(); ++v)
        positions[v] += Eigen::Quaterniond::FromTwoVectors(normals[v], turned[v]) * ways[v];
    }
  for (std::size_t v = 0; v < ways.size(); ++v) start[v] += ways[v];
}

void Obstacles::add_mesh(MPI_Comm comm, const Case& input, int body) {
  const config::Obstacle& o = inputs_[body];
  std::vector<WholeMesh> meshes = meshes_of(comm, input, body);
  const Local first = vertices();
  for (const Vec3& x : meshes.front().positions) add_vertex(body, x);
  std::vector<std::array<Local, 3>> triangles;
  for (const Cell& cell : meshes.front().cells)
    for (int k = 2; k < cell.size(); ++k)
      triangles.push_back({first + Local(cell.vertices[0]), first + Local(cell.vertices[k - 1]),
                           first + Local(cell.vertices[k])});
  if (triangles.empty())
    throw InputError(fmt::format("{}: an obstacle needs faces, and this mesh has none", meshes.front().name));
  add_triangles(triangles, body);
  if (!o.sequence) return;
  Frames& frames = frames_[body];
  frames = {first, o.sequence->fps, {}};
  for (WholeMesh& m : meshes) {
    for (Vec3& x : m.positions) x = turn_of(o) * x + o.start.translate;
    frames.positions.push_back(std::move(m.positions));
  }
}

Vec3 Obstacles::Frames::at(Local vertex, double time) const {
  const double frame = std::min(time * fps, double(positions.size() - 1));
  const auto before = std::min(std::size_t(frame), positions.size() - 2);
  const double part = frame - double(before);
  return (1 - part) * positions[before][vertex - first] + part * positions[before + 1][vertex - first];
}

Local Obstacles::add_vertex(int body, const Vec3& position) {
  start_.push_back(turn_of(inputs_[body]) * position + inputs_[body].start.translate);
  body_of_.push_back(body);
  return vertices() - 1;
}

/// The first triangle that has a vertex or an edge represents it.
void Obstacles::add_triangles(std::span<const std::array<Local, 3>> triangles, int body) {
  std::map<std::pair<Local, Local>, int> taken; // (v, v) for a vertex
  for (const auto& t : triangles) {
    Element element{t, 3, 0, std::int16_t(body)};
    for (int k = 0; k < 3; ++k) {
      const Local a = t[k], b = t[(k + 1) % 3];
      if (taken[{a, a}]++ == 0) element.represents |= std::uint8_t(1u << k);
      if (taken[std::minmax(a, b)]++ == 0) element.represents |= std::uint8_t(1u << (3 + k));
    }
    elements_.push_back(element);
  }
  for (const auto& [ends, count] : taken)
    if (ends.first != ends.second && count == 1) ++bodies_[body].rims;
}

bool Obstacles::all_rest() const {
  return std::all_of(inputs_.begin(), inputs_.end(), [](const config::Obstacle& o) {
    return o.motion.empty() && !o.sequence && !(o.growth && std::isfinite(o.growth->time));
  });
}

Vec3 Obstacles::moved(int body, const Vec3& start, double time) const {
  return place_at(inputs_[body].motion, start, time);
}

Mat3 Obstacles::turned(int body, double from, double to) const {
  const auto rotation = [&](double time) {
    const Vec3 origin = moved(body, Vec3::Zero(), time);
    Mat3 r;
    for (int k = 0; k < 3; ++k) r.col(k) = moved(body, Vec3::Unit(k), time) - origin;
    return r;
  };
  return rotation(to) * rotation(from).transpose();
}

void Obstacles::place(double time, std::vector<Vec3>& positions) const {
  positions.resize(start_.size());
  for (Local v = 0; v < vertices(); ++v) positions[v] = place_of(v, time);
}

Vec3 Obstacles::place_of(Local vertex, double time) const {
  const int body = body_of_[vertex];
  const auto frames = frames_.find(body);
  Vec3 start = frames == frames_.end() ? start_[vertex] : frames->second.at(vertex, time);
  if (inputs_[body].growth) start += slimness(vertex, time) * slim_[vertex];
  return moved(body, start, time);
}

} // namespace taut
