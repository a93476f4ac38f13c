// One mistake per file: fixtures/broken/map_*.yaml, each with the place and the text of its message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "logs/map/log_map.h"
#include "mapped_robot.h"
#include "support/printed_by_name.h"

namespace rehearse {
namespace {

const std::filesystem::path broken_files = std::filesystem::path(FIXTURES_DIR) / "broken";

struct Broken {
  const char* name;  // fixtures/broken/map_NAME.yaml
  int line;          // of the first message
  int column;
  const char* message;  // an extended regular expression found in it, hint included
};

// clang-format off
const Broken all_broken[] = {
    {"a_list", 1, 1, "the map is a list.*rehearse_map: 1"},
    {"a_scenario", 1, 1, "a scenario, not a map.*rehearse_map: 1"},
    {"empty", 1, 1, "the map is empty.*rehearse_map: 1"},
    {"not_yaml", 3, 9, "can't be read as YAML: this .*isn't closed"},
    {"no_version", 1, 1, "has no 'rehearse_map'.*rehearse_map: 1"},
    {"another_version", 1, 15, "rehearse_map is 2.*expected 1"},
    {"no_time_step", 1, 1, "has no 'time_step'.*tick"},
    {"time_step_zero", 2, 12, "time_step is 0.*from 1e-05 to 0.1"},
    {"time_step_of_a_rate", 2, 12, "time_step is '500 Hz'.*number"},
    {"tick_unknown", 4, 7, "no topic '/joint_state'.*did you mean '/joint_states'"},
    {"tick_a_rate", 4, 30, "unknown key 'rate' in the tick.*known keys: topic, grid, latency"},
    {"tick_grid_of_a_rate", 4, 36, "grid is 500.*true or false"},
    {"tick_latency_of_inputs", 4, 39, "'latency' is given for '/joint_states', which isn't the topic of the commands"},
    {"tick_latency_of_a_word", 5, 41, "latency is 'small'.*, or measured"},
    {"clock_twice", 5, 15, "'/imu/data' has a different clock here.*the clock of line 4"},
    {"clock_offset_without_stamps", 3, 46, "'clock_offset' without stamps.*clock: header.stamp"},
    {"unknown_key", 3, 1, "unknown key 'joint' in the map.*did you mean 'joints'"},
    {"duplicate_key", 4, 1, "'joints' is given twice.*line 3"},
    {"nothing_mapped", 1, 1, "names no input.*joints: /joint_states"},
    {"body_with_slash", 4, 7, "body is 'a/b'.*short name"},
    {"clock_of_the_wall", 4, 8, "clock is 'wall'.*log_time .* or header.stamp"},
    {"clock_without_header", 5, 19, "'/efforts' is of type std_msgs/msg/Float64MultiArray, which has no header.stamp.*clock: log_time"},
    {"start_of_a_word", 4, 8, "start is 'now'.*all .*, a topic of this map"},
    {"start_of_another_topic", 4, 8, "start is '/joy'.*a topic of this map"},
    {"start_after_every_log", 4, 8, "start is 1e9.*from 0 to"},
    {"missing_on_a_grid", 4, 10, "'missing: skip' without ticks at messages.*tick: TOPIC"},
    {"max_age_zero", 4, 10, "max_age is 0.*above 0"},
    {"controller_text", 4, 13, "the controller is 'Walker'.*map of KEY: VALUE"},
    {"controller_library", 4, 14, "unknown key 'library' in the controller"},
    {"controller_delay", 4, 21, "delay is 1.*true or false"},
    {"topic_unknown", 3, 9, "no topic '/joint_state'.*did you mean '/joint_states'"},
    {"topic_unlike_any", 3, 9, "no topic '/robot/axes'.*with a JointState or another type with joints' names there are: /joint_commands \\(sensor_msgs/msg/JointState\\), /joint_states"},
    {"topic_of_another_type", 3, 9, "'/scan' is of type sensor_msgs/msg/LaserScan, which isn't a JointState.*there are: /joint_commands"},
    {"topic_in_json", 3, 9, "'/json' can't be read.*encoded as 'json'"},
    {"topic_missing", 3, 9, "a source of joints has no 'topic'.*one of the log's topics"},
    {"topic_a_list", 3, 17, "joints is a list.*one of the log's topics"},
    {"joints_twice", 3, 25, "'/joint_states' is a source of joints twice"},
    {"joints_empty", 3, 9, "joints is an empty list.*at least one source"},
    {"joints_unknown_key", 3, 32, "unknown key 'rename' in a source of joints"},
    {"joint_unknown", 3, 43, "the model Bot has no joint 'ELBOV'.*did you mean 'ELBOW'"},
    {"joint_that_is_a_link", 3, 43, "has no joint 'ARM'.*known joints: SHOULDER, ELBOW"},
    {"joint_that_is_fixed", 3, 43, "'MOUNT' doesn't move.*fixed"},
    {"joint_of_two_names", 3, 53, "'a' and 'b' are the same joint"},
    {"joint_scale_zero", 3, 65, "scale is 0.*as -1"},
    {"joint_offset_with_unit", 3, 66, "offset is '3 mm'.*an angle"},
    {"joint_without_name", 3, 43, "a joint has no 'joint'"},
    {"names_a_list", 3, 39, "names is a list.*from the log's names to the model's"},
    {"velocity_unknown", 3, 42, "velocity is 'filtered'.*message .* or differentiate"},
    {"sampling_unknown", 3, 42, "sampling is 'cubic'.*hold .* or interpolate"},
    {"imu_without_device", 3, 7, "an IMU has no 'device'"},
    {"imu_text", 3, 7, "an IMU is '/imu/data'.*map of KEY: VALUE"},
    {"device_unknown", 3, 34, "the model Bot has no device 'Imuu'.*did you mean 'Imu'"},
    {"device_of_another_kind", 3, 34, "'Wrist' is a ForceSensor.*known gyros, accelerometers and IMUs: Imu, Gyro, Accel"},
    {"device_twice", 3, 40, "'Imu' has a second source.*line 3"},
    {"device_of_none", 3, 38, "device is an empty list.*name of a device"},
    {"wrench_of_an_imu", 3, 19, "'/imu/data' is of type sensor_msgs/msg/Imu, which isn't a WrenchStamped.*/ft_wrist"},
    {"camera_without_pictures", 3, 10, "neither 'topic' nor 'depth'"},
    {"camera_without_depth", 3, 45, "'Camera' is a Camera.*known cameras that measure depth: Depth|did you mean"},
    {"camera_interpolated", 3, 53, "unknown key 'sampling' in a camera"},
    {"camera_info_of_pictures", 3, 59, "'/camera/image_raw' is of type sensor_msgs/msg/Image, which isn't a CameraInfo.*/camera/camera_info"},
    {"ranges_of_a_camera", 3, 32, "'Depth' is a RangeCamera.*range sensors: Laser"},
    {"joystick_axis_unknown", 3, 32, "no axis 'L_STICK_X'.*did you mean"},
    {"joystick_axis_number", 3, 43, "L_STICK_H is 'left'.*whole number from 0 to 255"},
    {"joystick_button_unknown", 3, 35, "no button 'FIRE'.*known buttons: A, B"},
    {"joystick_buttons_list", 3, 34, "buttons is a list.*from names to numbers"},
    {"root_of_a_scan", 3, 7, "'/scan' is of type .*which isn't a PoseStamped, Odometry or TFMessage.*/odom .*/pose"},
    {"commands_of_an_array_alone", 4, 11, "'/efforts' is an array of numbers.*joints: \\[...\\], quantity"},
    {"commands_without_quantity", 4, 11, "has no 'quantity'.*position, velocity or effort"},
    {"commands_of_another_quantity", 4, 56, "quantity is 'torque'.*position, velocity or effort"},
    {"commands_joint_twice", 4, 45, "'ELBOW' is in 'joints' twice.*for one number"},
    {"commands_joint_unknown", 4, 38, "has no joint 'KNEE'"},
    {"commands_names_of_an_array", 4, 71, "'names' is given for an array"},
    {"commands_joints_of_a_joint_state", 4, 44, "'joints' is given for a topic that names its joints.*names: renames"},
    {"commands_shift_of_seconds", 4, 43, "shift is 0.1.*whole number from -1000 to 1000"},
    {"commands_max_age", 4, 36, "unknown key 'max_age' in a source of commands"},
    {"state_without_names", 4, 8, "'state' has no names.*names: \\[...\\]"},
    {"state_name_twice", 4, 37, "'I' is in 'names' twice.*of its own"},
    {"state_of_joints", 4, 16, "'/joint_states' is of type .*which isn't an array of numbers.*/efforts"},
    {"restart_falls", 4, 16, "the restart at 1.5 s isn't later.*rising times"},
    {"restart_of_a_word", 4, 10, "restart is 'now'.*number"},
    {"renamed_a_topic", 4, 10, "renamed is '/joints'.*\\{/old: /new\\}"},
    {"renamed_of_another_map", 4, 11, "'/scan' is no topic of this map"},
    {"renamed_to_nothing", 4, 26, "no topic '/joints'.*later name of /joint_states"},
    {"renamed_to_another_type", 4, 26, "'/scan' is of another type than '/joint_states'.*sensor_msgs/msg/JointState"},
    {"renamed_to_a_source", 5, 26, "'/joint_commands' is a topic of this map itself"},
    {"limits_without_commands", 4, 9, "'limits' without 'commands'"},
    {"limits_of_no_joint", 5, 10, "has no joint 'KNEE'"},
    {"limits_with_another_unit", 5, 17, "ELBOW is '8 rad'"},
    {"angles_in_turns", 4, 9, "angles is 'turns'.*radians, degrees"},
    {"tolerance_of_nothing", 5, 14, "allows nothing"},
    {"tolerances_without_commands", 4, 13, "'tolerances' without 'commands'"},
};
// clang-format on

std::filesystem::path file_of(const std::string& name) { return broken_files / ("map_" + name + ".yaml"); }

class BrokenMap : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenMap, IsRefusedAtItsPlaceAndForNothingElse) {
  const Broken& broken = GetParam();
  const auto result = LogMap::load(file_of(broken.name), mapped_robot(), mapped_topics());
  ASSERT_FALSE(result.ok());
  ASSERT_EQ(result.errors().size(), 1u) << to_string(result.errors());
  const Diagnostic& first = result.errors()[0];
  EXPECT_EQ(first.severity, Severity::error);
  EXPECT_EQ(first.file, file_of(broken.name).string());
  EXPECT_EQ(first.line, broken.line) << to_string(first);
  EXPECT_EQ(first.column, broken.column) << to_string(first);
  EXPECT_THAT(to_string(first), ::testing::ContainsRegex(broken.message));
  EXPECT_NE(first.hint, "") << "every message says what would be right";
}

INSTANTIATE_TEST_SUITE_P(Files, BrokenMap, ::testing::ValuesIn(all_broken), test::by_name);

TEST(BrokenMaps, AreAllInTheTable) {
  std::set<std::string> listed;
  for (const Broken& broken : all_broken) listed.insert(file_of(broken.name).filename().string());
  std::set<std::string> present;
  for (const auto& entry : std::filesystem::directory_iterator(broken_files)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("map_", 0) == 0) present.insert(name);
  }
  EXPECT_EQ(present, listed);
}

}  // namespace
}  // namespace rehearse
