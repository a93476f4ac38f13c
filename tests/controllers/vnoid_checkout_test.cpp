// The sample project of vnoid, a public controller of a humanoid (github.com/ytazz/vnoid): compiled and imported as it
// is, in a checkout that is named at configure time, cmake -DREHEARSE_VNOID_SOURCE=DIR. Its files aren't part of this
// repository, so without it the test is skipped.
#include <gtest/gtest.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "choreonoid/import/import.h"

namespace {

namespace fs = std::filesystem;

constexpr const char* project_name = "vnoid_sample_project";
constexpr const char* library_name = "vnoid_sample_controller";

/// What the materials of the project are here: vnoid has no table of its own, and names Choreonoid's.
constexpr const char* materials =
    "materials:\n  - {name: Default, roughness: 1, viscosity: 1}\n  - {name: Ground, roughness: 1, viscosity: 1}\n"
    "contact_materials:\n  - {materials: [Default, Default], friction: 0.5, restitution: 0}\n"
    "  - {materials: [Ground, Default], friction: 0.5, restitution: 0}\n";

class Vnoid : public testing::Test {
 protected:
  void SetUp() override {
    if (checkout_.empty()) GTEST_SKIP() << "there is no checkout of vnoid: -DREHEARSE_VNOID_SOURCE=DIR";
    fs::create_directories(folder_ / "share" / "default");
    if (!fs::exists(folder_ / "share" / "model"))
      fs::create_directory_symlink(fs::path(checkout_) / "model", folder_ / "share" / "model");
    std::ofstream(folder_ / "share" / "default" / "materials.yaml") << materials;
    setenv("REHEARSE_CONTROLLER_PATH", folder_.c_str(), 1);
  }

  void compile_controller() const {
    const fs::path library = folder_ / (std::string(library_name) + ".so");
    std::string command = std::string(COMPILE) + " -DVNOID_BUILD_CNOID -I'" + (fs::path(checkout_) / "src").string() +
                          "' -o '" + library.string() + "'";
    for (const char* source : {"filter", "fksolver", "footstep", "footstep_planner", "ground_estimator", "iksolver",
                               "robot", "robot_base", "rollpitchyaw", "stabilizer", "stepping_controller"})
      command += " '" + (fs::path(checkout_) / "src" / source).string() + ".cpp'";
    for (const char* source : {"main", "myrobot"})
      command += " '" + (fs::path(checkout_) / "controller" / "sample_controller" / source).string() + ".cpp'";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }

  std::string checkout_ = VNOID_SOURCE;
  fs::path folder_ = OUTPUT;
};

/// The feet that swing, one letter a step: a foot that bears no load for 0.2 s swings. A step takes 0.5 s.
std::string steps_of(const rehearse::Trace& run) {
  const auto left = run.values("Unitychan/lfsensor/force/z"), right = run.values("Unitychan/rfsensor/force/z");  // [N]
  std::string steps;
  int left_ticks = 0, right_ticks = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    left_ticks = left[i] < 20.0 ? left_ticks + 1 : 0;
    right_ticks = right[i] < 20.0 ? right_ticks + 1 : 0;
    if (left_ticks == 200) steps += 'L';
    if (right_ticks == 200) steps += 'R';
  }
  return steps;
}

TEST_F(Vnoid, WalksTenStepsWithItsOwnController) {
  rehearse::ImportOptions options;
  options.folder = folder_;
  options.share = folder_ / "share";
  options.duration = 8.0;
  const auto imported =
      rehearse::import_project(fs::path(checkout_) / "project" / (std::string(project_name) + ".cnoid"), options);
  ASSERT_TRUE(imported.ok()) << rehearse::to_string(imported.errors());
  const fs::path file = folder_ / (imported->name + ".yaml");
  std::ofstream(file) << imported->scenario;

  ASSERT_NO_FATAL_FAILURE(compile_controller());
  const auto scenario = rehearse::Scenario::load(file);
  ASSERT_TRUE(scenario.ok()) << rehearse::to_string(scenario.errors());
  const auto summary = rehearse::record(*scenario, folder_ / "run.mcap");
  ASSERT_TRUE(summary.ok()) << rehearse::to_string(summary.errors());
  ASSERT_FALSE(summary->failure) << summary->failure->message;
  const auto run = rehearse::Trace::load(folder_ / "run.mcap");
  ASSERT_TRUE(run.ok()) << rehearse::to_string(run.errors());
  EXPECT_GT(run->min("Unitychan/HIPS/position/z"), 0.55) << "it fell";  // [m]; at 0.66 while it walks
  EXPECT_GT(run->last("Unitychan/HIPS/position/x"), 0.9);               // [m]: 0.09 m a step
  EXPECT_EQ(steps_of(*run).substr(0, 12), "LRLRLRLRLRLR");
}

}  // namespace
