// The messages of a log that a controller reads at a tick.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "logs/map/log_map.h"
#include "logs/robot_log/log_feed.h"
#include "mapped_robot.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t ms = 1'000'000;  // [ns]

template <class T>
std::vector<std::byte> cdr_of(const T& message) {
  CdrWriter writer;
  msg::encode(message, writer);
  return {writer.bytes().begin(), writer.bytes().end()};
}

/// One source of a map and the feed of it.
class FeedTest : public ::testing::Test {
 protected:
  FeedTest() {
    BodyObservation& body = seen_.bodies.emplace_back();
    body.joints.resize(model_.joints.size());
    body.links.resize(model_.links.size());
    body.devices.resize(model_.devices.size());
    seen_.joystick.emplace();
  }

  /// Makes the feed of a map with these lines.
  void map(const std::string& lines) {
    auto map = LogMap::parse("rehearse_map: 1\ntime_step: 0.01\n" + lines, "map.yaml", model_, topics_);
    ASSERT_TRUE(map.ok()) << to_string(map.errors());
    map_ = *std::move(map);
    if (!map_.joints.empty()) feed_ = make_joint_feed(map_.joints[0], {}, model_, schema(map_.joints[0].topic));
    if (map_.root) feed_ = make_root_feed(*map_.root, schema(map_.root->topic));
    if (map_.joystick) feed_ = make_joy_feed(*map_.joystick, schema(map_.joystick->topic));
    if (!map_.devices.empty())
      feed_ = make_device_feed(map_.devices[0], model_, ticks_, topic(map_.devices[0].topic),
                               schema(map_.devices[0].topic));
  }

  const LogTopic& topic(const std::string& name) const {
    for (const LogTopic& known : topics_)
      if (known.name == name) return known;
    throw std::out_of_range(name);
  }

  ros2msg::Schema schema(const std::string& name) const {
    auto parsed = ros2msg::Schema::parse(topic(name).type, topic(name).schema);
    EXPECT_TRUE(parsed.ok());
    return *std::move(parsed);
  }

  template <class T>
  bool take(std::int64_t time, const T& message) {
    return feed_->take(time, cdr_of(message)).ok();
  }

  void look(std::int64_t time) {
    for (DeviceReading& device : seen_.bodies[0].devices) device.fresh = false;
    feed_->look({time, time / (10 * ms), static_cast<double>(time) * 1e-9}, seen_);
  }

  const JointReading& joint(int id) const { return seen_.bodies[0].joints[id]; }
  const DeviceReading& device(const std::string& name) const {
    return seen_.bodies[0].devices[model_.find_device(name)];
  }

  Model model_ = mapped_robot();
  std::vector<LogTopic> topics_ = mapped_topics();
  LogMap map_;
  const LogTicks ticks_{0, 0.01};
  std::unique_ptr<LogFeed> feed_;
  Observation seen_;
};

msg::JointState state(std::vector<std::string> names, std::vector<double> q, std::vector<double> dq = {},
                      std::vector<double> u = {}) {
  msg::JointState message;
  message.name = std::move(names);
  message.position = std::move(q);
  message.velocity = std::move(dq);
  message.effort = std::move(u);
  return message;
}

TEST_F(FeedTest, TakesJointsByName) {
  map("joints: /joint_states\n");
  ASSERT_TRUE(take(0, state({"ELBOW", "GRIPPER", "SHOULDER"}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9})));
  look(0);
  EXPECT_EQ(joint(0).q, 3.0);
  EXPECT_EQ(joint(0).dq, 6.0);
  EXPECT_EQ(joint(0).u, 9.0);
  EXPECT_EQ(joint(1).q, 1.0);
}

TEST_F(FeedTest, KeepsWhatAMessageDoesNotSpeakOf) {
  map("joints: /joint_states\n");
  take(0, state({"ELBOW"}, {1}, {2}, {3}));
  take(1, state({"SHOULDER"}, {4}));
  take(2, state({"ELBOW"}, {5}));
  look(2);
  EXPECT_EQ(joint(1).q, 5.0);
  EXPECT_EQ(joint(1).dq, 2.0);
  EXPECT_EQ(joint(1).u, 3.0);
  EXPECT_EQ(joint(0).q, 4.0);
}

