// What a run says of its world: joints beyond their limits, welds, and a solver that doesn't converge.

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class WorldRemarks : public RunTest {
 protected:
  WorldRemarks() { limit("lower=\"-100\" upper=\"100\"", "lower=\"-0.1\" upper=\"0.3\""); }

  /// Replaces a limit of joint RAIL.
  void limit(const std::string& present, const std::string& other) {
    urdf_.replace(urdf_.find(present), present.size(), other);
    write("rig.urdf", urdf_);
  }

 private:
  std::string urdf_ = rig_urdf;
};

TEST_F(WorldRemarks, AJointThatGoesBeyondItsLimitsIsAWarning) {
  std::string text = rig(behaviour("C", "drive effort 100 RAIL"), "cameras: none\n", "0.2");
  record_run(text);
  EXPECT_TRUE(summary_.remarks.empty());
  text.replace(text.find("    model: rig.urdf"), 19, "    joint_limits: false\n    model: rig.urdf");
  const Trace trace = record_run(text);
  EXPECT_GT(trace.last("Rig/RAIL/q"), 0.5);
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_EQ(summary_.remarks[0].severity, Severity::warning);
  EXPECT_THAT(summary_.remarks[0].message, HasSubstr("joint 'RAIL' of 'Rig' went 0.05"));
  EXPECT_THAT(summary_.remarks[0].message, HasSubstr("m beyond its limits, -0.1 to 0.3"));
}

TEST_F(WorldRemarks, AJointThatBeginsBeyondItsLimitsIsAWarning) {
  std::string text = rig("");
  text.replace(text.find("RAIL: 0.25"), 10, "RAIL: 0.75");
  const Trace trace = record_run(text);
  EXPECT_THAT(said(trace), Contains("world: joint 'RAIL' of 'Rig' begins 0.45 m beyond its limits, -0.1 to 0.3"));
}

TEST_F(WorldRemarks, WeldsAreEvents) {
  const Trace trace = record_run(R"(rehearse: 1
duration: 0.05
bodies:
  - {name: Wall, box: {size: [0.1, 0.1, 0.1]}, fixed: true, position: [0, 0, 1]}
  - {name: Box, box: {size: [0.1, 0.1, 0.1]}, mass: 1, position: [0.5, 0, 1]}
welds: [{name: grip, between: [Wall, Box], from: 0.01, until: 0.03}]
)");
  EXPECT_THAT(said(trace), Contains("world: 'grip' connects 'Wall/Wall' and 'Box/Box' in the step after tick 10"));
  EXPECT_THAT(said(trace), Contains("world: 'grip' separates 'Wall/Wall' and 'Box/Box' in the step after tick 30"));
}

TEST_F(WorldRemarks, ASolverThatStopsFarFromItsSolutionIsAWarningThatTheDirectOneAvoids) {
  const std::string arm = R"(bodies:
  - name: Rig
    model: rig.urdf
  - {name: Load, box: {size: [0.1, 0.1, 0.1]}, mass: 50, position: [0.2, 0, 1]}
  - {name: End, box: {size: [0.1, 0.1, 0.1]}, mass: 50, position: [0.5, 0, 1]}
joints:
  - {type: fixed, between: [Rig/ARM, Load]}
  - {type: fixed, between: [Load, End]}
)";
  const Trace trace =
      record_run("rehearse: 1\nduration: 0.05\ncameras: none\nsolver: {method: quick, iterations: 2}\n" + arm);
  ASSERT_FALSE(summary_.remarks.empty());
  EXPECT_THAT(summary_.remarks[0].message,
              HasSubstr("world: the solver's 2 iterations leave the forces at joint 'SHOULDER' of 'Rig' wrong"));
  EXPECT_THAT(said(trace), Contains(HasSubstr(", and in 9 before; 'method: direct' of the solver")));  // it lasts
  record_run("rehearse: 1\nduration: 0.05\ncameras: none\n" + arm);
  EXPECT_TRUE(summary_.remarks.empty());
}

/// A crate has no joint: the quick solver moves it beside an arm that the direct one moves.
TEST_F(WorldRemarks, ASwingingArmWithACrateElsewhereIsNoReasonToBlameASolverThatDoesNotMoveIt) {
  write("swing.urdf", R"(<robot name="Swing"><link name="world"/>
  <joint name="J1" type="continuous"><parent link="world"/><child link="UPPER"/><origin xyz="0 0 2"/>
    <axis xyz="0 1 0"/></joint>
  <link name="UPPER"><inertial><origin xyz="0.25 0 0"/><mass value="2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial></link>
  <joint name="J2" type="continuous"><parent link="UPPER"/><child link="LOWER"/><origin xyz="0.5 0 0"/>
    <axis xyz="0 1 0"/></joint>
  <link name="LOWER"><inertial><origin xyz="0.25 0 0"/><mass value="8"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link></robot>)");
  for (const std::string method : {"direct", "exact"}) {
    const Trace trace = record_run("rehearse: 1\nduration: 1\nsolver: {method: " + method + R"(}
bodies:
  - {name: Swing, model: swing.urdf}
  - {name: Floor, box: {size: [1, 1, 0.1]}, fixed: true, position: [0, 4, 0]}
  - {name: Crate, box: {size: [0.4, 0.4, 0.4]}, mass: 5, position: [0, 4, 0.3]}
)");
    EXPECT_GT(trace.max("Swing/J1/dq"), 3.0) << method;
    EXPECT_THAT(said(trace), Not(Contains(HasSubstr("iterations leave")))) << method;
  }
}

