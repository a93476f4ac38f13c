// RotorDevice: a propeller that pushes its link. It is in the same namespace as in Choreonoid.
//
// A controller sets value(), the thrust along direction(), and torque(), the reaction about it, then calls
// notifyStateChange(). Both are clamped to their ranges, -100 to 100 by default.
#pragma once

#include "Device.h"

namespace Multicopter {

class CNOID_GENERAL_EXPORT RotorDevice : public cnoid::Device {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  RotorDevice();

  const char* typeName() const override;
  void copyStateFrom(const cnoid::DeviceState& other) override;
  int stateSize() const override;
  /// active; position; direction; value, its range; torque, its range; wall effect's distance, middle value, maximum
  /// rate; ground effect's distance, middle value, maximum rate.
  double* writeState(double* buffer) const override;
  const double* readState(const double* buffer, int size) override;

  bool isActive() const { return isActive_; }
  void setActive(bool on) { isActive_ = on; }

  /// The position in the link frame [m]. Sets the device's place, too.
  const cnoid::Vector3& position() const { return position_; }
  void setPosition(const cnoid::Vector3& position);
  /// Unit vector, +z by default.
  const cnoid::Vector3& direction() const { return direction_; }
  void setDirection(const cnoid::Vector3& direction) { direction_ = direction.normalized(); }

  double value() const { return value_.now; }  // [N]
  void setValue(double value) { value_.now = value_.clamped(value); }
  void valueRange(double& min, double& max) const { value_.getRange(min, max); }
  void setValueRange(double min, double max) { value_.setRange(min, max); }
  double applyValueRange(double value) const { return value_.clamped(value); }

  double torque() const { return torque_.now; }  // [N·m]
  void setTorque(double torque) { torque_.now = torque_.clamped(torque); }
  void torqueRange(double& min, double& max) const { torque_.getRange(min, max); }
  void setTorqueRange(double min, double max) { torque_.setRange(min, max); }
  double applyTorqueRange(double torque) const { return torque_.clamped(torque); }

  /// The effect of a near wall, or of the ground, on the thrust: stored for a simulation of them.
  double wallEffectDistance() const { return wallEffect_.distance; }
  void setWallEffectDistance(double distance) { wallEffect_.distance = distance; }
  double wallEffectNormMiddleValue() const { return wallEffect_.normMiddleValue; }
  void setWallEffectNormMiddleValue(double value) { wallEffect_.normMiddleValue = value; }
  double wallEffectMaxRate() const { return wallEffect_.maxRate; }
  void setWallEffectMaxRate(double rate) { wallEffect_.maxRate = rate; }
  double groundEffectDistance() const { return groundEffect_.distance; }
  void setGroundEffectDistance(double distance) { groundEffect_.distance = distance; }
  double groundEffectNormMiddleValue() const { return groundEffect_.normMiddleValue; }
  void setGroundEffectNormMiddleValue(double value) { groundEffect_.normMiddleValue = value; }
  double groundEffectMaxRate() const { return groundEffect_.maxRate; }
  void setGroundEffectMaxRate(double rate) { groundEffect_.maxRate = rate; }

 protected:
  RotorDevice(const RotorDevice& other) = default;
  cnoid::Referenced* doClone(cnoid::CloneMap* cloneMap) const override;

 private:
  struct Limited {
    double now = 0.0;
    double min = -100.0;
    double max = 100.0;
    double clamped(double wanted) const { return wanted < min ? min : (wanted > max ? max : wanted); }
    void getRange(double& lower, double& upper) const {
      lower = min;
      upper = max;
    }
    void setRange(double lower, double upper) {
      min = lower;
      max = upper;
    }
  };
  struct Effect {
    double distance = 0.0;
    double normMiddleValue = 0.0;
    double maxRate = 0.0;
  };

  bool isActive_ = true;
  cnoid::Vector3 position_;
  cnoid::Vector3 direction_;
  Limited value_;
  Limited torque_;
  Effect wallEffect_;
  Effect groundEffect_;
};

using RotorDevicePtr = cnoid::ref_ptr<RotorDevice>;

}  // namespace Multicopter
