#include "urdf_texts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rehearse {
namespace {

using testing::HasSubstr;

/// Two links, a hinge between them, and the content of the <gazebo> block of the second.
Model with_sensors(const std::string& sensors, const std::string& reference = "arm") {
  return load(robot(link("base") + link("arm") + joint("hinge", "continuous", "base", "arm") + "<gazebo reference='" +
                    reference + "'>" + sensors + "</gazebo>"));
}

std::string camera(const std::string& content, const std::string& type = "camera", const std::string& before = "") {
  return "<sensor name='eye' type='" + type + "'>" + before + "<camera>" + content + "</camera></sensor>";
}

const Camera& only_camera(const Model& model) {
  static const Camera none;
  if (model.devices.size() == 1) {
    if (const auto* found = std::get_if<Camera>(&model.devices[0].kind)) return *found;
  }
  ADD_FAILURE() << "not one camera";
  return none;
}

TEST(UrdfSensors, TypesBecomeDevices) {
  const std::vector<std::pair<std::string, std::string>> types = {{"imu", "Imu"},
                                                                  {"accelerometer", "AccelerationSensor"},
                                                                  {"gyroscope", "RateGyroSensor"},
                                                                  {"gyro", "RateGyroSensor"},
                                                                  {"force_torque", "ForceSensor"}};
  for (const auto& [type, device] : types) {
    const Model model = with_sensors("<sensor name='s' type='" + type + "'/>");
    ASSERT_EQ(model.devices.size(), 1u) << type;
    EXPECT_EQ(type_name(model.devices[0]), device);
    EXPECT_EQ(model.devices[0].link, 1);
    EXPECT_EQ(model.devices[0].id, -1);
  }
}

TEST(UrdfSensors, CameraTypesWithDepthMeasureIt) {
  EXPECT_FALSE(only_camera(with_sensors(camera("", "camera"))).depth);
  for (const char* type : {"depth", "depth_camera", "rgbd", "rgbd_camera"}) {
    EXPECT_TRUE(only_camera(with_sensors(camera("", type))).depth) << type;
  }
}

TEST(UrdfSensors, OtherTypesAreNotedAndPassedOver) {
  const Model model = with_sensors("<sensor name='a' type='sonar'/><sensor name='b' type='sonar'/>");
  EXPECT_TRUE(model.devices.empty());
  EXPECT_THAT(to_string(model.report),
              HasSubstr("note: a sensor of type 'sonar' is ignored, here and in 1 other places"));
}

TEST(UrdfSensors, HaveAPoseInTheirLinkAndAnId) {
  const Model model = with_sensors("<sensor name='s' type='imu'><pose>1 2 3 0 0 0.5</pose><id>4</id></sensor>");
  ASSERT_EQ(model.devices.size(), 1u);
  EXPECT_EQ(model.devices[0].id, 4);
  EXPECT_EQ(model.devices[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(
      model.devices[0].pose.linear().isApprox(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
}

TEST(UrdfSensors, OfForceMayNameTheJointWhoseChildLinkTheySitOn) {
  const Model model = with_sensors("<sensor name='s' type='force_torque'/>", "hinge");
  ASSERT_EQ(model.devices.size(), 1u);
  EXPECT_EQ(model.devices[0].link, 1);
}

TEST(UrdfSensors, OfForcePreferAJointAndOthersALinkOfOneName) {
  const std::string text =
      robot(link("base") + link("arm") + link("hand") + joint("hand", "continuous", "base", "arm") +
            joint("wrist", "continuous", "arm", "hand") +
            "<gazebo reference='hand'><sensor name='f' type='force_torque'/>"
            "<sensor name='i' type='imu'/></gazebo>");
  const Model model = load(text);
  EXPECT_EQ(model.devices[static_cast<std::size_t>(model.find_device("f"))].link, model.find_link("arm"));
  EXPECT_EQ(model.devices[static_cast<std::size_t>(model.find_device("i"))].link, model.find_link("hand"));
}

TEST(UrdfSensors, StandByLinkThenByDocument) {
  const Model model =
      load(robot(link("base") + link("arm") + joint("hinge", "continuous", "base", "arm") +
                 "<gazebo reference='arm'><sensor name='c' type='imu'/></gazebo>"
                 "<gazebo reference='base'><sensor name='b' type='imu'/><sensor name='a' type='imu'/></gazebo>"));
  ASSERT_EQ(model.devices.size(), 3u);
  EXPECT_EQ(model.devices[0].name, "b");
  EXPECT_EQ(model.devices[1].name, "a");
  EXPECT_EQ(model.devices[2].name, "c");
}

TEST(UrdfCamera, LooksAlongTheLinksXWithZUpToTheLastBit) {
  const Model model = with_sensors(camera("", "camera", "<pose>1 2 3 0 0 0</pose>"));
  const Eigen::Matrix3d axes = model.devices.at(0).pose.linear();
  EXPECT_EQ(axes * -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());  // forward
  EXPECT_EQ(axes * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());   // up
  EXPECT_EQ(axes * Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY());  // right
  EXPECT_EQ(model.devices[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(UrdfCamera, AddsItsOwnPoseToTheSensors) {
  const Model model =
      with_sensors(camera("<pose>0.5 0 0 0 0 0</pose>", "camera", "<pose>1 0 0 0 0 1.5707963267948966</pose>"));
  EXPECT_TRUE(model.devices.at(0).pose.translation().isApprox(Eigen::Vector3d(1, 0.5, 0)));  // ahead is the link's +y
  EXPECT_TRUE((model.devices[0].pose.linear() * -Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(UrdfCamera, ReadsItsFigures) {
  const Camera eye =
      only_camera(with_sensors(camera("<image><width>64</width><height>48</height></image>"
                                      "<clip><near>0.2</near><far>30</far></clip>",
                                      "camera", "<update_rate>12.5</update_rate>")));
  EXPECT_EQ(eye.width, 64);
  EXPECT_EQ(eye.height, 48);
  EXPECT_EQ(eye.near_clip, 0.2);
  EXPECT_EQ(eye.far_clip, 30);
  EXPECT_EQ(eye.frame_rate, 12.5);
}

TEST(UrdfCamera, TurnsAnAngleAcrossIntoOneUpright) {
  const Camera eye = only_camera(with_sensors(camera(
      "<horizontal_fov>1.5707963267948966</horizontal_fov><image><width>200</width><height>100</height></image>")));
  EXPECT_NEAR(std::tan(eye.field_of_view / 2), 0.5,
              1e-15);  // 90 degrees across: one wide at distance one, half as high
}

TEST(UrdfCamera, KeepsAnAngleAcrossInPortrait) {
  const Camera eye = only_camera(with_sensors(
      camera("<horizontal_fov>0.5</horizontal_fov><image><width>100</width><height>200</height></image>")));
  EXPECT_EQ(eye.field_of_view, 0.5);
}

TEST(UrdfCamera, TakesAnUprightAngleAsItIs) {
  EXPECT_EQ(only_camera(with_sensors(camera("<vertical_fov>0.7</vertical_fov>"))).field_of_view, 0.7);
}

TEST(UrdfCamera, TurnsAnUprightAngleInPortrait) {
  const Camera eye = only_camera(with_sensors(
      camera("<vertical_fov>1.5707963267948966</vertical_fov><image><width>100</width><height>200</height></image>")));
  EXPECT_NEAR(std::tan(eye.field_of_view / 2), 0.5, 1e-15);
}

std::string laser(const std::string& horizontal, const std::string& vertical = "", const std::string& more = "",
                  const std::string& type = "ray") {
  const std::string element = type.ends_with("ray") ? "ray" : "lidar";
  return "<sensor name='laser' type='" + type + "'>" + more + "<" + element + "><scan><horizontal>" + horizontal +
         "</horizontal>" + (vertical.empty() ? "" : "<vertical>" + vertical + "</vertical>") +
         "</scan><range><min>0.2</min><max>30</max><resolution>0.01</resolution></range></" + element + "></sensor>";
}

std::string sweep(int samples, double lower, double upper) {
  return "<samples>" + std::to_string(samples) + "</samples><min_angle>" + std::to_string(lower) +
         "</min_angle><max_angle>" + std::to_string(upper) + "</max_angle>";
}

const RangeSensor& only_laser(const Model& model) {
  static const RangeSensor none;
  if (model.devices.size() == 1) {
    if (const auto* found = std::get_if<RangeSensor>(&model.devices[0].kind)) return *found;
  }
  ADD_FAILURE() << "not one range sensor";
  return none;
}

TEST(UrdfRangeSensor, ReadsItsFigures) {
  const Model model =
      with_sensors(laser(sweep(181, -0.5, 1.5), sweep(3, -0.25, 0.25), "<update_rate>12.5</update_rate>"));
  const RangeSensor& sensor = only_laser(model);
  EXPECT_EQ(sensor.yaw.samples, 181);
  EXPECT_EQ(sensor.yaw.lower, -0.5);
  EXPECT_EQ(sensor.yaw.upper, 1.5);
  EXPECT_EQ(sensor.pitch.samples, 3);
  EXPECT_EQ(sensor.pitch.lower, -0.25);
  EXPECT_EQ(sensor.pitch.upper, 0.25);
  EXPECT_EQ(sensor.min_distance, 0.2);
  EXPECT_EQ(sensor.max_distance, 30.0);
  EXPECT_EQ(sensor.scan_rate, 12.5);
  EXPECT_EQ(type_name(model.devices[0]), "RangeSensor");
  EXPECT_THAT(to_string(model.report), HasSubstr("note: <range><resolution> is ignored"));
}

TEST(UrdfRangeSensor, IsEachOfFourTypes) {
  for (const char* type : {"ray", "gpu_ray", "lidar", "gpu_lidar"})
    EXPECT_EQ(only_laser(with_sensors(laser(sweep(7, -1, 1), "", "", type))).yaw.samples, 7) << type;
}

TEST(UrdfRangeSensor, LooksAlongTheLinksXWithZUpToTheLastBit) {
  const Model model = with_sensors(laser(sweep(3, -1, 1), "", "<pose>1 2 3 0 0 0</pose>"));
  const Eigen::Matrix3d axes = model.devices.at(0).pose.linear();
  EXPECT_EQ(axes * -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());  // forward
  EXPECT_EQ(axes * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());   // up
  EXPECT_EQ(model.devices[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(UrdfRangeSensor, WithoutVerticalHasOneLevelRow) {
  const RangeSensor sensor = only_laser(with_sensors(laser(sweep(3, -1, 1))));
  EXPECT_EQ(sensor.pitch.samples, 1);
  EXPECT_EQ(sensor.pitch.lower, 0.0);
  EXPECT_EQ(sensor.pitch.upper, 0.0);
}

TEST(UrdfRangeSensor, ASingleBeamLooksAlongTheMiddle) {
  const RangeSensor sensor = only_laser(with_sensors(laser(sweep(1, -0.5, 1.0))));
  EXPECT_EQ(sensor.yaw.lower, 0.25);
  EXPECT_EQ(sensor.yaw.upper, 0.25);
}

TEST(UrdfRangeSensor, ResolutionMultipliesItsSamples) {
  EXPECT_EQ(only_laser(with_sensors(laser(sweep(100, -1, 1) + "<resolution>0.5</resolution>"))).yaw.samples, 50);
  EXPECT_EQ(only_laser(with_sensors(laser(sweep(100, -1, 1) + "<resolution>2</resolution>"))).yaw.samples, 200);
}

TEST(UrdfRangeSensor, HasNoNoiseAndSaysSo) {
  const Model model = with_sensors(
      "<sensor name='laser' type='ray'><ray><scan><horizontal>" + sweep(3, -1, 1) +
      "</horizontal></scan><range><min>0</min><max>1</max></range><noise><type>gaussian</type></noise></ray></sensor>");
  EXPECT_THAT(to_string(model.report), HasSubstr("note: <ray><noise> is ignored"));
}

const Light& only_light(const Model& model) {
  static const Light none;
  if (model.devices.size() == 1) {
    if (const auto* found = std::get_if<Light>(&model.devices[0].kind)) return *found;
  }
  ADD_FAILURE() << "not one light";
  return none;
}

TEST(UrdfLight, OfAPointReadsItsFigures) {
  const Model model = with_sensors(
      "<light name='l' type='point'><pose>1 2 3 0 0 0</pose><id>2</id><diffuse>1 0.5 0.25 1</diffuse>"
      "<intensity>2</intensity><attenuation><range>7</range><constant>0.5</constant><linear>0.125</linear>"
      "<quadratic>0.25</quadratic></attenuation></light>");
  const Light& light = only_light(model);
  EXPECT_EQ(type_name(model.devices[0]), "PointLight");
  EXPECT_EQ(model.devices[0].id, 2);
  EXPECT_EQ(model.devices[0].link, 1);
  EXPECT_EQ(model.devices[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(light.on);
  EXPECT_EQ(light.color, Eigen::Vector3f(1.0f, 0.5f, 0.25f));
  EXPECT_EQ(light.intensity, 2.0f);
  EXPECT_EQ(light.range, 7.0);
  EXPECT_EQ(light.constant, 0.5f);
  EXPECT_EQ(light.linear, 0.125f);
  EXPECT_EQ(light.quadratic, 0.25f);
  EXPECT_FALSE(light.cone.has_value());
}

TEST(UrdfLight, OfASpotHalvesTheAnglesOfItsCone) {
  const Model model = with_sensors(
      "<light name='l' type='spot'><direction>1 0 -1</direction>"
      "<spot><inner_angle>0.5</inner_angle><outer_angle>1.5</outer_angle><falloff>2</falloff></spot></light>");
  const Light& light = only_light(model);
  EXPECT_EQ(type_name(model.devices[0]), "SpotLight");
  ASSERT_TRUE(light.cone.has_value());
  EXPECT_EQ(light.cone->direction, Eigen::Vector3d(1, 0, -1));
  EXPECT_EQ(light.cone->beam_width, 0.25f);
  EXPECT_EQ(light.cone->cut_off_angle, 0.75f);
  EXPECT_EQ(light.cone->cut_off_exponent, 2.0f);
}

TEST(UrdfLight, WithoutFiguresIsAsSdfHasIt) {
  const Light light = only_light(with_sensors("<light name='l' type='point'/>"));
  EXPECT_EQ(light.color, Eigen::Vector3f::Ones());
  EXPECT_EQ(light.intensity, 1.0f);
  EXPECT_EQ(light.range, 10.0);
  EXPECT_EQ(light.constant, 1.0f);
  EXPECT_EQ(light.linear, 1.0f);
  EXPECT_EQ(light.quadratic, 0.0f);
  const Model spot = with_sensors("<light name='l' type='spot'><spot><outer_angle>1</outer_angle></spot></light>");
  EXPECT_EQ(only_light(spot).cone->direction, -Eigen::Vector3d::UnitZ());
}

TEST(UrdfLight, OfAnotherTypeIsNotedAndPassedOver) {
  const Model model = with_sensors("<light name='sun' type='directional'/><light name='l'/>");
  EXPECT_TRUE(model.devices.empty());
  EXPECT_THAT(to_string(model.report), HasSubstr("note: a light of type 'directional' is ignored"));
  EXPECT_THAT(to_string(model.report), HasSubstr("note: a light without a type is ignored"));
}

TEST(UrdfLight, SaysWhatItDoesNotRead) {
  const Model model = with_sensors(
      "<light name='l' type='point'><specular>1 1 1 1</specular><cast_shadows>true</cast_shadows></light>");
  EXPECT_THAT(to_string(model.report), HasSubstr("note: <light><specular> is ignored"));
  EXPECT_THAT(to_string(model.report), HasSubstr("note: <light><cast_shadows> is ignored"));
}

TEST(UrdfLight, StandsAmongTheSensorsInTheOrderOfTheDocument) {
  const Model model =
      with_sensors("<sensor name='a' type='imu'/><light name='b' type='point'/><sensor name='c' type='imu'/>");
  ASSERT_EQ(model.devices.size(), 3u);
  EXPECT_EQ(model.devices[1].name, "b");
}

}  // namespace
}  // namespace rehearse
