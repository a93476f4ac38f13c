// Lines of a history: written, appended, read, and told apart from other lines.
#include "viewing/history/history.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

CheckReport checked() {
  CheckReport report;
  report.verdict = {VerdictCode::expectations_violated, ""};
  report.verdict.add(VerdictCode::controller_changed);
  ExpectationResult result;
  result.text = "always q < 8 deg";
  result.closest = ClosestPlace{0.1, 0.04, 0.14, "rad", "2.3 of 8 deg", 42, 0.042, 0.7};
  report.expectations.push_back(result);
  report.expectations.push_back({});
  report.expectations.back().text = "undecided";
  return report;
}

class Histories : public ::testing::Test {
 protected:
  fs::path file() const { return folder_ / "history.jsonl"; }
  History read() const {
    auto history = read_history(file());
    EXPECT_TRUE(history.ok()) << to_string(history.errors());
    return history ? *std::move(history) : History();
  }

  test::TemporaryFolder folder_;
};

TEST_F(Histories, HaveLinesWithSortedKeys) {
  EXPECT_EQ(text_of(line_of({"3f2a", false, "2026-11-27"}, "hold", checked())),
            R"({"changed":false,"code":"expectations.violated","commit":"3f2a","date":"2026-11-27","first":null,)"
            R"("history":1,"margins":[{"bound":0.14,"margin":0.1,"share":0.7,"text":"always q < 8 deg","tick":42,)"
            R"("unit":"rad","value":0.04},{"bound":0.0,"margin":null,"share":null,"text":"undecided","tick":0,)"
            R"("unit":"","value":0.0}],"proved":false,"scenario":"hold"})");
}

TEST_F(Histories, AreReadAsTheyWereWritten) {
  CheckReport report = checked();
  report.run = RunSummary();
  ControlTimes control;
  control.controller = "Arm/Hold";
  control.costs = ControlCosts();
  control.costs->counts.push_back({"allocations", 12, 3, 1});
  report.run->control_times.push_back(control);
  const HistoryLine line = line_of({"3f2a", true, ""}, "hold", report);
  ASSERT_TRUE(append_to_history(file(), {text_of(line), text_of(line)}));
  const History history = read();
  EXPECT_TRUE(history.bad.empty()) << to_string(history.bad);
  ASSERT_EQ(history.lines.size(), 2U);
  EXPECT_EQ(text_of(history.lines[1]), text_of(line));
  EXPECT_EQ(history.lines[0].costs.at("Arm/Hold").at("allocations"), 12U);
  EXPECT_EQ(history.lines[0].margins[0].margin, 0.1);
  EXPECT_EQ(history.lines[0].margins[1].margin, std::nullopt);
}

TEST_F(Histories, HaveNoMarginThatIsInfinite) {
  CheckReport report = checked();
  report.expectations[0].closest->margin = std::numeric_limits<double>::infinity();
  EXPECT_EQ(line_of({}, "hold", report).margins[0].margin, std::nullopt);
}

