// Simultaneous runs in one folder: none uses files that a different run writes.
#include <gmock/gmock.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class RunsBesideEachOther : public Command {
 protected:
  RunsBesideEachOther() {
    fs::create_directories(folder() / "golden");
    scene(0.5);
    EXPECT_EQ(rehearse({"check", "box.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  }
  /// A box that falls from that height [m].
  void scene(double height) const {
    write("box.yaml",
          "rehearse: 1\nname: box\ngolden: Box.Falls\nduration: 0.3\nbodies:\n  - name: Box\n"
          "    box: {size: [0.2, 0.2, 0.2]}\n    mass: 1\n    position: [0, 0, " +
              std::to_string(height) + "]\n");
  }
  /// Runs `count` commands at the same time; returns the exit status and the output of each.
  std::vector<Outcome> at_once(int count, const std::string& line) const {
    std::string script;
    for (int i = 0; i < count; ++i)
      script += "{ " + line + " > " + std::to_string(i) + ".out 2> " + std::to_string(i) + ".err; echo $? > " +
                std::to_string(i) + ".status; } & ";
    EXPECT_EQ(run("/bin/sh", {"-c", script + "wait"}).status, 0);
    std::vector<Outcome> outcomes;
    for (int i = 0; i < count; ++i) {
      const std::string name = std::to_string(i);
      outcomes.push_back({std::stoi(read_file(folder() / (name + ".status"))), read_file(folder() / (name + ".out")),
                          read_file(folder() / (name + ".err"))});
    }
    return outcomes;
  }
  std::string check() const { return quoted(command.string()) + " check box.yaml"; }
  int runs_left_behind() const {
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder()))
      count += entry.path().filename().string().starts_with(".run-") ? 1 : 0;
    return count;
  }
};

TEST_F(RunsBesideEachOther, TwoAndFourChecksOfOneGoldenAllPass) {
  constexpr int rounds = 8;
  for (int round = 0; round < rounds; ++round) {
    for (const int count : {2, 4})
      for (const Outcome& outcome : at_once(count, check())) {
        EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("equal"));
        EXPECT_THAT(outcome.out, Not(HasSubstr("golden accept")));
      }
  }
  EXPECT_FALSE(exists("rehearse-pending/Box.Falls.mcap"));
  EXPECT_EQ(runs_left_behind(), 0);
}

TEST_F(RunsBesideEachOther, WhatWaitsIsWholeWheneverItIsThere) {
  scene(0.6);
  for (int round = 0; round < 4; ++round) {
    for (const Outcome& outcome : at_once(4, check() + " --no-report")) {
      EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr("this run: rehearse-pending/Box.Falls.mcap"));
      EXPECT_THAT(outcome.out, Not(HasSubstr(".run-")));
    }
    EXPECT_EQ(rehearse({"doctor", "rehearse-pending/Box.Falls.mcap"}).status, 0);
  }
  EXPECT_EQ(runs_left_behind(), 0);
  EXPECT_EQ(rehearse({"golden", "accept", "Box.Falls"}).status, 0);
  EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 0);
}

TEST_F(RunsBesideEachOther, AnOldRunThatWaitsGoesWhenACheckPasses) {
  scene(0.6);
  EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 1);
  EXPECT_TRUE(exists("rehearse-pending/Box.Falls.mcap"));
  scene(0.5);
  EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 0);
  EXPECT_FALSE(exists("rehearse-pending/Box.Falls.mcap"));
}

TEST_F(RunsBesideEachOther, TheFolderOfAKilledRunIsRemovedByTheNext) {
  fs::create_directories(folder() / "rehearse-pending/.run-abcdef");
  write("rehearse-pending/.run-abcdef/Box.Falls.mcap", "half");
  EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 0);
  EXPECT_EQ(runs_left_behind(), 0);
}

TEST_F(RunsBesideEachOther, TestProgramsOfTheSameTestsDoNotDisturbEachOther) {
  write("fall.yaml",
        "rehearse: 1\nname: fall\nduration: 0.1\nbodies:\n  - name: Box\n"
        "    box: {size: [0.2, 0.2, 0.2]}\n    mass: 1\n    position: [0, 0, 0.5]\n");
  const std::string environment = "REHEARSE_FIXTURES=. REHEARSE_GOLDEN_DIR=golden REHEARSE_REPORT=always ";
  const Outcome made = run(OWNING_TESTS, {}, environment + "REHEARSE_GOLDEN=new");
  ASSERT_EQ(made.status, 0) << made.out;
  for (int round = 0; round < 4; ++round)
    for (const Outcome& outcome : at_once(4, environment + quoted(OWNING_TESTS) + " --gtest_brief=1"))
      EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_TRUE(exists("traces/Macro.Falls.mcap"));
  EXPECT_EQ(rehearse({"doctor", "traces/Macro.Falls.mcap"}).status, 0);
  EXPECT_EQ(runs_left_behind(), 0);
}

TEST_F(RunsBesideEachOther, OneOfFourAcceptsDecidesAndTheOthersSayThatItIsDecided) {
  for (int round = 0; round < 8; ++round) {
    scene(0.6 + 0.01 * round);
    EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 1);
    int accepted = 0;
    for (const Outcome& outcome : at_once(4, quoted(command.string()) + " golden accept Box.Falls")) {
      accepted += outcome.status == 0 ? 1 : 0;
      if (outcome.status == 0) continue;
      EXPECT_EQ(outcome.status, 2);
      EXPECT_THAT(outcome.err,
                  ::testing::AnyOf(HasSubstr("error: another process has accepted or rejected the run that "
                                             "waited as 'Box.Falls'"),
                                   HasSubstr("error: nothing waits to be accepted as 'Box.Falls'")));
    }
    EXPECT_EQ(accepted, 1);
    EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 0);
  }
}

TEST_F(RunsBesideEachOther, AnAcceptanceRemovesTheDraftsOfAKilledOneAndNothingElse) {
  for (const char* file : {"golden/Box.Falls.mcap.new", "golden/Box.Falls.mcap.new.samples",
                           "golden/Other.Test.txt.new", "golden/notes.new"})
    write(file, "half of it");
  scene(0.7);
  EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 1);
  EXPECT_EQ(rehearse({"golden", "accept", "Box.Falls"}).status, 0);
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder() / "golden")) left.push_back(entry.path().filename());
  EXPECT_THAT(left, ::testing::UnorderedElementsAre("Box.Falls.mcap", "Box.Falls.txt", "notes.new"));
}

}  // namespace
}  // namespace rehearse::test
