// RangeCamera: a camera that also measures a point cloud.
//
// Points are in the device frame. An organized cloud has one point per pixel, row by row from the top left; for a pixel
// without a surface z is +infinity and x, y are infinite or 0. An unorganized cloud leaves these points out. Sharing is
// as in Camera.
#pragma once

#include "Camera.h"

#include <memory>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT RangeCamera : public Camera {
 public:
  RangeCamera();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  void clearState() override;

  using PointData = std::vector<Vector3f>;  // [m]

  int numPoints() const { return static_cast<int>(points_->size()); }
  const PointData& points() const { return *points_; }
  const PointData& constPoints() const { return *points_; }
  PointData& points();
  std::shared_ptr<const PointData> sharedPoints() const { return points_; }

  /// Creates a new, empty cloud to be filled.
  PointData& newPoints();
  /// Takes the points without copying if the caller is their only owner, else copies them. Leaves `points` null.
  void setPoints(std::shared_ptr<PointData>& points);
  void clearPoints();

  /// True if the cloud has one point per pixel. Changing it clears image and points.
  bool isOrganized() const { return organized_; }
  void setOrganized(bool on);
  /// True if the cloud contains no invalid points.
  bool isDense() const { return dense_; }
  void setDense(bool on) { dense_ = on; }

  /// Range of the sensor [m]. Stored only: the clip distances of the camera decide.
  double minDistance() const { return minDistance_; }
  void setMinDistance(double distance) { minDistance_ = distance; }
  double maxDistance() const { return maxDistance_; }
  void setMaxDistance(double distance) { maxDistance_ = distance; }

  /// Ratio of the detected points, 0 to 1.
  double detectionRate() const { return detectionRate_; }
  void setDetectionRate(double rate) { detectionRate_ = rate; }
  /// Standard deviation of the distance [m].
  double errorDeviation() const { return errorDeviation_; }
  void setErrorDeviation(double deviation) { errorDeviation_ = deviation; }

 protected:
  RangeCamera(const RangeCamera& other);
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  double minDistance_ = 0.1;
  double maxDistance_ = 10.0;
  double detectionRate_ = 1.0;
  double errorDeviation_ = 0.0;
  bool organized_ = true;
  bool dense_ = false;
  std::shared_ptr<PointData> points_;
};

using RangeCameraPtr = ref_ptr<RangeCamera>;

}  // namespace cnoid
