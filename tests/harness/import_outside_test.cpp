// Projects as other people have them: paths of other machines, variables, body files of old versions, devices of
// plugins, and what of them isn't used.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/scenario.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "choreonoid/import/import.h"
#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

const fs::path models = fs::path(FIXTURES_DIR) / "models";

/// A folder with a project of one body, in GROUP/project, and models in GROUP/model.
class OutsideProject : public ::testing::Test {
 protected:
  void SetUp() override {
    group_ = folder_.path() / "group";
    fs::create_directories(group_ / "project");
    fs::create_directories(group_ / "model");
    fs::copy_file(models / "hopper.wrl", group_ / "model/hopper.wrl");
    fs::copy(models / "meshes", group_ / "model/meshes");
    write("model/block.body", block());
    options_.folder = folder_.path() / "scenarios";
    fs::create_directories(options_.folder);
  }

  static std::string block(const std::string& element = "") {
    return "format: ChoreonoidBody\nformat_version: 2.0\nname: block\nlinks:\n  - name: BASE\n    joint_type: fixed\n"
           "    elements:\n      - { type: Shape, geometry: { type: Box, size: [ 1, 1, 1 ] } }\n" +
           element +
           "  - { name: DOOR, parent: BASE, joint_type: revolute, joint_axis: [ 0, 0, 1 ], joint_id: 0, mass: 1 }\n"
           "  - { name: LID, parent: BASE, joint_type: fixed, joint_axis: [ 0, 0, 0 ] }\n";
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(group_ / name) << text; }

  /// `data`: of the BodyItem, `controller`: of a controller of it.
  Result<ImportedProject> import(const std::string& data, const std::string& controller = "") const {
    std::string text =
        "items:\n  class: RootItem\n  children:\n    - class: WorldItem\n      name: World\n      data: { "
        "default_material_table_file: \"" FIXTURES_DIR
        "/projects/materials.yaml\" }\n      children:\n        - class: BodyItem\n          name: Thing\n"
        "          data: { " +
        data + " }\n";
    if (!controller.empty())
      text += "          children:\n            - { class: SimpleControllerItem, name: Drive, data: { " + controller +
              " } }\n";
    text += "    - { class: ODESimulatorItem, name: ODE, data: { time_range_mode: specified, time_length: 1 } }\n";
    return import_project_text(text, group_ / "project/test.cnoid", options_);
  }

  ImportedProject imported(const std::string& data, const std::string& controller = "") const {
    auto imported = import(data, controller);
    EXPECT_TRUE(imported.ok()) << to_string(imported.errors());
    return imported ? *std::move(imported) : ImportedProject();
  }

  Result<Scenario> scenario_of(const ImportedProject& imported) const {
    const fs::path file = options_.folder / "test.yaml";
    std::ofstream(file) << imported.scenario;
    return Scenario::load(file);
  }

  const test::TemporaryFolder folder_;
  fs::path group_;
  ImportOptions options_;
};

TEST_F(OutsideProject, MayNameBodiesInVrmlAndInYaml) {
  write("model/hopper.yml", "modelFile: hopper.wrl\n");
  for (const char* file : {"../model/hopper.wrl", "../model/hopper.yml"}) {
    const ImportedProject project = imported(std::string("file: ") + file);
    EXPECT_TRUE(project.files.empty());  // no model is written around a mesh
    const auto scenario = scenario_of(project);
    ASSERT_TRUE(scenario.ok()) << to_string(scenario.errors());
    EXPECT_EQ(scenario->bodies[0].model->links.size(), 3u);
    EXPECT_EQ(scenario->bodies[0].model_file, std::string("../group/model/") + fs::path(file).filename().string());
  }
}

TEST_F(OutsideProject, TakesAWrlWithoutAHumanoidForAMesh) {
  EXPECT_TRUE(imported("file: ../model/meshes/wheel.wrl").files.contains("Thing.body"));
}

TEST_F(OutsideProject, MayNameFilesByVariables) {
  options_.model.packages["MY_ROBOTS"] = group_ / "model";
  const ImportedProject given = imported("file: \"${MY_ROBOTS}/block.body\"");
  EXPECT_THAT(given.scenario, HasSubstr("model: ../group/model/block.body"));
  EXPECT_THAT(given.scenario, HasSubstr("packages: {MY_ROBOTS: ../group/model}"));
  EXPECT_THAT(to_string(given.remarks), Not(HasSubstr("warning")));
  EXPECT_TRUE(scenario_of(given).ok());
}

TEST_F(OutsideProject, MayNameFilesBelowTheHome) {
  const std::string before = std::getenv("HOME") == nullptr ? "" : std::getenv("HOME");
  setenv("HOME", group_.c_str(), 1);
  const ImportedProject project = imported("file: \"${HOME}/model/block.body\"");
  setenv("HOME", before.c_str(), 1);
  EXPECT_THAT(project.scenario, HasSubstr("model: ../group/model/block.body"));
  EXPECT_THAT(to_string(project.remarks), Not(HasSubstr("warning")));
}

