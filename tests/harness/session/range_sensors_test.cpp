// Range sensors in the closed loop: the controllers' inputs, the recording, and the replay without physics.

#include <rehearse/mcap.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <span>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// A turret (joint SHOULDER) on the world, with a laser of one row and one of three; a camera that nothing runs.
constexpr const char* turret_urdf = R"(<?xml version="1.0"?>
<robot name="Rig">
  <link name="world"/>
  <joint name="SHOULDER" type="continuous">
    <parent link="world"/><child link="HEAD"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
  </joint>
  <link name="HEAD">
    <inertial><mass value="1"/><inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.5"/></inertial>
    <collision><geometry><sphere radius="0.3"/></geometry></collision>
  </link>
  <gazebo reference="HEAD">
    <sensor name="Flat" type="ray">
      <update_rate>100</update_rate>
      <ray>
        <scan><horizontal><samples>3</samples><min_angle>-0.5</min_angle><max_angle>0.5</max_angle></horizontal></scan>
        <range><min>0.1</min><max>10</max></range>
      </ray>
    </sensor>
    <sensor name="Deep" type="gpu_lidar">
      <update_rate>200</update_rate>
      <lidar>
        <scan>
          <horizontal><samples>2</samples><min_angle>0</min_angle><max_angle>0.2</max_angle></horizontal>
          <vertical><samples>3</samples><min_angle>-0.3</min_angle><max_angle>0.3</max_angle></vertical>
        </scan>
        <range><min>0.1</min><max>4</max></range>
      </lidar>
    </sensor>
    <sensor name="Camera" type="camera"><camera/></sensor>
  </gazebo>
</robot>
)";

class RangeSensorRuns : public RunTest {
 protected:
  RangeSensorRuns() { write("rig.urdf", turret_urdf); }

  /// The turret before a wall 2 m ahead that reaches from its axis to the left; the floor is 1 m below it.
  static std::string before_a_wall(const std::string& controllers, const std::string& duration = "0.04") {
    return "rehearse: 1\nduration: " + duration +
           "\ncameras: none\nbodies:\n  - name: Rig\n    model: rig.urdf\n    controllers: [" + controllers +
           "]\n  - {name: Wall, box: {size: [0.2, 4, 4]}, fixed: true, position: [2.1, 1.9, 1]}\n"
           "  - {name: Floor, box: {size: [20, 20, 0.2]}, fixed: true, position: [0, 0, -0.1]}\n";
  }

  void expect_replays() {
    const auto report = replay_run();
    ASSERT_TRUE(report.ok()) << to_string(report.errors());
    EXPECT_TRUE(report->equal()) << (report->first ? to_string(*report->first) : to_string(*report->failure));
    EXPECT_EQ(report->ticks, summary_.ticks);
  }
};

TEST_F(RangeSensorRuns, GiveAControllerWhatItExpects) {
  const Trace trace = record_run(before_a_wall(behaviour("C", "scan Flat") + ", " + behaviour("D", "push 0"), "0.025"));
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: 3 x 1 beams, yaw -0.5 to 0.5, pitch 0 to 0, 0.1 to 10 m, 100 Hz",
                                       HasSubstr("as 'Rig/C' does"),
                                       "Rig/C: tick 10 delay 0.009: inf 2 2.27899",  // 2 m / cos 0.5; right-most first
                                       "Rig/C: tick 20 delay 0.009: inf 2 2.27899"));
}

TEST_F(RangeSensorRuns, NeedNoRenderer) {
  const Trace trace = record_run(before_a_wall(behaviour("C", "scan Flat")));
  EXPECT_EQ(trace.find_metadata("rehearse")->count("renderer"), 0u);
}

