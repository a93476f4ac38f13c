// The failures that a project keeps: campaigns and checks run them first.
#include "sweep_fixture.h"

#include <string>
#include <vector>

namespace rehearse::test {
namespace {

class KeptFailures : public Sweep {
 protected:
  KeptFailures() {
    write("CMakeLists.txt", "");
    for (const char* name : {"scenarios", "failures/low"}) fs::create_directories(folder() / name);
    box("", "scenarios/box.yaml");
  }
  /// A campaign of a few boxes, of which none is low.
  Outcome sweep(const std::string& campaign, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"sweep", "scenarios/high.yaml", "--cases", "4", "-o", campaign};
    words.insert(words.end(), more.begin(), more.end());
    return rehearse(words);
  }
  void keep_a_failure() const {
    std::string high = read_file(folder() / "scenarios/box.yaml");
    high.replace(high.find("[0.25,"), 6, "[0.4,");
    write("scenarios/high.yaml", high);
    rehearse({"sweep", "scenarios/box.yaml", "--cases", "40", "-o", "low"});
    const std::string csv = results("low");
    const std::size_t violated = csv.find(",violated,");
    ASSERT_NE(violated, std::string::npos) << "no case fails";
    const std::size_t line = csv.rfind('\n', violated) + 1;
    const std::string number = csv.substr(line, csv.find(',', line) - line);
    EXPECT_EQ(rehearse({"sweep", "shrink", number, "low", "-o", "failures/low/box.yaml"}).status, 0);
  }
};

TEST_F(KeptFailures, RunBeforeACampaignAndFailIt) {
  keep_a_failure();
  const Outcome fails = sweep("fails");
  EXPECT_EQ(fails.status, 1);
  EXPECT_THAT(fails.out, HasSubstr("kept failures: 0 of 1 pass\n"));
  EXPECT_THAT(fails.out, HasSubstr("4 of 4 cases pass"));
  EXPECT_THAT(fails.err, HasSubstr("failures/low/box.yaml: error: this kept failure fails again: violated: expected "
                                   "Box/Box/position/z above 0.3 m: "));
  const Outcome told = rehearse({"sweep", "resume", "fails", "--json"});
  EXPECT_EQ(told.status, 1);
  ASSERT_EQ(told.json()["kept_failures"].size(), 1u);
  EXPECT_EQ(told.json()["kept_failures"][0]["file"], "failures/low/box.yaml");
  EXPECT_EQ(told.json()["kept_failures"][0]["verdict"], "violated");
  EXPECT_EQ(rehearse({"sweep", "report", "fails"}).status, 0) << "it judges the cases alone";

  std::string mended = read_file(folder() / "failures/low/box.yaml");
  mended.replace(mended.find("above: 0.3"), 10, "above: 0.1");
  write("failures/low/box.yaml", mended);
  const Outcome passes = sweep("passes");
  EXPECT_EQ(passes.status, 0) << passes.out << passes.err;
  EXPECT_THAT(passes.out, HasSubstr("kept failures: 1 of 1 pass\n"));
  EXPECT_EQ(passes.err, "");
}

TEST_F(KeptFailures, ThatCantRunAreNamedToo) {
  keep_a_failure();
  write("failures/a.yaml", "rehearse: 1\n");
  const Outcome outcome = sweep("run", {"--json"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.json()["kept_failures"][0]["file"], "failures/a.yaml") << "by path";
  EXPECT_EQ(outcome.json()["kept_failures"][0]["verdict"], "invalid");
  EXPECT_THAT(outcome.err, HasSubstr("failures/a.yaml: error: this kept failure fails again: invalid: "));
}

TEST_F(KeptFailures, ArentCountedWhereThereAreNone) {
  keep_a_failure();
  fs::remove_all(folder() / "failures");
  const Outcome outcome = sweep("run", {"--json"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.json()["kept_failures"], nlohmann::json::array());
  EXPECT_THAT(sweep("again").out, ::testing::Not(HasSubstr("kept failures")));
}

TEST_F(KeptFailures, AreCheckedBeforeTheScenarios) {
  keep_a_failure();
  const Outcome checked = rehearse({"check", "--json"});
  EXPECT_EQ(checked.status, 1) << checked.err;
  const auto scenarios = checked.json()["scenarios"];
  ASSERT_EQ(scenarios.size(), 3u);
  EXPECT_EQ(scenarios[0]["file"], "failures/low/box.yaml");
  EXPECT_EQ(scenarios[1]["file"], "scenarios/box.yaml");
}

}  // namespace
}  // namespace rehearse::test
