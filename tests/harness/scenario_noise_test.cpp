// Noise in a scenario: the sensors to which a rule applies, and the priority of rules. The mistakes, one by one, are in
// scenario_broken_test.cpp.
#include "core/scenario/normal_quantile.h"
#include "scenario_files.h"

#include <cmath>
#include <numeric>

namespace rehearse {
namespace {

const std::string robot = R"(<robot name="Head">
  <link name="world"/>
  <joint name="NECK" type="continuous"><parent link="world"/><child link="HEAD"/></joint>
  <link name="HEAD"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <gazebo reference="HEAD">
    <sensor name="Gyro" type="gyroscope"/>
    <sensor name="Imu" type="imu"/>
    <sensor name="Eye" type="depth_camera"><camera/></sensor>
  </gazebo>
</robot>
)";

BodyNoise noise(const std::string& rules) {
  write_file("head.urdf", robot);
  const std::string text = "rehearse: 1\nduration: 1\nbodies:\n  - {name: Head, model: head.urdf}\nnoise:\n" + rules;
  return loaded(text).bodies.at(0).noise;
}

TEST(ScenarioNoise, IsNothingWhereNoRuleSpeaksOfIt) {
  const BodyNoise given = noise("  - {sensor: Head/Gyro, angular_velocity: {stddev: 0.5}}\n");
  EXPECT_EQ(given.devices.at(0).quantities.at(0).stddev, 0.5);
  EXPECT_TRUE(given.devices.at(1).changes_nothing());
  EXPECT_TRUE(given.joints.at(0).changes_nothing());
}

TEST(ScenarioNoise, GivesEachSensorOfAPatternWhatItMeasures) {
  const BodyNoise given = noise("  - {sensor: \"Head/*\", angular_velocity: {bias: [1, 2, 3]}, depth: {stddev: 4}}\n");
  EXPECT_EQ(given.devices.at(0).quantities.at(0).bias, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(given.devices.at(1).quantities.at(0).bias, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(given.devices.at(1).quantities.at(1).changes_nothing()) << "its acceleration";
  EXPECT_TRUE(given.devices.at(2).quantities.at(0).changes_nothing()) << "its colours";
  EXPECT_EQ(given.devices.at(2).quantities.at(1).stddev, 4.0);
}

TEST(ScenarioNoise, OfALaterRuleReplacesAllOfAnEarlierOne) {
  const BodyNoise given = noise(
      "  - {sensor: \"Head/*\", angular_velocity: {stddev: 1}, dropout: 0.5}\n"
      "  - {sensor: Head/Imu, acceleration: {stddev: 2}}\n");
  EXPECT_EQ(given.devices.at(0).dropout, 0.5);
  EXPECT_EQ(given.devices.at(1).dropout, 0.0);
  EXPECT_EQ(given.devices.at(1).quantities.at(0).stddev, 0.0);
  EXPECT_EQ(given.devices.at(1).quantities.at(1).stddev, 2.0);
}

TEST(ScenarioNoise, HasOneBiasForAllAxesIfItIsANumber) {
  const BodyNoise given = noise("  - {sensor: Head/Gyro, angular_velocity: {bias: -0.5}}\n");
  EXPECT_EQ(given.devices.at(0).quantities.at(0).bias, Eigen::Vector3d::Constant(-0.5));
}

TEST(ScenarioNoise, OfJointsIsByQuantity) {
  const BodyNoise given = noise("  - {joint: Head/NECK, velocity: {stddev: 0.5}, effort: {bias: 2}}\n");
  EXPECT_EQ(given.joints.at(0).quantities.at(0).stddev, 0.0);
  EXPECT_EQ(given.joints.at(0).quantities.at(1).stddev, 0.5);
  EXPECT_EQ(given.joints.at(0).quantities.at(2).bias.x(), 2.0);
}

TEST(NormalQuantile, IsTheInverseOfTheDistribution) {
  const auto distribution = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
  for (const double p : {1e-300, 1e-16, 1e-12, 1e-5, 0.01, 0.0749, 0.0751, 0.3, 0.5, 0.6, 0.9, 0.999})
    EXPECT_NEAR(distribution(normal_quantile(p)) / p, 1.0, 1e-12) << p;
  EXPECT_EQ(normal_quantile(0.5), 0.0);
  EXPECT_NEAR(normal_quantile(0.975), 1.9599639845400545, 1e-14);
  EXPECT_EQ(normal_quantile(0.25), -normal_quantile(0.75));
}

}  // namespace
}  // namespace rehearse
