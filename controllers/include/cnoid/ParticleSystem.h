// ParticleSystem: the particles of a fire or a fountain. Rehearse draws none; a controller's settings are kept.
#pragma once

#include "Config.h"
#include "EigenTypes.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT ParticleSystem {
 public:
  bool on() const { return on_; }
  void on(bool on) { on_ = on; }

  /// Time that passed before the first particle [s].
  float offsetTime() const { return offsetTime_; }
  void setOffsetTime(float time) { offsetTime_ = time; }
  /// Of a particle [s].
  float lifeTime() const { return lifeTime_; }
  void setLifeTime(float time) { lifeTime_ = time; }
  float particleSize() const { return particleSize_; }  // [m]
  void setParticleSize(float size) { particleSize_ = size; }
  int numParticles() const { return numParticles_; }
  void setNumParticles(int count) { numParticles_ = count; }
  /// Mean speed with which particles begin, and its variation [m/s].
  float initialSpeedAverage() const { return initialSpeedAverage_; }
  void setInitialSpeedAverage(float speed) { initialSpeedAverage_ = speed; }
  float initialSpeedVariation() const { return initialSpeedVariation_; }
  void setInitialSpeedVariation(float speed) { initialSpeedVariation_ = speed; }
  /// Angle of the cone in which particles begin [rad].
  float emissionRange() const { return emissionRange_; }
  void setEmissionRange(float range) { emissionRange_ = range; }
  const Vector3f& acceleration() const { return acceleration_; }  // [m/s²]
  void setAcceleration(const Vector3f& acceleration) { acceleration_ = acceleration; }
  /// Red, green, blue, 0 to 1.
  const Vector3f& tintColor() const { return tintColor_; }
  void setTintColor(const Vector3f& color) { tintColor_ = color; }

  /// The numbers of writeState(): on, and the members above in their order.
  static constexpr int stateSize = 14;
  double* writeState(double* buffer) const;
  const double* readState(const double* buffer);

 private:
  bool on_ = true;
  float offsetTime_ = 0.0f;
  float lifeTime_ = 3.0f;
  float particleSize_ = 0.1f;
  int numParticles_ = 500;
  float initialSpeedAverage_ = 0.1f;
  float initialSpeedVariation_ = 0.1f;
  float emissionRange_ = 1.0471976f;
  Vector3f acceleration_ = Vector3f::Zero();
  Vector3f tintColor_ = Vector3f::Ones();
};

}  // namespace cnoid
