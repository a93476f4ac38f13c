// rehearse check --history, and rehearse history.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A project of scenarios in which a box falls 12.3 mm.
class CommandHistory : public Command {
 protected:
  CommandHistory() { fs::create_directories(folder() / "golden"); }

  /// Expects the box above this height [m].
  void falls(const std::string& above, const std::string& name = "falls") const {
    fs::create_directories(folder() / "scenarios");
    write("scenarios/" + name + ".yaml",
          "rehearse: 1\nduration: 0.05\nbodies:\n  - name: Box\n    box: {size: [0.1, 0.1, 0.1]}\n"
          "    mass: 1\n    position: [0, 0, 1]\nexpect:\n  - {always: \"Box/Box/position/z > " +
              above + " m\"}\n");
  }
  std::vector<nlohmann::json> lines() const {
    std::vector<nlohmann::json> all;
    std::istringstream stream(read_file(folder() / "history.jsonl"));
    for (std::string line; std::getline(stream, line);) all.push_back(nlohmann::json::parse(line));
    return all;
  }
  /// A history of margins, a commit each.
  void keep(const std::vector<double>& margins) const {
    std::string text;
    for (std::size_t i = 0; i < margins.size(); ++i)
      text += nlohmann::json{{"history", 1},
                             {"commit", "c" + std::to_string(i)},
                             {"changed", false},
                             {"date", ""},
                             {"scenario", "walk"},
                             {"code", "same"},
                             {"proved", true},
                             {"first", nullptr},
                             {"margins", nlohmann::json::array({{{"text", "stays <upright>"},
                                                                 {"margin", margins[i]},
                                                                 {"value", 1.0},
                                                                 {"bound", 2.0},
                                                                 {"unit", "rad"},
                                                                 {"share", margins[i] / 2.0},
                                                                 {"tick", 7}}})}}
                  .dump() +
              "\n";
    write("history.jsonl", text);
  }
};

TEST_F(CommandHistory, HasALineForEachScenarioInTheirOrderHoweverManyWorkersThereAre) {
  for (const char* name : {"a", "b", "c"}) falls(name == std::string("b") ? "0.99" : "0.9", name);
  std::string before;
  for (const char* jobs : {"-j1", "-j3"}) {
    fs::remove(folder() / "history.jsonl");
    EXPECT_EQ(rehearse({"check", jobs, "--history", "history.jsonl", "--commit", "v1", "--date", "2026-11-27"}).status,
              1);
    const std::string text = read_file(folder() / "history.jsonl");
    if (!before.empty()) {
      EXPECT_EQ(text, before);
    }
    before = text;
  }
  const auto all = lines();
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0]["scenario"], "a");
  EXPECT_EQ(all[0]["code"], "expectations.hold");
  EXPECT_EQ(all[1]["scenario"], "b");
  EXPECT_EQ(all[1]["code"], "expectations.violated");
  EXPECT_NEAR(all[1]["margins"][0]["margin"].get<double>(), -0.0025, 0.0005);
  EXPECT_GT(all[1]["first"]["tick"], 0);
  EXPECT_EQ(all[2]["commit"], "v1");
  EXPECT_EQ(all[2]["date"], "2026-11-27");
  EXPECT_EQ(before.find(folder().string()), std::string::npos) << "no place of this machine: " << before;
}

TEST_F(CommandHistory, GrowsByEachCheckAndShowsTheMargin) {
  for (const char* bound : {"0.9", "0.9"}) {
    falls(bound);
    done({"check", "--history", "history.jsonl", "--commit", "v1"});
  }
  ASSERT_EQ(lines().size(), 2U);
  const Outcome shown = done({"history", "history.jsonl"});
  EXPECT_THAT(shown.out,
              AllOf(StartsWith("no drift: 1 margin of 1 scenario\nfalls: 2 checks, the last: expectations.hold\n"),
                    HasSubstr(" m, "), HasSubstr(" % of the bound: always Box/Box/position/z > 0.9 m\n")));
}

