#pragma once
#include "partition/types.hpp"

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace taut::garment {

/// Three points, counter-clockwise; neighbour k lies across the side opposite to vertex k, -1 on the border.
struct Triangle {
  std::array<int, 3> vertices;
  std::array<int, 3> neighbours{-1, -1, -1};
};

/// The smallest angle of a triangle, in rad; zero or less if it is not counter-clockwise.
double smallest_angle(const Vec2& a, const Vec2& b, const Vec2& c);

/// A triangulation of a region of the plane, with holes or without, whose border stays as it is: no edge of
/// it is flipped or split, and no point of it moves. All that is done inside is decided by the points alone,
/// in a fixed order.
class Triangulation {
public:
  /// `points` with triangles that cover the region, counter-clockwise, each given by three numbers of points.
  Triangulation(std::vector<Vec2> points, std::span<const std::array<int, 3>> triangles);

  const std::vector<Vec2>& points() const { return points_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  double angle(int triangle) const;

  /// Flips edges until all are Delaunay, but for those of the border [Lawson 1977].
  void make_delaunay();

  /// Puts points inside, or moves those put there before, until no triangle has an angle below `target` (rad)
  /// or nothing is to be gained any more: a triangle that is too sharp gets a point near its circumcentre,
  /// nearer to its shortest side if that will do, where it raises the smallest angle around
  /// [Ruppert 1995, Üngör 2004]. The triangulation must be Delaunay, and is so afterwards.
  void refine(double target);

  /// Puts a point inside, unless an angle below `target` and below all angles around came of it; with a
  /// target of zero, wherever no triangle turns over. Says whether it did.
  bool insert(const Vec2& point, double target);

private:
  /// Triangles that are to make room for a point, and their hull, to which it will be joined.
  struct Cavity {
    struct Side {
      int a, b;         ///< counter-clockwise around the cavity
      int beyond, back; ///< triangle across, -1 on the border; which of its neighbours this side is
    };
    std::vector<int> triangles;
    std::vector<Side> hull;
    double angle_before = 0, angle_after = 0; ///< smallest
  };

  void link_neighbours();
  bool flip_if_better(int triangle, int side, std::vector<std::pair<int, int>>& next);
  void settle(std::vector<std::pair<int, int>>& suspects);
  int side_towards(int triangle, const Vec2& point) const; ///< -1 if the point is inside, or on the rim
  std::optional<int> locate(const Vec2& point, int start) const;
  bool circle_holds(int triangle, const Vec2& point) const;
  Cavity surround(const Vec2& point, std::vector<int> triangles) const;
  /// Of the triangles whose circumcircles hold the point.
  std::optional<Cavity> cavity_of(const Vec2& point, int start) const;
  void fill(const Cavity& cavity, const Vec2& point);
  bool split(int triangle, double target);
  int insert_where_sharp(double target);
  std::vector<int> star_of(int vertex) const;
  int smooth(double target);
  bool move_for_the_better(int vertex);

  std::vector<Vec2> points_;
  std::vector<Triangle> triangles_;
  std::vector<int> triangle_of_; ///< one of those around each point
  int given_;                    ///< points that do not move
};

} // namespace taut::garment
