// RangeSensor: distances along a fan, or a grid, of beams.
//
// In the optical frame (see VisionSensor) pitch turns about +x, up is positive, and yaw about +y, left is positive.
// Index = pitch index * numYawSamples() + yaw index; yaw index 0 is the right-most beam, pitch index 0 the lowest.
// A value is the distance from the sensor's origin [m]; +infinity means that the beam hit nothing.
#pragma once

#include "VisionSensor.h"

#include <memory>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT RangeSensor : public VisionSensor {
 public:
  RangeSensor();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  void clearState() override;
  int stateSize() const override;
  /// VisionSensor's; yaw minimum, maximum, samples; pitch likewise; minimum and maximum distance.
  double* writeState(double* buffer) const override;
  const double* readState(const double* buffer, int size) override;

  double minYawAngle() const { return yaw_.minAngle; }               // [rad]
  double maxYawAngle() const { return yaw_.maxAngle; }               // [rad]
  double yawRange() const { return yaw_.maxAngle - yaw_.minAngle; }  // [rad]
  double yawStep() const { return yaw_.step; }                       // [rad]
  int numYawSamples() const { return yaw_.samples; }
  /// Ignored if the maximum is below the minimum. Of step and samples the one set last is kept, the other is computed.
  void setYawRange(double minAngle, double maxAngle) { yaw_.setRange(minAngle, maxAngle); }
  /// Sets a range that is symmetric about the forward direction.
  void setYawRange(double angle);
  /// Both ends of the range are sampled. Ignored if negative; 0 means a single sample.
  void setYawStep(double step) { yaw_.setStep(step); }
  /// Ignored if less than 1.
  void setNumYawSamples(int samples) { yaw_.setSamples(samples); }
  bool isNumYawSamplesCalculatedFromYawStep() const { return yaw_.stepDecides; }

  double minPitchAngle() const { return pitch_.minAngle; }                 // [rad]
  double maxPitchAngle() const { return pitch_.maxAngle; }                 // [rad]
  double pitchRange() const { return pitch_.maxAngle - pitch_.minAngle; }  // [rad]
  double pitchStep() const { return pitch_.step; }                         // [rad]
  int numPitchSamples() const { return pitch_.samples; }
  void setPitchRange(double minAngle, double maxAngle) { pitch_.setRange(minAngle, maxAngle); }
  void setPitchRange(double angle);
  void setPitchStep(double step) { pitch_.setStep(step); }
  void setNumPitchSamples(int samples) { pitch_.setSamples(samples); }
  bool isNumPitchSamplesCalculatedFromPitchStep() const { return pitch_.stepDecides; }

  double minDistance() const { return minDistance_; }  // [m]
  void setMinDistance(double distance) { minDistance_ = distance; }
  double maxDistance() const { return maxDistance_; }  // [m]
  void setMaxDistance(double distance) { maxDistance_ = distance; }

  double scanRate() const { return frameRate(); }  // [Hz]
  void setScanRate(double hertz) { setFrameRate(hertz); }

  /// Ratio of the beams that return a distance, 0 to 1.
  double detectionRate() const { return detectionRate_; }
  void setDetectionRate(double rate) { detectionRate_ = rate; }
  /// Standard deviation of the distance [m].
  double errorDeviation() const { return errorDeviation_; }
  void setErrorDeviation(double deviation) { errorDeviation_ = deviation; }

  using RangeData = std::vector<double>;  // [m]

  /// Empty until the first data are delivered. Sharing is as in Camera.
  const RangeData& rangeData() const { return *rangeData_; }
  const RangeData& constRangeData() const { return *rangeData_; }
  RangeData& rangeData();
  std::shared_ptr<const RangeData> sharedRangeData() const { return rangeData_; }
  RangeData& newRangeData();
  /// Takes the data without copying if the caller is its only owner, else copies it. Leaves `rangeData` null.
  void setRangeData(std::shared_ptr<RangeData>& rangeData);
  void clearRangeData();

  /// If true, clone() copies the range data, too; false by default.
  bool isRangeDataStateClonable() const { return rangeDataStateClonable_; }
  void setRangeDataStateClonable(bool on) { rangeDataStateClonable_ = on; }

  /// Yaw and pitch of a beam [rad].
  Vector2 getSphericalAngle(int rangeDataIndex) const;

 protected:
  RangeSensor(const RangeSensor& other);
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  /// One direction of the grid: a range of angles and the beams in it.
  struct CNOID_GENERAL_EXPORT Sweep {
    double minAngle = 0.0;
    double maxAngle = 0.0;
    double step = 0.0;
    int samples = 1;
    bool stepDecides = true;

    void setRange(double newMinAngle, double newMaxAngle);
    void setStep(double newStep);
    void setSamples(int newSamples);
  };

  Sweep yaw_;
  Sweep pitch_;
  double minDistance_ = 0.1;
  double maxDistance_ = 10.0;
  double detectionRate_ = 1.0;
  double errorDeviation_ = 0.0;
  bool rangeDataStateClonable_ = false;
  std::shared_ptr<RangeData> rangeData_;
};

using RangeSensorPtr = ref_ptr<RangeSensor>;

}  // namespace cnoid
