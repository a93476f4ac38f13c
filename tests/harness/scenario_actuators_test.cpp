// Actuators in a scenario: units, patterns, and which rule applies. The mistakes, one by one, are in
// scenario_broken_test.cpp.
#include <numbers>

#include "scenario_files.h"

namespace rehearse {
namespace {

const std::string leg_robot = R"(<robot name="Leg">
  <link name="world"/>
  <joint name="HIP" type="continuous"><parent link="world"/><child link="THIGH"/><dynamics friction="0.1"/></joint>
  <link name="THIGH"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="KNEE" type="continuous"><parent link="THIGH"/><child link="SHIN"/></joint>
  <link name="SHIN"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="FOOT" type="prismatic"><parent link="SHIN"/><child link="SOLE"/><limit lower="0" upper="1" effort="9" velocity="9"/></joint>
  <link name="SOLE"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
</robot>
)";

std::string leg_with(const std::string& rules, const std::string& more = "") {
  write_file("leg.urdf", leg_robot);
  return "rehearse: 1\nduration: 1\nbodies:\n  - name: Leg\n    model: leg.urdf\n    actuators:\n" + rules + more;
}

std::vector<std::optional<Actuator>> actuators(const std::string& rules) {
  return loaded(leg_with(rules)).bodies.at(0).actuators;
}

TEST(ScenarioActuators, AreNoneWithoutTheKey) {
  write_file("leg.urdf", leg_robot);
  EXPECT_TRUE(
      loaded("rehearse: 1\nduration: 1\nbodies:\n  - {name: Leg, model: leg.urdf}\n").bodies[0].actuators.empty());
}

TEST(ScenarioActuators, BelongToTheJointsOfTheirPattern) {
  const auto given = actuators("      - {joint: \"*E*\", delay: 0.01}\n");
  ASSERT_EQ(given.size(), 3u);
  EXPECT_FALSE(given[0]);
  ASSERT_TRUE(given[1]);
  EXPECT_EQ(given[1]->delay, 0.01);
  EXPECT_FALSE(given[2]);
}

TEST(ScenarioActuators, OfALaterRuleReplaceWhatItStates) {
  const auto given = actuators(
      "      - {joint: \"*\", delay: 0.01, effort: 20}\n"
      "      - {joint: KNEE, effort: 30, damping: 2}\n");
  EXPECT_EQ(given.at(0)->effort, 20.0);
  EXPECT_EQ(given.at(1)->effort, 30.0);
  EXPECT_EQ(given.at(1)->delay, 0.01);
  EXPECT_EQ(given.at(1)->damping, 2.0);
  EXPECT_FALSE(given.at(0)->damping);
}

TEST(ScenarioActuators, HaveUnits) {
  const auto given = actuators(
      "      - {joint: \"*\", delay: 6 ms, jitter: 500 us, bandwidth: 0.04 kHz, armature: 0.01}\n"
      "      - {joint: HIP, backlash: 0.5 deg, quantum: 0.1 rad}\n"
      "      - {joint: FOOT, backlash: 2 mm, quantum: 0.5}\n");
  EXPECT_NEAR(given.at(0)->delay, 0.006, 1e-15);
  EXPECT_NEAR(given.at(0)->jitter, 0.0005, 1e-15);
  EXPECT_NEAR(given.at(0)->bandwidth, 40.0, 1e-12);
  EXPECT_NEAR(given.at(0)->backlash, 0.5 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_EQ(given.at(0)->quantum, 0.1);
  EXPECT_NEAR(given.at(2)->backlash, 0.002, 1e-15);
  EXPECT_EQ(given.at(2)->quantum, 0.5);
}

TEST(ScenarioActuators, LeaveTheModelAsItsFileIs) {
  const Scenario scenario = loaded(leg_with("      - {joint: HIP, coulomb: 2, armature: 1, effort: 3}\n"));
  const Model& model = *scenario.bodies[0].model;
  const Joint& hip = model.links[static_cast<std::size_t>(model.joints[0])].joint;
  EXPECT_EQ(hip.friction, 0.1);
  EXPECT_EQ(hip.armature, 0.0);
  EXPECT_EQ(hip.effort, unlimited);
}

TEST(ScenarioActuators, WarnOfAGearWithoutRotor) {
  const Scenario scenario = loaded(leg_with("      - {joint: KNEE, gear: 9}\n"));
  ASSERT_EQ(scenario.warnings.size(), 1u);
  EXPECT_EQ(scenario.warnings[0].message, "gear does nothing for KNEE: the model states no inertia of its rotor");
}

TEST(ScenarioActuators, GetHotByNumbersThatVary) {
  const Scenario scenario =
      loaded(leg_with("      - {joint: KNEE, effort: 20, continuous_effort: 8, thermal_time: 500 ms}\n",
                      "    faults:\n      - {link: S*, fault: heavier, mass: 1, from: 0.5}\n"
                      "vary:\n"
                      "  hot: {path: \"bodies.Leg.actuators[0].continuous_effort\", uniform: [5, 20]}\n"
                      "  load: {path: \"bodies.Leg.faults[0].mass\", uniform: [1, 3]}\n"));
  EXPECT_EQ(scenario.bodies[0].actuators.at(1)->thermal_time, 0.5);
  const auto text = scenario.varied_text({"12", "2.5"});
  ASSERT_TRUE(text.ok());
  const Scenario varied = loaded(*text);
  EXPECT_EQ(varied.bodies[0].actuators.at(1)->continuous_effort, 12.0);
  ASSERT_EQ(varied.bodies[0].mass_faults.size(), 2u);  // SHIN and SOLE
  EXPECT_EQ(varied.bodies[0].mass_faults[1].factor, 2.5);
  EXPECT_EQ(varied.bodies[0].mass_faults[1].from, 0.5);
}

TEST(ScenarioActuators, AreVariedWithAndWithoutUnits) {
  const Scenario scenario =
      loaded(leg_with("      - {joint: \"*\", delay: 6 ms, armature: 0.01, bandwidth: 40}\n",
                      "vary:\n"
                      "  late: {path: \"bodies.Leg.actuators[0].delay\", uniform: [0, 12]}\n"
                      "  band: {path: \"bodies.Leg.actuators[0].bandwidth\", uniform: [5, 50]}\n"));
  const auto text = scenario.varied_text({"12", "7.5"});
  ASSERT_TRUE(text.ok());
  EXPECT_NE(text->find("delay: 12 ms,"), std::string::npos) << *text;
  EXPECT_NE(text->find("bandwidth: 7.5}"), std::string::npos) << *text;
  EXPECT_NEAR(loaded(*text).bodies[0].actuators[0]->delay, 0.012, 1e-15);
}

}  // namespace
}  // namespace rehearse
