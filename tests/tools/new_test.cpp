// rehearse new. tests/install tests that the new project builds and passes.
#include <gmock/gmock.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class New : public Command {};

TEST_F(New, WritesAProjectOfThatNameAndSaysHowToBuildIt) {
  const Outcome outcome = run(command, {"new", "my walker"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("cmake -S . -B build"));
  EXPECT_THAT(outcome.out, HasSubstr("\n  REHEARSE_GOLDEN=new ctest --test-dir build --output-on-failure\n"
                                     "  ctest --test-dir build --output-on-failure\n"));
  const fs::path project = folder() / "my walker";
  EXPECT_THAT(read_file(project / "CMakeLists.txt"), HasSubstr("project(my_walker CXX)"));
  EXPECT_THAT(read_file(project / "README.md"), HasSubstr("# my_walker"));
  for (const char* file : {".gitattributes", ".github/workflows/test.yml", ".gitignore", "hold.cpp", "hold_test.cpp",
                           "models/arm.urdf", "scenarios/hold.yaml"})
    EXPECT_GT(fs::file_size(project / file), 10u) << file;
}

/// The address is that of this build; without one a comment tells which line is to be filled in.
TEST_F(New, ItsWorkflowNeedsNoVariableOfTheRepository) {
  ASSERT_EQ(run(command, {"new", "."}).status, 0);
  const std::string workflow = read_file(folder() / ".github/workflows/test.yml"), repository = REHEARSE_REPOSITORY;
  EXPECT_THAT(workflow, Not(HasSubstr("vars.")));
  EXPECT_THAT(workflow, Not(HasSubstr("@RELEASE")));
  EXPECT_THAT(workflow, HasSubstr("/${package}_" REHEARSE_VERSION "-1_amd64.deb\"\n"));
  if (repository.empty())
    EXPECT_THAT(workflow,
                HasSubstr("  # Fill in the next line: the address of a folder with these packages, as that of a "
                          "release on GitHub.\n  REHEARSE_PACKAGES: \"\"\n"));
  else
    EXPECT_THAT(workflow,
                HasSubstr("REHEARSE_PACKAGES: \"" + repository + "/releases/download/v" REHEARSE_VERSION "\"\n"));
}

TEST_F(New, TheAddressOfItsReleasesIsTakenFromTheRemote) {
  const std::string functions = quoted((fixtures.parent_path() / "tools/lib.sh").string());
  const auto repository_of = [&](const std::string& remote) {
    return run("bash", {"-c", "source " + functions + "; repository_of \"$1\"", "bash", remote}).out;
  };
  for (const char* remote : {"git@github.com:owner/name.git", "ssh://git@github.com/owner/name",
                             "https://github.com/owner/name.git", "https://github.com/owner/name"})
    EXPECT_EQ(repository_of(remote), "https://github.com/owner/name\n") << remote;
  for (const char* remote : {"", "/srv/git/name.git", "git@example.org:owner/name.git"})
    EXPECT_EQ(repository_of(remote), "") << remote;
}

TEST_F(New, TheStepsItPrintsCanBeCopiedIntoAShell) {
  EXPECT_THAT(run(command, {"new", "my_walker"}).out, HasSubstr("\n  cd my_walker\n"));
  EXPECT_THAT(run(command, {"new", "bad name"}).out, HasSubstr("\n  cd 'bad name'\n"));
  const Outcome outcome = run(command, {"new", "it's $HOME; ~"});
  const std::string step = outcome.out.substr(outcome.out.find("cd "));
  EXPECT_EQ(run("sh", {"-c", step.substr(0, step.find('\n')) + " && pwd"}).out,
            (folder() / "it's $HOME; ~").string() + "\n");
}

TEST_F(New, ItsGoldensAreNeverMergedAndTheirDigestsAreShown) {
  ASSERT_EQ(run(command, {"new", "."}).status, 0);
  ASSERT_EQ(run("git", {"init", "--quiet"}).status, 0);
  const std::string attributes =
      run("git", {"check-attr", "diff", "merge", "text", "--", "golden/Arm.Holds.mcap", "golden/Arm.Holds.txt"}).out;
  EXPECT_EQ(
      attributes,
      "golden/Arm.Holds.mcap: diff: unset\ngolden/Arm.Holds.mcap: merge: unset\ngolden/Arm.Holds.mcap: text: unset\n"
      "golden/Arm.Holds.txt: diff: set\ngolden/Arm.Holds.txt: merge: unset\ngolden/Arm.Holds.txt: text: set\n");
}

TEST_F(New, ItsModelAndScenarioAreSound) {
  ASSERT_EQ(run(command, {"new", "."}).status, 0);  // an empty folder will do
  const Outcome inspected = run(command, {"inspect", "models/arm.urdf"});
  EXPECT_EQ(inspected.status, 0);
  EXPECT_THAT(inspected.out, HasSubstr("nothing was repaired, ignored or doubted"));
  const Outcome drawn = run(command, {"render", "scenarios/hold.yaml", "-o", "hold.png"});
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_EQ(drawn.err, "");
}

TEST_F(New, OverwritesNothing) {
  fs::create_directory(folder() / "mine");
  std::ofstream(folder() / "mine" / "notes.txt") << "keep";
  const Outcome outcome = run(command, {"new", "mine"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "error: mine is not empty (name a new folder, or an empty one)\n");
  EXPECT_FALSE(fs::exists(folder() / "mine" / "CMakeLists.txt"));
  EXPECT_EQ(read_file(folder() / "mine" / "notes.txt"), "keep");
}

TEST_F(New, NeedsAFolder) {
  std::ofstream(folder() / "file") << "x";
  EXPECT_EQ(run(command, {"new", "file"}).err, "error: file is not a folder\n");
  EXPECT_EQ(run(command, {"new"}).status, 2);
  EXPECT_THAT(run(command, {"new", "file/below"}).err, HasSubstr("can't make the folder file/below"));
}

}  // namespace
}  // namespace rehearse::test
