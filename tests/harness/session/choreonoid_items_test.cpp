// What a scenario states of Choreonoid's simulator items: limits of drives, contacts, commands of initialize(); and the
// order in which Choreonoid copies outputs and inputs.
#include <ostream>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

/// A wheel of 0.5 kg·m² whose joint has limits.
constexpr const char* wheel_urdf = R"(<?xml version="1.0"?>
<robot name="Wheel">
  <link name="world"/>
  <joint name="SHOULDER" type="revolute">
    <parent link="world"/><child link="RIM"/><axis xyz="0 1 0"/>
    <limit lower="-9" upper="9" effort="1" velocity="0.1"/>
  </joint>
  <link name="RIM">
    <inertial><mass value="1"/><inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.5"/></inertial>
  </link>
</robot>
)";

class ChoreonoidItems : public RunTest {
 protected:
  ChoreonoidItems() { write("wheel.urdf", wheel_urdf); }

  static std::string wheel(const std::string& keys, const std::string& controllers, const std::string& head = "") {
    return "rehearse: 1\nduration: 0.005\n" + head + "bodies:\n  - {name: Rig, model: wheel.urdf" + keys +
           ", controllers: [" + controllers + "]}\n";
  }
  static std::string box(const std::string& controllers) {
    return "rehearse: 1\nduration: 0.004\ngravity: [0, 0, 0]\nbodies:\n  - {name: Rig, box: {size: [1, 1, 1]}, mass: "
           "1, "
           "controllers: [" +
           controllers + "]}\n";
  }
  /// The joint's velocity after the first step, in which the command acts.
  double speed(const std::string& keys, const std::string& options) {
    return record_run(wheel(keys, behaviour("C", options, ", delay: false"))).values("Rig/SHOULDER/dq").at(1);
  }
  void expect_equal_replay() {
    const auto report = replay_run();
    ASSERT_TRUE(report.ok()) << to_string(report.errors());
    EXPECT_EQ(report->values_different, 0);
  }
};

// --- The table of items, modes and limits

constexpr const char* aist = ", effort_limits: true, drive_limits: false";
constexpr const char* ode = ", drive_limits: false";

TEST_F(ChoreonoidItems, AistClampsEffortsAndOdeDoesNot) {
  EXPECT_NEAR(speed(aist, "drive effort 5"), 0.002, 1e-9);
  EXPECT_NEAR(speed(ode, "drive effort 5"), 0.01, 1e-9);
}

TEST_F(ChoreonoidItems, NeitherLimitsDrivesOfVelocity) {
  EXPECT_NEAR(speed(aist, "drive velocity 3"), 3.0, 1e-6);
  EXPECT_NEAR(speed(ode, "drive velocity 3"), 3.0, 1e-6);
  EXPECT_NEAR(speed("", "drive velocity 3"), 0.002, 1e-9);
}

TEST_F(ChoreonoidItems, DrivesOfDisplacementReachTheirCommandInTheStep) {
  const std::string command = behaviour("C", "drive displacement 0.3", ", delay: false");
  EXPECT_NEAR(record_run(wheel(aist, command)).values("Rig/SHOULDER/q").at(1), 0.3, 1e-6);
  EXPECT_LT(record_run(wheel("", command)).last("Rig/SHOULDER/q"), 0.001);
  EXPECT_THAT(said(record_run(wheel(aist, command))), ElementsAre("Rig/C: mode 1")) << "no effort is the largest";
}

TEST_F(ChoreonoidItems, DriveLimitsOfAKinematicBodyDoNothing) {
  const Scenario scenario = load(wheel(", dynamics: kinematic, drive_limits: false", ""));
  ASSERT_FALSE(scenario.warnings.empty());
  EXPECT_THAT(scenario.warnings.front().message, HasSubstr("drive_limits does nothing"));
}

TEST_F(ChoreonoidItems, HighGainActuationIsAWarningAndTheOtherFlagDrives) {
  const Trace trace = record_run(wheel(aist, behaviour("C", "drive high_gain 0.3", ", delay: false")));
  EXPECT_THAT(said(trace), Contains(HasSubstr("HighGainActuation has no effect on link 'RIM'")));
  EXPECT_NEAR(trace.values("Rig/SHOULDER/q").at(1), 0.3, 1e-6);
}

// --- Contacts

/// A slab 1 mm above a plate, after 0.3 s.
std::string slab_on_plate(const std::string& of_slab, const std::string& of_plate) {
  return "rehearse: 1\nduration: 0.3\nbodies:\n  - {name: Plate, box: {size: [1, 1, 0.1]}, fixed: true" + of_plate +
         "}\n  - {name: Slab, box: {size: [0.4, 0.4, 0.1]}, mass: 1, position: [0, 0, 0.101]" + of_slab + "}\n";
}

