// A log whose joint messages are in another encoding than that of ROS 2 is replayed as it is in CDR.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

#include "robot_run.h"

namespace rehearse {
namespace {

using namespace robot_run;

template <class Number>
std::string raw(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}
std::string counted(const std::string& text) { return raw(static_cast<std::uint32_t>(text.size())) + text; }

/// An encoding: its names, a definition of joint states, and a writer of them.
struct OtherEncoding {
  const char* message_encoding;
  const char* schema_encoding;
  std::string definition;
  std::string (*write)(const msg::JointState& state);
};

std::string in_ros1(const msg::JointState& state) {
  std::string bytes = raw<std::uint32_t>(0) + raw(state.header.stamp.sec) + raw(state.header.stamp.nanosec) +
                      counted(state.header.frame_id) + raw(static_cast<std::uint32_t>(state.name.size()));
  for (const std::string& name : state.name) bytes += counted(name);
  for (const auto* numbers : {&state.position, &state.velocity, &state.effort}) {
    bytes += raw(static_cast<std::uint32_t>(numbers->size()));
    for (const double number : *numbers) bytes += raw(number);
  }
  return bytes;
}

std::string in_json(const msg::JointState& state) {
  return fmt::format(
      R"({{"header": {{"stamp": {{"sec": {}, "nsec": {}}}, "frame_id": ""}}, "name": ["{}"],
          "position": [{:.17g}], "velocity": [{:.17g}], "effort": [{:.17g}]}})",
      state.header.stamp.sec, state.header.stamp.nanosec, fmt::join(state.name, "\", \""),
      fmt::join(state.position, ", "), fmt::join(state.velocity, ", "), fmt::join(state.effort, ", "));
}

std::string varint(std::uint64_t number) {
  std::string bytes;
  for (; number >= 0x80; number >>= 7) bytes += static_cast<char>((number & 0x7f) | 0x80);
  return bytes + static_cast<char>(number);
}
std::string number_field(std::uint64_t field, std::uint64_t number) { return varint(field << 3) + varint(number); }
std::string text_field(std::uint64_t field, const std::string& text) {
  return varint(field << 3 | 2) + varint(text.size()) + text;
}

std::string in_protobuf(const msg::JointState& state) {
  const auto& stamp = state.header.stamp;
  std::string bytes = text_field(
      1, text_field(1, number_field(1, static_cast<std::uint64_t>(stamp.sec)) + number_field(2, stamp.nanosec)));
  for (const std::string& name : state.name) bytes += text_field(2, name);
  std::uint64_t field = 3;
  for (const auto* numbers : {&state.position, &state.velocity, &state.effort}) {
    std::string packed;
    for (const double number : *numbers) packed += raw(number);
    bytes += text_field(field++, packed);
  }
  return bytes;
}

std::string described(const char* name, std::uint64_t number, std::uint64_t type, bool repeated,
                      const std::string& type_name = "") {
  return text_field(2, text_field(1, name) + number_field(3, number) + number_field(4, repeated ? 3 : 1) +
                           number_field(5, type) + (type_name.empty() ? "" : text_field(6, type_name)));
}
std::string file_of(const std::string& package, const std::string& messages) {
  return text_field(1, text_field(2, package) + messages);
}

std::vector<OtherEncoding> encodings() {
  const std::string numbers = R"({"type": "array", "items": {"type": "number"}})";
  return {{"ros1", "ros1msg",
           "Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
           "================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n",
           in_ros1},
          {"json", "jsonschema",
           R"({"type": "object", "properties": {"header": {"type": "object", "properties": {
                "stamp": {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}},
                "frame_id": {"type": "string"}}},
              "name": {"type": "array", "items": {"type": "string"}}, "position": )" +
               numbers + R"(, "velocity": )" + numbers + R"(, "effort": )" + numbers + "}}",
           in_json},
          {"protobuf", "protobuf",
           file_of("google.protobuf", text_field(4, text_field(1, "Timestamp") + described("seconds", 1, 3, false) +
                                                        described("nanos", 2, 5, false))) +
               file_of("sensor_msgs.msg",
                       text_field(4, text_field(1, "Header") +
                                         described("stamp", 1, 11, false, ".google.protobuf.Timestamp")) +
                           text_field(4, text_field(1, "JointState") +
                                             described("header", 1, 11, false, ".sensor_msgs.msg.Header") +
                                             described("name", 2, 9, true) + described("position", 3, 1, true) +
                                             described("velocity", 4, 1, true) + described("effort", 5, 1, true))),
           in_protobuf}};
}

