// A folder, a robot, and functions to record and replay small scenarios, for tests of the closed loop.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/messages.h>
#include <rehearse/replay.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {

/// A wheel on a shaft (joint SHOULDER, about y, 0.5 kg·m², its centre on the axis) and a sled on a rail (joint RAIL,
/// along x, 2 kg), both fixed to the world and not affected by gravity; one sensor of each kind on the wheel, a camera
/// on the sled.
inline constexpr const char* rig_urdf = R"(<?xml version="1.0"?>
<robot name="Rig">
  <link name="world"/>
  <joint name="SHOULDER" type="continuous">
    <parent link="world"/><child link="ARM"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
  </joint>
  <link name="ARM">
    <inertial><mass value="1"/><inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.5"/></inertial>
    <visual><geometry><box size="0.4 0.1 0.1"/></geometry></visual>
  </link>
  <joint name="RAIL" type="prismatic">
    <parent link="world"/><child link="SLED"/><origin xyz="0 2 1"/><axis xyz="1 0 0"/>
    <limit lower="-100" upper="100" effort="1000" velocity="1000"/>
  </joint>
  <link name="SLED">
    <inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <gazebo reference="ARM">
    <sensor name="Accelerometer" type="accelerometer"/>
    <sensor name="Gyro" type="gyroscope"/>
    <sensor name="Imu" type="imu"/>
    <sensor name="Force" type="force_torque"/>
  </gazebo>
  <gazebo reference="SLED">
    <sensor name="Camera" type="depth_camera">
      <pose>0 0 0 0 0 -1.5707963267948966</pose>
      <update_rate>200</update_rate>
      <camera><image><width>16</width><height>12</height></image></camera>
    </sensor>
  </gazebo>
</robot>
)";

class RunTest : public ::testing::Test {
 protected:
  RunTest() {
    setenv("REHEARSE_CONTROLLER_PATH", TEST_CONTROLLERS, 1);
    write("rig.urdf", rig_urdf);
  }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }

  std::string bytes(const std::string& name) const { return test::read_file(path(name)); }

  /// A controller of Behaviours.so, as an entry of `controllers:`; `more` as ", delay: false".
  static std::string behaviour(const std::string& name, const std::string& options, const std::string& more = "") {
    return "{name: " + name + ", library: Behaviours, options: \"" + options + "\"" + more + "}";
  }

  /// 20 ticks of the robot with these controllers; `more` are additional lines of the scenario, which may override
  /// others.
  static std::string rig(const std::string& controllers, const std::string& more = "cameras: none\n",
                         const std::string& duration = "0.02") {
    return "rehearse: 1\nduration: " + duration + "\n" + more +
           "bodies:\n  - name: Rig\n    model: rig.urdf\n    joints: {RAIL: 0.25}\n    controllers: [" + controllers +
           "]\n";
  }

  static std::string rig_with(const std::string& options) { return rig(behaviour("C", options)); }

  Scenario load(const std::string& text) const {
    write("run.yaml", text);
    auto scenario = Scenario::load(path("run.yaml"));
    if (scenario) return *std::move(scenario);
    ADD_FAILURE() << to_string(scenario.errors()) << text;
    return {};
  }

  /// Records into `file` in the test's folder; the summary is in summary_. Also checks that the recorded commands alone
  /// move the world in the same way.
  Trace record_run(const std::string& text, const std::string& file = "run.mcap", double call_limit = 10.0) {
    RecordOptions options;
    options.call_limit = call_limit;
    const Scenario scenario = load(text);
    auto summary = record(scenario, path(file), options);
    if (!summary) {
      ADD_FAILURE() << to_string(summary.errors());
      return {};
    }
    summary_ = *summary;
    auto trace = Trace::load(path(file));
    if (!trace) {
      ADD_FAILURE() << to_string(trace.errors());
      return {};
    }
    if (!summary_.failure) expect_the_same_without_controllers(scenario, *trace);
    return *std::move(trace);
  }

  void expect_the_same_without_controllers(const Scenario& scenario, const Trace& recording) const {
    const auto run = run_plant(scenario, recording, path("plant.mcap"));
    ASSERT_TRUE(run.ok()) << to_string(run.errors());
    EXPECT_FALSE(run->failure);
    const auto trace = Trace::load(path("plant.mcap"));
    ASSERT_TRUE(trace.ok()) << to_string(trace.errors());
    CompareOptions what;
    what.stages = {Stage::physics, Stage::sensors, Stage::renderer};
    const Comparison comparison = compare(recording, *trace, {}, what);
    EXPECT_TRUE(comparison.equal) << "under the recorded commands: " << verdict(comparison) << "\n"
                                  << table(comparison);
  }

  /// Replays `file`, with different libraries if given.
  Result<ReplayReport> replay_run(const ReplayOptions& options = {}, const std::string& file = "run.mcap") const {
    return replay(path(file), options);
  }

  const test::TemporaryFolder folder_;
  RunSummary summary_;
};

/// "source: text" of each event of the trace, in order.
inline std::vector<std::string> said(const Trace& trace) {
  std::vector<std::string> lines;
  for (const msg::Event& event : trace.events()) lines.push_back(event.source + ": " + event.text);
  return lines;
}

/// Likewise, without what the world says.
inline std::vector<std::string> said_by_controllers(const Trace& trace) {
  std::vector<std::string> lines = said(trace);
  std::erase_if(lines, [](const std::string& line) { return line.starts_with("world: "); });
  return lines;
}

/// The names of the trace's topics that begin with this text.
inline std::vector<std::string> topics(const Trace& trace, const std::string& prefix) {
  std::vector<std::string> names;
  for (const TraceChannel& channel : trace.channels())
    if (channel.topic.starts_with(prefix)) names.push_back(channel.topic);
  return names;
}

/// The elements of a topic's numbers; empty if there is no such topic.
inline std::vector<std::string> elements(const Trace& trace, const std::string& topic) {
  std::vector<std::string> names;
  const TraceChannel* channel = trace.find_channel(topic);
  if (!channel) return names;
  for (const TraceColumn& column : channel->columns) names.push_back(column.element);
  return names;
}

}  // namespace rehearse
