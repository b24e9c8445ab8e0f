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

struct Found {
  std::span<const Box> first, second;
  std::vector<BoxPair> pairs;
};

/// Embree reports leaves that meet; the boxes in them may not.
void collect(void* found_pointer, RTCCollision* collisions, unsigned count) {
  Found& found = *static_cast<Found*>(found_pointer);
  for (const RTCCollision& c : std::span(collisions, count))
    if (found.first[c.primID0].overlaps(found.second[c.primID1]))
      found.pairs.emplace_back(Local(c.primID0), Local(c.primID1));
}

void bounds_of(const RTCBoundsFunctionArguments* arguments) {
  const Box& box = (*static_cast<const std::vector<Box>*>(arguments->geometryUserPtr))[arguments->primID];
  RTCBounds& bounds = *arguments->bounds_o;
  bounds.lower_x = box.low[0], bounds.lower_y = box.low[1], bounds.lower_z = box.low[2];
  bounds.upper_x = box.high[0], bounds.upper_y = box.high[1], bounds.upper_z = box.high[2];
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
  rtcSetGeometryUserPrimitiveCount(scene_->geometry, unsigned(scene_->boxes.size()));
  rtcCommitGeometry(scene_->geometry);
  rtcCommitScene(scene_->scene);
  if (rtcGetDeviceError(device()) != RTC_ERROR_NONE)
    throw std::runtime_error("Embree could not build its tree of boxes");
}

std::vector<BoxPair> BoxTree::pairs() const {
  std::vector<BoxPair> found = pairs_with(*this); // each pair both ways, and each box with itself
  std::erase_if(found, [](const BoxPair& p) { return p.first >= p.second; });
  return found;
}

std::vector<BoxPair> BoxTree::pairs_with(const BoxTree& other) const {
  Found found{scene_->boxes, other.scene_->boxes, {}};
  if (!found.first.empty() && !found.second.empty())
    rtcCollide(scene_->scene, other.scene_->scene, collect, &found);
  return std::move(found.pairs);
}

} // namespace taut
