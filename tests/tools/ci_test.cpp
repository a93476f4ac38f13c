// The output of `rehearse check` for continuous integration.
#include <gmock/gmock.h>
#include <tinyxml2.h>

#include <regex>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A project with a scenario that is as expected, and one that isn't, in line 9.
class Ci : public Command {
 protected:
  Ci() {
    fs::create_directories(folder() / "golden");
    fs::create_directories(folder() / "scenarios");
    const std::string box =
        "rehearse: 1\nduration: 0.05\nbodies:\n  - name: Box\n    box: {size: [0.1, 0.1, 0.1]}\n"
        "    mass: 1\n    position: [0, 0, 1]\nexpect:\n  - {channel: Box/Box/position/z, above: ";
    write("scenarios/falls.yaml", box + "0.5, at: end}\n");
    write("scenarios/stays.yaml", box + "0.999, at: end}\n");
  }
};

/// The text without wall times.
std::string without_seconds(const std::string& text) {
  return std::regex_replace(text, std::regex("; [0-9.]+ s\n"), "; s\n");
}

TEST_F(Ci, JunitHasACaseForEachScenarioWithTheVerdictForAMessage) {
  EXPECT_EQ(rehearse({"check", "--junit", "check.xml"}).status, 1);
  tinyxml2::XMLDocument xml;
  ASSERT_EQ(xml.LoadFile((folder() / "check.xml").c_str()), tinyxml2::XML_SUCCESS);
  const auto* suites = xml.RootElement();
  ASSERT_STREQ(suites->Name(), "testsuites");
  const auto* suite = suites->FirstChildElement("testsuite");
  ASSERT_NE(suite, nullptr);
  EXPECT_EQ(suite->IntAttribute("tests"), 2);
  EXPECT_EQ(suite->IntAttribute("failures"), 1);
  EXPECT_EQ(suite->IntAttribute("errors"), 0);
  const auto* falls = suite->FirstChildElement("testcase");
  EXPECT_STREQ(falls->Attribute("name"), "falls");
  EXPECT_TRUE(falls->NoChildren());
  const auto* stays = falls->NextSiblingElement("testcase");
  EXPECT_STREQ(stays->Attribute("name"), "stays");
  const auto* failure = stays->FirstChildElement("failure");
  ASSERT_NE(failure, nullptr);
  EXPECT_THAT(failure->Attribute("message"), HasSubstr("expected Box/Box/position/z above 0.999 m at the end"));
  EXPECT_STREQ(failure->Attribute("type"), "expectations.violated");
  EXPECT_THAT(failure->GetText(), StartsWith("scenarios/stays.yaml:9\n"));
}

TEST_F(Ci, AGoldenThatCantBeUsedTakesNoVerdictFromOtherScenarios) {
  std::ofstream(folder() / "scenarios/falls.yaml", std::ios::app) << "golden: Box.Falls\n";
  fs::remove(folder() / "scenarios/stays.yaml");
  ASSERT_EQ(rehearse({"check"}, "REHEARSE_GOLDEN=new").status, 0);
  fs::remove(folder() / "golden/Box.Falls.txt");
  write("scenarios/later.yaml",
        "rehearse: 1\nduration: 0.05\nbodies: [{name: B, sphere: {radius: 0.1}, mass: 1}]\n"
        "expect:\n  - {channel: B/B/position/z, below: 1}\n");
  for (const char* jobs : {"-j1", "-j2"}) {
    const Outcome outcome = rehearse({"check", jobs, "--junit", "check.xml"});
    EXPECT_EQ(outcome.status, 2) << jobs;
    EXPECT_THAT(outcome.out, HasSubstr("later: ")) << jobs;
    EXPECT_THAT(outcome.err, HasSubstr("the digest of golden/Box.Falls.mcap is missing")) << jobs;
    EXPECT_THAT(outcome.err, HasSubstr("1 of 2 scenarios wasn't judged: falls\n")) << jobs;
    EXPECT_THAT(read_file(folder() / "check.xml"), HasSubstr("<error message=\"not judged: the digest of")) << jobs;
  }
  EXPECT_EQ(rehearse({"check", "scenarios/falls.yaml"}).err.find("wasn't judged"), std::string::npos);
}

