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

TEST_F(ImportCommand, WritesNothingForAMistake) {
  const Outcome outcome =
      run(command, {"import", (fixtures / "broken/project_model_absent.cnoid").string(), "-o", "wagon"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("project_model_absent.cnoid:18: error: there is no model file"));
  EXPECT_FALSE(fs::exists(folder() / "wagon"));
}

}  // namespace
}  // namespace rehearse::test
