// long_log FOLDER SECONDS [commands]: writes a log that is so long, with its map and its robot, and, if it is asked
// for, with the commands of TankController. long_log FOLDER: reads it once in order, decodes each message, and prints
// the time. For measurements (the page contribute/robustness_tests.md).
#include "long_log.h"

#include <chrono>

#include "logs/robot_log/message_reader.h"
#include "logs/robot_log/sensor_codecs.h"

namespace rehearse {
namespace {

/// Decodes each message once, pictures included; returns the number of messages.
std::int64_t read_all(mcap::Reader& log) {
  const auto schema = [](const mcap::Schema& of) { return *ros2msg::Schema::parse(of.name, of.data); };
  std::map<std::string, ros2msg::Schema> schemas;
  for (const auto& [id, found] : log.schemas()) schemas.emplace(found.name, schema(found));
  MessageReader<msg::JointState> joints(schemas.at("sensor_msgs/msg/JointState"));
  MessageReader<msg::Imu> imu(schemas.at("sensor_msgs/msg/Imu"));
  MessageReader<msg::LaserScan> scan(schemas.at("sensor_msgs/msg/LaserScan"));
  MessageReader<msg::CompressedImage> picture(schemas.at("sensor_msgs/msg/CompressedImage"));
  MessageReader<msg::Joy> joy(schemas.at("sensor_msgs/msg/Joy"));
  std::int64_t count = 0;
  const auto done = log.for_each_message_in_order([&](const mcap::Message& message) {
    const std::string& topic = message.channel->topic;
    if (topic == "/joint_states" || topic == "/joint_commands") count += joints.read(message.data) != nullptr;
    if (topic == "/imu") count += imu.read(message.data) != nullptr;
    if (topic == "/scan") count += scan.read(message.data) != nullptr;
    if (topic == "/joy") count += joy.read(message.data) != nullptr;
    if (topic == "/camera/compressed") count += color_of(*picture.read(message.data)).ok();
    return true;
  });
  return done ? count : -1;
}

}  // namespace
}  // namespace rehearse

int main(int count, char** words) {
  using namespace rehearse;
  if (count == 3 || count == 4) {
    std::filesystem::create_directories(words[1]);
    test::write_long_log(words[1], std::filesystem::path(FIXTURES_DIR) / "models/tank.urdf", std::atof(words[2]),
                         count == 4);
    return 0;
  }
  if (count != 2) return std::fprintf(stderr, "usage: long_log FOLDER [SECONDS [commands]]\n"), 2;
  const auto begin = std::chrono::steady_clock::now();
  const auto log = mcap::Reader::open(std::filesystem::path(words[1]) / "log.mcap");
  if (!log) return std::fprintf(stderr, "%s\n", to_string(log.errors()).c_str()), 2;
  const std::int64_t messages = read_all(**log);
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  std::printf("read and decoded %lld messages once in %.3f s\n", static_cast<long long>(messages), passed.count());
  return messages > 0 ? 0 : 1;
}
