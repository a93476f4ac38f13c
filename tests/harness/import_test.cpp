// The project of fixtures/projects as a scenario.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/scenario.h>

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

const fs::path project = fs::path(FIXTURES_DIR) / "projects" / "wagon.cnoid";

class Import : public ::testing::Test {
 protected:
  void SetUp() override { options_.folder = folder_.path(); }
  ImportedProject imported() {
    auto imported = import_project(project, options_);
    EXPECT_TRUE(imported.ok()) << to_string(imported.errors());
    return imported ? *std::move(imported) : ImportedProject();
  }
  ImportedProject imported(std::string from, const std::string& to) {
    std::string text = test::read_file(project);
    EXPECT_THAT(text, HasSubstr(from));
    text.replace(text.find(from), from.size(), to);
    auto imported = import_project_text(text, project, options_);
    EXPECT_TRUE(imported.ok()) << to_string(imported.errors());
    return imported ? *std::move(imported) : ImportedProject();
  }
  Scenario loaded(const ImportedProject& imported) {
    for (const auto& [name, text] : imported.files) std::ofstream(folder_ / name) << text;
    const fs::path file = folder_ / (imported.name + ".yaml");
    std::ofstream(file) << imported.scenario;
    auto scenario = Scenario::load(file);
    EXPECT_TRUE(scenario.ok()) << to_string(scenario.errors());
    return scenario ? *std::move(scenario) : Scenario();
  }

  const test::TemporaryFolder folder_;
  ImportOptions options_;
};

TEST_F(Import, TakesTheSimulatorsSettings) {
  const Scenario scenario = loaded(imported());
  EXPECT_EQ(scenario.name, "wagon");
  EXPECT_EQ(scenario.time_step, 0.002);
  EXPECT_EQ(scenario.duration, 5.0);
  EXPECT_TRUE(scenario.ends_when_done);
  EXPECT_EQ(scenario.options, "quiet");
  EXPECT_EQ(scenario.solver.iterations, 80);
  EXPECT_EQ(scenario.solver.friction, 0.5);
  EXPECT_FALSE(scenario.planar);
  EXPECT_FALSE(scenario.lever_arms);
  ASSERT_TRUE(scenario.cameras);
  EXPECT_THAT(*scenario.cameras, ::testing::ElementsAre("Wagon/AHEAD"));
}

TEST_F(Import, TakesBodiesAtTheirInitialPoses) {
  const Scenario scenario = loaded(imported());
  ASSERT_EQ(scenario.bodies.size(), 2u);
  const ScenarioBody& wagon = scenario.bodies[0];
  EXPECT_EQ(wagon.name, "Wagon");
  EXPECT_TRUE(wagon.position.isApprox(Eigen::Vector3d(-0.5, 0, 0.1)));
  constexpr double ten_degrees = 0.17453292519943295;
  EXPECT_NEAR(Eigen::AngleAxisd(wagon.rotation).angle(), ten_degrees, 1e-9);
  EXPECT_FALSE(wagon.fixed);
  EXPECT_FALSE(wagon.joint_limits.value_or(true));
  EXPECT_TRUE(scenario.bodies[1].fixed);
  EXPECT_EQ(scenario.bodies[1].position.z(), -0.05);
}

/// The joints with an id come first, then the others in the order of links: here the front wheels.
TEST_F(Import, TakesDisplacementsInChoreonoidsOrder) {
  const Scenario scenario = loaded(imported());
  const ScenarioBody& wagon = scenario.bodies[0];
  const auto q = [&](const char* joint) {
    return wagon.joints.at(static_cast<std::size_t>(wagon.model->links[wagon.model->find_joint(joint)].joint.id));
  };
  EXPECT_NEAR(q("STEERING"), 0.0872664626, 1e-9);
  EXPECT_EQ(q("REAR_LEFT"), 0.0);
  EXPECT_NEAR(q("FRONT_LEFT"), 1.5707963268, 1e-9);
  EXPECT_NEAR(q("FRONT_RIGHT"), 1.5707963268, 1e-9);
}

/// A list of sliders, too, is in degrees; the lists of old projects are in [rad] and [m].
TEST_F(Import, ReadsTheUnitsOfDisplacementsAsChoreonoidDoes) {
  const ImportedProject old = imported("joint_displacements: [ 5, 0, 0, 90, 90 ]", "jointPositions: [ 0.25 ]");
  EXPECT_THAT(old.scenario, HasSubstr("joints: {STEERING: 0.25}"));
}

TEST_F(Import, TakesControllersWithOptionsAndDelay) {
  const Scenario scenario = loaded(imported());
  ASSERT_EQ(scenario.bodies[0].controllers.size(), 1u);
  const ScenarioController& drive = scenario.bodies[0].controllers[0];
  EXPECT_EQ(drive.name, "Drive");
  EXPECT_EQ(fs::weakly_canonical(folder_ / drive.library),
            fs::weakly_canonical(project.parent_path() / "WagonController.so"));
  EXPECT_EQ(drive.options, "2 s");
  EXPECT_FALSE(drive.delay);
}

