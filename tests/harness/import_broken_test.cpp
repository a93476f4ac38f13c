// One mistake per file: fixtures/broken/project_*.cnoid, each with the place and the text of its message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "choreonoid/import/import.h"
#include "support/printed_by_name.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

const fs::path broken_files = fs::path(FIXTURES_DIR) / "broken";

Result<ImportedProject> import(const std::string& name) {
  ImportOptions options;
  options.folder = broken_files;
  return import_project(broken_files / ("project_" + name + ".cnoid"), options);
}

struct Broken {
  const char* name;  // fixtures/broken/project_NAME.cnoid
  int line;          // of the first message
  const char* message;
};

// clang-format off
const Broken refused[] = {
    {"not_yaml", 2, "can't be read as YAML: this .*isn't closed"},
    {"a_list", 1, "it isn't a Choreonoid project.*items"},
    {"empty", 1, "it isn't a Choreonoid project"},
    {"a_scenario", 1, "it isn't a Choreonoid project"},
    {"a_part", 2, "no WorldItem.*a part of a project"},
    {"only_views", 1, "no WorldItem.*a part of a project"},
    {"without_bodies", 5, "no BodyItem is below the world"},
    {"item_without_class", 5, "the item 'World' has no class"},
    {"children_of_text", 4, "the children of the item 'Root' aren't a list"},
    {"data_of_text", 7, "the data of the item 'World' isn't a mapping"},
    {"item_of_text", 4, "an item isn't a mapping"},
    {"model_absent", 18, "no model file '../models/nowhere.body'.*looked for"},
    {"model_unnamed", 15, "the body 'Thing' names no model file"},
    {"model_broken", 18, "the model 'body_joint_type_unknown.body' can't be used"},
    {"variable_unknown", 18, "MY_MODELS.*whose folder is unknown.*--variable MY_MODELS=DIR"},
    {"translation_of_two", 18, "initial_root_translation isn't a list of 3 numbers"},
    {"rotation_of_text", 18, "a rotation isn't a list of 4 numbers"},
    {"attitude_no_rotation", 15, "the initial attitude of 'Thing' is no rotation"},
    {"flag_of_a_number", 18, "fix_root is '2', and true or false is expected"},
    {"joints_of_text", 18, "joint_displacements is 'left', and a number is expected"},
    {"time_step_zero", 15, "the time step is 0 s.*0.00001 to 0.1"},
    {"time_step_of_text", 18, "time_step is 'fast', and a number is expected"},
    {"time_length_negative", 18, "the run lasts -1 s"},
    {"time_bar_backwards", 20, "no positive frame_rate and max_time"},
    {"materials_absent", 9, "the table of materials '../projects/nowhere.yaml' can't be used: there is no such file"},
    {"materials_of_one", 9, "the table of materials 'project_materials_of_one.yaml' can't be used"},
};

const Broken remarked[] = {
    {"controller_unnamed", 20, "the controller 'Drive' names no library; it is left out"},
    {"controller_of_another_kind", 20, "BodyMotionControllerItem 'Motion' is left out: only SimpleControllers are run"},
    {"controllers_three_deep", 24, "the controller 'B' is a child.*started and stopped, but never called"},
    {"class_unknown", 15, "WindItem 'Wind' is left out: its class is unknown"},
    {"sub_project", 15, "SubProjectItem 'Rest' is left out: a project within the project"},
    {"key_twice", 18, "the key 'fix_root' appears twice; the last one counts"},
    {"without_simulator", 6, "the project has no simulator item.*--duration"},
    {"without_end", 18, "the project has no end; the scenario has 10 s.*--duration"},
};
// clang-format on

class BrokenProject : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenProject, IsRefusedWithItsPlace) {
  const auto imported = import(GetParam().name);
  ASSERT_FALSE(imported.ok());
  const Diagnostic& first = imported.errors().front();
  EXPECT_THAT(first.file, ::testing::EndsWith(std::string("project_") + GetParam().name + ".cnoid"));
  EXPECT_EQ(first.line, GetParam().line) << to_string(first);
  EXPECT_THAT(to_string(first), ::testing::ContainsRegex(GetParam().message));
}
INSTANTIATE_TEST_SUITE_P(All, BrokenProject, ::testing::ValuesIn(refused), test::by_name);

class OddProject : public ::testing::TestWithParam<Broken> {};

TEST_P(OddProject, IsImportedWithARemark) {
  const auto imported = import(GetParam().name);
  ASSERT_TRUE(imported.ok()) << to_string(imported.errors());
  std::string warnings;
  for (const Diagnostic& remark : imported->remarks)
    if (remark.severity == Severity::warning) warnings += to_string(remark) + "\n";
  EXPECT_THAT(warnings, ::testing::ContainsRegex(std::string("project_") + GetParam().name + ".cnoid:" +
                                                 std::to_string(GetParam().line) + ": warning: " + GetParam().message));
}
INSTANTIATE_TEST_SUITE_P(All, OddProject, ::testing::ValuesIn(remarked), test::by_name);

TEST(BrokenProjects, AreAllTested) {
  std::set<std::string> files, tested;
  for (const auto& entry : fs::directory_iterator(broken_files))
    if (entry.path().extension() == ".cnoid") files.insert(entry.path().filename().string());
  for (const Broken& broken : refused) tested.insert(std::string("project_") + broken.name + ".cnoid");
  for (const Broken& broken : remarked) tested.insert(std::string("project_") + broken.name + ".cnoid");
  EXPECT_EQ(files, tested);
}

TEST(BrokenProjects, NameTheMistakesOfTheirModels) {
  const auto imported = import("model_broken");
  ASSERT_FALSE(imported.ok());
  EXPECT_THAT(to_string(imported.errors()), ::testing::HasSubstr("body_joint_type_unknown.body:"));
}

TEST(BrokenProjects, ThatAreMissingAreNamed) {
  const auto imported = import("nowhere");
  ASSERT_FALSE(imported.ok());
  EXPECT_THAT(to_string(imported.errors().front()),
              ::testing::HasSubstr("project_nowhere.cnoid: error: there is no such file"));
}

}  // namespace
}  // namespace rehearse
