// The content of a valid map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "logs/map/log_map.h"
#include "logs/map/map_forms.h"
#include "mapped_robot.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

LogMap parsed(const std::string& lines) {
  auto map = LogMap::parse("rehearse_map: 1\ntime_step: 0.002\n" + lines, "map.yaml", mapped_robot(), mapped_topics());
  EXPECT_TRUE(map.ok()) << (map ? "" : to_string(map.errors()));
  return map ? *std::move(map) : LogMap{};
}

TEST(LogMap, NeedsFewLines) {
  const LogMap map =
      parsed("joints: /joint_states\nimus: {topic: /imu/data, device: Imu}\ncommands: /joint_commands\n");
  EXPECT_EQ(map.body, "Bot");
  EXPECT_EQ(map.time_step, 0.002);
  EXPECT_FALSE(map.tick);
  EXPECT_EQ(map.joints.at(0).clock, LogClock::log_time);
  EXPECT_EQ(map.start.when, StartRule::When::all);
  EXPECT_TRUE(map.controller.delay);
  ASSERT_EQ(map.joints.size(), 1u);
  EXPECT_EQ(map.joints[0].topic, "/joint_states");
  EXPECT_EQ(map.joints[0].sampling, Sampling::hold);
  EXPECT_EQ(map.joints[0].max_age, 0.1);
  EXPECT_EQ(map.joints[0].place.line, 3);
  EXPECT_EQ(map.joints[0].place.column, 9);
  ASSERT_EQ(map.devices.size(), 1u);
  EXPECT_EQ(map.devices[0].input->key, "imus");
  EXPECT_EQ(map.devices[0].devices, std::vector<int>{mapped_robot().find_device("Imu")});
  ASSERT_TRUE(map.commands);
  EXPECT_FALSE(map.commands->is_array);
  EXPECT_EQ(map.commands->shift, 0);
}

TEST(LogMap, RenamesTurnsAndMovesJoints) {
  const LogMap map = parsed(
      "joints:\n"
      "  topic: /joint_states\n"
      "  names: {a: SHOULDER, b: {joint: ELBOW, scale: -1, offset: 90 deg}}\n"
      "  velocity: differentiate\n"
      "  sampling: interpolate\n");
  const JointSource& source = map.joints.at(0);
  EXPECT_TRUE(source.differentiate);
  EXPECT_EQ(source.sampling, Sampling::interpolate);
  ASSERT_EQ(source.names.size(), 2u);
  EXPECT_EQ(source.names.at("a").joint, 0);
  EXPECT_EQ(source.names.at("a").scale, 1.0);
  EXPECT_EQ(source.names.at("b").joint, 1);
  EXPECT_EQ(source.names.at("b").scale, -1.0);
  EXPECT_DOUBLE_EQ(source.names.at("b").offset, 1.5707963267948966);
}

TEST(LogMap, MakesTicksOfATopic) {
  const LogMap map = parsed("joints: /joint_states\ntick: /joint_states\n");
  ASSERT_TRUE(map.tick);
  EXPECT_EQ(map.tick->topic, "/joint_states");
  EXPECT_EQ(map.tick->place.line, 4);
}

TEST(LogMap, HasAKeyForEachDeviceThatMeasures) {
  for (const DeviceKind& kind : device_kinds()) {
    Device device;
    device.kind = kind;
    const LogInput* input = log_input_of(device);
    ASSERT_EQ(input == nullptr, is_actuator(device)) << type_name(device);
    if (!input) continue;
    EXPECT_NE(map_form().find(input->key), nullptr) << input->key;
    EXPECT_TRUE(feeds(*input, device)) << type_name(device);
    EXPECT_FALSE(input->devices.empty() || input->messages.empty()) << type_name(device);
    if (input->content != LogInput::Content::numbers) continue;
    EXPECT_NE(form_of_input(*input).numbers, nullptr) << type_name(device);
    EXPECT_EQ(source_form(*input).name, input->form);
    EXPECT_FALSE(input->form.empty() || input->owner.empty()) << type_name(device);
  }
}

TEST(LogMap, ReportsAnEmptyListOfCamerasOnce) {
  const auto map = LogMap::parse("rehearse_map: 1\ntime_step: 0.002\njoints: /joint_states\ncameras: []\n", "map.yaml",
                                 mapped_robot(), mapped_topics());
  ASSERT_FALSE(map.ok());
  EXPECT_EQ(map.errors().size(), 1u) << to_string(map.errors());
}

