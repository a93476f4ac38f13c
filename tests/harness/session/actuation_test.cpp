// Drives of a robot's joints and links, from the view of a controller and its scenario; and warnings about modes
// without effect.

#include <cmath>

#include "core/kinds/channel_name.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Two fingers on rails, of which the second follows, and a belt.
constexpr const char* gripper_urdf = R"(<?xml version="1.0"?>
<robot name="Gripper">
  <link name="world"/>
  <joint name="LEFT" type="prismatic">
    <parent link="world"/><child link="LEFT_FINGER"/><axis xyz="1 0 0"/>
    <limit lower="-0.01" upper="0.002" effort="3" velocity="10"/>
  </joint>
  <joint name="RIGHT" type="prismatic">
    <parent link="world"/><child link="RIGHT_FINGER"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="100" velocity="10"/>
    <mimic joint="LEFT" multiplier="-1" offset="0.5"/>
  </joint>
  <joint name="BELT" type="continuous">
    <parent link="world"/><child link="BELT_LINK"/><axis xyz="0 1 0"/>
  </joint>
  <link name="LEFT_FINGER"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="RIGHT_FINGER"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="BELT_LINK"/>
  <gazebo reference="BELT"><pseudo_continuous_track/></gazebo>
</robot>
)";

/// A slab whose top is at z = 0, behind a fixed joint.
constexpr const char* conveyor_urdf = R"(<?xml version="1.0"?>
<robot name="Conveyor">
  <link name="world"/>
  <joint name="FRAME" type="fixed">
    <parent link="world"/><child link="SLAB"/><origin xyz="0 0 -0.1"/>
  </joint>
  <link name="SLAB"><collision><geometry><box size="4 1 0.2"/></geometry></collision></link>
</robot>
)";

class Actuation : public RunTest {
 protected:
  Actuation() {
    write("gripper.urdf", gripper_urdf);
    write("conveyor.urdf", conveyor_urdf);
  }

  /// 20 ticks of a body; `body` are its further lines, as "fixed: true, ".
  static std::string scenario(const std::string& body, const std::string& controllers) {
    return "rehearse: 1\nduration: 0.02\nbodies:\n  - {name: Rig, " + body + ", controllers: [" + controllers + "]}\n";
  }
  static std::string gripper(const std::string& options, const std::string& more = "") {
    return scenario("model: gripper.urdf" + more, behaviour("C", options));
  }
  static std::string free_box(const std::string& options) {
    return scenario("box: {size: [1, 1, 1]}, mass: 3, position: [0, 0, 2]", behaviour("C", options));
  }
  static std::string kinematic_box(const std::string& options) {
    return scenario("box: {size: [1, 1, 1]}, dynamics: kinematic, position: [0, 0, 2]", behaviour("C", options));
  }

  /// A box of 1 kg lies on the conveyor, whose surface is commanded to run at 0.7 m/s.
  static std::string conveyor(const std::string& more) {
    return "rehearse: 1\nduration: 0.5\nbodies:\n  - {name: Rig, model: conveyor.urdf" + more + ", controllers: [" +
           behaviour("C", "drive surface 0.7 SLAB") +
           "]}\n  - {name: Box, box: {size: [0.1, 0.1, 0.1]}, mass: 1, position: [-1, 0, 0.05]}\n";
  }

  void expect_equal_replay() {
    const auto report = replay_run();
    ASSERT_TRUE(report.ok()) << to_string(report.errors());
    EXPECT_EQ(report->values_different, 0);
    EXPECT_GT(report->values, 0);
  }
};

TEST_F(Actuation, AKinematicBodysRootGoesWhereLinkPositionSays) {
  const Trace trace = record_run(kinematic_box("teleport"));
  const std::vector<double> x = trace.values("Rig/Rig/position/x");
  for (std::size_t tick = 2; tick < x.size(); ++tick)
    ASSERT_NEAR(x[tick], 0.001 * static_cast<double>(tick - 1), 1e-15);
  EXPECT_THAT(trace.values("Rig/Rig/position/z"), Each(2.0));  // it doesn't fall
  EXPECT_NEAR(trace.last("Rig/Rig/linear/x"), 1.0, 1e-9);
  EXPECT_THAT(said(trace), IsEmpty());
  expect_equal_replay();
}

TEST_F(Actuation, ASimulatedBodysRootGoesWhereLinkPositionSays) {
  const Trace trace = record_run(free_box("teleport"));
  const std::vector<double> x = trace.values("Rig/Rig/position/x");
  for (std::size_t tick = 2; tick < x.size(); ++tick)
    ASSERT_NEAR(x[tick], 0.001 * static_cast<double>(tick - 1), 1e-12);
  EXPECT_NEAR(trace.last("Rig/Rig/position/z"), 2.0, 1e-4);  // it falls in the step before its first command acts
  EXPECT_THAT(said(trace), IsEmpty());
  expect_equal_replay();
}

