// replay --beside: faults in a controller, found by comparison with its old library.
#include <gmock/gmock.h>

#include <fstream>
#include <string>
#include <tuple>

#include "gdb_command.h"

namespace rehearse::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// "beside.cpp:41": the line with that comment.
std::string line_with(const std::string& comment, const std::string& source = "beside.cpp") {
  std::ifstream stream(std::string(BESIDE_SOURCES "/") + source);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.find("// " + comment) != std::string::npos) return source + ":" + std::to_string(number);
  }
  ADD_FAILURE() << "no line has the comment // " << comment;
  return "";
}

class Lockstep : public GdbCommand {
 protected:
  static std::string library(int fault) { return BESIDE_FOLDER "/beside_" + std::to_string(fault) + ".so"; }

  void record(const std::string& controller = library(0)) const {
    const Outcome outcome = rehearse({"record", (fixtures / "scenarios/quadruped.yaml").string(), "--controller",
                                      "Trot=" + controller, "--duration", "0.3", "-o", "run.mcap"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  Outcome beside(const std::string& changed, const std::string& old) const {
    return rehearse({"replay", "run.mcap", "--controller", "Trot=" + changed, "--beside", old}, environment);
  }
};

/// Number of the fault, the tick, the beginning of the verdict, and the number that differs.
using Fault = std::tuple<int, const char*, const char*>;

class LockstepOfFault : public Lockstep, public ::testing::WithParamInterface<Fault> {};

TEST_P(LockstepOfFault, NamesTheLineOfTheCause) {
  const auto [fault, when, what] = GetParam();
  record();
  const Outcome outcome = beside(library(fault), library(0));
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const std::string line = line_with("fault " + std::to_string(fault) + ":");
  const std::string verdict = outcome.out.substr(0, outcome.out.find('\n'));
  EXPECT_THAT(verdict, StartsWith(std::string("Quadruped/Trot differs first at tick ") + when));
  EXPECT_THAT(verdict, AllOf(HasSubstr(" " + line + " "), HasSubstr(what)));
  EXPECT_THAT(outcome.out, HasSubstr("\n  new  " + line));
  EXPECT_THAT(outcome.out, HasSubstr("\ncompared: 15 numbers of its object before "));
  EXPECT_EQ(outcome.err, "");
}

/// By day a member of a container and a branch; every night all.
std::vector<Fault> faults() {
  std::vector<Fault> all = {{5, "3 (0.003 s)", ": rate[0] is "}, {7, "100 (0.1 s)", ": is_rising is true, not false"}};
  const std::vector<Fault> others = {
      {2, "1 (0.001 s)", ": gain is 35, not 30"},           {3, "151 (0.151 s)", ""},
      {4, "1 (0.001 s)", ": share is 0, not 0.002"},        {6, "100 (0.1 s)", ": swing is 0.25"},
      {8, "101 (0.101 s)", ": cycles is 0.452, not 0.202"}, {9, "92 (0.092 s)", ": is_saturated_ is true, not false"},
      {11, "0 (0 s)", ": effort is 10, not 85.96"}};
  if (AT_NIGHT) all.insert(all.end(), others.begin(), others.end());
  return all;
}

INSTANTIATE_TEST_SUITE_P(Faults, LockstepOfFault, ::testing::ValuesIn(faults()),
                         [](const auto& info) { return "Number" + std::to_string(std::get<0>(info.param)); });

/// Changes of one line, in the form that a fix or a slip has. By day exchanged results; every night all.
class LockstepOfChange : public Lockstep, public ::testing::WithParamInterface<Fault> {};

TEST_P(LockstepOfChange, NamesTheLine) {
  const auto [fault, when, what] = GetParam();
  const std::string old = BESIDE_FOLDER "/beside_more_0.so";
  record(old);
  const Outcome outcome = beside(library(fault), old);
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const std::string verdict = outcome.out.substr(0, outcome.out.find('\n'));
  EXPECT_THAT(verdict, StartsWith(std::string("Quadruped/Trot differs first at tick ") + when));
  EXPECT_THAT(verdict,
              AllOf(HasSubstr(" " + line_with("fault " + std::to_string(fault) + ":", "beside_more.cpp") + " "),
                    HasSubstr(what)));
}

std::vector<Fault> changes() {
  std::vector<Fault> all = {{19, "0 (0 s)", ": its result is 0.010000000000000002, not 0.1"}};
  const std::vector<Fault> others = {{12, "50 (0.05 s)", ": they go different ways from "},
                                     {24, "201 (0.201 s)", ": its result is false, not true"},
                                     {13, "1 (0.001 s)", ": integral_ is "},
                                     {14, "0 (0 s)", ": to is 0.1, not 0.4"},
                                     {15, "51 (0.051 s)", ": they go different ways from "},
                                     {16, "0 (0 s)", ": they go different ways from "},
                                     {17, "0 (0 s)", ": filtered_ is "},
                                     {18, "0 (0 s)", ": they go different ways from "},
                                     {20, "51 (0.051 s)", ": gains[1] is 54, not 45"},
                                     {21, "51 (0.051 s)", ": integral_ is "},
                                     {22, "2 (0.002 s)", ": knee is "},
                                     {23, "1 (0.001 s)", ": its result is "}};
  if (AT_NIGHT) all.insert(all.end(), others.begin(), others.end());
  return all;
}

INSTANTIATE_TEST_SUITE_P(Changes, LockstepOfChange, ::testing::ValuesIn(changes()),
                         [](const auto& info) { return "Number" + std::to_string(std::get<0>(info.param)); });

TEST_F(Lockstep, NamesMembersThatDifferBeforeTheRun) {
  record();
  EXPECT_THAT(
      beside(library(1), library(0)).out,
      AllOf(StartsWith("Quadruped/Trot differs first before the run: legs_[2].side is -1, not 1; then at tick 100 "),
            HasSubstr(": wanted is -0.09")));
  EXPECT_THAT(beside(library(10), library(0)).out,
              StartsWith("Quadruped/Trot differs first before the run: lean_ is never set, not 0"));
}

TEST_F(Lockstep, OfEqualLibrariesFindsNothing) {
  record();
  const Outcome outcome = beside(library(0), library(0));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              StartsWith("Quadruped/Trot is equal with both libraries: its commands, and 15 numbers of its "
                         "object before 300 ticks\n"));
}

TEST_F(Lockstep, ComparesLibrariesOfWhichNeitherWasRecorded) {
  record();
  const Outcome outcome =
      beside(library(4), library(2));  // the commands of both differ from the recorded ones at tick 1
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, StartsWith("Quadruped/Trot differs first at tick 1 (0.001 s), after "));
  EXPECT_THAT(outcome.out, HasSubstr(": share is 0, not 0.002"));
  EXPECT_THAT(outcome.err, HasSubstr("isn't the recorded controller: its commands differ from tick 1 on"));
}

TEST_F(Lockstep, IsAnObjectOfJsonToo) {
  record();
  const nlohmann::json object =
      rehearse({"replay", "run.mcap", "--controller", "Trot=" + library(2), "--beside", "Trot=" + library(0), "--json"},
               environment)
          .json();
  EXPECT_EQ(object["equal"], false);
  EXPECT_EQ(object["controller"], "Quadruped/Trot");
  EXPECT_EQ(object["tick"], 1);
  EXPECT_EQ(object["values"], nlohmann::json::parse(R"([{"name": "gain", "old": "30", "new": "35"}])"));
  EXPECT_EQ("beside.cpp:" + std::to_string(object["new"]["line"].get<int>()), line_with("fault 2:"));
  EXPECT_EQ(object["new"]["function"], "(anonymous namespace)::Beside::hold");
}

TEST_F(Lockstep, OfOptimisedLibrariesNamesTheLastWrite) {
  record();
  const Outcome outcome = beside(BESIDE_FOLDER "/beside_optimised.so", library(0));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, AllOf(StartsWith("Quadruped/Trot differs first at tick 1 (0.001 s), after beside.cpp:"),
                                 HasSubstr(": command FL_ABDUCTION/u is 0.014")));
  EXPECT_THAT(outcome.err, HasSubstr("warning: the library is optimised: "));
}

