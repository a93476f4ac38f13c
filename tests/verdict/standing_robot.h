// A standing robot, watched by a camera, as files in a scratch folder, into which tests introduce faults.
#pragma once

#include <rehearse/check.h>
#include <rehearse/session.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <string>

#include "core/golden/state_samples.h"
#include "core/trace/filter.h"
#include "small_traces.h"
#include "support/files.h"

namespace rehearse {

/// A wall with a camera that looks at the robot, and two lamps.
inline constexpr const char* watcher_urdf = R"(<?xml version="1.0"?>
<robot name="Watcher">
  <link name="WALL"/>
  <gazebo reference="WALL">
    <light name="Lamp" type="point"><pose>0 1 1 0 0 0</pose><intensity>0.5</intensity></light>
    <light name="SecondLamp" type="point"><pose>0 -1 1 0 0 0</pose><intensity>0.5</intensity></light>
    <sensor name="Eye" type="camera">
      <pose>0 0 0 0 0 0</pose>
      <update_rate>20</update_rate>
      <camera><horizontal_fov>1.0471975511965976</horizontal_fov><image><width>96</width><height>72</height></image></camera>
    </sensor>
  </gazebo>
</robot>
)";

inline constexpr const char* standing_yaml = R"(rehearse: 1
duration: 0.6
seed: 7
solver: {friction: 1}
bodies:
  - name: Floor
    box: {size: [10, 10, 0.2], color: [0.2, 0.4, 0.8]}
    fixed: true
    position: [0, 0, -0.1]
  - name: Watcher
    model: watcher.urdf
    position: [2, 0, 1]
    rotation: [0, 0, 180 deg]
  - name: SR1
    model: sr1.urdf
    position: [0, 0, 0.7135]
    joints: {RLEG_HIP_P: -2.1 deg, RLEG_KNEE: 4.50001 deg, RLEG_ANKLE_P: -2.40001 deg, LLEG_HIP_P: -2.1 deg,
             LLEG_KNEE: 4.50001 deg, LLEG_ANKLE_P: -2.40001 deg, RARM_ELBOW: -90 deg, LARM_ELBOW: -90 deg}
    controllers: [{name: Stand, library: StandWith_none}]
noise:
  - {sensor: SR1/WaistGyro, angular_velocity: {stddev: 0.001}}
cameras: [Watcher/Eye]
)";

/// Changes a text of the scratch folder.
struct Edit {
  const char* file;
  const char* from;
  const char* to;
};

class StandingRobot {
 public:
  StandingRobot() {
    setenv("REHEARSE_CONTROLLER_PATH", VERDICT_CONTROLLERS, 1);
    write("watcher.urdf", watcher_urdf);
    write("scenario.yaml", standing_yaml);
    write("sr1.urdf", test::read_file(FIXTURES_DIR "/models/sr1.urdf"));
  }

  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file, std::ios::binary) << text;
  }
  void apply(const Edit& edit) const {
    std::string text = test::read_file(folder_ / edit.file);
    const std::size_t at = text.find(edit.from);
    ASSERT_NE(at, std::string::npos) << edit.from << " is not in " << edit.file;
    write(edit.file, text.replace(at, std::string(edit.from).size(), edit.to));
  }
  Scenario scenario() const {
    auto loaded = Scenario::load(folder_ / "scenario.yaml");
    EXPECT_TRUE(loaded.ok()) << to_string(loaded.errors());
    return *std::move(loaded);
  }
  void record_golden(const RecordOptions& options = {}) const {
    const auto made = record(scenario(), folder_ / "golden.mcap", options);
    ASSERT_TRUE(made.ok() && !made->failure) << to_string(made.ok() ? Diagnostics{*made->failure} : made.errors());
  }
  /// Of the golden's state only samples remain. Returns the channels that keep all ticks.
  std::set<std::string> keep_samples(double rate) const {
    const auto golden = Trace::load(file("golden.mcap"));
    EXPECT_TRUE(golden.ok());
    Scenario wish;
    wish.golden_state_rate = rate;
    mcap::FilterOptions samples;
    samples.samples = state_rate_of(wish, *golden);
    const auto reduced = mcap::filter(file("golden.mcap"), file("samples.mcap"), samples);
    EXPECT_TRUE(reduced.ok()) << to_string(reduced.errors());
    std::filesystem::rename(file("samples.mcap"), file("golden.mcap"));
    return samples.samples->whole;
  }
  Result<CheckReport> check(const CheckOptions& options = {},
                            const Simulation& simulation = {record, run_plant}) const {
    return check_scenario(scenario(), folder_ / "golden.mcap", folder_ / "actual.mcap", options, simulation);
  }
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }

 private:
  testing::TemporaryFolder folder_;
};

}  // namespace rehearse
