#include <gtest/gtest.h>
#include <cnoid/BasicSensors>
#include <cnoid/DeviceList>
#include <cnoid/RangeCamera>

#include "bodies.h"

namespace {

using cnoid::Camera;
using cnoid::Device;
using cnoid::DeviceList;
using cnoid::ForceSensor;
using cnoid::Imu;
using cnoid::RangeCamera;

DeviceList<> mixed_devices() {
  DeviceList<> devices;
  devices.push_back(new ForceSensor);
  devices.push_back(new RangeCamera);
  devices.push_back(new ForceSensor);
  devices.push_back(new Camera);
  return devices;
}

TEST(DeviceList, PicksItsTypeOutOfAnotherList) {
  const DeviceList<> devices = mixed_devices();
  const DeviceList<ForceSensor> sensors(devices);
  ASSERT_EQ(sensors.size(), 2u);
  EXPECT_EQ(sensors[0].get(), devices[0].get());
  EXPECT_EQ(sensors[1].get(), devices[2].get());
}

TEST(DeviceList, CountsADerivedDeviceAsOneOfItsBase) {
  EXPECT_EQ(DeviceList<Camera>(mixed_devices()).size(), 2u);
  EXPECT_EQ(DeviceList<RangeCamera>(mixed_devices()).size(), 1u);
}

TEST(DeviceList, AppendsWithTheExtractionOperator) {
  DeviceList<ForceSensor> sensors;
  sensors.push_back(new ForceSensor);
  sensors << mixed_devices();
  EXPECT_EQ(sensors.size(), 3u);
}

TEST(DeviceList, GivesElementsAsPlainPointers) {
  DeviceList<ForceSensor> sensors(mixed_devices());
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    ForceSensor* sensor = sensors[i];
    sensor->F()[0] = 1.0;
  }
  EXPECT_EQ(sensors.back()->F()[0], 1.0);
}

TEST(DeviceList, ExtractsItsTypeFromAnotherListAndLeavesTheRest) {
  DeviceList<> devices = mixed_devices();
  DeviceList<Camera> cameras;
  EXPECT_TRUE(cameras.extractFrom(devices));
  EXPECT_EQ(cameras.size(), 2u);
  EXPECT_EQ(devices.size(), 2u);
  EXPECT_FALSE(cameras.extractFrom(devices));
  EXPECT_EQ(devices.extract<ForceSensor>().size(), 2u);
  EXPECT_TRUE(devices.empty());
}

TEST(DeviceList, SortsByIdAndLeavesHolesNull) {
  DeviceList<Imu> imus;
  for (const int id : {2, -1, 0}) {
    auto* imu = new Imu;
    imu->setId(id);
    imus.push_back(imu);
  }
  const DeviceList<Imu> sorted = imus.getSortedById();
  ASSERT_EQ(sorted.size(), 3u);
  EXPECT_EQ(sorted[0].get(), imus[2].get());
  EXPECT_EQ(sorted[1].get(), nullptr);
  EXPECT_EQ(sorted[2].get(), imus[0].get());
}

}  // namespace
