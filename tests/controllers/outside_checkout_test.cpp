// Projects and bodies of other people's repositories, imported as they are: checkouts below a folder that is named at
// configure time, cmake -DREHEARSE_OUTSIDE_PROJECTS=DIR, each in OWNER+NAME. Their files aren't part of this
// repository, so without the folder, or without one of them, these tests are skipped. The files that ${SHARE} means are
// those of -DREHEARSE_CHOREONOID_SOURCE. REHEARSE_PROJECT_TABLE in the environment prints the reason of each refusal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/body.h>
#include <rehearse/scenario.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <string>

#include "choreonoid/import/import.h"
#include "support/printed_by_name.h"
#include "support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

/// A repository, and how many of its projects and bodies are read at least.
struct Repository {
  const char* name;
  const char* folder;
  std::size_t projects;  // that import into a scenario that loads
  std::size_t bodies;
};

class OutsideRepository : public testing::TestWithParam<Repository> {
 protected:
  void SetUp() override {
    if (*OUTSIDE_PROJECTS == '\0') GTEST_SKIP() << "there is no folder of checkouts: -DREHEARSE_OUTSIDE_PROJECTS=DIR";
    if (*CHOREONOID_SOURCE == '\0')
      GTEST_SKIP() << "there is no checkout of Choreonoid: -DREHEARSE_CHOREONOID_SOURCE=DIR";
    if (!fs::is_directory(root_)) GTEST_SKIP() << "there is no checkout " << root_;
    options_.model.allow_unknown_devices = true;
    options_.share = fs::path(CHOREONOID_SOURCE) / "share";
    options_.folder = folder_.path();
  }

  std::set<fs::path> files(const char* ending) const {
    std::set<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(root_))
      if (entry.path().extension() == ending && entry.is_regular_file()) found.insert(entry.path());
    return found;
  }

  /// True if the project becomes a scenario that loads. A refusal has a message.
  bool imports(const fs::path& project) const {
    const auto imported = rehearse::import_project(project, options_);
    if (!imported) return tell(project, imported.errors()), false;
    for (const auto& [name, text] : imported->files) std::ofstream(folder_ / name) << text;
    const fs::path file = folder_ / (imported->name + ".yaml");
    std::ofstream(file) << imported->scenario;
    const auto scenario = rehearse::Scenario::load(file);
    if (!scenario) tell(project, scenario.errors());
    return scenario.ok();
  }

  bool loads(const fs::path& body) const {
    const auto model = rehearse::load_model(body, options_.model);
    if (!model) tell(body, model.errors());
    return model.ok();
  }

  void tell(const fs::path& file, const rehearse::Diagnostics& errors) const {
    ASSERT_FALSE(errors.empty()) << file;
    EXPECT_FALSE(errors.front().message.empty()) << file;
    if (std::getenv("REHEARSE_PROJECT_TABLE") != nullptr)
      std::cout << file.lexically_relative(root_).string() << ": " << errors.back().message << "\n";
  }

  const rehearse::test::TemporaryFolder folder_;
  fs::path root_ = fs::path(OUTSIDE_PROJECTS) / GetParam().folder;
  rehearse::ImportOptions options_;
};

TEST_P(OutsideRepository, IsImportedAsItIs) {
  std::size_t imported = 0, loaded = 0;
  const std::set<fs::path> projects = files(".cnoid"), bodies = files(".body");
  for (const fs::path& project : projects) imported += imports(project);
  for (const fs::path& body : bodies) loaded += loads(body);
  std::cout << GetParam().folder << ": " << imported << " of " << projects.size() << " projects, " << loaded << " of "
            << bodies.size() << " bodies\n";
  EXPECT_GE(imported, GetParam().projects);
  EXPECT_GE(loaded, GetParam().bodies);
}

const Repository repositories[] = {{"Surena", "CAST-Robotics+surena_choreonoid_ros", 3, 1},
                                   {"VnoidOfMa1", "MA1-Biped+vnoid", 9, 10},
                                   {"Craneplus", "MasutaniLab+CraneplusForChoreonoid", 1, 3},
                                   {"Kobuki", "MasutaniLab+KobukiForChoreonoid", 2, 5},
                                   {"SimpleControllers", "hayat0-ota+choreonoid-simple-controllers", 1, 1},
                                   {"Vnoid2022", "hvac-solver+vnoid2022", 2, 5},
                                   {"HairoWorld", "inSect-WRS2025+hairo-world-plugin", 37, 56},
                                   {"JvrcPlugin", "jvrc+JVRCPlugin", 1, 0},
                                   {"JvrcModel", "jvrc+model", 9, 0},
                                   {"CnoidExt", "keitaronaruse+cnoid-ext-ws", 25, 37},
                                   {"Plugins", "kyawawa+choreonoid_plugins", 1, 3},
                                   {"Thormang", "s-kajita+thormang3_cnoid", 1, 3},
                                   {"Jsk", "start-jsk+rtmros_choreonoid", 2, 3},
                                   {"Vnoid", "ytazz+vnoid", 15, 13}};
INSTANTIATE_TEST_SUITE_P(All, OutsideRepository, testing::ValuesIn(repositories), rehearse::test::by_name);

}  // namespace
