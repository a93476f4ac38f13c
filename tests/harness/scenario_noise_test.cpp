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

BodyErrors noise(const std::string& rules) {
  write_file("head.urdf", robot);
  const std::string text = "rehearse: 1\nduration: 1\nbodies:\n  - {name: Head, model: head.urdf}\nnoise:\n" + rules;
  return loaded(text).bodies.at(0).errors;
}

TEST(ScenarioNoise, IsNothingWhereNoRuleSpeaksOfIt) {
  const BodyErrors given = noise("  - {sensor: Head/Gyro, angular_velocity: {stddev: 0.5}}\n");
  EXPECT_EQ(given.devices.at(0).quantities.at(0).of("stddev").x(), 0.5);
  EXPECT_TRUE(given.devices.at(1).changes_nothing());
  EXPECT_TRUE(given.joints.at(0).changes_nothing());
}

TEST(ScenarioNoise, GivesEachSensorOfAPatternWhatItMeasures) {
  const BodyErrors given = noise("  - {sensor: \"Head/*\", angular_velocity: {bias: [1, 2, 3]}, depth: {stddev: 4}}\n");
  EXPECT_EQ(given.devices.at(0).quantities.at(0).of("bias"), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(given.devices.at(1).quantities.at(0).of("bias"), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(given.devices.at(1).quantities.at(1).changes_nothing()) << "its acceleration";
  EXPECT_TRUE(given.devices.at(2).quantities.at(0).changes_nothing()) << "its colours";
  EXPECT_EQ(given.devices.at(2).quantities.at(1).of("stddev").x(), 4.0);
}

TEST(ScenarioNoise, OfALaterRuleReplacesAllOfAnEarlierOne) {
  const BodyErrors given = noise(
      "  - {sensor: \"Head/*\", angular_velocity: {stddev: 1}, dropout: 0.5}\n"
      "  - {sensor: Head/Imu, acceleration: {stddev: 2}}\n");
  EXPECT_EQ(given.devices.at(0).dropout, 0.5);
  EXPECT_EQ(given.devices.at(1).dropout, 0.0);
  EXPECT_EQ(given.devices.at(1).quantities.at(0).of("stddev").x(), 0.0);
  EXPECT_EQ(given.devices.at(1).quantities.at(1).of("stddev").x(), 2.0);
}

TEST(ScenarioNoise, HasOneBiasForAllAxesIfItIsANumber) {
  const BodyErrors given = noise("  - {sensor: Head/Gyro, angular_velocity: {bias: -0.5}}\n");
  EXPECT_EQ(given.devices.at(0).quantities.at(0).of("bias"), Eigen::Vector3d::Constant(-0.5));
}

TEST(ScenarioNoise, OfJointsIsByQuantity) {
  const BodyErrors given = noise("  - {joint: Head/NECK, velocity: {stddev: 0.5}, effort: {bias: 2}}\n");
  EXPECT_EQ(given.joints.at(0).quantities.at(0).of("stddev").x(), 0.0);
  EXPECT_EQ(given.joints.at(0).quantities.at(1).of("stddev").x(), 0.5);
  EXPECT_EQ(given.joints.at(0).quantities.at(2).of("bias").x(), 2.0);
}

// The five numbers have the names and units of Kalibr's imu.yaml: rad/s/sqrt(Hz), rad/s^2/sqrt(Hz), m/s^2/sqrt(Hz),
// m/s^3/sqrt(Hz) and Hz. A random walk in x/s/sqrt(Hz) is one in x/sqrt(s).
TEST(ScenarioNoise, HasTheFiveNumbersOfAnImu) {
  const BodyErrors short_form = noise(
      "  - {sensor: Head/Imu, imu: {gyroscope_noise_density: 0.01 deg/s/sqrt(Hz), gyroscope_random_walk: 0.002,\n"
      "     accelerometer_noise_density: 100 ug/sqrt(Hz), accelerometer_random_walk: 0.004, update_rate: 400}}\n");
  const BodyErrors long_form = noise(
      "  - {sensor: Head/Imu, rate: 400 Hz, angular_velocity: {density: 0.01 deg/s/sqrt(Hz), bias_walk: 0.002},\n"
      "     acceleration: {density: 100 ug/sqrt(Hz), bias_walk: 0.004}}\n");
  const ReadingErrors &found = short_form.devices.at(1), &wanted = long_form.devices.at(1);
  EXPECT_EQ(found.rate, 400.0);
  EXPECT_EQ(found.rate, wanted.rate);
  ASSERT_EQ(found.quantities.size(), wanted.quantities.size());
  for (std::size_t i = 0; i < wanted.quantities.size(); ++i) {
    ASSERT_EQ(found.quantities[i].given.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(found.quantities[i].given[k].form, wanted.quantities[i].given[k].form)
          << "in the order of their effect";
      EXPECT_EQ(found.quantities[i].given[k].numbers, wanted.quantities[i].given[k].numbers);
    }
  }
}

TEST(ScenarioNoise, HasTheUnitsOfDataSheets) {
  const BodyErrors given = noise(
      "  - {sensor: Head/Imu, angular_velocity: {density: 0.01 deg/s/sqrt(Hz), bias_walk: 1 deg/s/sqrt(s), bias: 2 "
      "deg/s},\n"
      "     acceleration: {density: 100 ug/sqrt(Hz), stddev: 1 mg, saturation: 16 g}, latency: 5 ms, rate: 0.2 kHz}\n");
  constexpr double degree = 0.017453292519943295, gravity = 9.80665;
  const ReadingErrors& imu = given.devices.at(1);
  EXPECT_DOUBLE_EQ(imu.quantities.at(0).of("density").y(), 0.01 * degree);
  EXPECT_DOUBLE_EQ(imu.quantities.at(0).of("bias_walk").y(), degree);
  EXPECT_DOUBLE_EQ(imu.quantities.at(0).of("bias").z(), 2.0 * degree);
  EXPECT_DOUBLE_EQ(imu.quantities.at(1).of("density").x(), 1e-4 * gravity);
  EXPECT_DOUBLE_EQ(imu.quantities.at(1).of("stddev").x(), 1e-3 * gravity);
  EXPECT_DOUBLE_EQ(imu.quantities.at(1).of("saturation").x(), 16.0 * gravity);
  EXPECT_EQ(imu.latency, 0.005);
  EXPECT_EQ(imu.rate, 200.0);
  EXPECT_TRUE(imu.records_truth());
}

TEST(ScenarioNoise, HasADensityForEachSpellingOfAUnit) {
  const BodyErrors given = noise(
      "  - {sensor: Head/Imu, acceleration: {density: 2 m/s^2/sqrt(Hz)}}\n"
      "  - {joint: Head/NECK, displacement: {stddev: 3 mrad, density: 2 mrad/sqrt(Hz)}}\n");
  EXPECT_DOUBLE_EQ(given.devices.at(1).quantities.at(1).of("density").x(), 2.0);
  EXPECT_DOUBLE_EQ(given.joints.at(0).quantities.at(0).of("stddev").x(), 0.003);
  EXPECT_DOUBLE_EQ(given.joints.at(0).quantities.at(0).of("density").x(), 0.002);
}

TEST(ScenarioNoise, OfAFaultIsAddedToThatOfARule) {
  write_file("head.urdf", robot);
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - name: Head\n    model: head.urdf\n    faults:\n"
      "      - {sensor: Gyro, fault: stuck, from: 100 ms, until: 0.2}\n"
      "      - {sensor: Imu, fault: offset, quantity: acceleration, by: 1 g, from: 0.5}\n"
      "      - {encoder: NECK, fault: delayed, by: 20 ms}\n"
      "      - {actuator: NECK, fault: weak, effort: 0.4}\n"
      "noise:\n  - {sensor: \"Head/*\", latency: 3 ms}\n");
  const BodyErrors& errors = scenario.bodies[0].errors;
  EXPECT_EQ(errors.devices.at(0).latency, 0.003);
  EXPECT_EQ(errors.devices.at(0).stuck.at(0).from, 0.1);
  EXPECT_EQ(errors.devices.at(0).stuck.at(0).until, 0.2);
  EXPECT_EQ(errors.devices.at(1).quantities.at(1).of("offset").x(), 9.80665);
  EXPECT_EQ(errors.devices.at(1).quantities.at(1).given.at(0).when.from, 0.5);
  EXPECT_EQ(errors.joints.at(0).delayed.at(0).by, 0.02);
  EXPECT_EQ(scenario.bodies[0].actuators.at(0)->faults.at(0).share, 0.4);
}

TEST(ScenarioNoise, ExposesTheCamerasOfAPattern) {
  write_file("head.urdf", robot);
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - {name: Head, model: head.urdf}\n"
      "noise: [{sensor: \"Head/*\", exposure: 10 ms, subframes: 4, readout: 5 ms}]\n"
      "vary: {light: {path: \"noise[0].exposure\", uniform: [0, 20]}}\n");
  const Exposure& eye = scenario.bodies[0].errors.devices.at(2).exposure;
  EXPECT_EQ(eye.time, 0.01);
  EXPECT_EQ(eye.frames, 4);
  EXPECT_EQ(eye.readout, 0.005);
  const auto text = scenario.varied_text({"3"});
  ASSERT_TRUE(text.ok());
  EXPECT_NEAR(loaded(*text).bodies[0].errors.devices.at(2).exposure.time, 0.003, 1e-15);
}