TEST_F(RangeSensorRuns, OfOneRowAreRecordedAsLaserScans) {
  const Trace trace = record_run(before_a_wall(behaviour("C", "push 0")));
  const TraceChannel* scans = trace.find_channel("/Rig/Flat/scan");
  ASSERT_NE(scans, nullptr);
  EXPECT_EQ(scans->type, "sensor_msgs/msg/LaserScan");
  EXPECT_EQ(scans->messages(), 4u);  // they arrive at ticks 10, 20, 30 and in the state after the last tick
  EXPECT_EQ(trace.last("Rig/Flat/ranges/0"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(trace.last("Rig/Flat/ranges/1"), 2.0);
  EXPECT_EQ(trace.last("Rig/Flat/ranges/2"), static_cast<double>(static_cast<float>(2.0 / std::cos(0.5))));
  EXPECT_NEAR(trace.last("Rig/Flat/angle_min"), -0.5, 1e-7);
  EXPECT_EQ(trace.last("Rig/Flat/range_max"), 10.0);
}

TEST_F(RangeSensorRuns, OfSeveralRowsAreRecordedAsPointClouds) {
  const Trace trace = record_run(before_a_wall(behaviour("C", "push 0")));
  EXPECT_EQ(trace.find_channel("/Rig/Deep/points")->type, "sensor_msgs/msg/PointCloud2");
  EXPECT_NEAR(trace.last("Rig/Deep/ranges/0"), 2.0 / std::cos(0.3), 1e-6);  // lowest row: the wall before the floor
  EXPECT_NEAR(trace.last("Rig/Deep/ranges/2"), 2.0, 1e-6);
  EXPECT_NEAR(trace.last("Rig/Deep/ranges/3"), 2.0 / std::cos(0.2), 1e-6);

  auto reader = mcap::Reader::open(path("run.mcap"));
  ASSERT_TRUE(reader.ok());
  msg::PointCloud2 cloud;
  ASSERT_TRUE((*reader)->for_each_message([&](const mcap::Message& message) {
    if (message.channel->topic != "/Rig/Deep/points") return true;
    CdrReader payload(message.data);
    return msg::decode(payload, cloud);
  }));
  EXPECT_EQ(cloud.width, 2u);
  EXPECT_EQ(cloud.height, 3u);
  EXPECT_EQ(cloud.header.frame_id, "Rig/Deep/scan");
  float point[4];  // of the third beam: straight ahead
  ASSERT_EQ(cloud.data.size(), 6 * sizeof point);
  std::memcpy(point, cloud.data.data() + 2 * sizeof point, sizeof point);
  EXPECT_THAT(point, ElementsAre(2.0f, 0.0f, 0.0f, 2.0f));
}

TEST_F(RangeSensorRuns, StandInTheTransformsWithTheAxesOfRos) {
  const Trace trace = record_run(before_a_wall(behaviour("C", "push 0")));
  EXPECT_NEAR(trace.last("Rig/Flat/scan/position/z"), 1.0, 1e-6);
  EXPECT_NEAR(std::abs(trace.last("Rig/Flat/scan/orientation/w")), 1.0, 1e-9);  // as the link: x ahead, z up
}

TEST_F(RangeSensorRuns, FollowTheLinkTheySitOn) {
  const Trace trace = record_run(before_a_wall(behaviour("C", "drive velocity 20"), "0.1"));
  const std::vector<double> ahead = trace.values("Rig/Flat/ranges/1"), q = trace.values("Rig/SHOULDER/q");
  ASSERT_EQ(ahead.size(), 10u);
  for (std::size_t i = 1; i < ahead.size(); ++i) {
    const double yaw = q[10 * i];  // at the time of the scan that arrived as the i-th
    EXPECT_LT(std::abs(yaw), 1.9) << i;
    if (std::abs(yaw) < 1.0) {
      EXPECT_NEAR(ahead[i], 2.0 / std::cos(yaw), 1e-5) << i;
    }
  }
}

TEST_F(RangeSensorRuns, AreSilentWhileSwitchedOff) {
  const Trace trace =
      record_run(before_a_wall(behaviour("C", "scan Flat") + ", " + behaviour("S", "laser_off Flat 12")));
  EXPECT_THAT(said(trace), Contains("Rig/C: tick 13 delay 0.009:"));  // the ranges are empty now
  EXPECT_THAT(said(trace), Contains("Rig/C: tick 38 delay 0.009: inf 2 2.27899"));
  EXPECT_THAT(said(trace), Not(Contains(HasSubstr("tick 20"))));
  EXPECT_THAT(topics(trace, "/Rig/S/output/Flat"), ElementsAre("/Rig/S/output/Flat/state"));
}

TEST_F(RangeSensorRuns, ReplayScansBitForBit) {
  record_run(before_a_wall(behaviour("C", "scan Flat") + ", " + behaviour("D", "scan Deep") + ", " +
                               behaviour("S", "laser_off Flat 12") + ", " + behaviour("T", "laser_off Deep 22"),
                           "0.08"));
  expect_replays();
  const std::vector<double> sums = Trace::load(path("run.mcap"))->values("Rig/D/output/SHOULDER/u");
  EXPECT_NE(sums[4], sums[5]);
  EXPECT_NE(sums[22], sums[23]);
}

TEST_F(RangeSensorRuns, AreRecordedTwiceWithTheSameBytes) {
  const std::string run = before_a_wall(behaviour("C", "scan Deep") + ", " + behaviour("D", "drive velocity 3"));
  record_run(run, "a.mcap");
  record_run(run, "b.mcap");
  EXPECT_EQ(bytes("a.mcap"), bytes("b.mcap"));
}

TEST_F(RangeSensorRuns, ChangeNothingInThePhysics) {
  const std::string turning = before_a_wall(behaviour("C", "push 1"));
  const std::vector<double> with = record_run(turning).values("Rig/SHOULDER/q");
  std::string blind = turret_urdf;
  for (std::size_t at; (at = blind.find("<sensor")) != std::string::npos;)
    blind.erase(at, blind.find("</sensor>", at) + 9 - at);
  write("rig.urdf", blind);
  EXPECT_EQ(record_run(turning).values("Rig/SHOULDER/q"), with);
}

TEST_F(RangeSensorRuns, RefuseToReplayAScanOfAnotherNumberOfBeams) {
  record_run(before_a_wall(behaviour("C", "scan Flat")));
  EXPECT_TRUE(replay_run().ok());
  // the same recording, with a scenario whose sensor has four beams
  auto reader = mcap::Reader::open(path("run.mcap"));
  auto writer = mcap::Writer::create(path("other.mcap"));
  ASSERT_TRUE(reader.ok() && writer.ok());
  std::string urdf = turret_urdf;
  urdf.replace(urdf.find("<samples>3"), 10, "<samples>4");
  for (const auto& attachment : (*reader)->attachments()) {
    const bool is_model = attachment.name == "rig.urdf";
    const auto data = is_model ? std::as_bytes(std::span(urdf)) : std::span<const std::byte>(attachment.data);
    ASSERT_TRUE((*writer)->add_attachment(attachment.name, attachment.media_type, data));
  }
  for (const auto& record : (*reader)->metadata()) ASSERT_TRUE((*writer)->add_metadata(record.name, record.values));
  std::map<std::uint16_t, std::uint16_t> channels;
  ASSERT_TRUE((*reader)->for_each_message([&](const mcap::Message& message) {
    std::uint16_t& channel = channels[message.channel->id];
    const mcap::Schema& schema = *(*reader)->schema_of(*message.channel);
    if (!channel)
      channel = (*writer)->add_channel((*writer)->add_schema(schema.name, schema.encoding, schema.data),
                                       message.channel->topic, "cdr", message.channel->metadata);
    return (*writer)->write(channel, message.log_time, message.publish_time, message.data).ok();
  }));
  ASSERT_TRUE((*writer)->close());
  const auto refused = replay_run({}, "other.mcap");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.errors()[0].message, HasSubstr("is not a measurement of device 'Flat'"));
}

}  // namespace
}  // namespace rehearse