/// A project of `rehearse new` whose golden is in the last but one commit, and whose sources have changed since.
class Committed : public Lockstep {
 protected:
  const std::string rehearse_word = quoted(command.string()), check = rehearse_word + " check --no-report";

  Outcome shell(const std::string& line, const std::string& more = "CI=", int status = 0) const {
    const std::string in_build = "CMAKE_PREFIX_PATH=" BUILD_FOLDER " REHEARSE_CALL_STACK=never ";
    const Outcome outcome = run("/bin/sh", {"-c", "cd arm && " + line}, in_build + more);
    EXPECT_EQ(outcome.status, status) << line << ": " << outcome.out << outcome.err;
    return outcome;
  }
  /// `change`: an expression of sed.
  void make(const std::string& language, const std::string& source, const std::string& change) const {
    ASSERT_EQ(rehearse({"new", "--language", language, "arm"}).status, 0);
    const std::string build = "cmake --build build --target Hold";
    const std::string commit = "git add . && git -c user.name=t -c user.email=t@t commit -qm ";
    shell("cmake -S . -B build && " + build);
    shell(check, "CI= REHEARSE_GOLDEN=new");
    shell("git init -q . && " + commit + "golden && echo >> " + source + " && " + commit + "later");
    shell("sed -i " + quoted(change) + " " + source + " && " + build);
  }
};

