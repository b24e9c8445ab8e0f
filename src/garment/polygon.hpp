#pragma once
#include "partition/types.hpp"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// What GEOS knows of polygons. A ring is a list of points, of any direction, closed from the last to the
/// first.
namespace taut::garment {

using Ring = std::vector<Vec2>;

/// Why a ring is not that of a simple polygon, in the words of GEOS, and where.
struct RingFault {
  std::string reason;
  Vec2 place;
};
std::optional<RingFault> fault_of_ring(const Ring& ring);

/// The radius of the largest circle inside a simple polygon, to within `tolerance`.
double inscribed_radius(const Ring& ring, double tolerance);

/// How far apart two simple polygons are, with what is inside; 0 where they overlap, or GEOS fails.
double distance_between(const Ring& one, const Ring& two);

/// How far a point is from a simple polygon, with what is inside; 0 if GEOS fails.
double distance_between(const Ring& ring, const Vec2& p);

/// The area that two simple polygons have in common; 0 if GEOS fails.
double common_area(const Ring& one, const Ring& two);

/// Covers a simple polygon by triangles whose corners are its points, by their numbers; counter-clockwise,
/// not all of them Delaunay. Nothing if GEOS fails.
std::optional<std::vector<std::array<int, 3>>> triangulate(const Ring& ring);

} // namespace taut::garment