TEST_F(Actuation, ASimulatedBodysRootHasTheVelocitiesThatLinkTwistSays) {
  const Trace trace = record_run(free_box("spin 2.0"));
  EXPECT_NEAR(trace.last("Rig/Rig/angular/z"), 2.0, 1e-12);
  EXPECT_NEAR(trace.last("Rig/Rig/linear/z"), 0.0, 1e-12);
  EXPECT_THAT(said(trace), IsEmpty());
  expect_equal_replay();
}

TEST_F(Actuation, AReplayedCommandHasTheUnitThatTheRecordingStates) {
  const Trace trace = record_run(kinematic_box("teleport"));
  std::vector<OutputField> fields;
  ReplayOptions options;
  options.on_started = [&fields](const std::vector<OutputField>& all) { fields = all; };
  options.on_outputs = [](std::int64_t, const std::vector<std::uint64_t>&) {};
  ASSERT_TRUE(replay_run(options).ok());
  std::vector<std::string> units;
  for (const OutputField& field : fields) {
    const TraceChannel* channel = trace.find_channel(field.channel);
    if (!channel || field.kind != CellKind::floating) continue;
    EXPECT_EQ(field.unit, unit_of(channel->metadata, field.element)) << field.element;
    units.push_back(field.unit);
  }
  EXPECT_THAT(units, Contains("quaternion"));
}

TEST_F(Actuation, AKinematicBodysJointsGoWhereTheyAreCommanded) {
  const Trace trace =
      record_run(scenario("model: rig.urdf, dynamics: kinematic", behaviour("C", "drive displacement 0.3")));
  EXPECT_EQ(trace.values("Rig/SHOULDER/q")[2], 0.3);
  EXPECT_EQ(trace.last("Rig/SHOULDER/q"), 0.3);
  expect_equal_replay();
}

TEST_F(Actuation, AKinematicBodyTakesNoEfforts) {
  const Trace trace = record_run(scenario("model: rig.urdf, dynamics: kinematic", behaviour("C", "drive effort 1")));
  EXPECT_EQ(trace.last("Rig/SHOULDER/q"), 0.0);
  EXPECT_THAT(said(trace),
              Contains("Rig/C: joint 'SHOULDER' can't be driven by JointEffort: its body is kinematic, and "
                       "moves by JointDisplacement or JointVelocity"));
}

TEST_F(Actuation, OnlyTheRootOfAKinematicBodyTakesAPosition) {
  const Trace trace = record_run(scenario("model: rig.urdf, dynamics: kinematic", behaviour("C", "teleport ARM")));
  EXPECT_THAT(said(trace),
              Contains(HasSubstr("link 'ARM' can't be moved by command: of a kinematic body only the root")));
}

TEST_F(Actuation, ARootThatIsFixedTakesNoPosition) {
  const Trace trace = record_run(scenario("model: rig.urdf, dynamics: kinematic", behaviour("C", "teleport")));
  EXPECT_THAT(said(trace), Contains(HasSubstr("link 'world' can't be moved by command: it is fixed to the world")));
}

TEST_F(Actuation, EffortsAreClampedOnlyIfTheScenarioSaysSo) {
  EXPECT_NEAR(record_run(gripper("drive effort 5 LEFT")).values("Rig/LEFT/dq")[2], 0.0025, 1e-9);  // both fingers
  const Trace clamped = record_run(gripper("drive effort 5 LEFT", ", effort_limits: true"));
  EXPECT_NEAR(clamped.values("Rig/LEFT/dq")[2], 0.0015, 1e-9);
  EXPECT_EQ(clamped.last("Rig/C/output/LEFT/u"), 5.0);  // the controller's command
  EXPECT_EQ(clamped.last("Rig/LEFT/u"), 3.0);           // the applied effort
}

TEST_F(Actuation, JointsStopAtTheirLimitsUnlessTheScenarioSaysNo) {
  EXPECT_GT(record_run(gripper("drive effort 50 LEFT", ", joint_limits: false")).last("Rig/LEFT/q"), 0.004);
  EXPECT_NEAR(record_run(gripper("drive effort 50 LEFT")).last("Rig/LEFT/q"), 0.002, 1e-4);
  EXPECT_NEAR(record_run(gripper("drive effort 50 LEFT", ", joint_limits: true")).last("Rig/LEFT/q"), 0.002, 1e-4);
}

TEST_F(Actuation, AMimicJointFollowsAndSaysSoToThoseWhoCommandIt) {
  const Trace trace = record_run(gripper("drive velocity 0.3 LEFT"));
  EXPECT_EQ(trace.values("Rig/RIGHT/q")[0], 0.5);  // from the beginning
  EXPECT_NEAR(trace.last("Rig/RIGHT/q"), 0.5 - trace.last("Rig/LEFT/q"), 1e-5);
  EXPECT_THAT(said(record_run(gripper("drive velocity 1 RIGHT"))),
              Contains("Rig/C: joint 'RIGHT' follows joint 'LEFT': a command to it has no effect"));
}

