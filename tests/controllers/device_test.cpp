// Properties of all devices, tested for each type.
#include <gtest/gtest.h>
#include <cnoid/AttachmentDevice>
#include <cnoid/BasicSensors>
#include <cnoid/HolderDevice>
#include <cnoid/RangeCamera>
#include <cnoid/RangeSensor>
#include <cnoid/RotorDevice>
#include <cnoid/SpotLight>
#include <cnoid/ZmpDevice>

#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/printed_by_name.h"

namespace {

using cnoid::Device;
using cnoid::DevicePtr;
using cnoid::Vector3;

struct Kind {
  std::string name;  // of the type
  std::function<Device*()> make;
  int state_size;
};

class EveryDevice : public testing::TestWithParam<Kind> {
 protected:
  /// A state that differs in each number, and is possible for each type: whole numbers from 1 on.
  static std::vector<double> counting_state(const Device& device) {
    std::vector<double> state(static_cast<std::size_t>(device.stateSize()));
    std::iota(state.begin(), state.end(), 1.0);
    return state;
  }
  static std::vector<double> state_of(const Device& device) {
    std::vector<double> state(static_cast<std::size_t>(device.stateSize()));
    EXPECT_EQ(device.writeState(state.data()), state.data() + state.size());
    return state;
  }
};

TEST_P(EveryDevice, HasItsTypesNameAndStateSize) {
  const DevicePtr device = GetParam().make();
  EXPECT_EQ(device->typeName(), GetParam().name);
  EXPECT_EQ(device->stateSize(), GetParam().state_size);
}

TEST_P(EveryDevice, ReadsTheStateThatItWrote) {
  const DevicePtr device = GetParam().make();
  const std::vector<double> state = counting_state(*device);
  EXPECT_EQ(device->readState(state.data(), static_cast<int>(state.size())), state.data() + state.size());
  EXPECT_EQ(state_of(*device), state);
}

TEST_P(EveryDevice, ReadsNothingFromTooShortABuffer) {
  const DevicePtr device = GetParam().make();
  const std::vector<double> before = state_of(*device);
  const std::vector<double> state = counting_state(*device);
  EXPECT_EQ(device->readState(state.data(), device->stateSize() - 1), state.data());
  EXPECT_EQ(state_of(*device), before);
}

TEST_P(EveryDevice, CopiesTheStateOfItsOwnTypeOnly) {
  const DevicePtr source = GetParam().make();
  const DevicePtr target = GetParam().make();
  const std::vector<double> state = counting_state(*source);
  source->readState(state.data(), static_cast<int>(state.size()));
  target->copyStateFrom(*source);
  EXPECT_EQ(state_of(*target), state);

  const bool is_imu = GetParam().name == "Imu";
  const DevicePtr other = is_imu ? DevicePtr(new cnoid::ForceSensor) : DevicePtr(new cnoid::Imu);
  EXPECT_THROW(target->copyStateFrom(*other), std::invalid_argument);
}

TEST_P(EveryDevice, ClonesPlaceAndStateButNotItsListeners) {
  const DevicePtr device = GetParam().make();
  device->setName("d");
  device->setId(7);
  device->setIndex(3);
  device->setLocalTranslation(Vector3(1, 2, 3));
  const std::vector<double> state = counting_state(*device);
  device->readState(state.data(), static_cast<int>(state.size()));
  int notified = 0;
  device->sigStateChanged().connect([&] { ++notified; });

  const DevicePtr copy = device->clone();
  EXPECT_EQ(copy->typeName(), GetParam().name);
  EXPECT_EQ(copy->name(), "d");
  EXPECT_EQ(copy->id(), 7);
  EXPECT_EQ(copy->index(), -1);
  EXPECT_EQ(copy->p_local(), Vector3(1, 2, 3));
  EXPECT_EQ(state_of(*copy), state);
  copy->notifyStateChange();
  EXPECT_EQ(notified, 0);
  device->notifyStateChange();
  EXPECT_EQ(notified, 1);
}

template <class Type>
Kind kind(const std::string& type_name, int state_size) {
  return {type_name, [] { return new Type; }, state_size};
}

INSTANTIATE_TEST_SUITE_P(
    All, EveryDevice,
    testing::Values(kind<cnoid::ForceSensor>("ForceSensor", 6), kind<cnoid::RateGyroSensor>("RateGyroSensor", 3),
                    kind<cnoid::AccelerationSensor>("AccelerationSensor", 3), kind<cnoid::Imu>("Imu", 6),
                    kind<cnoid::Camera>("Camera", 3 + 5), kind<cnoid::RangeCamera>("RangeCamera", 3 + 5),
                    kind<cnoid::RangeSensor>("RangeSensor", 3 + 8), kind<cnoid::PointLight>("PointLight", 5 + 3),
                    kind<cnoid::SpotLight>("SpotLight", 5 + 3 + 6), kind<cnoid::HolderDevice>("HolderDevice", 1),
                    kind<cnoid::AttachmentDevice>("AttachmentDevice", 1),
                    kind<Multicopter::RotorDevice>("RotorDevice", 19), kind<cnoid::ZmpDevice>("ZmpDevice", 4)),
    rehearse::test::by_name);

TEST(Device, IsAlwaysOnUnlessItCanBeSwitched) {
  const DevicePtr imu = new cnoid::Imu;
  imu->on(false);
  EXPECT_TRUE(imu->on());
  const DevicePtr camera = new cnoid::Camera;
  camera->on(false);
  EXPECT_FALSE(camera->on());
  const DevicePtr light = new cnoid::SpotLight;
  EXPECT_TRUE(light->on());
  light->on(false);
  EXPECT_FALSE(light->on());
}

TEST(Device, HasInformationBesideItsState) {
  const DevicePtr camera = new cnoid::Camera;
  EXPECT_TRUE(camera->info()->empty());
  EXPECT_EQ(camera->info()->get("pepper", 0.25), 0.25);
  camera->info()->write("pepper", 0.5);
  const DevicePtr copy = camera->clone();
  EXPECT_EQ(copy->info()->get("pepper", 0.0), 0.5);
  copy->info()->write("pepper", 0.75);
  EXPECT_EQ(camera->info()->get("pepper", 0.0), 0.5) << "a copy's information is its own";

  int notified = 0;
  camera->sigInfoChanged().connect([&] { ++notified; });
  camera->notifyStateChange();
  EXPECT_EQ(notified, 0);
  camera->notifyInfoChange();
  EXPECT_EQ(notified, 1);
  camera->resetInfo(new cnoid::Mapping);
  EXPECT_TRUE(camera->info()->empty());
}

TEST(Device, HasAPlaceOnItsLink) {
  const DevicePtr device = new cnoid::Imu;
  const cnoid::AngleAxis turn(0.5, Vector3::UnitX());
  device->setLocalRotation(turn.toRotationMatrix());
  device->p_local() = Vector3(0, 1, 0);
  EXPECT_EQ(device->T_local().translation(), Vector3(0, 1, 0));
  EXPECT_TRUE(device->R_local().isApprox(turn.toRotationMatrix()));
  device->setLocalPosition(cnoid::Isometry3::Identity());
  EXPECT_TRUE(device->localPosition().isApprox(cnoid::Isometry3::Identity()));
}

TEST(Device, HasTheCycleOfEarlierReleasesWithoutEffect) {
  const cnoid::ForceSensorPtr sensor = new cnoid::ForceSensor;
  sensor->setCycle(5.0);
  EXPECT_EQ(sensor->cycle(), 20.0);
  cnoid::Isometry3 pose(cnoid::AngleAxis(0.3, cnoid::Vector3::UnitZ()));
  pose.translation() = cnoid::Vector3(1, 2, 3);
  sensor->setLocalAttitude(pose);
  EXPECT_TRUE(sensor->R_local().isApprox(pose.linear()));
  EXPECT_TRUE(sensor->T_local_org().translation().isZero(0.0));
}

}  // namespace
