#include "src/contact/union_mesh.hpp"

#include "src/config/solids.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace taut {

namespace {

/// Of the lattice's cubes over the edges wanted: the surface has about 6.5 vertices per side of a cube
/// squared, and with equal triangles 1.155 per edge squared.
constexpr double cube_over_edge = 2.37;
constexpr double nearest_end = 0.1; ///< of an edge of the lattice: least distance of a vertex from its ends
constexpr int relaxations = 8;
constexpr int most_steps = 40; ///< back to the surface

/// A point of the lattice in halves of a cube: all even at corners, all odd at centres.
using Point = std::array<int, 3>;

class Marching {
public:
  explicit Marching(const config::Union& input) : distance_(input), half_(0.5 * cube_over_edge * input.edge) {
    const config::Box box = config::around(input);
    const double margin = input.blend + 4 * half_;
    origin_ = box.min - Vec3::Constant(margin);
    int cubes = 1;
    while (2 * half_ * cubes < (box.max - box.min).maxCoeff() + 2 * margin) cubes *= 2;
    visit({0, 0, 0}, cubes);
    relax();
  }

  UnionMesh mesh;

private:
  Vec3 place(const Point& p) const { return origin_ + half_ * Vec3(p[0], p[1], p[2]); }

  /// Of a block of cubes, whose number along a side is a power of two, those the surface may go through.
  void visit(const Point& corner, int cubes) {
    const Vec3 middle = place(corner) + half_ * cubes * Vec3::Ones();
    const double around = half_ * (std::sqrt(3.0) * cubes + 2); // the tetrahedra reach into the next cubes
    if (!distance_.may_be_near(middle, around)) return;
    if (cubes == 1) return march(corner);
    for (int k = 0; k < 8; ++k) {
      Point part = corner;
      for (int axis = 0; axis < 3; ++axis) part[axis] += (k >> axis & 1) * cubes;
      visit(part, cubes / 2);
    }
  }

  /// The tetrahedra around the lines from a cube's centre to those of the next cubes: each line with a side
  /// of the square that it goes through.
  void march(const Point& corner) {
    const Point centre{corner[0] + 1, corner[1] + 1, corner[2] + 1};
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      Point next = centre, square[4];
      next[axis] += 2;
      for (int k = 0; k < 4; ++k) {
        square[k] = centre;
        square[k][axis] += 1;
        square[k][u] += k == 0 || k == 3 ? -1 : 1;
        square[k][v] += k < 2 ? -1 : 1;
      }
      for (int k = 0; k < 4; ++k) cut({centre, next, square[k], square[(k + 1) % 4]});
    }
  }

  void cut(const std::array<Point, 4>& tetrahedron) {
    std::vector<Point> in, out;
    for (const Point& p : tetrahedron) (value(p) < 0 ? in : out).push_back(p);
    if (in.size() == 1) {
      add(in, out, {{{0, 0}, {0, 1}, {0, 2}}});
    } else if (out.size() == 1) {
      add(in, out, {{{0, 0}, {1, 0}, {2, 0}}});
    } else if (in.size() == 2) {
      add(in, out, {{{0, 0}, {0, 1}, {1, 1}}});
      add(in, out, {{{0, 0}, {1, 1}, {1, 0}}});
    }
  }

  /// A triangle of vertices between points inside and points outside, turned by the middles of these lines.
  void add(const std::vector<Point>& in, const std::vector<Point>& out,
           const std::array<std::array<int, 2>, 3>& lines) {
    std::array<Local, 3> triangle{};
    Vec3 x[3], outwards = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const Point &a = in[lines[k][0]], &b = out[lines[k][1]];
      triangle[k] = vertex(a, b);
      x[k] = place(a) + place(b);
      outwards += place(b) - place(a);
    }
    if ((x[1] - x[0]).cross(x[2] - x[0]).dot(outwards) < 0) std::swap(triangle[1], triangle[2]);
    mesh.triangles.push_back(triangle);
  }

  Local vertex(const Point& in, const Point& out) {
    const auto [found, is_new] = vertices_.try_emplace({in, out}, Local(mesh.positions.size()));
    if (is_new) {
      const double a = value(in), b = value(out),
                   part = std::clamp(a / (a - b), nearest_end, 1 - nearest_end);
      mesh.positions.push_back((1 - part) * place(in) + part * place(out));
    }
    return found->second;
  }

  double value(const Point& p) {
    const auto [found, is_new] = values_.try_emplace(p, 0.0);
    if (is_new) found->second = distance_.at(place(p)).distance;
    return found->second;
  }

  void relax() {
    for (Vec3& x : mesh.positions) x = on_surface(x);
    for (int round = 0; round < relaxations; ++round) {
      std::vector<Vec3> sums(mesh.positions.size(), Vec3::Zero());
      std::vector<int> counts(sums.size(), 0);
      for (const auto& t : mesh.triangles) // each edge has two triangles, each neighbour counts twice
        for (int k = 0; k < 3; ++k) {
          sums[t[k]] += mesh.positions[t[(k + 1) % 3]] + mesh.positions[t[(k + 2) % 3]];
          counts[t[k]] += 2;
        }
      for (std::size_t i = 0; i < sums.size(); ++i) mesh.positions[i] = on_surface(sums[i] / counts[i]);
    }
  }

  /// By Newton's method along the gradient.
  Vec3 on_surface(Vec3 x) const {
    for (int k = 0; k < most_steps; ++k) {
      const auto [distance, gradient] = distance_.at(x);
      const double steep = gradient.squaredNorm();
      if (std::abs(distance) < 1e-12 * half_ || steep < 1e-6) break;
      x -= distance / steep * gradient;
    }
    return x;
  }

  UnionDistance distance_;
  double half_; ///< m, side of a cube
  Vec3 origin_;
  std::map<Point, double> values_;
  std::map<std::pair<Point, Point>, Local> vertices_;
};

} // namespace

UnionMesh mesh_union(const config::Union& input) { return Marching(input).mesh; }

} // namespace taut
