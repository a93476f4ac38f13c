#include <gtest/gtest.h>
#include <cnoid/MarkerDevice>
#include <cnoid/RotorDevice>

#include <stdexcept>
#include <vector>

namespace {

using cnoid::MarkerDevice;
using cnoid::MarkerDevicePtr;
using cnoid::Vector3;
using Multicopter::RotorDevice;
using Multicopter::RotorDevicePtr;

TEST(MarkerDevice, HasChoreonoidsDefaults) {
  const MarkerDevicePtr marker = new MarkerDevice;
  EXPECT_TRUE(marker->on());
  EXPECT_EQ(marker->markerType(), MarkerDevice::SPHERE_MARKER);
  EXPECT_EQ(marker->markerSize(), 0.01);
  EXPECT_EQ(marker->color(), cnoid::Vector3f(1, 0, 0));
  EXPECT_EQ(marker->emission(), 0.5f);
  EXPECT_EQ(marker->transparency(), 0.7f);
  EXPECT_TRUE(marker->offsetPosition().isApprox(cnoid::Isometry3::Identity()));
}

TEST(MarkerDevice, ReadsTheStateThatItWrote) {
  const MarkerDevicePtr marker = new MarkerDevice;
  marker->on(false);
  marker->setMarkerType(MarkerDevice::AXES_MARKER);
  marker->setMarkerSize(0.24);
  marker->setColor(cnoid::Vector3f(0.25f, 0.5f, 0.75f));
  marker->setEmission(0.125f);
  marker->setTransparency(0.0f);
  cnoid::Isometry3 offset(cnoid::AngleAxis(0.5, Vector3(2, 1, 2) / 3.0));
  offset.translation() = Vector3(1, 2, 3);
  marker->setOffsetPosition(offset);
  std::vector<double> state(15);
  ASSERT_EQ(marker->stateSize(), 15);
  EXPECT_EQ(marker->writeState(state.data()), state.data() + 15);

  const MarkerDevicePtr other = new MarkerDevice;
  EXPECT_EQ(other->readState(state.data(), 14), state.data()) << "one number is missing";
  EXPECT_TRUE(other->on());
  EXPECT_EQ(other->readState(state.data(), 15), state.data() + 15);
  EXPECT_FALSE(other->on());
  EXPECT_EQ(other->markerType(), MarkerDevice::AXES_MARKER);
  EXPECT_EQ(other->markerSize(), 0.24);
  EXPECT_EQ(other->color(), marker->color());
  EXPECT_EQ(other->emission(), 0.125f);
  EXPECT_EQ(other->transparency(), 0.0f);
  EXPECT_TRUE(other->offsetPosition().isApprox(offset, 1e-15));
}

TEST(MarkerDevice, CopiesItsState) {
  const MarkerDevicePtr marker = new MarkerDevice;
  marker->on(false);
  marker->setOffsetTranslation(Vector3(1, 2, 3));
  const MarkerDevicePtr other = new MarkerDevice;
  other->copyStateFrom(*marker);
  EXPECT_FALSE(other->on());
  EXPECT_EQ(Vector3(other->offsetPosition().translation()), Vector3(1, 2, 3));
  EXPECT_THROW(other->copyStateFrom(RotorDevice()), std::invalid_argument);
}

TEST(RotorDevice, KeepsThrustAndTorqueWithinTheirRanges) {
  const RotorDevicePtr rotor = new RotorDevice;
  rotor->setValue(1000.0);
  rotor->setTorque(-1000.0);
  EXPECT_EQ(rotor->value(), 100.0);
  EXPECT_EQ(rotor->torque(), -100.0);
  rotor->setValueRange(0.0, 20.0);
  rotor->setTorqueRange(-1.0, 1.0);
  rotor->setValue(-5.0);
  rotor->setTorque(0.5);
  EXPECT_EQ(rotor->value(), 0.0);
  EXPECT_EQ(rotor->torque(), 0.5);
  EXPECT_EQ(rotor->applyValueRange(30.0), 20.0);
  EXPECT_EQ(rotor->applyTorqueRange(-3.0), -1.0);
  double min = 9.0, max = 9.0;
  rotor->valueRange(min, max);
  EXPECT_EQ(min, 0.0);
  EXPECT_EQ(max, 20.0);
  rotor->torqueRange(min, max);
  EXPECT_EQ(min, -1.0);
  EXPECT_EQ(max, 1.0);
}

TEST(RotorDevice, PushesAlongAUnitVectorFromItsPlace) {
  const RotorDevicePtr rotor = new RotorDevice;
  EXPECT_TRUE(rotor->isActive());
  EXPECT_EQ(rotor->direction(), Vector3(0, 0, 1));
  rotor->setDirection(Vector3(0, 3, 4));
  EXPECT_TRUE(rotor->direction().isApprox(Vector3(0, 0.6, 0.8)));
  rotor->setPosition(Vector3(1, 2, 3));
  EXPECT_EQ(Vector3(rotor->localTranslation()), Vector3(1, 2, 3));
}

TEST(RotorDevice, StoresTheEffectsOfWallsAndGround) {
  const RotorDevicePtr rotor = new RotorDevice;
  rotor->setWallEffectDistance(1.0);
  rotor->setWallEffectNormMiddleValue(2.0);
  rotor->setWallEffectMaxRate(3.0);
  rotor->setGroundEffectDistance(4.0);
  rotor->setGroundEffectNormMiddleValue(5.0);
  rotor->setGroundEffectMaxRate(6.0);
  std::vector<double> state(19);
  rotor->writeState(state.data());
  EXPECT_EQ(std::vector<double>(state.begin() + 13, state.end()), (std::vector<double>{1, 2, 3, 4, 5, 6}));
}

}  // namespace