TEST_F(OutsideProject, IsToldTheOptionForAnUnknownVariable) {
  const auto unknown = import("file: \"${MY_ROBOTS}/else/where.body\"");
  ASSERT_FALSE(unknown.ok());
  EXPECT_THAT(to_string(unknown.errors()),
              HasSubstr("test.cnoid:10: error: '${MY_ROBOTS}/else/where.body' is below ${MY_ROBOTS}, whose folder is "
                        "unknown (--variable MY_ROBOTS=DIR)"));
}

/// Of a plugin whose models are installed from a folder beside the project's.
TEST_F(OutsideProject, TakesFilesOfOtherPartsOfItsCheckout) {
  fs::create_directories(group_ / "plugin/model/Block");
  write("plugin/model/Block/block.body", block());
  EXPECT_FALSE(import("file: \"${MY_ROBOTS}/model/Block/block.body\"").ok()) << "nothing says where a checkout ends";
  fs::create_directories(group_ / ".git");
  const ImportedProject project = imported("file: \"${MY_ROBOTS}/model/Block/block.body\"");
  EXPECT_THAT(project.scenario, HasSubstr("model: ../group/plugin/model/Block/block.body"));
  EXPECT_THAT(to_string(project.remarks), HasSubstr("isn't there; ../plugin/model/Block/block.body is taken, a guess"));
  EXPECT_FALSE(import("file: \"${MY_ROBOTS}/Block/block.body\"").ok()) << "one folder is too little";
}

/// A file with the same last folder and name, above the project or in the share folder; its old endings count.
TEST_F(OutsideProject, TakesFilesFromSimilarPlacesWithAWarning) {
  for (const char* path : {"${HOME}/ws/src/choreonoid/ext/group/model/block.body", "${MY_ROBOTS}/model/block.body",
                           "/home/somebody/group/model/block.body", "../../group/ext/model/block.wrl"}) {
    const ImportedProject project = imported("file: \"" + std::string(path) + "\"");
    EXPECT_THAT(project.scenario, HasSubstr("model: ../group/model/block.body")) << path;
    EXPECT_THAT(to_string(project.remarks),
                HasSubstr("warning: '" + std::string(path) + "' isn't there; ../model/block.body is taken, a guess"));
  }
  fs::create_directories(folder_.path() / "share/model/misc");
  std::ofstream(folder_.path() / "share/model/misc/slab.body") << block();
  options_.share = folder_.path() / "share";
  EXPECT_THAT(imported("file: ../../choreonoid/share/model/misc/slab.body").scenario,
              HasSubstr("model: ../share/model/misc/slab.body"));
  EXPECT_FALSE(import("file: ../model/absent.body").ok());
}

/// Folders of --search: the longest end of the path that one of them has, before the folders above the project.
TEST_F(OutsideProject, TakesFilesFromFoldersThatAreGiven) {
  const auto other = [&](const std::string& name) { return folder_.path() / "other" / name; };
  fs::create_directories(other("tasks/A"));
  fs::create_directories(other("second/tasks/A"));
  EXPECT_THAT(to_string(import("file: tasks/A/flag.body").errors()), HasSubstr("--search DIR"));
  std::ofstream(other("second/tasks/A/flag.body")) << block();
  options_.search = {other(""), other("second")};
  const ImportedProject second = imported("file: tasks/A/flag.body");
  EXPECT_THAT(second.scenario, HasSubstr("model: ../other/second/tasks/A/flag.body"));
  EXPECT_THAT(to_string(second.remarks), HasSubstr("warning: 'tasks/A/flag.body' isn't there; "));
  EXPECT_TRUE(scenario_of(second).ok());
  std::ofstream(other("tasks/A/flag.body")) << block();
  EXPECT_THAT(imported("file: tasks/A/flag.body").scenario, HasSubstr("model: ../other/tasks/A/flag.body"));
  EXPECT_THAT(imported("file: ../model/block.body").scenario, HasSubstr("model: ../group/model/block.body"));
  fs::create_directories(other("model"));
  std::ofstream(other("model/block.body")) << block();
  EXPECT_THAT(imported("file: \"${MY_ROBOTS}/model/block.body\"").scenario,
              HasSubstr("model: ../other/model/block.body"));
}

TEST_F(OutsideProject, IsToldToMakeAUrdfOfAXacroFile) {
  write("model/robot.xacro", "<robot/>\n");
  const auto refused = import("file: ../model/robot.xacro");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(to_string(refused.errors()),
              HasSubstr("test.cnoid:10: error: the model '../model/robot.xacro' is a template of ROS"));
}