/// Default with Default is 0.5, as the solver's friction says; pairs that no table lists are means of roughnesses.
TEST_F(Import, StatesThePairsOfMaterialsThatDifferFromTheDefault) {
  const Scenario scenario = loaded(imported());
  const auto pair = [&](const char* a, const char* b) -> const MaterialPair* {
    for (const MaterialPair& pair : scenario.pairs)
      if (pair.materials == std::array<std::string, 2>{a, b}) return &pair;
    return nullptr;
  };
  ASSERT_NE(pair("Default", "Tire"), nullptr);
  EXPECT_EQ(pair("Default", "Tire")->friction, 0.8);
  EXPECT_EQ(pair("Default", "Tire")->restitution, 0.1);
  ASSERT_NE(pair("Oil", "Tire"), nullptr);
  EXPECT_NEAR(*pair("Oil", "Tire")->friction, 0.189737, 1e-6);
  EXPECT_EQ(pair("Default", "Default"), nullptr);
  const ScenarioBody& wagon = scenario.bodies[0];
  EXPECT_EQ(wagon.materials.at(static_cast<std::size_t>(wagon.model->find_link("CHASSIS"))), "Default");
  EXPECT_EQ(wagon.materials.at(static_cast<std::size_t>(wagon.model->find_link("REAR_LEFT"))), "Tire");
}

TEST_F(Import, TellsOfEachItemWhatBecameOfIt) {
  std::string taken, left_out;
  for (const ImportedItem& item : imported().items)
    (item.is_taken ? taken : left_out) += item.type + " " + item.name + ": " + item.outcome + "\n";
  EXPECT_EQ(taken,
            "WorldItem World: the scenario\n"
            "BodyItem Wagon: body Wagon: wagon.body, 6 links, 5 joints\n"
            "SimpleControllerItem Drive: controller Drive: " +
                fs::weakly_canonical(project.parent_path() / "WagonController.so")
                    .lexically_proximate(fs::weakly_canonical(folder_.path()))
                    .string() +
                ", options '2 s'\n"
                "BodyItem Floor: body Floor: floor.body, 2 links, 0 joints\n"
                "ODESimulatorItem ODESimulator: time step 0.002 s, gravity, solver, options\n"
                "GLVisionSimulatorItem Vision: the cameras take pictures\n");
  EXPECT_EQ(left_out,
            "AISTSimulatorItem AISTSimulator: another simulator item is taken\n"
            "LightingItem Sun: belongs to the display\n");
}

TEST_F(Import, TakesTheSimulatorThatIsAskedFor) {
  options_.simulator = "AISTSimulator";
  options_.duration = 3.0;
  const ImportedProject aist = imported();
  const Scenario scenario = loaded(aist);
  EXPECT_EQ(scenario.duration, 3.0);
  EXPECT_FALSE(scenario.ends_when_done);
  EXPECT_EQ(scenario.solver.iterations, 50);
  EXPECT_THAT(aist.scenario, HasSubstr("cameras: none"));
  EXPECT_THAT(to_string(aist.remarks), HasSubstr("the direct solver here: forces differ from its own"));
}

TEST_F(Import, RefusesASimulatorThatIsNotThere) {
  options_.simulator = "ODESimulater";
  const auto imported = import_project(project, options_);
  ASSERT_FALSE(imported.ok());
  EXPECT_THAT(to_string(imported.errors().front()), HasSubstr("did you mean 'ODESimulator'"));
}

TEST_F(Import, WritesAModelAroundAMeshThatIsABody) {
  const ImportedProject mesh = imported("file: \"floor.body\"", "file: \"../models/meshes/wheel.wrl\"");
  ASSERT_TRUE(mesh.files.contains("Floor.body"));
  const Scenario scenario = loaded(mesh);
  ASSERT_EQ(scenario.bodies.size(), 2u);
  EXPECT_TRUE(scenario.bodies[1].fixed);
  EXPECT_FALSE(scenario.bodies[1].model->links[0].collisions.empty());
}

TEST_F(Import, KeepsTwoDimensionsAndJointLimits) {
  const Scenario scenario =
      loaded(imported("num_iterations: 80", "use_2d_mode: true\n                enable_joint_limit: true"));
  EXPECT_TRUE(scenario.planar);
  EXPECT_TRUE(scenario.bodies[0].joint_limits.value_or(true));
}

TEST_F(Import, NotesTheTargetsOfAVisionSimulatorThatArentThere) {
  const std::string remarks =
      to_string(imported("target_sensors: [ AHEAD ]", "target_bodies: [ Wagon, Cart ]").remarks);
  EXPECT_THAT(remarks, HasSubstr("note: GLVisionSimulatorItem is for the body 'Cart', which isn't there"));
  EXPECT_THAT(remarks, Not(HasSubstr("'Wagon'")));
}

TEST_F(Import, SaysThatFrictionIsAHalfWithoutChoreonoidsTable) {
  options_.share.clear();
  const ImportedProject without =
      imported("        default_material_table_file: \"${PROJECT_DIR}/materials.yaml\"\n", "");
  EXPECT_THAT(without.scenario, HasSubstr("friction: 0.5"));
  EXPECT_THAT(to_string(without.remarks), HasSubstr("--share DIR"));
  EXPECT_THAT(without.scenario, Not(HasSubstr("between: [Default, Default]")));
}

}  // namespace
}  // namespace rehearse