TEST(LogMap, DoesNotInterpolateCountsOfContacts) {
  const auto map =
      LogMap::parse("rehearse_map: 1\ntime_step: 0.002\ncontacts: {topic: /touch, device: Touch, sampling: hold}\n",
                    "map.yaml", mapped_robot(), mapped_topics());
  ASSERT_FALSE(map.ok());
  EXPECT_THAT(to_string(map.errors()), ::testing::HasSubstr("unknown key 'sampling' in a contact sensor"));
}

TEST(LogMap, GivesEachKindOfSourceItsOwnAge) {
  const LogMap map = parsed(
      "joints: /joint_states\nranges: {topic: /scan, device: Laser}\njoystick: /joy\n"
      "cameras: {topic: /camera/image_raw, info: /camera/camera_info, device: Camera, max_age: 3}\n");
  EXPECT_EQ(map.joints.at(0).max_age, 0.1);
  ASSERT_EQ(map.devices.size(), 3u);
  EXPECT_EQ(map.devices[0].input->content, LogInput::Content::picture);
  EXPECT_EQ(map.devices[0].max_age, 3.0);
  EXPECT_EQ(map.devices[1].input->content, LogInput::Content::camera_info);
  EXPECT_EQ(map.devices[1].max_age, std::nullopt);
  EXPECT_EQ(map.devices[2].input->content, LogInput::Content::ranges);
  EXPECT_EQ(map.devices[2].max_age, 1.0);
  EXPECT_EQ(map.joystick->max_age, std::nullopt) << "it speaks when it is touched";
}

TEST(LogMap, HasOneAgeForAllIfItSaysSo) {
  const LogMap map = parsed("max_age: 0.5\njoints: /joint_states\nimus: {topic: /imu/data, device: Imu, max_age: 2}\n");
  EXPECT_EQ(map.joints.at(0).max_age, 0.5);
  EXPECT_EQ(map.devices.at(0).max_age, 2.0);
}

TEST(LogMap, TakesOneMessageForSeveralDevices) {
  const LogMap map = parsed("imus: {topic: /imu/data, device: [Gyro, Accel]}\n");
  const Model model = mapped_robot();
  EXPECT_EQ(map.devices.at(0).devices, (std::vector<int>{model.find_device("Gyro"), model.find_device("Accel")}));
}

TEST(LogMap, TakesTheJoystickAsItIsOrByNumber) {
  const LogMap as_it_is = parsed("joystick: /joy\n");
  EXPECT_EQ(as_it_is.joystick->axes[3].index, 3);
  EXPECT_EQ(as_it_is.joystick->buttons[10], 10);
  const LogMap by_number =
      parsed("joystick: {topic: /joy, axes: {L_STICK_V: {index: 4, invert: true}}, buttons: {START: 7}}\n");
  EXPECT_EQ(by_number.joystick->axes[1].index, 4);
  EXPECT_TRUE(by_number.joystick->axes[1].invert);
  EXPECT_EQ(by_number.joystick->axes[0].index, -1) << "what isn't named rests";
  EXPECT_EQ(by_number.joystick->buttons[7], 7);
  EXPECT_EQ(by_number.joystick->buttons[0], -1);
}

TEST(LogMap, KnowsOdometryByItsFields) {
  EXPECT_TRUE(parsed("root: /odom\n").root->has_twist);
  EXPECT_FALSE(parsed("root: /pose\n").root->has_twist);
}

TEST(LogMap, NamesTheJointsOfAnArray) {
  const LogMap map =
      parsed("joints: /joint_states\ncommands: {topic: /efforts, joints: [ELBOW, ~, SHOULDER], quantity: velocity}\n");
  EXPECT_TRUE(map.commands->is_array);
  EXPECT_EQ(map.commands->quantity, CommandSource::Quantity::velocity);
  EXPECT_EQ(map.commands->joints, (std::vector<std::optional<int>>{1, std::nullopt, 0}));
}