TEST_F(OutsideProject, SearchesControllersOfOtherMachinesByTheirNames) {
  for (const char* path : {"/usr/lib/choreonoid-1.7/simplecontroller/DriveController.so",
                           "${PROGRAM_TOP}/lib/choreonoid-2.0/simplecontroller/DriveController",
                           "C:\\\\choreonoid\\\\lib\\\\DriveController.dll"}) {
    const ImportedProject project = imported("file: ../model/block.body", "controller: \"" + std::string(path) + "\"");
    EXPECT_THAT(project.scenario, HasSubstr("library: DriveController\n")) << path;
    EXPECT_THAT(to_string(project.remarks), HasSubstr("note: the library"));
    EXPECT_THAT(to_string(project.remarks), HasSubstr("isn't there; it is searched by its name"));
  }
  const fs::path here = group_ / "Here.so";
  std::ofstream(here) << "a library";
  EXPECT_THAT(imported("file: ../model/block.body", "controller: \"" + here.string() + "\"").scenario,
              HasSubstr("library: " + here.string()));
}

TEST_F(OutsideProject, LeavesOutDevicesOfPluginsIfThatIsAllowed) {
  write("model/drone.body",
        block("      - { type: Rotor, name: FRONT, value: 1, elements: [ { type: Shape, geometry: { "
              "type: Sphere, radius: 0.1 } } ] }\n      - { type: DoseMeter, name: DOSE }\n"));
  const auto refused = import("file: ../model/drone.body");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(to_string(refused.errors()), HasSubstr("drone.body:9: error: the element type 'Rotor' isn't known"));
  EXPECT_THAT(to_string(refused.errors()), HasSubstr("--allow-unknown-devices"));
  options_.model.allow_unknown_devices = true;
  const ImportedProject project = imported("file: ../model/drone.body");
  EXPECT_THAT(project.scenario, HasSubstr("allow_unknown_devices: true"));
  const auto scenario = scenario_of(project);
  ASSERT_TRUE(scenario.ok()) << to_string(scenario.errors());
  EXPECT_EQ(scenario->bodies[0].model->links[0].collisions.size(), 2u);  // the rotor's shape stays
  EXPECT_TRUE(scenario->bodies[0].model->devices.empty());
  const std::string warnings = to_string(scenario->warnings);
  EXPECT_THAT(warnings, HasSubstr("drone.body:9: warning: the device 'Rotor' 'FRONT' isn't known; it is left out"));
  EXPECT_THAT(warnings, HasSubstr("drone.body:10: warning: the device 'DoseMeter' 'DOSE' isn't known"));
}

TEST_F(OutsideProject, IsToldOfValuesThatArentUsed) {
  const ImportedProject surplus = imported("file: ../model/block.body, joint_displacements: [ 10, 0, 20, 30 ]");
  EXPECT_THAT(surplus.scenario, HasSubstr("joints: {DOOR: 10 deg}"));
  EXPECT_THAT(to_string(surplus.remarks),
              HasSubstr("note: 3 of 4 joint values of 'Thing' aren't used: block.body has 1 joint\n"));
  EXPECT_THAT(to_string(imported("file: ../model/block.body, joint_displacements: [ 10 ]").remarks),
              Not(HasSubstr("joint values")));
  EXPECT_THAT(to_string(imported("file: ../model/block.body, paint: red").remarks),
              HasSubstr("note: keys of a BodyItem without effect here: paint"));
}

TEST_F(OutsideProject, IsWarnedOfTheOldTargetMode) {
  for (const char* key : {"is_old_target_variable_mode", "isOldTargetVariableMode"})
    EXPECT_THAT(
        to_string(imported("file: ../model/block.body", "controller: X, " + std::string(key) + ": true").remarks),
        HasSubstr("warning: the controller 'Drive' is run in the old target variable mode"));
}

TEST_F(OutsideProject, NeedsItsTimeBarOnlyForItsLength) {
  const auto with = [&](const std::string& mode) {
    const std::string text =
        "items:\n  class: RootItem\n  children:\n    - class: WorldItem\n      name: World\n      data: { "
        "default_material_table_file: \"" FIXTURES_DIR
        "/projects/materials.yaml\" }\n      children:\n        - { class: BodyItem, name: Thing, data: { file: "
        "../model/block.body } }\n    - { class: ODESimulatorItem, name: ODE, data: { time_range_mode: " +
        mode + ", time_length: 1 } }\ntoolbars:\n  TimeBar: { max_time: 0 }\n";
    return import_project_text(text, group_ / "project/test.cnoid", options_);
  };
  EXPECT_TRUE(with("specified").ok());
  ASSERT_FALSE(with("timebar").ok());
  EXPECT_THAT(to_string(with("timebar").errors()), HasSubstr("the time bar has no positive frame_rate and max_time"));
  options_.duration = 2.0;
  EXPECT_TRUE(with("timebar").ok());
}

}  // namespace
}  // namespace rehearse
