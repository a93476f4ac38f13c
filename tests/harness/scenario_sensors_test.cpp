// Sensors that a scenario adds to a model. The mistakes, one by one, are in scenario_broken_test.cpp.
#include <cmath>
#include <numbers>

#include "scenario_files.h"

namespace rehearse {
namespace {

const std::string head_robot = R"(<robot name="Head">
  <link name="BASE"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="NECK" type="continuous"><parent link="BASE"/><child link="HEAD"/></joint>
  <link name="HEAD"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision name="nose"><geometry><sphere radius="0.1"/></geometry></collision>
    <collision name="chin"><geometry><sphere radius="0.1"/></geometry></collision></link>
  <gazebo reference="HEAD">
    <sensor name="Own" type="imu"/>
    <sensor name="Eye" type="camera"><pose>0.1 0 0 0 0.2 0</pose><update_rate>20</update_rate>
      <camera><horizontal_fov>1.2</horizontal_fov><image><width>64</width><height>48</height></image>
      <clip><near>0.05</near><far>30</far></clip></camera></sensor>
    <sensor name="Laser" type="ray"><pose>0 0 0.1 0 0 0.3</pose><update_rate>15</update_rate>
      <ray><scan><horizontal><samples>9</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
      <range><min>0.2</min><max>8</max></range></ray></sensor>
  </gazebo>
</robot>
)";

Scenario head_with(const std::string& sensors) {
  write_file("head.urdf", head_robot);
  return loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - {name: Plain, model: head.urdf}\n  - name: Head\n"
      "    model: head.urdf\n    sensors:\n" +
      sensors);
}

const Device& device(const Scenario& scenario, const std::string& name) {
  const Model& model = *scenario.bodies[1].model;
  const int index = model.find_device(name);
  EXPECT_GE(index, 0) << name;
  return model.devices[static_cast<std::size_t>(std::max(index, 0))];
}

TEST(ScenarioSensors, AreBesideThoseOfTheModelInOrderOfTheirLinks) {
  const Scenario scenario = head_with(
      "      - {name: Top, type: gyro, link: HEAD}\n"
      "      - {name: Low, type: imu, link: BASE}\n");
  std::vector<std::string> names;
  for (const Device& each : scenario.bodies[1].model->devices) names.push_back(each.name);
  EXPECT_EQ(names, (std::vector<std::string>{"Low", "Own", "Eye", "Laser", "Top"}));
  EXPECT_EQ(scenario.bodies[0].model->devices.size(), 3u) << "another body keeps the model of the file";
  EXPECT_EQ(scenario.bodies[1].model->source_text, head_robot) << "and so its digest";
}

TEST(ScenarioSensors, HaveAPoseInTheirLink) {
  const Scenario scenario =
      head_with("      - {name: A, type: imu, link: HEAD, pose: {position: [1, 2, 3], rotation: [0, 0, 90 deg]}}\n");
  const Device& imu = device(scenario, "A");
  EXPECT_EQ(imu.pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE((imu.pose.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(ScenarioSensors, AreOfEachType) {
  const Scenario scenario = head_with(
      "      - {name: A, type: accelerometer, link: HEAD}\n"
      "      - {name: M, type: magnetometer, link: HEAD}\n"
      "      - {name: F, type: force, link: HEAD}\n"
      "      - {name: T, type: contact, link: HEAD, collision: chin}\n"
      "      - {name: D, type: depth, link: HEAD}\n");
  EXPECT_TRUE(std::holds_alternative<Accelerometer>(device(scenario, "A").kind));
  EXPECT_TRUE(std::holds_alternative<Magnetometer>(device(scenario, "M").kind));
  EXPECT_TRUE(std::holds_alternative<ForceSensor>(device(scenario, "F").kind));
  EXPECT_EQ(std::get<ContactSensor>(device(scenario, "T").kind).collision, 1);
  EXPECT_TRUE(std::get<Camera>(device(scenario, "D").kind).depth);
}

TEST(ScenarioSensors, AreThoseThatTheModelsFileWouldState) {
  const Scenario scenario = head_with(
      "      - {name: Eye2, type: camera, link: HEAD, pose: {position: [0.1, 0, 0], rotation: [0, 0.2, 0]}, rate: 20 "
      "Hz,\n"
      "         width: 64, height: 48, horizontal_fov: 1.2, near: 0.05, far: 30}\n"
      "      - {name: Laser2, type: range, link: HEAD, pose: {position: [0, 0, 0.1], rotation: [0, 0, 0.3]}, rate: "
      "15,\n"
      "         yaw: {from: -1, to: 1, samples: 9}, min: 0.2, max: 8}\n");
  EXPECT_TRUE(device(scenario, "Eye2").pose.isApprox(device(scenario, "Eye").pose, 1e-12));
  EXPECT_TRUE(device(scenario, "Laser2").pose.isApprox(device(scenario, "Laser").pose, 1e-12));
  const auto& eye = std::get<Camera>(device(scenario, "Eye").kind);
  const auto& added = std::get<Camera>(device(scenario, "Eye2").kind);
  EXPECT_EQ(added.field_of_view, eye.field_of_view);
  EXPECT_EQ(added.frame_rate, eye.frame_rate);
  EXPECT_EQ(added.near_clip, eye.near_clip);
  EXPECT_EQ(added.far_clip, eye.far_clip);
  const auto& laser = std::get<RangeSensor>(device(scenario, "Laser").kind);
  const auto& scanner = std::get<RangeSensor>(device(scenario, "Laser2").kind);
  EXPECT_EQ(scanner.yaw.lower, laser.yaw.lower);
  EXPECT_EQ(scanner.yaw.samples, laser.yaw.samples);
  EXPECT_EQ(scanner.pitch.samples, laser.pitch.samples);
  EXPECT_EQ(scanner.min_distance, laser.min_distance);
  EXPECT_EQ(scanner.max_distance, laser.max_distance);
  EXPECT_EQ(scanner.scan_rate, laser.scan_rate);
}

TEST(ScenarioSensors, AreNamedByNoiseAndCameras) {
  write_file("head.urdf", head_robot);
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - name: Head\n    model: head.urdf\n    sensors:\n"
      "      - {name: Low, type: gyro, link: BASE}\n      - {name: Cam, type: camera, link: BASE, rate: 10}\n"
      "noise: [{sensor: Head/Low, angular_velocity: {stddev: 0.5}}]\ncameras: [Head/Cam]\n"
      "vary: {rate: {path: \"bodies.Head.sensors[1].rate\", uniform: [1, 30]}}\n");
  EXPECT_EQ(scenario.bodies[0].errors.devices.at(0).quantities.at(0).of("stddev").x(), 0.5);
  EXPECT_TRUE(scenario.runs_camera("Head", "Cam"));
  EXPECT_FALSE(scenario.runs_camera("Head", "Eye"));
}

}  // namespace
}  // namespace rehearse