TEST(LogMap, TellsAllMistakesInTheFilesOrder) {
  const auto map =
      LogMap::parse("rehearse_map: 1\ntime_step: 0\njoints: /nobody\nimus: {topic: /scan, device: Wrist}\nstart: now\n",
                    "map.yaml", mapped_robot(), mapped_topics());
  ASSERT_FALSE(map.ok());
  std::vector<int> lines;
  for (const Diagnostic& mistake : map.errors()) lines.push_back(mistake.line);
  EXPECT_EQ(lines, (std::vector<int>{2, 3, 4, 4, 5})) << to_string(map.errors());
}

TEST(LogMap, IsReadFromAFile) {
  const auto none = LogMap::load("/nowhere/map.yaml", mapped_robot(), mapped_topics());
  ASSERT_FALSE(none.ok());
  EXPECT_THAT(to_string(none.errors()), HasSubstr("there is no such file (expected a map, a YAML file)"));
  const auto folder = LogMap::load("/", mapped_robot(), mapped_topics());
  ASSERT_FALSE(folder.ok());
  EXPECT_THAT(to_string(folder.errors()), HasSubstr("it is a directory"));
}

// Each sample of a map is one that a robot could have.
TEST(SampleMaps, AreWithoutMistakes) {
  UrdfOptions without_meshes;
  without_meshes.meshes = UrdfOptions::Meshes::skip;
  const std::filesystem::path fixtures = FIXTURES_DIR;
  const auto walker = load_urdf(fixtures / "models/sr1.urdf", without_meshes);
  const auto tank = load_urdf(fixtures / "models/tank.urdf", without_meshes);
  ASSERT_TRUE(walker.ok() && tank.ok());
  std::vector<LogTopic> topics = mapped_topics();
  for (const char* name : {"/legs/joint_states", "/arms/joint_states", "/Tank/joints", "/Tank/Driver/output/joints"})
    topics.push_back(topic_with<msg::JointState>(name));
  for (const char* name : {"/ft/left", "/ft/right"}) topics.push_back(topic_with<msg::WrenchStamped>(name));
  topics.push_back(topic_with<msg::CompressedImage>("/head/left/image_raw/compressed"));
  topics.push_back(topic_with<msg::Image>("/head/left/depth"));
  topics.push_back(topic_with<msg::CameraInfo>("/head/left/camera_info"));
  const std::map<std::string, const Model*> models{{"tank.map.yaml", &*tank}, {"walker.map.yaml", &*walker}};
  int maps = 0;
  for (const auto& entry : std::filesystem::directory_iterator(fixtures / "logs")) {
    const auto model = models.find(entry.path().filename().string());
    ASSERT_NE(model, models.end()) << entry.path() << " has no robot here";
    const auto map = LogMap::load(entry.path(), *model->second, topics);
    EXPECT_TRUE(map.ok()) << (map ? "" : to_string(map.errors()));
    ++maps;
  }
  EXPECT_EQ(maps, 2);
}

TEST(LogTopics, KnowTheFieldsOfTheirMessages) {
  const LogTopic topic = topic_with<msg::JointState>("/joint_states");
  EXPECT_EQ(topic.type, "sensor_msgs/msg/JointState");
  EXPECT_TRUE(topic.has("header/stamp/sec"));
  EXPECT_TRUE(topic.has("name/*", FieldContent::text));
  EXPECT_TRUE(topic.has("position/*"));
  EXPECT_FALSE(topic.has("position"));
  EXPECT_TRUE(topic_with<msg::Image>("/image").has("data", FieldContent::bytes));
  EXPECT_TRUE(topic_with<msg::PointCloud2>("/cloud").has("fields/*/name", FieldContent::text));
}

TEST(LogTopics, SayWhyTheyCannotBeRead) {
  EXPECT_THAT(topic_with("/t", "a/msg/B", "float64").problem, HasSubstr("its schema can't be read"));
  const mcap::Schema idl{1, "a/msg/B", "ros2idl", ""};
  EXPECT_THAT(log_topic("/t", "cdr", &idl).problem, HasSubstr("its schema can't be read: it doesn't define a/msg/B"));
  EXPECT_EQ(log_topic("/t", "json", &idl).problem,
            "messages of encoding 'json' with a schema in 'ros2idl' can't be read");
  EXPECT_THAT(log_topic("/t", "cdr", nullptr).problem, HasSubstr("no schema"));
}

}  // namespace
}  // namespace rehearse