TEST_F(CommandHistory, HasALineForAScenarioThatCannotBeJudged) {
  falls("0.9");
  write("scenarios/broken.yaml", "rehearse: 1\nexpect: 3\n");
  EXPECT_EQ(rehearse({"check", "--history", "history.jsonl"}).status, 2);
  ASSERT_EQ(lines().size(), 2U);
  EXPECT_EQ(lines()[0]["code"], "undecided.bad_input");
  EXPECT_EQ(lines()[0]["commit"], "") << "there is no repository";
}

TEST_F(CommandHistory, IsRefusedWithoutADateInItsForm) {
  falls("0.9");
  const Outcome outcome = rehearse({"check", "--history", "history.jsonl", "--date", "yesterday"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("the date of a history is 'yesterday' (write it as 2026-11-27 or"));
  EXPECT_FALSE(exists("history.jsonl"));
  EXPECT_EQ(rehearse({"check", "--date", "2026-11-27"}).status, 2) << "without --history";
  EXPECT_EQ(rehearse({"check", "--history", "none/history.jsonl"}).status, 2);
}

TEST_F(CommandHistory, FailsOnDriftIfThatIsWanted) {
  keep({0.5, 0.49, 0.4802, 0.4706, 0.4612, 0.452, 0.4429, 0.4341, 0.4254, 0.4169, 0.4085});
  const std::string sentence =
      "the margin of 'stays <upright>' of walk shrank in 10 of the last 10 commits, by 18.3 %\n";
  EXPECT_THAT(done({"history", "history.jsonl"}).out, StartsWith(sentence));
  const Outcome outcome = rehearse({"history", "history.jsonl", "--fail-on-drift", "--html", "history.html"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, AllOf(StartsWith(sentence), HasSubstr("\n  ██▇▆▅▄▄▃▂▁▁ 0.4085 rad, 20.4 % of the bound: "),
                                 HasSubstr(": it drifts (p = 0.00098)\n"), HasSubstr("wrote history.html\n")));
  const std::string page = read_file(folder() / "history.html");
  EXPECT_THAT(page, AllOf(StartsWith("<!doctype html>"), HasSubstr("<polyline"), HasSubstr("stays &lt;upright&gt;")));
  EXPECT_EQ(page.find("stays <upright>"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos) << "one file";
  const nlohmann::json object = rehearse({"history", "history.jsonl", "--json"}).json();
  EXPECT_EQ(object["drifts"], true);
  EXPECT_EQ(object["margins"][0]["shrank"], 10);
  EXPECT_EQ(object["margins"][0]["points"][10]["commit"], "c10");
}

TEST_F(CommandHistory, PassesWithoutDrift) {
  keep({0.5, 0.51, 0.49, 0.5, 0.52, 0.5, 0.49, 0.51});
  EXPECT_EQ(done({"history", "history.jsonl", "--fail-on-drift"}).err, "");
}

TEST_F(CommandHistory, NamesBadLinesAndShowsTheOthers) {
  keep({0.5, 0.5});
  std::ofstream(folder() / "history.jsonl", std::ios::app) << ">>>>>>> theirs\n";
  const Outcome outcome = rehearse({"history", "history.jsonl"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.out, HasSubstr("walk: 2 checks"));
  EXPECT_EQ(outcome.err,
            "history.jsonl:3:1: error: this line is no JSON: '>>>>>>> theirs' (git left it: keep the lines of both "
            "sides, and remove its marks)\n");
  EXPECT_EQ(rehearse({"history", "history.jsonl", "--json"}).json()["errors"][0]["line"], 3);
}

TEST_F(CommandHistory, RefusesFilesThatAreNone) {
  EXPECT_EQ(rehearse({"history", "none.jsonl"}).status, 2);
  write("empty.jsonl", "\n");
  EXPECT_THAT(rehearse({"history", "empty.jsonl"}).err, HasSubstr("the history has no line (rehearse check --history"));
  keep({0.5});
  write("page.html", "mine");
  EXPECT_EQ(rehearse({"history", "history.jsonl", "--html", "page.html"}).status, 2);
  EXPECT_EQ(read_file(folder() / "page.html"), "mine");
}

}  // namespace
}  // namespace rehearse::test