TEST_F(ChoreonoidItems, ABodyWithoutCollisionFallsThroughOthers) {
  const auto height = [&](const std::string& text) { return record_run(text).last("Slab/Slab/position/z"); };
  EXPECT_NEAR(height(slab_on_plate("", "")), 0.1, 1e-3);
  const double fallen = 0.101 - 0.5 * 9.80665 * 0.3 * 0.3;
  EXPECT_NEAR(height(slab_on_plate(", collision: none", "")), fallen, 2e-3);
  EXPECT_NEAR(height(slab_on_plate("", ", collision: none")), fallen, 2e-3);
}

TEST_F(ChoreonoidItems, SelfCollisionOfABodyWithoutCollisionDoesNothing) {
  const Scenario scenario = load(wheel(", collision: none, self_collision: true", ""));
  ASSERT_FALSE(scenario.warnings.empty());
  EXPECT_THAT(scenario.warnings.front().message, HasSubstr("self_collision does nothing"));
}

// --- Commands of initialize()

TEST_F(ChoreonoidItems, CommandsOfInitializeActInTheFirstStepIfTheScenarioSaysSo) {
  const Trace without = record_run(rig_with("early"));
  EXPECT_EQ(without.values("Rig/SHOULDER/dq").at(1), 0.0);
  const Trace with = record_run(rig(behaviour("C", "early"), "cameras: none\ninitial_commands: true\n"));
  EXPECT_NEAR(with.values("Rig/SHOULDER/dq").at(1), 0.01, 1e-9);
  EXPECT_NEAR(with.values("Rig/SHOULDER/dq").at(2), 0.02, 1e-9);
  expect_equal_replay();
}

/// Of a controller whose other commands are equal.
TEST_F(ChoreonoidItems, AReplayComparesTheCommandsOfInitializeThatAct) {
  ReplayOptions options;
  options.run_options = "softer";
  const auto replayed = [&](const char* keys) {
    record_run(rig(behaviour("C", "early once"), std::string("cameras: none\n") + keys));
    return replay_run(options);
  };
  const auto report = replayed("initial_commands: true\n");
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  ASSERT_TRUE(report->first);
  EXPECT_EQ(report->values_different, 1);
  EXPECT_EQ(report->first->tick, 0);
  EXPECT_EQ(report->first->channel, "/Rig/C/output/joints");
  EXPECT_EQ(report->first->element, "initialize/SHOULDER/u");
  EXPECT_EQ(report->first->expected, 5.0);
  EXPECT_EQ(report->first->actual, 4.0);
  EXPECT_FALSE(report->commands_hold);
  EXPECT_FALSE(report->repeats_the_run);
  ASSERT_TRUE(write_replay(path("run.mcap"), path("again.mcap"), options).ok());
  const auto again = Trace::load(path("again.mcap"));
  ASSERT_TRUE(again.ok());
  ASSERT_TRUE(again->find_metadata("rehearse.initial_commands"));
  EXPECT_EQ(again->find_metadata("rehearse.initial_commands")->at("Rig/SHOULDER u"), "4");
  const auto without = replayed("");
  ASSERT_TRUE(without.ok()) << to_string(without.errors());
  EXPECT_FALSE(without->first) << "what initialize() writes has no effect there";
}

TEST_F(ChoreonoidItems, CommandsOfInitializeAreReadBackInTheFirstCall) {
  const std::string both = behaviour("B", "echo effort 1") + ", " + behaviour("A", "early");
  const auto first = [&](const std::string& head) {
    for (const std::string& line : said_by_controllers(record_run(rig(both, "cameras: none\n" + head, "0.002"))))
      if (line.starts_with("Rig/B: ")) return line;
    return std::string();
  };
  EXPECT_EQ(first("initial_commands: true\n"), "Rig/B: 5");
  EXPECT_EQ(first(""), "Rig/B: 0");
}

/// AIST's item sets external wrenches to zero before its first step, as every other item.
TEST_F(ChoreonoidItems, AnExternalForceOfInitializeIsLost) {
  const Trace trace = record_run("initial_commands: true\n" + box(behaviour("C", "early_force")));
  EXPECT_THAT(said_by_controllers(trace), Contains("Rig/C: 0"));
  EXPECT_THAT(said_by_controllers(trace), ::testing::Not(Contains("Rig/C: 7")));
  EXPECT_EQ(trace.last("Rig/Rig/position/x"), 0.0);
  expect_equal_replay();
}

// --- Children of children