TEST_F(Actuation, ATrackTakesItsSpeedByEitherName) {
  for (const std::string mode : {"velocity", "surface"}) {
    const Trace trace = record_run(gripper("drive " + mode + " 0.7 BELT"));
    EXPECT_EQ(trace.last("Rig/BELT/dq"), 0.7) << mode;
    EXPECT_EQ(trace.last("Rig/C/output/BELT/dq"), 0.7) << mode;
    EXPECT_THAT(said(trace), Not(Contains(HasSubstr("track")))) << mode;
    expect_equal_replay();
  }
}

TEST_F(Actuation, ATrackTakesNothingElse) {
  for (const std::string mode : {"effort", "displacement"})
    EXPECT_THAT(said(record_run(gripper("drive " + mode + " 0.7 BELT"))),
                Contains("Rig/C: track 'BELT' can be commanded by JointVelocity, and by nothing else"));
}

TEST_F(Actuation, AFixedLinkThatTheScenarioNamesABeltCarriesABox) {
  const Trace trace = record_run(conveyor(", belts: [{link: SLAB, axis: [0, 1, 0]}]"));
  EXPECT_THAT(said(trace), Not(Contains(HasSubstr("SLAB"))));
  EXPECT_EQ(trace.last("Rig/FRAME/dq"), 0.7);
  EXPECT_NEAR(trace.last("Box/Box/linear/x"), 0.7, 1e-6);
  EXPECT_NEAR(trace.last("Box/Box/linear/y"), 0.0, 1e-9);
  expect_equal_replay();
}

TEST_F(Actuation, ABeltRunsAboutItsAxis) {
  const Trace trace = record_run(conveyor(", belts: [{link: SLAB, axis: [-2, 0, 0]}]"));
  EXPECT_NEAR(trace.last("Box/Box/linear/x"), 0.0, 1e-9);
  EXPECT_NEAR(trace.last("Box/Box/linear/y"), 0.7, 1e-6);
}

TEST_F(Actuation, WithoutThatLineTheRunSaysWhichLineIsMissing) {
  const Trace trace = record_run(conveyor(""));
  EXPECT_THAT(said(trace), Contains("Rig/C: link 'SLAB' has no joint to command; its surface runs if the scenario's "
                                    "body has belts: [{link: SLAB, axis: [0, 1, 0]}]"));
  EXPECT_NEAR(trace.last("Box/Box/linear/x"), 0.0, 1e-6);
}

TEST_F(Actuation, ModesThatDriveNothingAreNamed) {
  EXPECT_THAT(said(record_run(rig_with("drive acceleration 1"))),
              Contains("Rig/C: JointAcceleration doesn't drive joint 'SHOULDER'"));
  EXPECT_THAT(said(record_run(rig_with("drive twist 1"))),
              Contains("Rig/C: link 'ARM' can't be moved by command: joint 'SHOULDER' connects it to its parent"));
}

TEST_F(Actuation, TwoControllersWithUnlikeModesForOneJointAreNamed) {
  const Trace trace = record_run(rig(behaviour("A", "drive velocity 3") + ", " + behaviour("B", "drive effort 1")));
  EXPECT_THAT(said(trace), Contains("Rig/B: commands joint 'SHOULDER' by JointEffort, which 'Rig/A' commands by "
                                    "JointVelocity: it is driven as 'Rig/B' says"));
  EXPECT_NEAR(trace.values("Rig/SHOULDER/dq")[2], 0.002, 1e-9);  // the effort of 1 N·m on 0.5 kg·m²
  ASSERT_FALSE(summary_.remarks.empty());
  EXPECT_EQ(summary_.remarks[0].severity, Severity::warning);
}

TEST_F(Actuation, TwoControllersThatCommandOneJointInOneModeAreNamed) {
  const Trace trace = record_run(rig(behaviour("A", "drive velocity 3") + ", " + behaviour("B", "drive velocity 1")));
  EXPECT_THAT(said(trace), Contains("Rig/B: commands joint 'SHOULDER' by JointVelocity, as 'Rig/A' does: of a tick the "
                                    "command of 'Rig/B' acts"));
  EXPECT_NEAR(trace.last("Rig/SHOULDER/dq"), 1.0, 1e-9);
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_EQ(summary_.remarks[0].severity, Severity::warning);
  record_run(rig(behaviour("A", "drive velocity 3") + ", " + behaviour("B", "drive displacement 0.3 RAIL")));
  EXPECT_TRUE(summary_.remarks.empty());
}

TEST_F(Actuation, AControllerAndItsChildThatWriteOneNumberAreNotNamed) {
  record_run(rig("{name: A, library: Behaviours, options: \"drive velocity 3\", children: [" +
                 behaviour("B", "drive velocity 1") + "]}"));
  EXPECT_TRUE(summary_.remarks.empty());
}

TEST_F(Actuation, TwoControllersOfOneModeAreNot) {
  const Trace trace = record_run(rig(behaviour("A", "drive effort 3") + ", " + behaviour("B", "drive effort 1")));
  EXPECT_THAT(said(trace), Not(Contains(HasSubstr("which 'Rig/A' commands"))));
}

}  // namespace
}  // namespace rehearse