class Encodings : public RobotRunLog {
 protected:
  static void SetUpTestSuite() { setenv("REHEARSE_CONTROLLER_PATH", TEST_CONTROLLERS, 1); }

  /// Writes the log's joint states and commands anew in the encoding.
  void rewrite(const OtherEncoding& encoding, std::size_t cut = 0) const {
    std::vector<std::pair<std::uint64_t, std::pair<std::string, std::string>>> messages;  // time, topic, payload
    {
      const auto log = mcap::Reader::open(path("log.mcap"));
      ASSERT_TRUE(log);
      ASSERT_TRUE((*log)->for_each_message([&](const mcap::Message& message) {
        if (message.channel->topic == "/efforts") return true;
        CdrReader reader(message.data);
        msg::JointState state;
        if (msg::decode(reader, state))
          messages.emplace_back(message.log_time, std::pair(message.channel->topic, encoding.write(state)));
        return true;
      }));
    }
    const auto writer = mcap::Writer::create(path("log.mcap"));
    ASSERT_TRUE(writer);
    const std::string type =
        encoding.schema_encoding == std::string("protobuf") ? "sensor_msgs.msg.JointState" : "sensor_msgs/JointState";
    const auto schema = (*writer)->add_schema(type, encoding.schema_encoding, encoding.definition);
    std::map<std::string, std::uint16_t> channels;
    for (const auto& [time, message] : messages) {
      const auto [channel, is_new] = channels.try_emplace(message.first, 0);
      if (is_new) channel->second = (*writer)->add_channel(schema, message.first, encoding.message_encoding);
      const std::string& payload = message.second;
      ASSERT_TRUE((*writer)->write(channel->second, time, time,
                                   std::as_bytes(std::span(payload.data(), payload.size() - cut))));
    }
    ASSERT_TRUE((*writer)->close());
  }
};

TEST_F(Encodings, OfJointsAndCommandsAreReplayedBitForBit) {
  const Robot robot("ServoWith_filtered", "pendulum.urdf", joints_of("pendulum.urdf"), false);
  const RobotRun run = robot.run(11, {}, 300);
  for (const OtherEncoding& encoding : encodings()) {
    write(run);
    rewrite(encoding);
    const auto report = replay(robot, by_message);
    ASSERT_TRUE(report) << encoding.message_encoding << ": " << to_string(report.errors());
    EXPECT_TRUE(report->equal()) << encoding.message_encoding;
    EXPECT_GT(report->ticks_compared, 290) << encoding.message_encoding;
  }
}

TEST_F(Encodings, AChangeIsFound) {
  const Robot robot("ServoWith_none", "pendulum.urdf", joints_of("pendulum.urdf"), false);
  RobotRun run = robot.run(11, {}, 300);
  for (RobotMessage& command : run.commands)
    for (double& effort : command.joints.effort) effort *= 1.01;
  for (const OtherEncoding& encoding : encodings()) {
    write(run);
    rewrite(encoding);
    const auto report = replay(robot, by_message);
    ASSERT_TRUE(report) << encoding.message_encoding << ": " << to_string(report.errors());
    EXPECT_FALSE(report->within()) << encoding.message_encoding;
  }
}

TEST_F(Encodings, APayloadThatIsCutIsReported) {
  const Robot robot("ServoWith_none", "pendulum.urdf", joints_of("pendulum.urdf"), false);
  for (const OtherEncoding& encoding : encodings()) {
    write(robot.run(11, {}, 50));
    rewrite(encoding, 1);
    const auto report = replay(robot, by_message);
    ASSERT_FALSE(report) << encoding.message_encoding;
    EXPECT_THAT(to_string(report.errors()), testing::HasSubstr("aren't what its schema says"))
        << encoding.message_encoding;
  }
}

}  // namespace
}  // namespace rehearse