TEST_F(WorldRemarks, AJointThatMissesItsDrivesVelocityIsAWarning) {
  write("rig.urdf", R"(<robot name="Rig"><link name="world"/>
  <joint name="ANKLE_P" type="continuous"><parent link="world"/><child link="CROSS"/><axis xyz="0 1 0"/></joint>
  <link name="CROSS"><inertial><mass value="0.06"/>
    <inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial></link>
  <joint name="ANKLE_R" type="continuous"><parent link="CROSS"/><child link="TRUNK"/><axis xyz="1 0 0"/></joint>
  <link name="TRUNK"><inertial><origin xyz="0.02 0 0.9"/><mass value="40"/>
    <inertia ixx="4" ixy="0" ixz="0" iyy="4" iyz="0" izz="1"/></inertial></link></robot>)");
  const auto held = [](const std::string& method) {
    return "rehearse: 1\nduration: 0.2\nsolver: {method: " + method +
           "}\nbodies:\n  - {name: Rig, model: rig.urdf, controllers: [" + behaviour("C", "posture") + "]}\n";
  };
  const Trace trace = record_run(held("quick"));
  EXPECT_THAT(said(trace), Contains(HasSubstr("world: the solver's 50 iterations leave joint 'ANKLE_")));
  EXPECT_THAT(said(trace), Contains(HasSubstr("rad/s off its drive's velocity in the step after tick")));
  record_run(held("direct"));
  EXPECT_TRUE(summary_.remarks.empty());
}

TEST_F(WorldRemarks, AVelocityBeyondTheJointsLimitIsAWarning) {
  limit("velocity=\"1000\"", "velocity=\"2\"");
  record_run(rig_with("drive velocity 1.9 RAIL"));
  EXPECT_TRUE(summary_.remarks.empty());
  record_run(rig_with("drive velocity -3 RAIL"));
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_THAT(
      summary_.remarks[0].message,
      HasSubstr("joint 'RAIL' of 'Rig' is driven at -3 m/s, beyond its velocity limit of 2 m/s, which a velocity "
                "drive doesn't obey"));
}

TEST_F(WorldRemarks, AVelocityTowardsAStopIsAnEventThere) {
  const std::string beyond =
      "world: joint 'RAIL' of 'Rig' is at its limit, 0.3 m, and its velocity drive is commanded ";
  const Trace trace = record_run(rig_with("drive velocity 5 RAIL"));
  EXPECT_THAT(said(trace), Contains(HasSubstr(beyond + "beyond it")));
  EXPECT_THAT(said(record_run(rig_with("drive velocity 1 RAIL"))), Not(Contains(HasSubstr("is at its limit"))));
  EXPECT_TRUE(summary_.remarks.empty());
}

TEST_F(WorldRemarks, ADriveAtItsEffortLimitIsAnEvent) {
  limit("effort=\"1000\"", "effort=\"5\"");
  const std::string limited = "world: joint 'RAIL' of 'Rig' was driven with its largest effort, 5 N";
  EXPECT_THAT(said(record_run(rig_with("drive displacement 0.2 RAIL"))), Contains(limited));
  EXPECT_THAT(said(record_run(rig_with("drive displacement 0.25 RAIL"))), Not(Contains(limited)));
}

TEST_F(WorldRemarks, ADriveThatIsTooWeakForItsLoadIsAWarning) {
  const auto arm = [this](const std::string& effort) {
    write("rig.urdf", R"(<robot name="Rig"><link name="world"/>
  <joint name="SHOULDER" type="revolute"><parent link="world"/><child link="ARM"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="100" effort=")" +
                          effort + R"("/></joint>
  <link name="ARM"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link></robot>)");
    record_run("rehearse: 1\nduration: 0.3\nbodies:\n  - {name: Rig, model: rig.urdf, controllers: [" +
               behaviour("C", "posture") + "]}\n");
  };
  arm("5");
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_THAT(summary_.remarks[0].message, HasSubstr("joint 'SHOULDER' of 'Rig' moves away from its command, 0.05"));
  EXPECT_THAT(summary_.remarks[0].message, HasSubstr("rad so far: its effort limit of 5 N·m is too small"));
  arm("50");
  EXPECT_TRUE(summary_.remarks.empty());
}

TEST_F(WorldRemarks, ACameraThatIsReadAndDoesNotRunIsAWarning) {
  record_run(rig_with("look"));
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_THAT(
      summary_.remarks[0].message,
      HasSubstr("'Rig/C' reads camera 'Camera' of 'Rig', which takes no pictures: the scenario's 'cameras' leaves "
                "it out"));
  record_run(rig(behaviour("C", "look"), ""));
  EXPECT_TRUE(summary_.remarks.empty());
}

}  // namespace
}  // namespace rehearse
