// rehearse import: a project of Choreonoid as a scenario. tests/harness/import_test.cpp tests what it takes.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ImportCommand : public Command {
 protected:
  const std::string project_ = (fixtures / "projects/wagon.cnoid").string();
};

TEST_F(ImportCommand, WritesTheScenarioAndTellsOfEachItem) {
  const Outcome outcome = run(command, {"import", project_, "-o", "wagon"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("BodyItem"));
  EXPECT_THAT(outcome.out, HasSubstr("another simulator item is taken"));
  EXPECT_THAT(outcome.out, HasSubstr("wrote wagon/wagon.yaml; run it with: rehearse record wagon/wagon.yaml"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("error")));
  EXPECT_THAT(read_file(folder() / "wagon/wagon.yaml"), HasSubstr("# Imported from wagon.cnoid"));
}

/// The controller says that it is done at 2 s, and the step in which it says so is made.
TEST_F(ImportCommand, WritesARunThatEndsWhenItsControllersAreDone) {
  ASSERT_EQ(run(command, {"import", project_, "-o", "wagon"}).status, 0);
  const Outcome recorded =
      run(command, {"record", "wagon/wagon.yaml", "-o", "wagon.mcap", "--controller", "Drive=" WAGON, "--json"});
  ASSERT_EQ(recorded.status, 0) << recorded.err;
  EXPECT_EQ(recorded.json()["ticks"], 1001);
  EXPECT_EQ(recorded.json()["failure"], nullptr);
  const Outcome replayed = run(command, {"replay", "wagon.mcap", "--controller", "Drive=" WAGON});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  const Outcome checked = run(
      command, {"check", "wagon/wagon.yaml", "--golden", "wagon.mcap", "--controller", "Drive=" WAGON, "--no-report"});
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
}

TEST_F(ImportCommand, OverwritesNothing) {
  fs::create_directory(folder() / "wagon");
  std::ofstream(folder() / "wagon/wagon.yaml") << "mine";
  const Outcome outcome = run(command, {"import", project_, "-o", "wagon"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("wagon/wagon.yaml: error: it exists, and may have been changed by hand"));
  EXPECT_EQ(read_file(folder() / "wagon/wagon.yaml"), "mine");
}

TEST_F(ImportCommand, ReplacesAnEarlierImportIfItIsForced) {
  ASSERT_EQ(run(command, {"import", project_, "-o", "wagon"}).status, 0);
  std::ofstream(folder() / "wagon/wagon.yaml") << "mine";
  EXPECT_EQ(run(command, {"import", project_, "-o", "wagon", "--force"}).status, 0);
  EXPECT_THAT(read_file(folder() / "wagon/wagon.yaml"), HasSubstr("# Imported from wagon.cnoid"));
  EXPECT_FALSE(exists("wagon/wagon.yaml.earlier"));
}

TEST_F(ImportCommand, ReadsSeveralFilesAsOneProject) {
  write("views.cnoid", "items: {name: Root, class: RootItem}\nviews: []\n");
  const Outcome outcome = run(command, {"import", "views.cnoid", project_, "-o", "wagon"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(exists("wagon/wagon.yaml"));
}

TEST_F(ImportCommand, WritesNothingForAMistake) {
  const Outcome outcome =
      run(command, {"import", (fixtures / "broken/project_model_absent.cnoid").string(), "-o", "wagon"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("project_model_absent.cnoid:18: error: there is no model file"));
  EXPECT_FALSE(fs::exists(folder() / "wagon"));
}

/// The wagon's project with other words in it, beside copies of the files that it names.
class ImportOfChanged : public ImportCommand {
 protected:
  std::string project(const std::string& from, const std::string& to) const {
    std::string text = read_file(project_);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    for (const char* absolute : {"../models/", "${PROJECT_DIR}/"})
      for (std::size_t found = text.find(absolute); found != std::string::npos; found = text.find(absolute))
        text.replace(found, std::string(absolute).size(),
                     (fixtures / (absolute[0] == '.' ? "models" : "projects")).string() + "/");
    return write("changed.cnoid", text).string();
  }
  static inline const std::string floor = "file: \"floor.body\"";
  static inline const std::string at_fixtures = "file: \"" + (fixtures / "projects/floor.body").string() + "\"";
};

TEST_F(ImportOfChanged, EndsWithFourIfWhatDecidesTheRunIsLeftOut) {
  const std::string changed = project(floor, at_fixtures);
  std::string text = read_file(changed);
  const std::string known = "class: AISTSimulatorItem";
  ASSERT_NE(text.find(known), std::string::npos);
  text.replace(text.find(known), known.size(), "class: PythonScriptItem");
  std::ofstream(changed) << text;
  const Outcome outcome = run(command, {"import", changed, "-o", "out"});
  EXPECT_EQ(outcome.status, 4) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: PythonScriptItem"));
  EXPECT_TRUE(exists("out/changed.yaml"));
  const Outcome as_json = run(command, {"import", changed, "-o", "json", "--json"});
  EXPECT_EQ(as_json.status, 4);
  EXPECT_EQ(as_json.json()["scenario"], "json/changed.yaml");
}

TEST_F(ImportOfChanged, TakesTheOptionsOfAModel) {
  fs::create_directories(folder() / "parts");
  fs::copy_file(fixtures / "models/mesh_arm/meshes/bracket.glb", folder() / "parts/bracket.glb");
  write("loose.body",
        "format: ChoreonoidBody\nformat_version: 2.0\nname: Floor\nlinks:\n  - name: BASE\n    joint_type: fixed\n"
        "  - name: ARM\n    parent: BASE\n    joint_type: revolute\n    joint_id: 0\n    joint_axis: [0, 1, 0]\n"
        "    elements:\n      - {type: Resource, uri: \"package://bits/bracket.glb\"}\n");
  const std::string changed = project(floor, "file: \"loose.body\"");
  EXPECT_EQ(run(command, {"import", changed, "-o", "out"}).status, 2);
  fs::create_directory(folder() / "out");
  std::ofstream(folder() / "out/changed.yaml") << "mine";
  EXPECT_EQ(run(command, {"import", changed, "-o", "out", "--force"}).status, 2);
  EXPECT_EQ(read_file(folder() / "out/changed.yaml"), "mine") << "a scenario with mistakes replaces nothing";
  fs::remove(folder() / "out/changed.yaml");
  const Outcome outcome =
      run(command, {"import", changed, "-o", "out", "--package", "bits=parts", "--default-mass", "2"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(read_file(folder() / "out/changed.yaml"),
              HasSubstr("    packages: {bits: ../parts}\n    default_mass: 2\n"));
}

TEST_F(ImportOfChanged, WritesNothingIfTheScenarioCantBeLoaded) {
  write("holed.body",
        "format: ChoreonoidBody\nformat_version: 2.0\nname: Floor\nlinks:\n  - name: BASE\n    joint_type: fixed\n"
        "    elements:\n      - {type: Resource, uri: none.stl}\n");
  const std::string changed = project(floor, "file: \"holed.body\"");
  const Outcome outcome = run(command, {"import", changed, "-o", "a/b"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, HasSubstr("changed.cnoid: error: nothing was written: a/b/changed.yaml would have"));
  EXPECT_THAT(outcome.err, HasSubstr("none.stl"));
  EXPECT_FALSE(exists("a"));
  const Outcome allowed = run(command, {"import", changed, "-o", "allowed", "--allow-missing-meshes"});
  EXPECT_EQ(allowed.status, 4) << allowed.err;
  EXPECT_THAT(allowed.err, HasSubstr("none.stl"));
  EXPECT_THAT(read_file(folder() / "allowed/changed.yaml"), HasSubstr("    allow_missing_meshes: true\n"));
  EXPECT_EQ(run(command, {"import", changed, "-o", "a/b", "--json"}).json()["errors"].empty(), false);
  fs::create_directory(folder() / "mine");
  EXPECT_EQ(run(command, {"import", changed, "-o", "mine"}).status, 2);
  EXPECT_TRUE(exists("mine"));
  EXPECT_TRUE(fs::is_empty(folder() / "mine"));
}

}  // namespace
}  // namespace rehearse::test