TEST_F(Ci, AScenarioThatCannotBeReadTakesNoVerdictFromOtherScenarios) {
  write("scenarios/broken.yaml", read_file(folder() / "scenarios/falls.yaml") + "mass: 1\n");
  write("scenarios/heap.yaml", "rehearse: 1\nduration: 0.05\nbodies: [{name: B, sphere: {radius: 0.1}, mass: 1}]\n");
  for (const char* jobs : {"-j1", "-j2"}) {
    const Outcome outcome = rehearse({"check", jobs, "--json"});
    EXPECT_EQ(outcome.status, 2) << jobs;
    EXPECT_THAT(outcome.err,
                AllOf(StartsWith("scenarios/broken.yaml:"), HasSubstr("1 of 3 scenarios wasn't judged: broken\n")))
        << jobs;
    const nlohmann::json scenarios = outcome.json()["scenarios"];
    ASSERT_EQ(scenarios.size(), 3U) << jobs << ": heap.yaml expects nothing";
    EXPECT_THAT(scenarios[0]["verdict"].get<std::string>(), StartsWith("not judged: ")) << jobs;
    EXPECT_EQ(scenarios[0]["code"], "undecided.bad_input") << jobs;
    EXPECT_FALSE(scenarios[0].contains("first")) << jobs << ": it has no place";
    EXPECT_TRUE(outcome.json()["first"].is_null()) << jobs;
    EXPECT_EQ(scenarios[1]["code"], "expectations.hold") << jobs;
    EXPECT_EQ(scenarios[2]["codes"], nlohmann::json({"expectations.violated"})) << jobs;
    EXPECT_EQ(scenarios[1]["within"], true) << jobs;
    EXPECT_EQ(scenarios[2]["within"], false) << jobs;
  }
}

TEST_F(Ci, AControllerThatFailsSideBySideLeavesTheOthersAsTheyAre) {
  const std::string swing = read_file(pendulum(MISBEHAVING, "throw 3")) + "expect:\n  - {no_event: \"*never*\"}\n";
  fs::remove(folder() / "pendulum.yaml");
  for (const char* name : {"a", "b", "y", "z"}) write(std::string("scenarios/") + name + ".yaml", swing);
  const Outcome one = rehearse({"check", "-j1"}), several = rehearse({"check", "-j2"});
  EXPECT_EQ(one.status, 3);
  EXPECT_EQ(several.status, 3);
  EXPECT_EQ(without_seconds(several.out), without_seconds(one.out));
  EXPECT_EQ(several.err, one.err);
}

TEST_F(Ci, ASignalEndsAllThatIsCheckedSideBySide) {
  for (const char* name : {"a", "b", "c"})
    write(std::string("scenarios/") + name + ".yaml",
          "rehearse: 1\nduration: 5000\nbodies: [{name: B, sphere: {radius: 0.1}, mass: 1, position: [0, 0, 9]}]\n"
          "expect:\n  - {channel: B/B/position/z, below: 10}\n");
  for (const char* jobs : {"-j1", "-j2"}) {
    const Outcome outcome =
        rehearse({"check", jobs}, "timeout --preserve-status -s INT 3");  // after its start, also if it is slow
    EXPECT_EQ(outcome.status, 130) << jobs;
    EXPECT_EQ(outcome.out, "") << jobs;
    EXPECT_EQ(outcome.err, "error: interrupted by SIGINT: a was not judged\n") << jobs;
  }
}

TEST_F(Ci, ManyScenariosTakeTheMemoryOfAFew) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps memory of its own";
#endif
  const std::string falls = read_file(folder() / "scenarios/falls.yaml");
  fs::remove(folder() / "scenarios/stays.yaml");
  const auto memory = [&](int count, const char* jobs) {
    for (int i = 0; i < count; ++i) write("scenarios/" + std::to_string(i) + ".yaml", falls);
    return memory_of({"check", jobs});
  };
  const long one = memory(3, "-j1"), two = memory(3, "-j2");
  EXPECT_LT(memory(40, "-j1"), one + 10'000);  // [kB]; a mebibyte of each scenario would be 37,000 more
  EXPECT_LT(memory(40, "-j2"), two + 10'000);
}

TEST_F(Ci, JunitOfACrashIsAnError) {
  write("scenarios/crashes.yaml",
        read_file(pendulum(MISBEHAVING, "crash 3")) + "expect:\n  - {no_event: \"*never*\"}\n");
  fs::remove(folder() / "pendulum.yaml");
  EXPECT_EQ(rehearse({"check", "--junit", "check.xml"}).status, 3);
  EXPECT_THAT(read_file(folder() / "check.xml"), HasSubstr("<error message="));
}

TEST_F(Ci, ScenariosSideBySideGiveTheOutputOfOneAfterTheOther) {
  for (const char* name : {"a", "b", "c"})
    write(std::string("scenarios/") + name + ".yaml", read_file(folder() / "scenarios/falls.yaml"));
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--json"}}) {
    std::vector<std::string> one{"check", "-j1"}, several{"check", "-j3"};
    one.insert(one.end(), more.begin(), more.end());
    several.insert(several.end(), more.begin(), more.end());
    const Outcome first = rehearse(one), second = rehearse(several);
    EXPECT_EQ(first.status, 1);
    EXPECT_EQ(second.status, 1);
    EXPECT_EQ(without_seconds(second.out), without_seconds(first.out));
    EXPECT_EQ(second.err, first.err);
  }
}