TEST(ScenarioNoise, IsReachedByVary) {
  write_file("head.urdf", robot);
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - name: Head\n    model: head.urdf\n"
      "    faults: [{actuator: NECK, fault: weak, effort: 0.4, from: 0.1}]\n"
      "noise:\n  - {sensor: Head/Imu, latency: 3 ms, angular_velocity: {density: 0.01 deg/s/sqrt(Hz)}}\n"
      "vary:\n"
      "  density: {path: \"noise[0].angular_velocity.density\", uniform: [0, 1]}\n"
      "  latency: {path: \"noise[0].latency\", uniform: [0, 20]}\n"
      "  left: {path: \"bodies.Head.faults[0].effort\", uniform: [0, 1]}\n"
      "  kind: {path: \"bodies.Head.faults[0].fault\", choice: [weak, dead]}\n");
  ASSERT_EQ(scenario.variations.size(), 4u);
  const auto text = scenario.varied_text({"0.5", "7", "0.25", "dead"});
  ASSERT_TRUE(text.ok());
  EXPECT_NE(text->find("latency: 7 ms"), std::string::npos);
  EXPECT_NE(text->find("density: 0.5 deg/s/sqrt(Hz)"), std::string::npos);
  EXPECT_NE(text->find("fault: dead, effort: 0.25"), std::string::npos);
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
