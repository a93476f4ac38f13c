// Choreonoid's sample projects, imported and run without editing anything: in a checkout that is named at configure
// time, cmake -DREHEARSE_CHOREONOID_SOURCE=DIR. Its files aren't part of this repository, so without it these tests are
// skipped. REHEARSE_PROJECT_TABLE in the environment prints a line for each project.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <set>

#include "choreonoid/import/import.h"
#include "support/printed_by_name.h"

namespace {

namespace fs = std::filesystem;

std::string checkout() { return CHOREONOID_SOURCE; }

bool is_told() { return std::getenv("REHEARSE_PROJECT_TABLE") != nullptr; }

rehearse::ImportOptions options_for(const fs::path& folder) {
  rehearse::ImportOptions options;
  options.folder = folder;
  return options;
}

/// Compiles a sample controller into the folder; not if it is there and newer.
void compile(const std::string& library, const fs::path& folder) {
  const fs::path source = fs::path(checkout()) / "sample" / "SimpleController" / (library + ".cpp");
  const fs::path file = folder / (library + ".so");
  if (!fs::exists(source) || (fs::exists(file) && fs::last_write_time(file) > fs::last_write_time(source))) return;
  const std::string whole = file.string(), part = whole + "." + std::to_string(getpid());
  const std::string command = std::string(COMPILE) + " -o '" + part + "' '" + source.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  fs::rename(part, whole);
}

/// A project of sample/SimpleController. The least height of a walking robot's waist tells a fall [m].
struct Sample {
  const char* name;
  const char* waist = "";
  double least = 0.0;
};

class ProjectOfChoreonoid : public testing::TestWithParam<Sample> {
 protected:
  void SetUp() override {
    if (checkout().empty()) GTEST_SKIP() << "there is no checkout of Choreonoid: -DREHEARSE_CHOREONOID_SOURCE=DIR";
    fs::create_directories(folder_ / "share" / "motion" / "SR1");
    for (const char* pattern : {"SR1WalkPattern1.seq", "SR1WalkPattern2.seq", "SR1WalkPattern3.seq"})
      fs::copy_file(fs::path(checkout()) / "sample" / "SimpleController" / pattern,
                    folder_ / "share" / "motion" / "SR1" / pattern, fs::copy_options::overwrite_existing);
    fs::create_directories(libraries_);
    setenv("REHEARSE_CONTROLLER_PATH", libraries_.c_str(), 1);
    setenv("REHEARSE_CHOREONOID_SHARE", (folder_ / "share").c_str(), 1);
  }
  fs::path folder_ = fs::path(OUTPUT) / GetParam().name;
  fs::path libraries_ = fs::path(OUTPUT) / "libraries";
};

TEST_P(ProjectOfChoreonoid, RunsForItsWholeLengthAsItIs) {
  const fs::path project =
      fs::path(checkout()) / "sample" / "SimpleController" / (std::string(GetParam().name) + ".cnoid");
  const auto imported = rehearse::import_project(project, options_for(folder_));
  ASSERT_TRUE(imported.ok()) << rehearse::to_string(imported.errors());
  for (const auto& [name, text] : imported->files) std::ofstream(folder_ / name) << text;
  const fs::path file = folder_ / (imported->name + ".yaml");
  std::ofstream(file) << imported->scenario;

  auto scenario = rehearse::Scenario::load(file);
  ASSERT_TRUE(scenario.ok()) << rehearse::to_string(scenario.errors());
  for (const auto& body : scenario->bodies) {
    for (const auto& controller : body.controllers) {
      compile(controller.library, libraries_);
      for (const auto& child : controller.children) compile(child.library, libraries_);
    }
  }
  const fs::path trace = folder_ / "run.mcap";
  const auto summary = rehearse::record(*scenario, trace);
  ASSERT_TRUE(summary.ok()) << rehearse::to_string(summary.errors());
  EXPECT_FALSE(summary->failure) << summary->failure->message;
  if (!scenario->ends_when_done) {
    EXPECT_EQ(summary->ticks, scenario->ticks());
  }
  const auto run = rehearse::Trace::load(trace);
  ASSERT_TRUE(run.ok()) << rehearse::to_string(run.errors());
  double lowest = 0.0;
  if (GetParam().least > 0.0) {
    lowest = run->min(std::string(GetParam().waist) + "/WAIST/position/z");
    EXPECT_GT(lowest, GetParam().least) << "it fell";
  }
  if (!is_told()) return;
  std::cout << GetParam().name << ": " << static_cast<double>(summary->ticks) * scenario->time_step << " s of "
            << scenario->duration << (scenario->ends_when_done ? " at most" : "");
  if (GetParam().least > 0.0) std::cout << ", the waist is never below " << lowest << " m";
  std::cout << "\n";
}

constexpr double standing = 0.5;  // [m], of SR1's waist, which is 0.7 m high
const Sample samples[] = {{"AizuSpiderDS"},
                          {"AizuSpiderNS"},
                          {"AizuSpiderSS"},
                          {"AizuSpiderVisionSensors"},
                          {"AizuWheel"},
                          {"ControlledSpringModel"},
                          {"ConveyorSample"},
                          {"DoubleArmV7S"},
                          {"FourWheelCarJoystick"},
                          {"HandyRockDrill"},
                          {"LinkForceControl"},
                          {"LinkPositionControl"},
                          {"MultiUR10Pickup"},
                          {"PA10Pickup"},
                          {"PendulumSample"},
                          {"SR1DHWalk", "SR1DH", standing},
                          {"SR1Liftup", "SR1", 0.2},
                          {"SR1LiftupOneModel"},
                          {"SR1Minimum", "SR1", standing},
                          {"SR1Walk", "SR1", standing},
                          {"SR1Walk2D", "SR1_2D", standing},
                          {"SR1WalkSlippy"},
                          {"SR1WalkURDF", "SR1", standing},
                          {"SR1WalkinHouse", "SR1", standing},
                          {"SampleCrawler"},
                          {"SampleCrawlerJoystick"},
                          {"SampleCrawlerSlope"},
                          {"Tank"},
                          {"UR10Pickup"},
                          {"UR3Pickup"},
                          {"UR5CellSample"},
                          {"UR5Pickup"}};
INSTANTIATE_TEST_SUITE_P(All, ProjectOfChoreonoid, testing::ValuesIn(samples), rehearse::test::by_name);

/// What isn't imported is refused, with a place in the project.
TEST(ProjectsOfChoreonoid, AreImportedOrRefusedWithAPlace) {
  if (checkout().empty()) GTEST_SKIP() << "there is no checkout of Choreonoid: -DREHEARSE_CHOREONOID_SOURCE=DIR";
  std::set<fs::path> projects;
  std::error_code ignored;  // a checkout may be a part of the repository
  for (const char* folder : {"share", "sample", "src"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(checkout()) / folder, ignored))
      if (entry.path().extension() == ".cnoid") projects.insert(entry.path());
  std::size_t imported = 0;
  std::map<std::string, int> refusals;
  for (const auto& project : projects) {
    const auto result = rehearse::import_project(project, options_for(OUTPUT));
    if (result) {
      ++imported;
      continue;
    }
    const rehearse::Diagnostic& first = result.errors().front();
    EXPECT_EQ(first.file, project.string());
    EXPECT_GT(first.line, 0);
    ++refusals[std::regex_replace(first.message, std::regex("'[^']*'"), "'...'")];
    if (is_told())
      std::cout << project.lexically_relative(checkout()).string() << ": " << rehearse::to_string(first) << "\n";
  }
  std::cout << imported << " of " << projects.size() << " projects are imported\n";
  for (const auto& [message, count] : refusals) std::cout << "  refused " << count << ": " << message << "\n";
  EXPECT_GE(imported, 85u);
}

}  // namespace