TEST_F(Ci, AScenarioThatCannotRunEndsTheOnesBehindIt) {
  write("scenarios/a.yaml", read_file(folder() / "scenarios/falls.yaml") + "golden: No.Folder\n");
  fs::remove_all(folder() / "golden");
  write("golden", "a file");
  const Outcome one = rehearse({"check", "scenarios/falls.yaml", "scenarios/a.yaml", "scenarios/stays.yaml", "-j1"});
  const Outcome several =
      rehearse({"check", "scenarios/falls.yaml", "scenarios/a.yaml", "scenarios/stays.yaml", "-j3"});
  EXPECT_EQ(one.status, several.status);
  EXPECT_EQ(without_seconds(one.out), without_seconds(several.out));
  EXPECT_EQ(one.err, several.err);
}

TEST_F(Ci, AFailedScenarioPrintsTheAddressOfTheListOfReports) {
  const std::string page =
      "REHEARSE_REPORT_PAGE=" + write("page.html", "<!doctype html><html><!-- REHEARSE DATA --></html>").string();
  const Outcome outcome = rehearse({"check", "scenarios/stays.yaml"}, page);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, ContainsRegex("\nall reports: file:///.*/rehearse-pending/index.html\n$"));
  const std::string index = read_file(folder() / "rehearse-pending/index.html");
  EXPECT_THAT(index,
              AllOf(HasSubstr("1 of 1 test failed"), HasSubstr("stays.html"), HasSubstr("data:image/png;base64,")));
  EXPECT_EQ(rehearse({"check", "-j2"}, page).status, 1);
  EXPECT_THAT(read_file(folder() / "rehearse-pending/index.html"),
              AllOf(HasSubstr("1 of 2 tests failed"), HasSubstr("falls")));
}

TEST_F(Ci, JunitIsValidByTheSchemaOfJenkins) {
  const std::string schema = JUNIT_SCHEMA;
  if (schema.empty()) GTEST_SKIP() << "there is no schema (cmake -DREHEARSE_JUNIT_SCHEMA=FILE.xsd)";
  write("scenarios/crashes.yaml",
        read_file(pendulum(MISBEHAVING, "crash 3")) + "expect:\n  - {no_event: \"*never*\"}\n");
  fs::remove(folder() / "pendulum.yaml");
  EXPECT_EQ(rehearse({"check", "--junit", "check.xml"}).status, 3);
  const Outcome checked = run("/usr/bin/env", {"xmllint", "--noout", "--schema", schema, "check.xml"});
  EXPECT_EQ(checked.status, 0) << checked.err;
}

TEST_F(Ci, AFileThatCantBeWrittenIsAnError) {
  const Outcome outcome = rehearse({"check", "--junit", "nowhere/check.xml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("can't write nowhere/check.xml"));
}

TEST_F(Ci, GithubGetsAnErrorAtTheLineOfTheExpectation) {
  const Outcome outcome = rehearse({"check"}, "GITHUB_ACTIONS=true GITHUB_STEP_SUMMARY=summary.md");
  EXPECT_THAT(outcome.out, ContainsRegex("\n::error file=scenarios/stays.yaml,line=9::stays: .*above 0.999 m"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("::error file=scenarios/falls.yaml")));
  EXPECT_THAT(read_file(folder() / "summary.md"),
              AllOf(HasSubstr("| scenario |"), HasSubstr("| falls | passed |"), HasSubstr("| stays | differs |")));
  EXPECT_THAT(rehearse({"check"}).out, Not(HasSubstr("::error")));
}

TEST_F(Ci, AdviceNamesNothingThatCiRefusesAndNoLinkToItsDisk) {
  std::string text = read_file(folder() / "scenarios/falls.yaml");
  write("scenarios/falls.yaml", "golden: Box.Falls\n" + text);
  const Outcome outcome = rehearse({"check", "scenarios/falls.yaml"}, "CI=true");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("there is no golden golden/Box.Falls.mcap"));
  EXPECT_THAT(outcome.out, HasSubstr("make this run on a machine of yours"));
  EXPECT_THAT(outcome.out,
              AllOf(Not(HasSubstr("golden accept")), Not(HasSubstr("REHEARSE_GOLDEN")), Not(HasSubstr("file://"))));
}

}  // namespace
}  // namespace rehearse::test
