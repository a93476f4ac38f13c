// What a project means under each of its simulator items, in projects of our own making.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/body.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <fstream>

#include "choreonoid/import/import.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* arm_body = R"(
format: ChoreonoidBody
format_version: 2.0
name: Arm
links:
  - {name: BASE, joint_type: fixed}
  - name: HAND
    parent: BASE
    joint_type: revolute
    joint_id: 0
    joint_axis: Y
    joint_displacement: 30
    joint_velocity_range: [-100, 200]
    max_joint_effort: 5
    mass: 1
    inertia: [1, 0, 0, 0, 1, 0, 0, 0, 1]
)";

class ImportItems : public ::testing::Test {
 protected:
  ImportItems() {
    options_.folder = folder_.path();
    write("arm.body", arm_body);
    write("Kin.so", "");
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  /// `item`: the class of the simulator item, and further keys of it, each ", key: value".
  std::string project(const std::string& item, const std::string& item_keys = "", const std::string& body_keys = "",
                      const std::string& controllers = "[]", const std::string& name = "Arm") const {
    return "items:\n  name: Root\n  class: RootItem\n  children:\n    - name: World\n      class: WorldItem\n"
           "      data: {}\n      children:\n        - name: " +
           name + "\n          class: BodyItem\n          data: {file: arm.body" + body_keys +
           "}\n          children: " + controllers + "\n        - {name: Sim, class: " + item +
           ", data: {time_range_mode: specified, time_length: 1" + item_keys + "}}\n";
  }
  ImportedProject imported(const std::string& text) const {
    auto imported = import_project_text(text, folder_ / "p.cnoid", options_);
    EXPECT_TRUE(imported.ok()) << to_string(imported.errors()) << text;
    return imported ? *std::move(imported) : ImportedProject();
  }
  Scenario loaded(const std::string& text) const {
    const ImportedProject project = imported(text);
    write("p.yaml", project.scenario);
    auto scenario = Scenario::load(folder_ / "p.yaml");
    EXPECT_TRUE(scenario.ok()) << to_string(scenario.errors()) << project.scenario;
    return scenario ? *std::move(scenario) : Scenario();
  }

  const test::TemporaryFolder folder_;
  ImportOptions options_;
};

constexpr const char* aist = "AISTSimulatorItem";
constexpr const char* ode = "ODESimulatorItem";
constexpr const char* controller = "[{name: C, class: SimpleControllerItem, data: {controller: \"Kin\"}}]";

TEST_F(ImportItems, TheCollisionSwitchOfABodyCountsForAistAndNotForOde) {
  for (const char* key : {", collision_detection: false", ", collisionDetection: false"}) {
    EXPECT_FALSE(loaded(project(aist, "", key)).bodies.at(0).contact.touches);
    EXPECT_TRUE(loaded(project(ode, "", key)).bodies.at(0).contact.touches);
  }
  EXPECT_TRUE(loaded(project(aist)).bodies.at(0).contact.touches);
  EXPECT_THAT(to_string(imported(project(ode, "", ", collision_detection: false")).remarks),
              HasSubstr("keys of a BodyItem without effect here: collision_detection"));
}

TEST_F(ImportItems, SelfCollisionOfABodyWithoutCollisionIsLeftOut) {
  const std::string both = ", collision_detection: false, self_collision_detection: true";
  EXPECT_THAT(to_string(loaded(project(aist, "", both)).warnings), Not(HasSubstr("self_collision")));
}

TEST_F(ImportItems, AistsKinematicsModeIsKinematic) {
  EXPECT_TRUE(loaded(project(aist, ", dynamicsMode: Kinematics")).bodies.at(0).kinematic);
  EXPECT_TRUE(loaded(project(aist, ", dynamics_mode: \"Kinematics\"")).bodies.at(0).kinematic);
  EXPECT_FALSE(loaded(project(aist, ", dynamics_mode: \"Forward dynamics\"")).bodies.at(0).kinematic);
  EXPECT_TRUE(loaded(project("KinematicSimulatorItem")).bodies.at(0).kinematic);
}

TEST_F(ImportItems, LimitsAreThoseThatTheItemApplies) {
  const ScenarioBody of_aist = loaded(project(aist)).bodies.at(0), of_ode = loaded(project(ode)).bodies.at(0),
                     of_other = loaded(project("MuJoCoSimulatorItem")).bodies.at(0);
  EXPECT_TRUE(of_aist.effort_limits);
  EXPECT_FALSE(of_aist.drive_limits);
  EXPECT_FALSE(of_ode.effort_limits);
  EXPECT_FALSE(of_ode.drive_limits);
  EXPECT_FALSE(of_other.effort_limits);
  EXPECT_TRUE(of_other.drive_limits);
}

TEST_F(ImportItems, CommandsOfInitializeActUnlessTheItemSetsThemBack) {
  EXPECT_TRUE(loaded(project(aist, "", "", controller)).initial_commands);
  for (const char* item : {ode, "BulletSimulatorItem"})
    EXPECT_FALSE(loaded(project(item, "", "", controller)).initial_commands) << item;
}

TEST_F(ImportItems, AistsKeysThatChangeItsRunAreWarningsUnlessTheyAreTheUsualOnes) {
  const std::string usual = ", contact_culling_depth: 0.05, max_num_iterations: 10, error_criterion: 1.0e-3";
  EXPECT_THAT(to_string(imported(project(aist, usual)).remarks), Not(HasSubstr("no counterpart")));
  EXPECT_THAT(to_string(imported(project(aist, ", max_num_iterations: 200, kinematicWalking: true")).remarks),
              HasSubstr("warning: max_num_iterations, enable_kinematic_walking have no counterpart here, and "
                        "Choreonoid's run uses them"));
}

TEST_F(ImportItems, AistClampsFrictionToItsRange) {
  EXPECT_THAT(imported(project(aist, ", max_friction_coefficient: 0.25")).scenario, HasSubstr("friction: 0.25"));
  EXPECT_THAT(imported(project(ode, ", max_friction_coefficient: 0.25")).scenario, HasSubstr("friction: 0.5"));
}

TEST_F(ImportItems, SavedStatesOfDevicesAreAWarning) {
  EXPECT_THAT(to_string(imported(project(aist, "", ", device_states: [{type: Camera}]")).remarks),
              HasSubstr("the states of devices that the project keeps for 'Arm' aren't read"));
}

TEST_F(ImportItems, VariablesArePartOfEveryPath) {
  const auto of = [](const std::string& path) {
    return "[{name: C, class: SimpleControllerItem, data: {controller: \"" + path + "\"}}]";
  };
  EXPECT_EQ(loaded(project(ode, "", "", of("${PROJECT_DIR}/Kin.so"))).bodies.at(0).controllers.at(0).library,
            "./Kin.so");
  EXPECT_EQ(loaded(project(ode, "", "", of("${PROJECT_DIR}/Kin"))).bodies.at(0).controllers.at(0).library, "./Kin.so");
  EXPECT_EQ(loaded(project(ode, "", "", of("${NOWHERE}/Kin.so"))).bodies.at(0).controllers.at(0).library, "Kin");
}

TEST_F(ImportItems, KeysOfOldProjectsMeanTheSame) {
  const std::string bar = "toolbars: {TimeBar: {frameRate: 500, maxTime: 7}}\n";
  const auto of = [&](const std::string& data) {
    return loaded(
        "items:\n  name: Root\n  class: RootItem\n  children:\n    - name: World\n      class: WorldItem\n      data: "
        "{}\n      children:\n        - name: Arm\n          class: BodyItem\n          data: {modelFile: arm.body}\n"
        "          children: [{name: C, class: SimpleControllerItem, data: {controller: Kin.so, RelativePathBase: "
        "Project directory}}]\n        - {name: Sim, class: AISTSimulatorItem, data: {" +
        data + "}}\n" + bar);
  };
  const Scenario scenario = of("framerate: 200, timeRangeMode: TimeBar range");
  EXPECT_EQ(scenario.time_step, 0.005);
  EXPECT_EQ(scenario.duration, 7.0);
  EXPECT_EQ(scenario.bodies.at(0).controllers.at(0).library, "./Kin.so");
  EXPECT_EQ(of("timeRangeMode: Time bar range").time_step, 0.002);
}

TEST_F(ImportItems, SubSimulatorsOfPluginsAreLeftOutWithAWarning) {
  const auto report = [&](const std::string& data, const std::string& simulator = "") {
    options_.simulator = simulator;
    const ImportedProject of = imported(
        "items:\n  name: Root\n  class: RootItem\n  children:\n    - name: World\n      class: WorldItem\n      data: "
        "{}\n      children:\n        - {name: Arm, class: BodyItem, data: {file: arm.body}}\n        - {name: Other, "
        "class: ODESimulatorItem, data: {time_range_mode: specified, time_length: 1}}\n        - name: Sim\n          "
        "class: AISTSimulatorItem\n          data: {time_range_mode: specified, time_length: 1}\n          children: "
        "[{name: Air, class: BreezeSimulatorItem, data: " +
        data + "}]\n");
    std::string text = to_string(of.remarks);
    for (const ImportedItem& item : of.items)
      if (item.name == "Air") text += item.outcome;
    return text;
  };
  EXPECT_THAT(report("{enabled: true}", "Sim"),
              HasSubstr("warning: BreezeSimulatorItem 'Air' is left out: the effects of this plugin's simulator aren't "
                        "simulated"));
  EXPECT_THAT(report("{enabled: false}", "Sim"), AllOf(HasSubstr("it is not enabled"), Not(HasSubstr("'Air'"))));
  EXPECT_THAT(report("{}"), AllOf(HasSubstr("another simulator item is taken"), Not(HasSubstr("'Air'"))));
  options_.simulator = "Air";
  EXPECT_FALSE(import_project_text(project(aist), folder_ / "p.cnoid", options_).ok());
}

TEST_F(ImportItems, VisionSimulatorsTakePicturesTogether) {
  write("eyes.body",
        "format: ChoreonoidBody\nformat_version: 2.0\nname: Eyes\nlinks:\n  - name: BASE\n    joint_type: fixed\n"
        "    elements:\n      - {type: Camera, name: LEFT, format: COLOR, width: 8, height: 6}\n"
        "      - {type: Camera, name: RIGHT, format: COLOR, width: 8, height: 6}\n"
        "      - {type: Camera, name: BACK, format: COLOR, width: 8, height: 6}\n");
  const auto of = [&](const std::string& items) {
    return imported(
        "items:\n  name: Root\n  class: RootItem\n  children:\n    - name: World\n      class: WorldItem\n      data: "
        "{}\n      children:\n        - {name: Eyes, class: BodyItem, data: {file: eyes.body}}\n        - name: Sim\n"
        "          class: AISTSimulatorItem\n          data: {time_range_mode: specified, time_length: 1}\n"
        "          children: [" +
        items + "]\n");
  };
  const std::string left = "{name: L, class: GLVisionSimulatorItem, data: {target_sensors: [LEFT]}}",
                    right = "{name: R, class: GLVisionSimulatorItem, data: {target_sensors: [RIGHT]}}",
                    effects = "{name: V, class: VFXVisionSimulatorItem, data: {enabled: true}}";
  EXPECT_THAT(of("").scenario, HasSubstr("cameras: none"));
  EXPECT_THAT(of(left + ", " + right).scenario, HasSubstr("cameras: [Eyes/LEFT, Eyes/RIGHT]"));
  for (const std::string& items : {effects, effects + ", " + left, left + ", " + effects}) {
    const ImportedProject with = of(items);
    EXPECT_THAT(with.scenario, Not(HasSubstr("cameras:"))) << items;
    EXPECT_THAT(to_string(with.remarks),
                HasSubstr("warning: VFXVisionSimulatorItem 'V' takes pictures, and its effects aren't drawn here"));
  }
}

TEST_F(ImportItems, SeveralFilesAreOneProject) {
  write("world.cnoid", project(aist, "", "", controller));
  write("bar.cnoid", "items: {name: Root, class: RootItem}\ntoolbars: {TimeBar: {frameRate: 500, maxTime: 7}}\n");
  write("part.cnoid",
        "items:\n  name: Root\n  class: RootItem\n  children:\n    - {name: Loose, class: BodyItem, data: {file: "
        "arm.body}}\n");
  const auto whole =
      import_projects({folder_ / "bar.cnoid", folder_ / "world.cnoid", folder_ / "part.cnoid"}, options_);
  ASSERT_TRUE(whole.ok()) << to_string(whole.errors());
  EXPECT_EQ(whole->name, "world");
  EXPECT_THAT(whole->scenario, HasSubstr("time_step: 0.002"));
  EXPECT_THAT(to_string(whole->remarks), HasSubstr("part.cnoid:5: warning: BodyItem 'Loose' is outside of the world"));
  EXPECT_EQ(whole->items.back().outcome, "of part.cnoid, outside of the world of world.cnoid");
  write("later.cnoid", project(aist, "", "", controller) + "toolbars: {TimeBar: {frameRate: 250, maxTime: 7}}\n");
  const auto late = import_projects({folder_ / "bar.cnoid", folder_ / "later.cnoid"}, options_);
  ASSERT_TRUE(late.ok()) << to_string(late.errors());
  EXPECT_THAT(late->scenario, HasSubstr("time_step: 0.004")) << "the bar of the last file that has one";
  const auto parts = import_projects({folder_ / "bar.cnoid", folder_ / "part.cnoid"}, options_);
  ASSERT_FALSE(parts.ok());
  EXPECT_THAT(to_string(parts.errors().front()), HasSubstr("no WorldItem"));
}

TEST_F(ImportItems, AChildOfAChildIsTaken) {
  const std::string nested =
      "[{name: A, class: SimpleControllerItem, data: {controller: Kin}, children: [{name: B, class: "
      "SimpleControllerItem, data: {controller: Kin}, children: [{name: C, class: SimpleControllerItem, data: "
      "{controller: Kin}}]}]}]";
  const Scenario scenario = loaded(project(ode, "", "", nested));
  const ScenarioController& parent = scenario.bodies.at(0).controllers.at(0);
  ASSERT_EQ(parent.children.size(), 2u);
  EXPECT_EQ(parent.children[0].name, "B");
  EXPECT_TRUE(parent.children[0].is_called);
  EXPECT_EQ(parent.children[1].name, "C");
  EXPECT_FALSE(parent.children[1].is_called);
}

TEST_F(ImportItems, BodiesKeepTheirNamesForControllers) {
  const Scenario scenario = loaded(project(ode, "", "", "[]", "My Arm"));
  EXPECT_EQ(scenario.bodies.at(0).name, "My_Arm");
  EXPECT_EQ(scenario.bodies.at(0).title, "My Arm");
}

TEST_F(ImportItems, BothEndsOfARangeOfVelocityAreKept) {
  const Scenario scenario = loaded(project(ode));
  const Joint& joint = scenario.bodies.at(0).model->links.at(1).joint;
  ASSERT_TRUE(joint.velocity_range);
  EXPECT_NEAR((*joint.velocity_range)[0], -1.7453292519943295, 1e-12);
  EXPECT_NEAR((*joint.velocity_range)[1], 3.490658503988659, 1e-12);
  EXPECT_NEAR(joint.velocity, 1.7453292519943295, 1e-12);
}

}  // namespace
}  // namespace rehearse
