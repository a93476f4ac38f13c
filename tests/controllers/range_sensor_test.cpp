#include <gtest/gtest.h>
#include <cnoid/EigenUtil>
#include <cnoid/RangeSensor>

namespace {

using cnoid::radian;
using cnoid::RangeSensor;
using cnoid::RangeSensorPtr;

TEST(RangeSensor, HasChoreonoidsDefaults) {
  const RangeSensorPtr sensor = new RangeSensor;
  EXPECT_EQ(sensor->scanRate(), 10.0);
  EXPECT_EQ(sensor->maxYawAngle(), radian(60.0));
  EXPECT_EQ(sensor->minYawAngle(), radian(-60.0));
  EXPECT_EQ(sensor->yawStep(), 1.0);
  EXPECT_EQ(sensor->numYawSamples(), 3);  // 2.09 rad in steps of 1
  EXPECT_EQ(sensor->numPitchSamples(), 1);
  EXPECT_EQ(sensor->minDistance(), 0.1);
  EXPECT_EQ(sensor->maxDistance(), 10.0);
}

TEST(RangeSensor, SamplesBothEndsOfItsRange) {
  const RangeSensorPtr sensor = new RangeSensor;
  sensor->setYawRange(radian(360.0));
  sensor->setYawStep(radian(0.4));
  EXPECT_EQ(sensor->numYawSamples(), 901);
  EXPECT_TRUE(sensor->isNumYawSamplesCalculatedFromYawStep());
}

TEST(RangeSensor, KeepsTheNumberOfSamplesWhenThatWasSet) {
  const RangeSensorPtr sensor = new RangeSensor;
  sensor->setNumPitchSamples(5);
  sensor->setPitchRange(-0.2, 0.2);
  EXPECT_EQ(sensor->numPitchSamples(), 5);
  EXPECT_DOUBLE_EQ(sensor->pitchStep(), 0.1);
  sensor->setPitchRange(0.2, -0.2);  // the wrong way round: ignored
  EXPECT_EQ(sensor->minPitchAngle(), -0.2);
  sensor->setNumPitchSamples(0);
  EXPECT_EQ(sensor->numPitchSamples(), 5);
}

TEST(RangeSensor, GivesTheAnglesOfABeam) {
  const RangeSensorPtr sensor = new RangeSensor;
  sensor->setYawRange(-0.1, 0.1);
  sensor->setNumYawSamples(3);
  sensor->setPitchRange(0.0, 0.5);
  sensor->setNumPitchSamples(2);
  EXPECT_TRUE(sensor->getSphericalAngle(0).isApprox(cnoid::Vector2(-0.1, 0.0)));
  EXPECT_TRUE(sensor->getSphericalAngle(5).isApprox(cnoid::Vector2(0.1, 0.5)));
}

TEST(RangeSensor, SharesItsDataWithACopyOfItsState) {
  const RangeSensorPtr simulated = new RangeSensor;
  const RangeSensorPtr seen = new RangeSensor;
  auto data = std::make_shared<RangeSensor::RangeData>(3, 1.5);
  simulated->setRangeData(data);
  seen->copyStateFrom(*simulated);
  EXPECT_EQ(&seen->constRangeData(), &simulated->constRangeData());
  seen->rangeData()[0] = 9.0;
  EXPECT_EQ(simulated->constRangeData()[0], 1.5);
  simulated->clearState();
  EXPECT_TRUE(simulated->constRangeData().empty());
}

TEST(RangeSensor, LeavesItsDataBehindWhenClonedUnlessToldOtherwise) {
  const RangeSensorPtr sensor = new RangeSensor;
  sensor->newRangeData().resize(3);
  EXPECT_TRUE(RangeSensorPtr(static_cast<RangeSensor*>(sensor->clone()))->constRangeData().empty());
  sensor->setRangeDataStateClonable(true);
  EXPECT_EQ(RangeSensorPtr(static_cast<RangeSensor*>(sensor->clone()))->constRangeData().size(), 3u);
}

}  // namespace
