#include "src/garment/polygon.hpp"

#include <geos_c.h>

#include <cstring>
#include <memory>
#include <unordered_map>

namespace taut::garment {

namespace {

/// GEOS without its words on stderr; those who fail return nothing.
class Geos {
public:
  struct Destroy {
    GEOSContextHandle_t context;
    void operator()(GEOSGeometry* g) const { GEOSGeom_destroy_r(context, g); }
  };
  using Geometry = std::unique_ptr<GEOSGeometry, Destroy>;

  Geos() : context_(GEOS_init_r()) {}
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;
  ~Geos() { GEOS_finish_r(context_); }

  GEOSContextHandle_t context() const { return context_; }
  Geometry own(GEOSGeometry* g) const { return {g, {context_}}; }

  Geometry polygon(const Ring& ring) const {
    std::vector<double> numbers;
    for (std::size_t i = 0; i <= ring.size(); ++i)
      numbers.insert(numbers.end(), {ring[i % ring.size()][0], ring[i % ring.size()][1]});
    GEOSCoordSequence* points =
        GEOSCoordSeq_copyFromBuffer_r(context_, numbers.data(), unsigned(ring.size() + 1), 0, 0);
    return own(GEOSGeom_createPolygon_r(context_, GEOSGeom_createLinearRing_r(context_, points), nullptr, 0));
  }

  /// The first `count` points of a line or ring; whoever has fewer gives none.
  std::vector<Vec2> points_of(const GEOSGeometry* line, unsigned count) const {
    const GEOSCoordSequence* sequence = line ? GEOSGeom_getCoordSeq_r(context_, line) : nullptr;
    unsigned size = 0;
    if (!sequence || !GEOSCoordSeq_getSize_r(context_, sequence, &size) || size < count) return {};
    std::vector<Vec2> points(count);
    for (unsigned i = 0; i < count; ++i)
      GEOSCoordSeq_getXY_r(context_, sequence, i, &points[i][0], &points[i][1]);
    return points;
  }

private:
  GEOSContextHandle_t context_;
};

/// Points by their exact coordinates.
struct PointHash {
  std::size_t operator()(const Vec2& p) const {
    std::uint64_t x, y;
    std::memcpy(&x, &p[0], 8);
    std::memcpy(&y, &p[1], 8);
    return (x * 0x9e3779b97f4a7c15u) ^ (y * 0xc2b2ae3d27d4eb4fu >> 7);
  }
};

} // namespace

std::optional<RingFault> fault_of_ring(const Ring& ring) {
  const Geos geos;
  const auto polygon = geos.polygon(ring);
  char* reason = nullptr;
  GEOSGeometry* found = nullptr;
  const char valid = polygon ? GEOSisValidDetail_r(geos.context(), polygon.get(), 0, &reason, &found) : 0;
  const auto place = geos.own(found);
  RingFault fault{reason ? reason : "not a polygon", ring[0]};
  if (reason) GEOSFree_r(geos.context(), reason);
  if (valid == 1) return std::nullopt;
  if (const auto at = geos.points_of(place.get(), 1); !at.empty()) fault.place = at[0];
  return fault;
}

double inscribed_radius(const Ring& ring, double tolerance) {
  const Geos geos;
  const auto polygon = geos.polygon(ring);
  const auto radius = geos.own(GEOSMaximumInscribedCircle_r(geos.context(), polygon.get(), tolerance));
  const auto ends = geos.points_of(radius.get(), 2);
  return ends.empty() ? 0 : (ends[1] - ends[0]).norm();
}

double distance_between(const Ring& one, const Ring& two) {
  const Geos geos;
  const auto a = geos.polygon(one), b = geos.polygon(two);
  double distance = 0;
  if (!a || !b || !GEOSDistance_r(geos.context(), a.get(), b.get(), &distance)) return 0;
  return distance;
}

double distance_between(const Ring& ring, const Vec2& p) {
  const Geos geos;
  const auto polygon = geos.polygon(ring);
  const auto point = geos.own(GEOSGeom_createPointFromXY_r(geos.context(), p[0], p[1]));
  double distance = 0;
  if (!polygon || !point || !GEOSDistance_r(geos.context(), polygon.get(), point.get(), &distance)) return 0;
  return distance;
}

double common_area(const Ring& one, const Ring& two) {
  const Geos geos;
  const auto a = geos.polygon(one), b = geos.polygon(two);
  const auto common = geos.own(a && b ? GEOSIntersection_r(geos.context(), a.get(), b.get()) : nullptr);
  double area = 0;
  if (!common || !GEOSArea_r(geos.context(), common.get(), &area)) return 0;
  return area;
}

std::optional<std::vector<std::array<int, 3>>> triangulate(const Ring& ring) {
  std::unordered_map<Vec2, int, PointHash> numbers;
  for (const Vec2& p : ring) numbers.emplace(p, int(numbers.size()));
  const Geos geos;
  const auto polygon = geos.polygon(ring);
  const auto all =
      geos.own(polygon ? GEOSConstrainedDelaunayTriangulation_r(geos.context(), polygon.get()) : nullptr);
  if (!all) return std::nullopt;
  std::vector<std::array<int, 3>> triangles(std::size_t(GEOSGetNumGeometries_r(geos.context(), all.get())));
  if (triangles.size() + 2 != ring.size() || numbers.size() != ring.size()) return std::nullopt;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const GEOSGeometry* triangle = GEOSGetGeometryN_r(geos.context(), all.get(), int(t));
    const auto corners = geos.points_of(GEOSGetExteriorRing_r(geos.context(), triangle), 4);
    if (corners.empty()) return std::nullopt;
    for (int k = 0; k < 3; ++k) {
      const auto found = numbers.find(corners[k]);
      if (found == numbers.end()) return std::nullopt;
      triangles[t][k] = found->second;
    }
    // GEOS gives all of them clockwise. That is not to be measured: those with corners on one line have no
    // area.
    std::swap(triangles[t][1], triangles[t][2]);
  }
  return triangles;
}

} // namespace taut::garment