TEST_F(Histories, GrowByWholeLinesThoughProcessesAppendAtTheSameTime) {
  const std::string line = text_of(line_of({"3f2a", false, ""}, "hold", checked()));
  std::vector<pid_t> children;
  for (int i = 0; i < 8; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      bool done = true;
      for (int k = 0; k < 50; ++k) done = append_to_history(file(), {line, line}).ok() && done;
      _exit(done ? 0 : 1);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  const History history = read();
  EXPECT_TRUE(history.bad.empty());
  EXPECT_EQ(history.lines.size(), 800U);
}

TEST_F(Histories, KeepAnIncompleteLastLineApart) {
  std::ofstream(file()) << "{\"changed\": fal";
  ASSERT_TRUE(append_to_history(file(), {text_of(line_of({}, "hold", checked()))}));
  const History history = read();
  EXPECT_EQ(history.lines.size(), 1U);
  ASSERT_EQ(history.bad.size(), 1U);
  EXPECT_EQ(history.bad[0].line, 1);
}

TEST_F(Histories, ThatCannotBeWrittenSaySo) {
  const auto written = append_to_history(folder_ / "none" / "history.jsonl", {"{}"});
  ASSERT_FALSE(written.ok());
  EXPECT_THAT(to_string(written.errors()), HasSubstr("the history can't be written: No such file or directory"));
  EXPECT_FALSE(read_history(folder_ / "none").ok());
  EXPECT_FALSE(read_history(folder_.path()).ok());
}

struct BadLine {
  const char *text, *message;
};

class BadLines : public Histories, public ::testing::WithParamInterface<BadLine> {};

TEST_P(BadLines, AreNamedAndTheOthersAreRead) {
  const std::string good = text_of(line_of({"3f2a", false, ""}, "hold", checked()));
  std::ofstream(file()) << good << "\n\n" << GetParam().text << "\n" << good << "\n";
  const History history = read();
  EXPECT_EQ(history.lines.size(), 2U);
  ASSERT_EQ(history.bad.size(), 1U);
  EXPECT_EQ(history.bad[0].line, 3);
  EXPECT_THAT(to_string(history.bad[0]), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Of, BadLines,
    ::testing::Values(
        BadLine{"<<<<<<< HEAD", "3:1: error: this line is no JSON: '<<<<<<< HEAD' (git left it"},
        BadLine{"{\"history\": 1,}", "3:15: error: this line is no JSON"},
        BadLine{"[1]", "this is no line of a history: it is no object"}, BadLine{"{}", "it has no 'history'"},
        BadLine{"{\"history\": 2}", "it has the version 2, and this program reads 1"},
        BadLine{R"({"history":1,"commit":1})", "its 'commit' is no text"},
        BadLine{R"({"history":1,"commit":"","changed":false,"date":"","scenario":"a","code":"same","proved":0})",
                "its 'proved' is no true or false"},
        BadLine{R"({"history":1,"commit":"","changed":false,"date":"","scenario":"a","code":"same","proved":true})",
                "it has no list 'margins'"},
        BadLine{
            R"({"history":1,"commit":"","changed":false,"date":"","scenario":"a","code":"same","proved":true,"margins":[1]})",
            "a margin is no object"},
        BadLine{
            R"({"history":1,"commit":"","changed":false,"date":"","scenario":"a","code":"same","proved":true,"margins":[{"text":"t"}]})",
            "it has no 'margin'"},
        BadLine{
            R"({"history":1,"commit":"","changed":false,"date":"","scenario":"a","code":"same","proved":true,"margins":[],"costs":[1]})",
            "the costs of a controller are no object"},
        BadLine{
            R"({"history":1,"commit":"","changed":false,"date":"","scenario":"a","code":"same","proved":true,"margins":[],"costs":{"A/B":{"locks":-1}}})",
            "the cost 'locks' is no count"}));

TEST(Stamps, HaveTheStatedCommitAndADate) {
  const auto stamp = stamp_of("v1.2", "2026-11-27T06:50:00Z", ".", "history.jsonl");
  ASSERT_TRUE(stamp.ok());
  EXPECT_EQ(stamp->commit, "v1.2");
  EXPECT_FALSE(stamp->changed);
  for (const char* date : {"27.11.2026", "2026-13-01", "2026-11-32", "2026-11-27 06:50", "now"}) {
    const auto bad = stamp_of("v1.2", date, ".", "history.jsonl");
    ASSERT_FALSE(bad.ok()) << date;
    EXPECT_THAT(to_string(bad.errors()), HasSubstr("write it as 2026-11-27 or 2026-11-27T06:50:00Z"));
  }
}

/// The commit of a repository, and whether its files differ from it; the history itself doesn't count.
TEST_F(Histories, KnowTheCommitOfARepository) {
  const auto git = [this](const std::string& words) {
    return std::system(("cd '" + folder_.path().string() +
                        "' && git -c user.name=A -c user.email=a@b.c -c init.defaultBranch=main " + words +
                        " > /dev/null 2>&1")
                           .c_str());
  };
  if (std::system("git --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "there is no git";
  const auto stamp = [this] {
    auto found = stamp_of("", "", folder_.path(), file());
    EXPECT_TRUE(found.ok());
    return found ? *found : HistoryStamp();
  };
  EXPECT_EQ(stamp().commit, "") << "no repository";
  ASSERT_EQ(git("init"), 0);
  EXPECT_EQ(stamp().commit, "") << "no commit";
  std::ofstream(folder_ / "a.txt") << "1";
  ASSERT_EQ(git("add a.txt"), 0);
  ASSERT_EQ(git("commit -m one"), 0);
  EXPECT_EQ(stamp().commit.size(), 40U);
  EXPECT_FALSE(stamp().changed);
  std::ofstream(file()) << "{}\n";
  EXPECT_FALSE(stamp().changed) << "the history is new";
  ASSERT_EQ(git("add history.jsonl"), 0);
  ASSERT_EQ(git("commit -m two"), 0);
  std::ofstream(file()) << "{}\n{}\n";
  EXPECT_FALSE(stamp().changed) << "the history has grown";
  std::ofstream(folder_ / "a.txt") << "2";
  EXPECT_TRUE(stamp().changed);
}

}  // namespace
}  // namespace rehearse