/// `check` names the commit of the golden, and the command that it prints finds the line.
TEST_F(Committed, SourcesAreBuiltForTheCommandThatCheckPrints) {
  if (test::run("git --version && cmake --version").status != 0) GTEST_SKIP() << "git or cmake isn't installed";
  make("c++", "hold.cpp", "s/damping \\* shoulder/0.5 * damping * shoulder/");
  std::string golden_commit = shell("git rev-parse --short HEAD~1").out;
  golden_commit.pop_back();
  const std::string words = " replay golden/Hold.ComesBackAfterAPush.mcap --beside " + golden_commit;
  EXPECT_THAT(shell(check, "CI=", 1).out, HasSubstr("\nwhich line: rehearse" + words + "\n"));
  EXPECT_THAT(shell(check, "CI=true", 1).out, Not(HasSubstr("which line"))) << "a clone there may have one commit";
  const Outcome outcome = shell(rehearse_word + words, environment, 1);
  EXPECT_THAT(outcome.out, AllOf(StartsWith("Arm/Hold differs first at tick "),
                                 HasSubstr(" in Hold::control(): command "
                                           "SHOULDER/u is "),
                                 HasSubstr("\n  new  hold.cpp:"), HasSubstr(" - 0.5 * damping * ")));
  shell("git rm -q --cached golden/Hold.ComesBackAfterAPush.mcap");
  EXPECT_THAT(shell(check, "CI=", 1).out, Not(HasSubstr("which line"))) << "no commit has this golden";
}

TEST_F(Committed, ControllerInCHasNoClassToCompare) {
  if (test::run("git --version && cmake --version").status != 0) GTEST_SKIP() << "git or cmake isn't installed";
  make("c", "hold.c", "s/60/59/");
  EXPECT_THAT(shell(check, "CI=", 1).out, AllOf(HasSubstr("the controller changed"), Not(HasSubstr("which line"))));
}

class LockstepRefusal : public Lockstep {
 protected:
  std::string refusal(const std::vector<std::string>& words, const std::string& with = environment) const {
    const Outcome outcome = rehearse(words, with);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    return outcome.err;
  }
};

TEST_F(LockstepRefusal, SaysWhatIsMissing) {
  record();
  EXPECT_THAT(refusal({"replay", "run.mcap", "--beside", "nothing"}),
              AllOf(StartsWith("error: controller library 'nothing' not found"),
                    HasSubstr("git knows no commit of that name")));
  EXPECT_EQ(refusal({"replay", "run.mcap", "--beside", "Walk=" + library(0)}),
            "error: --beside Walk=...: the run has no controller of that name (expected NAME=OLD; controllers: "
            "Quadruped/Trot)\n");
  write("trot.py", "");
  EXPECT_EQ(
      refusal({"replay", "run.mcap", "--controller", "Trot=trot.py:Trot", "--beside", library(0)}),
      "error: --beside compares controllers in C++, and trot.py:Trot is in Python (replay --tick and --watch show "
      "commands beside the recorded ones)\n");
  EXPECT_THAT(refusal({"replay", "run.mcap", "--beside", library(0), "--tick", "3"}),
              StartsWith("error: --beside compares two libraries in whole recordings"));
  EXPECT_EQ(refusal({"replay", "run.mcap", "--beside", library(0)}, "PATH=/nowhere"),
            "error: there is no gdb on the PATH (apt-get install gdb)\n");
}

TEST_F(LockstepRefusal, OfALibraryWithoutDebugInformation) {
  record();
  EXPECT_THAT(refusal({"replay", "run.mcap", "--controller", "Trot=" BESIDE_FOLDER "/beside_without_lines.so",
                       "--beside", library(0)}),
              HasSubstr("Quadruped/Trot has no class in its debug information; it has to be C++, built with -g"));
}

}  // namespace
}  // namespace rehearse::test
