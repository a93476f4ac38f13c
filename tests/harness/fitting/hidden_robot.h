// Simulated robots whose numbers a test knows, and recordings of them as a robot would make them: joints measured with
// noise, no checkpoints.
#pragma once

#include <rehearse/fit.h>
#include <rehearse/scenario.h>
#include <rehearse/session.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace rehearse::test {

inline constexpr const char* pendulum_urdf = R"(<?xml version="1.0"?>
<robot name="Pendulum">
  <link name="BASE"><inertial><mass value="5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="SHOULDER" type="continuous">
    <parent link="BASE"/><child link="ARM"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
  </joint>
  <link name="ARM">
    <inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.002"/></inertial>
  </link>
</robot>
)";

inline constexpr const char* two_links_urdf = R"(<?xml version="1.0"?>
<robot name="Arm">
  <link name="BASE"><inertial><mass value="5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="SHOULDER" type="continuous">
    <parent link="BASE"/><child link="UPPER"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
  </joint>
  <link name="UPPER">
    <inertial><origin xyz="0 0 -0.15"/><mass value="1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.001"/></inertial>
  </link>
  <joint name="ELBOW" type="continuous">
    <parent link="UPPER"/><child link="LOWER"/><origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/>
  </joint>
  <link name="LOWER">
    <inertial><origin xyz="0 0 -0.15"/><mass value="0.7"/>
      <inertia ixx="0.006" ixy="0" ixz="0" iyy="0.006" iyz="0" izz="0.001"/></inertial>
  </link>
</robot>
)";

class HiddenRobot : public ::testing::Test {
 protected:
  HiddenRobot() {
    setenv("REHEARSE_CONTROLLER_PATH", TEST_CONTROLLERS, 1);
    folder_.write("pendulum.urdf", pendulum_urdf);
    folder_.write("arm.urdf", two_links_urdf);
  }

  /// The scenario of a robot. `rules`: lines of the body; `options`: of its controller.
  static std::string scenario(const std::string& model, const std::string& rules, const std::string& options = "1",
                              double duration = 4.0, int seed = 1) {
    return fmt::format(
        "rehearse: 1\nduration: {}\ntime_step: 0.001\nseed: {}\nbodies:\n  - name: Robot\n    model: {}.urdf\n"
        "    fixed: true\n    controllers: [{{name: Shake, library: Shaker, options: \"{}\"}}]\n{}",
        duration, seed, model, options, rules);
  }
  static constexpr const char* noise =
      "noise:\n  - {joint: \"Robot/*\", displacement: {stddev: 0.0005}, velocity: {stddev: 0.01}}\n";

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Records a robot that has these numbers. `checkpoint_period` 0: as a robot, without complete states.
  std::string fly(const std::string& name, const std::string& text, double checkpoint_period = 0.0) const {
    folder_.write(name + ".yaml", text);
    const auto hidden = Scenario::load(folder_ / (name + ".yaml"));
    if (!hidden) {
      ADD_FAILURE() << to_string(hidden.errors());
      return {};
    }
    RecordOptions options;
    options.checkpoint_period = checkpoint_period;
    const auto made = record(*hidden, folder_ / (name + ".mcap"), options);
    EXPECT_TRUE(made) << (made ? "" : to_string(made.errors()));
    return path(name + ".mcap");
  }
  /// Fits the numbers of a model on paper.
  Result<FitResult> fit_to(const std::vector<std::string>& recordings, const std::string& paper,
                           const std::vector<FitRequest>& vary, std::size_t jobs = 2) const {
    folder_.write("paper.yaml", paper);
    FitOptions options;
    options.vary = vary;
    options.jobs = jobs;
    return fit(folder_ / "paper.yaml", recordings, options);
  }

  const TemporaryFolder folder_;
};

}  // namespace rehearse::test
