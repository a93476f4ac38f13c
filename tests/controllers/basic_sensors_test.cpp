#include <gtest/gtest.h>
#include <cnoid/BasicSensors>

namespace {

using cnoid::ref_ptr;
using cnoid::Vector3;

TEST(ForceSensor, IsOneVectorUnderManyNames) {
  const ref_ptr<cnoid::ForceSensor> sensor = new cnoid::ForceSensor;
  sensor->f() = Vector3(1, 2, 3);
  sensor->tau() = Vector3(4, 5, 6);
  cnoid::Vector6 expected;
  expected << 1, 2, 3, 4, 5, 6;
  EXPECT_EQ(sensor->F(), expected);
  EXPECT_EQ(sensor->wrench(), expected);
  EXPECT_EQ(sensor->force(), Vector3(1, 2, 3));
  EXPECT_EQ(sensor->torque(), Vector3(4, 5, 6));
  sensor->clearState();
  EXPECT_TRUE(sensor->F().isZero(0.0));
}

TEST(BasicSensors, ReadZeroAtFirst) {
  EXPECT_TRUE(ref_ptr<cnoid::ForceSensor>(new cnoid::ForceSensor)->F().isZero(0.0));
  EXPECT_TRUE(ref_ptr<cnoid::RateGyroSensor>(new cnoid::RateGyroSensor)->w().isZero(0.0));
  EXPECT_TRUE(ref_ptr<cnoid::AccelerationSensor>(new cnoid::AccelerationSensor)->dv().isZero(0.0));
  EXPECT_TRUE(ref_ptr<cnoid::Imu>(new cnoid::Imu)->dv().isZero(0.0));
}

TEST(BasicSensors, HaveNoLimitUnlessOneIsSet) {
  const ref_ptr<cnoid::Imu> imu = new cnoid::Imu;
  EXPECT_EQ(imu->w_max(), Vector3::Constant(std::numeric_limits<double>::max()));
  imu->w_max() = Vector3(1, 1, 1);
  const ref_ptr<cnoid::Imu> copy = static_cast<cnoid::Imu*>(imu->clone());
  EXPECT_EQ(copy->w_max(), Vector3(1, 1, 1));
}

TEST(Imu, WritesAngularVelocityBeforeAcceleration) {
  const ref_ptr<cnoid::Imu> imu = new cnoid::Imu;
  imu->w() = Vector3(1, 2, 3);
  imu->dv() = Vector3(4, 5, 6);
  double state[6];
  imu->writeState(state);
  EXPECT_EQ(state[0], 1.0);
  EXPECT_EQ(state[3], 4.0);
}

}  // namespace
