// Messages of each type that Rehearse writes, read by @mcap/core with its CRC checks on and by Foxglove's decoder of
// ROS 2 messages, value by value.
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <sstream>

#include "core/mcap/copy.h"
#include "core/ros2msg/ros2msg.h"
#include "node.h"

using namespace rehearse;
using namespace rehearse::test;

namespace {

using Interop = NodeTest;

template <class Message>
void write_one(mcap::Writer& writer, std::string_view topic, std::uint64_t time, const Message& message,
               mcap::ChunkGroup group = mcap::numbers) {
  const auto schema = writer.add_schema(Message::type_name, "ros2msg", msg::schema_text<Message>());
  const auto channel = writer.add_channel(schema, topic, "cdr", {}, group);
  CdrWriter cdr;
  msg::encode(message, cdr);
  ASSERT_TRUE(writer.write(channel, time, time, cdr.bytes()));
}

void write_all_types(const fs::path& file) {
  mcap::WriterOptions options;
  options.chunk_span = 5;  // several chunks
  auto writer = std::move(*mcap::Writer::create(file, options));
  ASSERT_TRUE(writer->add_attachment("scenario.yaml", "application/yaml", std::as_bytes(std::span("rehearse: 1", 11))));
  ASSERT_TRUE(writer->add_metadata("provenance", {{"seed", "0"}}));
  constexpr double inf = std::numeric_limits<double>::infinity();
  const msg::Header header{{1, 2}, "WAIST"};
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  write_one(*writer, "/SR1/joints", 1,
            msg::JointState{header, {"KNEE", "ANKLE"}, {0.1, -0.0}, {inf, -inf}, {not_a_number, 5e-324}});
  write_one(*writer, "/SR1/empty", 2, msg::JointState{});
  msg::Imu imu;
  imu.angular_velocity = {1.0 / 3.0, 2, 3};
  imu.orientation_covariance[0] = -1;
  write_one(*writer, "/SR1/Imu/imu", 3, imu);
  write_one(*writer, "/SR1/Camera/image", 4, msg::Image{header, 1, 1, "rgb8", 0, 3, {1, 2, 255}}, mcap::pictures);
  write_one(*writer, "/SR1/Camera/png", 5, msg::CompressedImage{header, "png", {0x89, 0x50}}, mcap::pictures);
  msg::CameraInfo info;
  info.d = {0.5};
  info.k[8] = 1;
  info.roi.do_rectify = true;
  write_one(*writer, "/SR1/Camera/info", 6, info);
  write_one(*writer, "/SR1/WAIST/pose", 7, msg::PoseStamped{header, {{1, 2, 3}, {0, 0, 0, 1}}});
  write_one(*writer, "/SR1/WAIST/twist", 8, msg::TwistStamped{header, {{1, 2, 3}, {4, 5, 6}}});
  write_one(*writer, "/SR1/WAIST/accel", 9, msg::AccelStamped{header, {{1, 2, 3}, {4, 5, 6}}});
  write_one(*writer, "/SR1/Foot/wrench", 10, msg::WrenchStamped{header, {{1, 2, 3}, {4, 5, 6}}});
  write_one(*writer, "/tf", 11, msg::TFMessage{{{header, "CHEST", {}}, {header, "HEAD", {}}}});
  write_one(*writer, "/tick", 12, msg::Tick{{0, 12}, -1, ~std::uint64_t{0}, 1, 2, {true, false}});
  write_one(*writer, "/SR1/Device/state", 13, msg::DeviceState{header, {1, 2}});
  write_one(*writer, "/SR1/Pd/input/FOOT/contacts", 13,
            msg::Contacts{header, {{{1, 2, 3}, {0, 0, 1}, {4, 5, inf}, {6, 7, -0.0}, 1.0 / 3.0}, {}}});
  write_one(*writer, "/SR1/Sole/contact", 13, msg::ContactForce{header, 4, {1, 2, 3}});
  write_one(*writer, "/SR1/accelerations", 14, msg::JointAccelerations{header, {"KNEE"}, {7}});
  msg::LaserScan scan;
  scan.angle_min = -1.0f / 3.0f;
  scan.ranges = {0.1f, std::numeric_limits<float>::infinity(), -0.0f};
  write_one(*writer, "/SR1/Laser/scan", 14, scan);
  write_one(
      *writer, "/SR1/Laser/points", 14,
      msg::PointCloud2{header, 1, 1, {{"range", 0, msg::PointField::float32, 1}}, false, 4, 4, {1, 2, 3, 4}, true});
  write_one(*writer, "/events", 15, msg::Event{{0, 15}, 15, "note", "SR1", "höher"});
  write_one(*writer, "/checkpoint", 16, msg::Checkpoint{{0, 16}, 16, "ode/1", {9, 8, 7}});
  write_one(*writer, "/joy", 17, msg::Joy{header, {-0.3F, 1.0F, -0.0F}, {1, 0, -7}});
  ASSERT_TRUE(writer->close());
}

std::string hex(std::uint64_t value, std::size_t width) {
  std::array<char, 16> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, 16).ptr;
  const std::string text(digits.data(), end);
  return std::string(width - text.size(), '0') + text;
}

