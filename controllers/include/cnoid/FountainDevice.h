// FountainDevice: a jet of water. Its state is that of its particles; after notifyStateChange() the robot's other
// controllers see it. Rehearse draws no particles, and no model file has a FountainDevice: a controller that looks for
// one gets null.
#pragma once

#include "Device.h"
#include "ParticleSystem.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT FountainDevice : public Device {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  FountainDevice();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;
  const double* readState(const double* buffer, int size) override;

  bool on() const override { return particleSystem_.on(); }
  void on(bool on) override { particleSystem_.on(on); }

  ParticleSystem& particleSystem() { return particleSystem_; }
  const ParticleSystem& particleSystem() const { return particleSystem_; }

 protected:
  FountainDevice(const FountainDevice& other) = default;
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  ParticleSystem particleSystem_;
};

using FountainDevicePtr = ref_ptr<FountainDevice>;

}  // namespace cnoid
