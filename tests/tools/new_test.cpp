// rehearse new. tests/install tests that the new project builds and passes.
#include <gmock/gmock.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string origin = "https://github.com/owner/name";
const std::string commit = "0123456789012345678901234567890123456789";

class New : public Command {};

TEST_F(New, WritesAProjectOfThatNameAndSaysHowToBuildIt) {
  const Outcome outcome = run(command, {"new", "my walker", "--origin", origin, "--commit", commit});
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

TEST_F(New, WritesTheControllerInTheLanguageThatIsAskedFor) {
  ASSERT_EQ(run(command, {"new", "--language", "c", "in_c"}).status, 0);
  EXPECT_THAT(read_file(folder() / "in_c/CMakeLists.txt"),
              AllOf(HasSubstr("project(in_c C CXX)"), HasSubstr("rehearse_add_simple_controller(Hold hold.c)")));
  EXPECT_TRUE(fs::exists(folder() / "in_c/hold.c"));
  EXPECT_FALSE(fs::exists(folder() / "in_c/hold.cpp"));
  ASSERT_EQ(run(command, {"new", "--language", "rust", "in_rust", "--origin", origin, "--commit", commit}).status, 0);
  EXPECT_THAT(read_file(folder() / "in_rust/CMakeLists.txt"),
              HasSubstr("rehearse_add_rust_controller(Hold Cargo.toml)"));
  EXPECT_THAT(read_file(folder() / "in_rust/README.md"), HasSubstr("| `src/lib.rs` | the controller"));
  EXPECT_THAT(read_file(folder() / "in_rust/.github/workflows/test.yml"), HasSubstr(" cargo cmake g++ make "));
  EXPECT_TRUE(fs::exists(folder() / "in_rust/src/rehearse.rs"));
  ASSERT_EQ(run(command, {"new", "--language", "python", "in_python", "--origin", origin, "--commit", commit}).status,
            0);
  EXPECT_THAT(read_file(folder() / "in_python/scenarios/hold.yaml"), HasSubstr("- library: hold.py:Hold\n"));
  EXPECT_THAT(read_file(folder() / "in_python/README.md"), HasSubstr("# in_python\n"));
  EXPECT_TRUE(fs::exists(folder() / "in_python/test_hold.py"));
  const std::string workflow = read_file(folder() / "in_python/.github/workflows/test.yml");
  EXPECT_THAT(workflow,
              AllOf(HasSubstr("! fetch python3-rehearse;"), HasSubstr(" python3-pytest ca-certificates "),
                    HasSubstr("        run: python3 -m pytest "), HasSubstr("\n            rehearse-pending\n"),
                    Not(HasSubstr("cmake")), Not(ContainsRegex("@[A-Z]+@"))));
  for (const char* other : {"CMakeLists.txt", "hold_test.cpp"})
    EXPECT_FALSE(fs::exists(folder() / "in_python" / other)) << other;
  EXPECT_THAT(read_file(folder() / "in_c/scenarios/hold.yaml"), HasSubstr("- library: Hold\n"));
  const Outcome refused = run(command, {"new", "--language", "ada", "in_ada"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("ada"), HasSubstr("c++")));
}

TEST_F(New, ItsWorkflowNeedsNoVariableOfTheRepository) {
  ASSERT_EQ(run(command, {"new", ".", "--origin", origin, "--commit", commit}).status, 0);
  const std::string workflow = read_file(folder() / ".github/workflows/test.yml");
  EXPECT_THAT(workflow, AllOf(Not(HasSubstr("vars.")), Not(HasSubstr("secrets.")), Not(ContainsRegex("@[A-Z]+@"))));
  EXPECT_THAT(workflow, HasSubstr("  REHEARSE_ORIGIN: \"https://github.com/owner/name\"\n  REHEARSE_COMMIT: \"" +
                                  commit + "\" "));
  EXPECT_THAT(workflow, AllOf(HasSubstr("    timeout-minutes: "), HasSubstr("\nconcurrency:"),
                              HasSubstr("key: rehearse-" REHEARSE_VERSION "-${{ env.REHEARSE_COMMIT }}-debian12")));
  EXPECT_THAT(workflow, HasSubstr("/releases/download/v" REHEARSE_VERSION "/$1_" REHEARSE_VERSION "-1_amd64.deb\""));
}

TEST_F(New, WithoutAnAddressItSaysHowToGetAWorkflow) {
  if (!std::string(REHEARSE_ORIGIN).empty()) GTEST_SKIP() << "this build knows its address";
  const Outcome made = run(command, {"new", "my arm"});
  EXPECT_EQ(made.status, 0);
  EXPECT_FALSE(fs::exists(folder() / "my arm/.github"));
  EXPECT_THAT(made.out, EndsWith("ctest --test-dir build --output-on-failure\n")) << "its steps can be copied";
  EXPECT_EQ(made.err,
            "note: it has no workflow for GitHub Actions, as this build doesn't know the address of Rehearse's "
            "repository: rehearse new --workflow --origin URL --commit COMMIT 'my arm' writes one\n");
  EXPECT_THAT(read_file(folder() / "my arm/README.md"), Not(HasSubstr("GitHub"))) << "it speaks of what there is";
  const Outcome refused = run(command, {"new", "--workflow", "my arm"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.err,
            "error: this build doesn't know the address of Rehearse's repository (--origin URL states it)\n");
}

TEST_F(New, AddsAWorkflowToAProjectThatExists) {
  fs::create_directory(folder() / "arm");
  const Outcome added = run(command, {"new", "--workflow", "--origin", origin, "--commit", commit, "arm"});
  EXPECT_EQ(added.status, 0) << added.err;
  EXPECT_THAT(added.out, HasSubstr("arm/.github/workflows/test.yml: builds the project and runs its tests on GitHub"));
  EXPECT_FALSE(fs::exists(folder() / "arm/hold.cpp"));
  EXPECT_THAT(read_file(folder() / "arm/.github/workflows/test.yml"), HasSubstr(origin));
  const Outcome again = run(command, {"new", "--workflow", "--origin", origin, "--commit", commit, "arm"});
  EXPECT_EQ(again.status, 2);
  EXPECT_EQ(again.err,
            "arm/.github/workflows/test.yml: error: there is a workflow (remove it to have it written anew)\n");
  EXPECT_EQ(run(command, {"new", "--workflow", "--origin", origin, "--commit", commit, "nowhere"}).err,
            "error: there is no folder nowhere\n");
}

TEST_F(New, ItsWorkflowNamesAWholeCommit) {
  for (const char* wrong : {"HEAD", "main", "0123456", "v0.1.0"}) {
    const Outcome refused = run(command, {"new", "arm", "--origin", origin, "--commit", wrong});
    EXPECT_EQ(refused.status, 2) << wrong;
    EXPECT_EQ(refused.err, "error: --commit '" + std::string(wrong) +
                               "' isn't a whole commit (expected 40 digits, as git ls-remote URL HEAD prints them)\n");
  }
  if (!std::string(REHEARSE_COMMIT).empty()) GTEST_SKIP() << "this build knows its commit";
  const Outcome made = run(command, {"new", "arm", "--origin", origin});
  EXPECT_EQ(made.status, 0);
  EXPECT_FALSE(fs::exists(folder() / "arm/.github"));
  EXPECT_EQ(made.err,
            "note: it has no workflow for GitHub Actions, as this build doesn't know the commit of Rehearse: rehearse "
            "new --workflow --commit COMMIT arm writes one\n");
  EXPECT_EQ(run(command, {"new", "--workflow", "--origin", origin, "arm"}).err,
            "error: this build doesn't know its commit, which the workflow names (--commit COMMIT states it; git "
            "ls-remote URL HEAD prints the newest)\n");
}

TEST_F(New, ItsReadmeSpeaksOfTheWorkflowThatWasWritten) {
  for (const char* language : {"c++", "python"}) {
    const std::string name = std::string("in_") + language;
    ASSERT_EQ(run(command, {"new", name, "--language", language, "--origin", origin, "--commit", commit}).status, 0);
    EXPECT_THAT(read_file(folder() / name / "README.md"),
                HasSubstr("\n\nOn GitHub `.github/workflows/test.yml` runs the tests, "));
  }
}

TEST_F(New, RefusesAnAddressThatGitHubCantFetchFrom) {
  for (const char* wrong : {"/srv/git/rehearse", "github.com/owner/name", "https://a\"b", "https://a b", "://x"}) {
    const Outcome refused = run(command, {"new", "arm", "--origin", wrong});
    EXPECT_EQ(refused.status, 2) << wrong;
    EXPECT_EQ(refused.err, "error: --origin '" + std::string(wrong) +
                               "' isn't the address of a repository (expected one that anyone can fetch from, as "
                               "https://github.com/OWNER/NAME)\n");
  }
  EXPECT_FALSE(fs::exists(folder() / "arm"));
}

TEST_F(New, ItsWorkflowMayWriteOnlyForABranchOfTheHistory) {
  ASSERT_EQ(run(command, {"new", "usual", "--origin", origin, "--commit", commit}).status, 0);
  ASSERT_EQ(run(command, {"new", "branch", "--origin", origin, "--commit", commit, "--history", "branch"}).status, 0);
  const auto workflow = [&](const std::string& project) {
    return read_file(folder() / project / ".github/workflows/test.yml");
  };
  EXPECT_THAT(workflow("usual"), AllOf(HasSubstr("  REHEARSE_HISTORY: artifact #"), HasSubstr("  contents: read #")));
  EXPECT_THAT(workflow("branch"), AllOf(HasSubstr("  REHEARSE_HISTORY: branch #"), HasSubstr("  contents: write #")));
  const Outcome refused = run(command, {"new", "other", "--history", "disk"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("disk"), HasSubstr("artifact")));
  EXPECT_FALSE(fs::exists(folder() / "other"));
}

/// The text of a step's `run`.
std::string script_of(const std::string& workflow, const std::string& step) {
  const std::size_t begin = workflow.find("run: |\n", workflow.find("- name: " + step + "\n")) + 7;
  return workflow.substr(begin, workflow.find("      - name", begin) - begin);
}

/// The steps that keep the history on a branch, with a repository on this disk.
TEST_F(New, ItsWorkflowKeepsTheHistoryOnABranch) {
  ASSERT_EQ(run(command, {"new", "arm", "--origin", origin, "--commit", commit, "--history", "branch"}).status, 0);
  const std::string workflow = read_file(folder() / "arm/.github/workflows/test.yml");
  const auto write_step = [&](const std::string& name, const std::string& step) {
    std::string text = script_of(workflow, step);
    const std::string clone = (folder() / "clone").string();  // in place of the steps' own folder
    for (std::size_t at = 0; (at = text.find("/tmp/history", at)) != std::string::npos; at += clone.size())
      text.replace(at, 12, clone);
    write(name, text);
  };
  write_step("fetch.sh", "Fetch the history of checks");
  write_step("keep.sh", "Keep the history on its branch");
  const std::string identity = "git -c user.name=n -c user.email=e ";
  const auto shell = [&](const std::string& line) { return run("bash", {"-e", "-c", line}); };
  ASSERT_EQ(shell("git init -q -b main origin && cd origin && echo a > a && git add a && " + identity +
                  "commit -q -m a && git config receive.denyCurrentBranch ignore")
                .status,
            0);
  const std::string environment =
      "export TOKEN=t GITHUB_SHA=abc ORIGIN=" + quoted("file://" + folder().string() + "/origin");
  for (const char* line : {"first", "second"}) {
    const Outcome kept = shell(environment + "; rm -rf clone work; mkdir work; cd work; bash -e ../fetch.sh; echo " +
                               line + " >> history.jsonl; bash -e ../keep.sh");
    ASSERT_EQ(kept.status, 0) << kept.out << kept.err;
  }
  const Outcome unchanged =
      shell(environment + "; rm -rf clone work; mkdir work; cd work; bash -e ../fetch.sh; bash -e ../keep.sh");
  EXPECT_EQ(unchanged.status, 0) << unchanged.err << "no check was added";
  EXPECT_EQ(shell("git -C origin show rehearse-history:history.jsonl").out, "first\nsecond\n");
  EXPECT_EQ(shell("git -C origin ls-tree --name-only rehearse-history").out, "history.jsonl\n") << "nothing else";
  EXPECT_EQ(shell("git -C origin log --format=%s rehearse-history").out,
            "Add the checks of abc\nAdd the checks of abc\n");
  EXPECT_EQ(shell("git -C origin log --format=%s main").out, "a\n") << "other branches stay";
}

/// The step of the workflow that gets the packages, with programs in place of apt and curl that need no network.
class NewWorkflow : public New {
 protected:
  NewWorkflow() {
    EXPECT_EQ(run(command, {"new", ".", "--origin", "file://" + repository().string(), "--commit", commit}).status, 0);
    const std::string workflow = read_file(folder() / ".github/workflows/test.yml");
    std::string text = script_of(workflow, "Fetch the packages of Rehearse, or build them");
    const std::string source = (folder() / "source").string();  // in place of the step's own folder
    for (std::size_t at = 0; (at = text.find("/tmp/rehearse", at)) != std::string::npos; at += source.size())
      text.replace(at, 13, source);
    for (const char* below : {"bin", "repository/tools", "repository/releases/download/v" REHEARSE_VERSION})
      fs::create_directories(folder() / below);
    write("step.sh", text);
    write("bin/apt-get", "#!/bin/sh\n");
    write("bin/dpkg", "#!/bin/sh\ngrep -q '^a package' \"$2\"\n");
    write("bin/curl", "#!/bin/sh\nfor last; do :; done\ncp \"${last#file://}\" \"$4\"\n");
    for (const char* program : {"apt-get", "dpkg", "curl"})
      fs::permissions(folder() / "bin" / program, fs::perms::owner_all);
    write("repository/tools/package",
          "#!/bin/sh\nmkdir -p build/packages\nfor package in rehearse rehearse-dev rehearse-doc; do\n"
          "  echo \"a package built of $(git rev-parse HEAD)\" > build/packages/${package}_9-1_amd64.deb\ndone\n");
    fs::permissions(repository() / "tools/package", fs::perms::owner_all);
    const std::string line =
        "cd repository && git init --quiet && git add . && git -c user.name=n -c user.email=e "
        "commit --quiet -m first && git rev-parse HEAD";
    commit_ = run("sh", {"-c", line}).out;
  }
  fs::path repository() const { return folder() / "repository"; }
  void release(const std::string& package, const std::string& content) const {
    write("repository/releases/download/v" REHEARSE_VERSION "/" + package + "_" REHEARSE_VERSION "-1_amd64.deb",
          content);
  }
  Outcome get() const {
    return run(
        "bash", {"-e", "step.sh"},
        "PATH=\"$PWD/bin:$PATH\" REHEARSE_PACKAGES=\"$PWD/packages\" REHEARSE_COMMIT=HEAD REHEARSE_ORIGIN=\"file://" +
            repository().string() + "\"");
  }
  std::string commit_;
};

TEST_F(NewWorkflow, InstallsTheRelease) {
  release("rehearse", "a package of the release\n");
  release("rehearse-dev", "a package for builds\n");
  const Outcome got = get();
  EXPECT_EQ(got.status, 0) << got.err;
  EXPECT_EQ(read_file(folder() / "packages/rehearse.deb"), "a package of the release\n");
  EXPECT_EQ(read_file(folder() / "packages/rehearse-dev.deb"), "a package for builds\n");
  EXPECT_FALSE(fs::exists(folder() / "source"));
}

TEST_F(NewWorkflow, BuildsFromSourceWithoutARelease) {
  const Outcome got = get();
  EXPECT_EQ(got.status, 0) << got.err;
  for (const char* package : {"rehearse", "rehearse-dev"})
    EXPECT_EQ(read_file(folder() / "packages" / (std::string(package) + ".deb")), "a package built of " + commit_);
}

/// Some servers answer with a page instead of an error.
TEST_F(NewWorkflow, BuildsFromSourceWhereTheAnswerIsNoPackage) {
  release("rehearse", "<html>Sign in</html>\n");
  release("rehearse-dev", "<html>Sign in</html>\n");
  const Outcome got = get();
  EXPECT_EQ(got.status, 0) << got.err;
  EXPECT_EQ(read_file(folder() / "packages/rehearse.deb"), "a package built of " + commit_);
}

TEST_F(New, TheAddressOfItsOriginIsTakenFromTheRemote) {
  const std::string functions = quoted((fixtures.parent_path() / "tools/lib.sh").string());
  const auto origin_of = [&](const std::string& remote) {
    return run("bash", {"-c", "source " + functions + "; origin_of \"$1\"", "bash", remote}).out;
  };
  for (const char* remote : {"git@github.com:owner/name.git", "ssh://git@github.com/owner/name",
                             "https://github.com/owner/name.git", "https://github.com/owner/name"})
    EXPECT_EQ(origin_of(remote), "https://github.com/owner/name\n") << remote;
  EXPECT_EQ(origin_of("git@example.org:group/team/name.git"), "https://example.org/group/team/name\n");
  for (const char* remote : {"", "/srv/git/name.git", "../name", "file:///srv/git/name.git"})
    EXPECT_EQ(origin_of(remote), "") << remote;
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
  EXPECT_EQ(outcome.err, "error: mine is not empty (name a new folder, an empty one, or a repository without files)\n");
  EXPECT_FALSE(fs::exists(folder() / "mine" / "CMakeLists.txt"));
  EXPECT_EQ(read_file(folder() / "mine" / "notes.txt"), "keep");
}

TEST_F(New, GoesIntoARepositoryWithoutFiles) {
  fs::create_directories(folder() / "mine/.git");
  EXPECT_EQ(run(command, {"new", "mine", "--language", "cpp"}).status, 0) << "as C++ is often spelt";
  EXPECT_TRUE(fs::exists(folder() / "mine/hold.cpp"));
}

TEST_F(New, LeavesNothingOnAFullDisk) {
  fs::create_directories(folder() / "mine/.git");
  for (const char* name : {"new", "mine"}) {
    const Outcome outcome = rehearse({"new", name}, "trap '' XFSZ; ulimit -f 1;");
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("can't"));
  }
  EXPECT_FALSE(fs::exists(folder() / "new"));
  EXPECT_TRUE(fs::exists(folder() / "mine/.git"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder() / "mine"), {}), 1);
}

TEST_F(New, NeedsAFolder) {
  std::ofstream(folder() / "file") << "x";
  EXPECT_EQ(run(command, {"new", "file"}).err, "error: file is not a folder\n");
  EXPECT_EQ(run(command, {"new"}).status, 2);
  EXPECT_THAT(run(command, {"new", "file/below"}).err, HasSubstr("can't make the folder file/below"));
}

}  // namespace
}  // namespace rehearse::test