std::string print(const ros2msg::Value& value) {
  using Kind = ros2msg::Value::Kind;
  switch (value.kind) {
    case Kind::signed_integer: return std::to_string(value.integer);
    case Kind::unsigned_integer:
    case Kind::boolean: return std::to_string(value.unsigned_integer);
    case Kind::floating: return hex(std::bit_cast<std::uint64_t>(value.number), 16);
    case Kind::text: return std::string(value.text);
    case Kind::blob: break;
  }
  std::string text;
  for (const std::byte byte : value.blob) text += hex(std::to_integer<std::uint64_t>(byte), 2);
  return text;
}

/// The lines that read_trace.mjs prints, made with Rehearse's own reader and decoder.
std::string print_messages(const fs::path& file) {
  auto reader = std::move(*mcap::Reader::open(file));
  std::ostringstream out;
  EXPECT_TRUE(reader->for_each_message([&](const mcap::Message& message) {
    const mcap::Schema& schema = *reader->schema_of(*message.channel);
    ros2msg::Decoder decoder(std::move(*ros2msg::Schema::parse(schema.name, schema.data)));
    out << message.channel->topic << ' ' << message.sequence << ' ' << message.log_time;
    EXPECT_TRUE(decoder.decode(message.data,
                               [&](const ros2msg::Value& value) { out << ' ' << value.path << '=' << print(value); }));
    out << '\n';
    return true;
  }));
  return out.str();
}

}  // namespace

TEST_F(Interop, OthersReadOurTracesBitForBit) {
  write_all_types(file_);
  const Output output = node("read_trace.mjs");
  ASSERT_EQ(output.status, 0) << output.text;
  EXPECT_EQ(output.text, print_messages(file_) +
                             "attachment scenario.yaml application/yaml rehearse: 1\n"
                             "metadata provenance {\"seed\":\"0\"}\n"
                             "statistics 21 messages, 5 chunks\n");
}

TEST_F(Interop, OurSchemasAreThoseOfRos2) {
  write_all_types(file_);
  const Output output = node("compare_schemas.mjs");
  EXPECT_EQ(output.status, 0) << output.text;
  EXPECT_EQ(
      output.text,
      "builtin_interfaces/Time geometry_msgs/Accel geometry_msgs/AccelStamped geometry_msgs/Point geometry_msgs/Pose "
      "geometry_msgs/PoseStamped geometry_msgs/Quaternion geometry_msgs/Transform geometry_msgs/TransformStamped "
      "geometry_msgs/Twist geometry_msgs/TwistStamped geometry_msgs/Vector3 geometry_msgs/Wrench "
      "geometry_msgs/WrenchStamped sensor_msgs/CameraInfo sensor_msgs/CompressedImage sensor_msgs/Image "
      "sensor_msgs/Imu sensor_msgs/JointState sensor_msgs/Joy sensor_msgs/LaserScan sensor_msgs/PointCloud2 "
      "sensor_msgs/PointField sensor_msgs/RegionOfInterest std_msgs/Header tf2_msgs/TFMessage\n");
}

TEST_F(Interop, OthersReadACopyThatMetadataWasAddedTo) {
  const fs::path plain = file_.string() + ".plain";
  write_all_types(plain);
  const auto copied = mcap::copy_with_metadata(plain, file_, "note", {{"note.1", {{"kind", "first"}}}, {"note.2", {}}});
  fs::remove(plain);
  ASSERT_TRUE(copied) << to_string(copied.errors());
  const Output output = node("read_trace.mjs");
  ASSERT_EQ(output.status, 0) << output.text;
  EXPECT_EQ(output.text, print_messages(file_) +
                             "attachment scenario.yaml application/yaml rehearse: 1\n"
                             "metadata provenance {\"seed\":\"0\"}\n"
                             "metadata note.1 {\"kind\":\"first\"}\n"
                             "metadata note.2 {}\n"
                             "statistics 21 messages, 5 chunks\n");
}

TEST_F(Interop, OthersRefuseOurTracesWhenOneBitIsFlipped) {
  write_all_types(file_);
  const mcap::Chunk chunk = (*mcap::Reader::open(file_))->chunks().front();
  // The last byte of the first chunk; the CRC of the data section @mcap/core doesn't check.
  const std::uint64_t fields = 9 + 8 + 8 + 8 + 4 + (4 + chunk.compression.size()) + 8;  // before the chunk's records
  const auto place = static_cast<long>(chunk.offset + fields + chunk.stored_size) - 1;
  std::FILE* file = std::fopen(file_.c_str(), "r+b");
  ASSERT_NE(file, nullptr);
  std::fseek(file, place, SEEK_SET);
  const int byte = std::fgetc(file);
  std::fseek(file, place, SEEK_SET);
  std::fputc(byte ^ 1, file);
  std::fclose(file);
  EXPECT_NE(node("read_trace.mjs").status, 0);
}