TEST_F(ChoreonoidItems, AChildOfAChildIsStartedAndStoppedAndNeverCalled) {
  const std::string family =
      "{name: A, library: Behaviours, options: \"calls a\", children: [{name: B, library: "
      "Behaviours, options: \"calls b\", children: [" +
      behaviour("C", "calls c") + "]}]}";
  const Trace trace = record_run(wheel("", family, "cameras: none\n"));
  const std::vector<std::string> lines = said(trace);
  for (const char* line : {"Rig/C: c initialize", "Rig/C: c start", "Rig/C: c stop", "Rig/B: b control"})
    EXPECT_THAT(lines, Contains(line));
  EXPECT_THAT(lines, ::testing::Not(Contains("Rig/C: c control")));
  EXPECT_THAT(lines, Contains(HasSubstr("is a child of a child: it is started and stopped")));
  expect_equal_replay();
}

// --- The name for controllers

TEST_F(ChoreonoidItems, ControllersReadTheTitleOfTheirBody) {
  const std::string text = wheel(", title: My wheel", behaviour("C", "body_name"));
  EXPECT_THAT(said_by_controllers(record_run(text)), Contains("Rig/C: My wheel"));
}

// --- Outputs that are read back: flag x delay x controllers

struct ReadBack {
  const char* flag;
  const char* first;              // "nodelay" or ""
  const char* second;             // likewise; null: there is one controller
  std::vector<std::string> read;  // by the first, in its first calls
};

void PrintTo(const ReadBack& row, std::ostream* stream) {
  *stream << row.flag << " " << row.first << "/" << (row.second ? row.second : "alone");
}

class ReadsBack : public ChoreonoidItems, public ::testing::WithParamInterface<ReadBack> {};

/// The first commands 1, 2, 3, ...; the second, after it, 11, 12, 13, ...
TEST_P(ReadsBack, WhatChoreonoidDoes) {
  const ReadBack& row = GetParam();
  std::string controllers = behaviour("A", std::string("echo ") + row.flag + " 1 " + row.first);
  if (row.second) controllers += ", " + behaviour("B", std::string("echo ") + row.flag + " 11 " + row.second);
  const std::string flag = row.flag;
  const bool of_joint = flag == "effort" || flag == "acceleration" || flag == "displacement" || flag == "velocity";
  const Trace trace = record_run(of_joint ? rig(controllers, "cameras: none\n", "0.004") : box(controllers));
  std::vector<std::string> read;
  for (const std::string& line : said_by_controllers(trace))
    if (line.starts_with("Rig/A: ") && line.size() < 12) read.push_back(line.substr(7));
  EXPECT_THAT(read, ElementsAreArray(row.read));
  expect_equal_replay();
}

const std::vector<std::string> own{"0", "1", "2", "3"}, late{"0", "0", "1", "2"}, none{"0", "0", "0", "0"},
    of_second{"0", "11", "12", "13"}, sums{"0", "12", "14", "16"};

INSTANTIATE_TEST_SUITE_P(
    Table, ReadsBack,
    ::testing::Values(
        // displacements and velocities are read from the state, and go to targets
        ReadBack{"displacement", "", nullptr, late}, ReadBack{"displacement", "nodelay", nullptr, own},
        ReadBack{"velocity", "", nullptr, late}, ReadBack{"velocity", "nodelay", nullptr, own},
        // an effort stays until the next output, whose last writer wins
        ReadBack{"effort", "", nullptr, own}, ReadBack{"effort", "nodelay", nullptr, own},
        ReadBack{"effort", "", "", of_second}, ReadBack{"effort", "", "nodelay", own},
        ReadBack{"effort", "nodelay", "", of_second}, ReadBack{"effort", "nodelay", "nodelay", of_second},
        // an external wrench is a sum, and each step sets it to zero
        ReadBack{"wrench", "", nullptr, own}, ReadBack{"wrench", "nodelay", nullptr, none},
        ReadBack{"wrench", "", "", sums}, ReadBack{"wrench", "nodelay", "", of_second},
        ReadBack{"wrench", "", "nodelay", own},
        // the step computes accelerations anew
        ReadBack{"acceleration", "", nullptr, own}, ReadBack{"acceleration", "nodelay", nullptr, none},
        ReadBack{"acceleration", "", "", of_second}, ReadBack{"link_acceleration", "", nullptr, own},
        ReadBack{"link_acceleration", "nodelay", nullptr, none},
        // a pose and a twist are those of the state afterwards
        ReadBack{"position", "", nullptr, own}, ReadBack{"position", "nodelay", nullptr, own},
        ReadBack{"position", "", "", of_second}, ReadBack{"twist", "", nullptr, own},
        ReadBack{"twist", "nodelay", nullptr, own}, ReadBack{"twist", "", "", of_second}));

}  // namespace
}  // namespace rehearse
