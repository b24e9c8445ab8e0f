#include "src/contact/box_tree.hpp"

#include <embree3/rtcore.h>

#include <stdexcept>

namespace taut {

namespace {

/// Embree's device: a pool of settings without a state of its own, one a process. Ranks are the threads here.
RTCDevice device() {
  static const struct Owner {
    RTCDevice device = rtcNewDevice("threads=1");
    ~Owner() { rtcReleaseDevice(device); }
  } owner;
  return owner.device;
}

/// So many consecutive boxes make one primitive of Embree's: neighbours in the list are neighbours in space,
/// and to compare the boxes of two primitives costs less than the tree does for as many.
constexpr std::size_t group = 4;

std::span<const Box> in_group(std::span<const Box> boxes, unsigned k) {
  return boxes.subspan(k * group, std::min(group, boxes.size() - k * group));
}

struct Found {
  std::span<const Box> first, second;
  std::vector<BoxPair> pairs;

  void compare(unsigned a, unsigned b) {
    const auto boxes = in_group(first, a), others = in_group(second, b);
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for (std::size_t j = 0; j < others.size(); ++j)
        if (boxes[i].overlaps(others[j])) pairs.emplace_back(Local(a * group + i), Local(b * group + j));
  }
  bool is_self() const { return first.data() == second.data(); }
};

/// Embree reports leaves that meet; the primitives in them may not. Of a tree with itself it may leave out
/// that a primitive meets itself.
void collect(void* found_pointer, RTCCollision* collisions, unsigned count) {
  Found& found = *static_cast<Found*>(found_pointer);
  for (const RTCCollision& c : std::span(collisions, count))
    if (!found.is_self() || c.primID0 < c.primID1) found.compare(c.primID0, c.primID1);
}

unsigned groups_of(std::span<const Box> boxes) { return unsigned((boxes.size() + group - 1) / group); }

void bounds_of(const RTCBoundsFunctionArguments* arguments) {
  const auto& boxes = *static_cast<const std::vector<Box>*>(arguments->geometryUserPtr);
  Box box;
  for (const Box& b : in_group(boxes, arguments->primID)) box.include(b);
  RTCBounds& bounds = *arguments->bounds_o;
  bounds.lower_x = box.low[0], bounds.lower_y = box.low[1], bounds.lower_z = box.low[2];
  bounds.upper_x = box.high[0], bounds.upper_y = box.high[1], bounds.upper_z = box.high[2];
}

struct Search {
  std::span<const Box> boxes;
  const std::function<double(Local)>& distance;
  std::pair<Local, double> nearest{-1, HUGE_VAL};

  /// Whether what is farther away need not be looked at any more.
  bool look_at(unsigned k) {
    const double before = nearest.second;
    for (std::size_t i = k * group; i < std::min((k + 1) * group, boxes.size()); ++i)
      if (const double d = distance(Local(i)); d < nearest.second) nearest = {Local(i), d};
    return nearest.second < before;
  }
};

bool narrow(RTCPointQueryFunctionArguments* arguments) {
  Search& search = *static_cast<Search*>(arguments->userPtr);
  if (!search.look_at(arguments->primID)) return false;
  constexpr double rounding = 1 + 1e-6;
  arguments->query->radius = float(rounding * std::max(search.nearest.second, 0.0));
  return true;
}

} // namespace

struct BoxTree::Scene {
  RTCScene scene = rtcNewScene(device());
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_USER);
  std::vector<Box> boxes;

  Scene() {
    rtcSetSceneFlags(scene, RTCSceneFlags(RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST));
    rtcSetGeometryUserData(geometry, &boxes);
    rtcSetGeometryBoundsFunction(
        geometry, [](const auto* a) { bounds_of(a); }, nullptr);
    rtcAttachGeometry(scene, geometry);
  }
  ~Scene() {
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
};

BoxTree::BoxTree() : scene_(std::make_unique<Scene>()) {}
BoxTree::~BoxTree() = default;
BoxTree::BoxTree(BoxTree&&) noexcept = default;
BoxTree& BoxTree::operator=(BoxTree&&) noexcept = default;

void BoxTree::build(std::vector<Box> boxes) {
  scene_->boxes = std::move(boxes);
  rtcSetGeometryUserPrimitiveCount(scene_->geometry, groups_of(scene_->boxes));
  rtcCommitGeometry(scene_->geometry);
  rtcCommitScene(scene_->scene);
  if (rtcGetDeviceError(device()) != RTC_ERROR_NONE)
    throw std::runtime_error("Embree could not build its tree of boxes");
}

std::pair<Local, double> BoxTree::nearest(const Vec3& place,
                                          const std::function<double(Local)>& distance) const {
  Search search{scene_->boxes, distance};
  if (scene_->boxes.empty()) return search.nearest;
  RTCPointQuery query{float(place[0]), float(place[1]), float(place[2]), 0, HUGE_VALF};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_->scene, &query, &context, narrow, &search);
  return search.nearest;
}

std::vector<BoxPair> BoxTree::pairs() const {
  Found found{scene_->boxes, scene_->boxes, {}};
  for (unsigned k = 0; k < groups_of(scene_->boxes); ++k) found.compare(k, k);
  if (!scene_->boxes.empty()) rtcCollide(scene_->scene, scene_->scene, collect, &found);
  std::erase_if(found.pairs, [](const BoxPair& p) { return p.first >= p.second; });
  return std::move(found.pairs);
}

std::vector<BoxPair> BoxTree::pairs_with(const BoxTree& other) const {
  Found found{scene_->boxes, other.scene_->boxes, {}};
  if (!found.first.empty() && !found.second.empty())
    rtcCollide(scene_->scene, other.scene_->scene, collect, &found);
  return std::move(found.pairs);
}

} // namespace taut
