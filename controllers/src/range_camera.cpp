#include <cnoid/RangeCamera>

#include "device_state_cast.h"
#include "shared_data.h"

namespace cnoid {

RangeCamera::RangeCamera() : points_(std::make_shared<PointData>()) { setImageType(NO_IMAGE); }

RangeCamera::RangeCamera(const RangeCamera& other) = default;

const char* RangeCamera::typeName() const { return "RangeCamera"; }

void RangeCamera::copyStateFrom(const DeviceState& other) {
  const auto& camera = sameType<RangeCamera>(other);
  copyCameraStateFrom(camera);
  minDistance_ = camera.minDistance_;
  maxDistance_ = camera.maxDistance_;
  organized_ = camera.organized_;
  dense_ = camera.dense_;
  points_ = camera.points_;
}

Referenced* RangeCamera::doClone(CloneMap*) const {
  auto* camera = new RangeCamera(*this);
  if (!isImageStateClonable()) camera->clearPoints();
  return camera;
}

void RangeCamera::clearState() {
  Camera::clearState();
  clearPoints();
}

RangeCamera::PointData& RangeCamera::points() { return ownData(points_); }

RangeCamera::PointData& RangeCamera::newPoints() {
  points_ = std::make_shared<PointData>();
  return *points_;
}

void RangeCamera::setPoints(std::shared_ptr<PointData>& points) { points_ = takeData(points); }

void RangeCamera::clearPoints() { newPoints(); }

void RangeCamera::setOrganized(bool on) {
  if (on != organized_) clearState();  // the stored points have the other form
  organized_ = on;
}

}  // namespace cnoid