TEST_F(FeedTest, TurnsJointsAround) {
  map("joints: {topic: /joint_states, names: {motor: {joint: ELBOW, scale: -0.5, offset: 0.25}}}\n");
  take(0, state({"motor", "ELBOW"}, {2.0, 100.0}, {4.0, 100.0}, {8.0, 100.0}));
  look(0);
  EXPECT_EQ(joint(1).q, 100.0) << "two names of one joint: the later in the message";
  take(1, state({"motor"}, {2.0}, {4.0}, {8.0}));
  look(1);
  EXPECT_EQ(joint(1).q, -0.75);
  EXPECT_EQ(joint(1).dq, -2.0);
  EXPECT_EQ(joint(1).u, -16.0) << "the power stays the same";
}

TEST_F(FeedTest, LeavesBitsAsTheyAre) {
  map("joints: /joint_states\n");
  take(0, state({"ELBOW"}, {-0.0}));
  look(0);
  EXPECT_TRUE(std::signbit(joint(1).q));
}

TEST_F(FeedTest, PassesNaNWithItsBits) {
  map("joints: /joint_states\n");
  const double nan = std::bit_cast<double>(std::uint64_t{0xfff8'0000'0000'1234});
  take(0, state({"ELBOW", "SHOULDER"}, {nan, 1.0}, {2.0, 3.0}));
  look(0);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(joint(1).q), 0xfff8'0000'0000'1234u);
  EXPECT_TRUE(feed_->has_position(1));
  take(10 * ms, state({"ELBOW", "SHOULDER"}, {4.0, nan}, {nan, 3.0}));
  look(10 * ms);
  EXPECT_EQ(joint(1).q, 4.0);
  EXPECT_TRUE(std::isnan(joint(1).dq)) << "not the value before";
  EXPECT_TRUE(std::isnan(joint(0).q));
}

TEST_F(FeedTest, NamesAJointThatFallsSilentWhileOthersGoOn) {
  map("joints: {topic: /joint_states, max_age: 0.05}\n");
  for (int i = 0; i < 20; ++i) {
    take(i * 10 * ms, i < 5 || i > 14 ? state({"ELBOW", "SHOULDER"}, {1, 2}) : state({"SHOULDER"}, {2}));
    look(i * 10 * ms);
    EXPECT_EQ(feed_->take_silences().size(), i == 10 ? 1u : 0u) << i;
  }
  const std::vector<SilentJoint> silent = feed_->silent_joints();
  ASSERT_EQ(silent.size(), 1u);
  EXPECT_EQ(silent[0].joint, "ELBOW");
  EXPECT_EQ(silent[0].gaps, 1);
  EXPECT_EQ(silent[0].ticks_in_gaps, 5);
  EXPECT_DOUBLE_EQ(silent[0].worst_age, 0.1);
  EXPECT_DOUBLE_EQ(silent[0].worst_age_at, 0.14);
  look(400 * ms);
  EXPECT_TRUE(feed_->take_silences().empty()) << "a gap of the whole topic";
}

TEST_F(FeedTest, RefusesArraysOfOtherLengths) {
  map("joints: /joint_states\n");
  EXPECT_FALSE(take(0, state({"ELBOW", "SHOULDER"}, {1})));
  EXPECT_EQ(feed_->take(0, cdr_of(state({"ELBOW"}, {}, {1, 2}))).errors()[0].message, "2 velocities of 1 joints");
  EXPECT_EQ(feed_->take(0, std::vector<std::byte>(7)).errors()[0].message, "7 bytes that aren't what its schema says");
}

TEST_F(FeedTest, InterpolatesAContinuousJointTheShorterWay) {
  map("joints: {topic: /joint_states, sampling: interpolate}\n");
  take(0, state({"ELBOW", "SHOULDER"}, {3.0, 3.0}, {0.0, 0.0}));
  take(10 * ms, state({"ELBOW", "SHOULDER"}, {-3.0, -3.0}, {1.0, 1.0}));
  look(5 * ms);
  EXPECT_NEAR(joint(1).q, std::numbers::pi, 1e-12) << "ELBOW turns on and on";
  EXPECT_NEAR(joint(0).q, 0.0, 1e-12) << "SHOULDER has limits";
  EXPECT_DOUBLE_EQ(joint(0).dq, 0.5);
}

TEST_F(FeedTest, HoldsAcrossAGapInsteadOfInterpolating) {
  map("joints: {topic: /joint_states, sampling: interpolate, max_age: 0.05}\n");
  take(0, state({"SHOULDER"}, {1.0}));
  take(100 * ms, state({"SHOULDER"}, {2.0}));
  look(50 * ms);
  EXPECT_EQ(joint(0).q, 1.0);
}

TEST_F(FeedTest, DifferentiatesIfItIsAskedTo) {
  map("joints: {topic: /joint_states, velocity: differentiate}\n");
  take(0, state({"ELBOW", "SHOULDER"}, {3.1, 0.0}, {77.0, 77.0}));
  look(0);
  EXPECT_EQ(joint(0).dq, 0.0) << "one position has no speed yet";
  take(10 * ms, state({"ELBOW", "SHOULDER"}, {-3.1, 0.02}));
  look(10 * ms);
  EXPECT_NEAR(joint(0).dq, 2.0, 1e-12);
  EXPECT_NEAR(joint(1).dq, (2 * std::numbers::pi - 6.2) / 0.01, 1e-9) << "the shorter way round";
}

/// A magnetic field in single precision, from another vendor.
struct FloatField {
  struct Axes {
    static constexpr std::string_view type_name = "robot_msgs/msg/Axes";
    float x = 0.0F, y = 0.0F, z = 0.0F;
    REHEARSE_FIELDS(x, y, z)
  };
  static constexpr std::string_view type_name = "robot_msgs/msg/Field";
  Axes magnetic_field;
  REHEARSE_FIELDS(magnetic_field)
};

TEST_F(FeedTest, TakesAMagneticFieldByTheNamesOfItsFields) {
  map("magnetometers: {topic: /mag/float, device: Compass}\n");
  ASSERT_TRUE(take(0, FloatField{{0.5F, 0.25F, -2.0F}}));
  look(0);
  EXPECT_EQ(device("Compass").values, (std::vector<double>{0.5, 0.25, -2.0}));
}

TEST_F(FeedTest, InterpolatesAMagneticField) {
  map("magnetometers: {topic: /mag/float, device: Compass, sampling: interpolate}\n");
  ASSERT_TRUE(take(0, FloatField{{1.0F, 0.0F, 0.0F}}));
  ASSERT_TRUE(take(10 * ms, FloatField{{3.0F, 4.0F, 0.0F}}));
  look(5 * ms);
  EXPECT_EQ(device("Compass").values, (std::vector<double>{2.0, 2.0, 0.0}));
}

TEST_F(FeedTest, TakesTheForcesOfAContactSensor) {
  map("contacts: {topic: /touch, device: Touch}\n");
  ASSERT_TRUE(take(0, msg::ContactForce{{}, 2, {1.0, 2.0, 3.0}}));
  look(0);
  EXPECT_EQ(device("Touch").values, (std::vector<double>{2, 1, 2, 3}));
}

TEST_F(FeedTest, GivesOneMessageToSeveralDevices) {
  map("imus: {topic: /imu/data, device: [Gyro, Accel, Imu]}\n");
  msg::Imu imu;
  imu.angular_velocity = {1, 2, 3};
  imu.linear_acceleration = {4, 5, 6};
  take(0, imu);
  look(10 * ms);
  EXPECT_EQ(device("Gyro").values, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(device("Accel").values, (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(device("Imu").values, (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(device("Imu").fresh);
  look(20 * ms);
  EXPECT_FALSE(device("Imu").fresh) << "it is still the same message";
  EXPECT_EQ(device("Imu").values.size(), 6u);
}

TEST_F(FeedTest, InterpolatesForces) {
  map("wrenches: {topic: /ft_wrist, device: Wrist, sampling: interpolate}\n");
  msg::WrenchStamped wrench;
  take(0, wrench);
  wrench.wrench = {{10, 20, 30}, {1, 2, 3}};
  take(10 * ms, wrench);
  look(5 * ms);
  EXPECT_EQ(device("Wrist").values, (std::vector<double>{5, 10, 15, 0.5, 1, 1.5}));
  EXPECT_TRUE(device("Wrist").fresh);
}

TEST_F(FeedTest, TurnsTheRootTheShorterWay) {
  map("root: {topic: /pose, sampling: interpolate}\n");
  msg::PoseStamped pose;
  pose.pose = {{0, 0, 1}, {0, 0, 0, 1}};
  take(0, pose);
  const double half = std::sqrt(0.5);
  pose.pose = {{2, 0, 1}, {0, 0, -half, -half}};  // a quarter turn about z, with the opposite sign of the quaternion
  take(10 * ms, pose);
  look(5 * ms);
  const LinkReading& root = seen_.bodies[0].links[0];
  EXPECT_EQ(root.position, Eigen::Vector3d(1, 0, 1));
  EXPECT_NEAR(Eigen::AngleAxisd(root.rotation).angle(), std::numbers::pi / 4, 1e-12);
  EXPECT_FALSE(take(20 * ms, msg::PoseStamped{{}, {{}, {0, 0, 0, 0}}})) << "that is no orientation";
}

TEST_F(FeedTest, TakesTheJoystickByNumber) {
  map("joystick: {topic: /joy, axes: {L_STICK_V: {index: 1, invert: true}, R_STICK_H: 7}, buttons: {START: 2}}\n");
  msg::Joy joy;
  joy.axes = {0.25f, 0.5f};
  joy.buttons = {1, 1, 1};
  take(0, joy);
  look(0);
  EXPECT_EQ(seen_.joystick->axes[1], -0.5f);
  EXPECT_EQ(seen_.joystick->axes[0], 0.0f);
  EXPECT_EQ(seen_.joystick->axes[2], 0.0f) << "the message has no such axis";
  EXPECT_TRUE(seen_.joystick->buttons[7]);
  EXPECT_FALSE(seen_.joystick->buttons[0]);
}

TEST_F(FeedTest, ShowsAPictureWhenItHasArrivedWithTheTimeOfItsCapture) {
  map("cameras: {topic: /camera/image_raw, device: Camera}\n");
  msg::Image image;
  image.header.stamp = msg::Time::from_ns(20 * ms);
  image.width = 8;
  image.height = 6;
  image.step = 8;
  image.encoding = "mono8";
  image.data.assign(48, 7);
  take(55 * ms, image);
  look(50 * ms);
  EXPECT_EQ(device("Camera").image, nullptr);
  look(60 * ms);
  ASSERT_NE(device("Camera").image, nullptr);
  EXPECT_TRUE(device("Camera").fresh);
  EXPECT_EQ(device("Camera").image->pixels, std::vector<std::uint8_t>(144, 7));
  EXPECT_DOUBLE_EQ(device("Camera").measured_at, 0.02);
  look(70 * ms);
  EXPECT_FALSE(device("Camera").fresh);
}

TEST_F(FeedTest, RefusesPicturesOfAnotherCamera) {
  map("cameras: {topic: /camera/image_raw, device: Camera}\n");
  msg::Image image;
  image.width = image.height = 6;
  image.step = 6;
  image.encoding = "mono8";
  image.data.assign(36, 7);
  take(0, image);
  look(0);
  EXPECT_EQ(device("Camera").image, nullptr);
  const auto unreadable = feed_->take_unreadable();
  ASSERT_EQ(unreadable.size(), 1u);
  EXPECT_EQ(unreadable[0].reason.message, "pictures of 6 x 6 pixels, and the model's camera 'Camera' has 8 x 6");
}

TEST_F(FeedTest, LeavesOutABrokenPictureAmongGoodOnes) {
  map("cameras: {topic: /camera/image_raw, device: Camera}\n");
  msg::Image image;
  image.width = 8;
  image.height = 6;
  image.step = 8;
  image.encoding = "mono8";
  image.data.assign(48, 7);
  take(0, image);
  look(0);
  image.data.resize(40);
  take(10 * ms, image);
  look(10 * ms);
  EXPECT_EQ(device("Camera").image->pixels.size(), 144u);
  EXPECT_FALSE(device("Camera").fresh);
  const auto unreadable = feed_->take_unreadable();
  ASSERT_EQ(unreadable.size(), 1u);
  EXPECT_EQ(unreadable[0].time, 10 * ms);
  EXPECT_EQ(unreadable[0].reason.message, "a picture of 8 x 6 pixels in mono8 has 40 bytes, 8 a row");
}

TEST_F(FeedTest, TakesScansByBeam) {
  map("ranges: {topic: /scan, device: Laser}\n");
  msg::LaserScan scan;
  scan.angle_min = -1.0f;
  scan.angle_increment = 0.5f;
  scan.range_min = 0.1f;
  scan.range_max = 10.0f;
  scan.ranges = {-std::numeric_limits<float>::infinity(), 0.05f, 11.0f, std::numeric_limits<float>::quiet_NaN(), 2.0f};
  take(0, scan);
  look(0);
  const float none = std::numeric_limits<float>::infinity();
  const std::vector<float>& ranges = *device("Laser").ranges;
  EXPECT_EQ((std::vector<float>{ranges[0], ranges[1], ranges[2], ranges[4]}),
            (std::vector<float>{-none, none, none, 2.0f}));
  EXPECT_TRUE(std::isnan(ranges[3]));
  EXPECT_TRUE(feed_->take_remarks().empty());
}

TEST_F(FeedTest, RemarksOnScansThatPointElsewhere) {
  map("ranges: {topic: /scan, device: Laser}\n");
  msg::LaserScan scan;
  scan.angle_min = -2.0f;
  scan.angle_increment = 1.0f;
  scan.range_max = 10.0f;
  scan.ranges.assign(5, 1.0f);
  take(0, scan);
  look(0);
  EXPECT_THAT(to_string(feed_->take_remarks()), HasSubstr("go from -2 to 2 rad, and the model's 'Laser' from -1 to 1"));
  scan.ranges.resize(4);
  std::unique_ptr<LogFeed> another = make_device_feed(map_.devices[0], model_, ticks_, topic("/scan"), schema("/scan"));
  ASSERT_TRUE(another->take(0, cdr_of(scan)));
  another->look({0, 0, 0.0}, seen_);
  const auto unreadable = another->take_unreadable();
  ASSERT_EQ(unreadable.size(), 1u);
  EXPECT_EQ(unreadable[0].reason.message, "a scan of 4, where the sensor has 5 beams");
}

TEST_F(FeedTest, MeasuresThePointsOfACloudOfAnyLayout) {
  map("ranges: {topic: /cloud, device: Laser}\n");
  msg::PointCloud2 cloud;
  cloud.fields = {{"intensity", 0, 2, 1}, {"z", 4, 7, 1}, {"y", 8, 7, 1}, {"x", 12, 7, 1}};
  cloud.is_bigendian = true;
  cloud.width = 5;
  cloud.height = 1;
  cloud.point_step = 16;
  cloud.row_step = 80;
  cloud.data.assign(80, 0);
  cloud.data[4] = 0x40, cloud.data[5] = 0x40;    // z = 3 of the first point
  cloud.data[12] = 0x40, cloud.data[13] = 0x80;  // and x = 4
  take(0, cloud);
  look(0);
  EXPECT_EQ(device("Laser").ranges->at(0), 5.0f);
  EXPECT_EQ(device("Laser").ranges->at(1), std::numeric_limits<float>::infinity()) << "a point at the sensor is none";
}

TEST_F(FeedTest, ReadsAVendorsMessagesByTheNamesOfTheirFields) {
  topics_ = {topic_with("/arm", "vendor_msgs/msg/ArmState",
                        "uint8 mode\nstring[] name\nfloat32[] temperature\nfloat32[] position\n")};
  map("joints: /arm\n");
  CdrWriter writer;
  writer.put(std::uint8_t{3});
  writer.put(std::uint32_t{1});
  writer.put(std::string_view("ELBOW"));
  writer.put(std::uint32_t{1});
  writer.put(36.6f);
  writer.put(std::uint32_t{1});
  writer.put(0.5f);
  ASSERT_TRUE(feed_->take(0, {writer.bytes().begin(), writer.bytes().end()}));
  look(0);
  EXPECT_EQ(joint(1).q, 0.5);
}

TEST_F(FeedTest, ReadsBothByteOrders) {
  topics_ = {topic_with("/arm", "vendor_msgs/msg/ArmState", "string[<=4] name\nfloat64[] position\n")};
  map("joints: /arm\n");
  const std::uint8_t big_endian[] = {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0,    6, 'E', 'L', 'B', 'O', 'W', 0,
                                     0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0x40, 0, 0,   0,   0,   0,   0,   0};
  const auto bytes = std::as_bytes(std::span(big_endian));
  ASSERT_TRUE(feed_->take(0, bytes));
  look(0);
  EXPECT_EQ(joint(1).q, 2.0);
}

}  // namespace
}  // namespace rehearse
