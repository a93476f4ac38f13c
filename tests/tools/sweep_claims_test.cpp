// rehearse sweep: results that it must not claim, and what its reports say of them.
#include "sweep_fixture.h"

#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace rehearse::test {
namespace {

/// Of 200 boxes, whose heights are spread over 0.25 to 0.6 m, about 85 % stay above 0.3 m.
TEST_F(Sweep, AnswersAClaimOnThePassRateInThreeWays) {
  const auto answer = [this](const std::string& rate, int status) {
    const std::string name = "claims-" + rate;
    box("pass_rate: {at_least: " + rate + "}\n", name + ".yaml");
    const Outcome outcome = rehearse({"sweep", name + ".yaml", "--cases", "200", "-o", name, "--json"});
    EXPECT_EQ(outcome.status, status) << outcome.out << outcome.err;
    return outcome.json();
  };
  const auto passes = answer("0.75", 0), fails = answer("0.95", 1), undecided = answer("0.86", 4);
  EXPECT_EQ(passes["claim"]["answer"], "passes");
  EXPECT_EQ(passes["claim"]["confidence"], 0.95);
  EXPECT_EQ(passes["claim"]["more_cases"], nullptr);
  EXPECT_GE(passes["interval"][0], 0.75);
  EXPECT_EQ(fails["claim"]["answer"], "fails");
  EXPECT_LT(fails["interval"][1], 0.95);
  EXPECT_EQ(undecided["claim"]["answer"], "undecided");
  EXPECT_GT(undecided["claim"]["more_cases"], 0);
  EXPECT_THAT(undecided["verdict"].get<std::string>(),
              HasSubstr("; it is undecided whether at least 86 % pass, with 95 % confidence: "));
  EXPECT_EQ(rehearse({"sweep", "report", "claims-0.86"}).status, 4);
  EXPECT_EQ(rehearse({"sweep", "status", "claims-0.86"}).status, 0);
  EXPECT_THAT(read_file(folder() / "claims-0.75/report.html"), HasSubstr("; at least 75 % pass, with 95 % confidence"));
}

TEST_F(Sweep, ReportsStateTheConfidenceOfTheirClaim) {
  box("pass_rate: {at_least: 0.5, confidence: 0.9}\n");
  rehearse({"sweep", "box.yaml", "--cases", "20", "-o", "run"});
  EXPECT_THAT(read_file(folder() / "run/report.md"), HasSubstr(" with 90 % confidence (the exact interval)"));
}

TEST_F(Sweep, PlansSayHowManyCasesAClaimNeeds) {
  box("pass_rate: {at_least: 0.95, confidence: 0.95}\n");
  EXPECT_THAT(
      rehearse({"sweep", "box.yaml", "--cases", "40", "-o", "plan", "--plan"}).out,
      HasSubstr("plan: 40 cases\nthat at least 95 % pass, with 95 % confidence, needs 72 cases if all pass, and 295 "
                "if 97.5 % pass; this plan has 40, which can't show it\n"));
}

/// The box violates from a height on that its nominal run shows: it falls as far from any.
TEST_F(Sweep, EstimatesTheProbabilityOfAFailureFromSteeredCases) {
  std::string text = read_file(box());
  text.replace(text.find("above: 0.3"), 10, "above: 0.2495");
  write("rare.yaml", text);
  const double margin = rehearse({"check", "rare.yaml", "--json"}).json()["expectations"][0]["margin"];
  const double fall = 0.5 - 0.2495 - margin, probability = (0.2495 + fall - 0.25) / (0.6 - 0.25);
  ASSERT_GT(probability, 0.001);
  ASSERT_LT(probability, 0.01);
  const std::vector<std::string> words{"sweep", "rare.yaml", "--cases",    "40",  "--towards", "position/z above",
                                       "-o",    "search",    "--estimate", "400", "--json"};
  const Outcome found = rehearse(words);
  EXPECT_EQ(found.status, 1) << found.err;
  const auto estimated = found.json()["probability"];
  EXPECT_LE(estimated["interval"][0], probability);
  EXPECT_GE(estimated["interval"][1], probability);
  EXPECT_NEAR(estimated["estimate"].get<double>() / probability, 1.0, 0.3);
  EXPECT_EQ(estimated["cases"], 400);
  EXPECT_GT(estimated["violations"], 20) << "an ordinary campaign would have two";
  EXPECT_EQ(estimated["folder"], "search/estimate");
  EXPECT_TRUE(exists("search/estimate/report.html"));
  EXPECT_EQ(rehearse(words).out, found.out) << "it is continued";
  EXPECT_THAT(rehearse({"sweep", "rare.yaml", "--cases", "40", "--estimate", "9", "-o", "new"}).err,
              HasSubstr("--estimate requires --towards"));
}

TEST_F(Sweep, DrawsItsCasesByThePlanOfTheScenario) {
  box("plan: sobol\n");
  rehearse({"sweep", "box.yaml", "--cases", "8", "-o", "eight"});
  rehearse({"sweep", "box.yaml", "--cases", "16", "-o", "sixteen"});
  const std::string few = read_file(folder() / "eight/plan.csv"), many = read_file(folder() / "sixteen/plan.csv");
  EXPECT_EQ(many.substr(0, few.size()), few) << "more cases begin with the same";
  EXPECT_TRUE(exists("eight/report.html"));
  std::set<int> eighths;  // of the heights
  for (const auto& [height, verdict] : verdicts("eight"))
    eighths.insert(static_cast<int>((std::stod(height) - 0.25) / 0.35 * 8.0));
  EXPECT_EQ(eighths.size(), 8u);
}

TEST_F(Sweep, ReportsTheImportanceOfParameters) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "100", "-o", "run"});
  const auto parameters = nlohmann::json::parse(read_file(folder() / "run/report.json"))["parameters"];
  EXPECT_GT(parameters[0]["importance"]["margin"]["share"], 0.95) << "the height is all of it";
  EXPECT_LT(parameters[1]["importance"]["margin"]["share"], 0.3) << "the mass has no say";
  EXPECT_GT(parameters[0]["importance"]["passing"], 0.5);
  EXPECT_GT(parameters[0]["importance"]["passing_interval"][1], 0.95) << "a threshold of the height decides";
  EXPECT_LE(parameters[0]["importance"]["margin"]["interval"][0], parameters[0]["importance"]["margin"]["share"]);
  EXPECT_THAT(read_file(folder() / "run/report.md"), HasSubstr("## Importance"));
}

TEST_F(Sweep, ReportsBeginWithTheirFailures) {
  box();
  const Outcome outcome = rehearse({"sweep", "box.yaml", "--cases", "60", "-o", "run"});
  EXPECT_THAT(outcome.out, ::testing::ContainsRegex("\n  violated  [0-9]+: Box/Box/position/z above 0.3 m\n"));
  const std::string text = read_file(folder() / "run/report.md");
  EXPECT_LT(text.find("## Failures"), text.find("## Verdicts"));
  EXPECT_THAT(text, HasSubstr("| passed | "));
  EXPECT_EQ(text.find("| crashed |"), std::string::npos) << "no case did";
  const std::string page = read_file(folder() / "run/report.html");
  EXPECT_LT(page.find("<h2>Failures</h2>"), page.find("<h2>Verdicts</h2>"));
  EXPECT_THAT(page, HasSubstr("text-anchor=\"middle\">height</text>"));
  EXPECT_THAT(page, HasSubstr("text-anchor=\"middle\">share of cases</text>"));
}

TEST_F(Sweep, ShowsTheCaseOfADotInItsPage) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "60", "-o", "run"});
  const std::string page = read_file(folder() / "run/report.html");
  const auto numbers = [&](const std::string& before) {
    std::set<std::string> found;
    for (std::size_t at = 0; (at = page.find(before, at)) != std::string::npos;) {
      at += before.size();
      found.insert(page.substr(at, page.find('"', at) - at));
    }
    return found;
  };
  EXPECT_EQ(numbers("href=\"#case-").size(), 60u);
  EXPECT_EQ(numbers("href=\"#case-"), numbers("id=\"case-"));
  const std::set<std::string> kept = numbers("href=\"traces/violated-");
  EXPECT_EQ(kept.size(), 3u) << "three recordings are kept";
  for (const std::string& name : kept) EXPECT_TRUE(exists("run/traces/violated-" + name)) << name;
  const std::string first = kept.begin()->substr(0, kept.begin()->find('.'));
  const std::size_t article = page.find("id=\"case-" + first + "\"");
  const std::string text = page.substr(article, page.find("</article>", article) - article);
  EXPECT_THAT(text, HasSubstr("<b>case " + first + ": violated</b>: Box/Box/position/z above 0.3 m"));
  EXPECT_THAT(text, HasSubstr("height 0."));
  EXPECT_THAT(text, HasSubstr("rehearse sweep case " + first + " run"));
}

TEST_F(Sweep, FailsIfNoCaseReachedAStateThatSomeMust) {
  box("pass_rate: {at_least: 0.1}\n"
      "sometimes:\n  low start: \"Box/Box/position/z < 0.35 m\"\n  flies away: \"Box/Box/position/z > 5 m\"\n");
  const Outcome outcome = rehearse({"sweep", "box.yaml", "--cases", "20", "-o", "run", "--json"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.json()["verdict"].get<std::string>(),
              ::testing::StartsWith("never tried: no case reached flies away; "));
  EXPECT_EQ(outcome.json()["reached"]["flies away"], 0);
  EXPECT_GT(outcome.json()["reached"]["low start"], 0);
  EXPECT_LT(outcome.json()["reached"]["low start"], 20);
  // they aren't expectations: no case fails by them, and a check knows nothing of them
  EXPECT_EQ(outcome.json()["verdicts"]["violated"].get<int>() + outcome.json()["verdicts"]["passed"].get<int>(), 20);
  const auto checked = rehearse({"check", "box.yaml", "--json"}).json();
  EXPECT_EQ(checked["expectations"].size(), 1u);
}

TEST_F(Sweep, IsContentIfEachStateWasReached) {
  box("pass_rate: {at_least: 0.1}\nsometimes: {low start: \"Box/Box/position/z < 0.35 m\"}\n");
  EXPECT_EQ(rehearse({"sweep", "box.yaml", "--cases", "20", "-o", "run"}).status, 0);
}

TEST_F(Sweep, RefusesAStateOfASeriesThatNoRunHas) {
  box("sometimes: {low: \"Box/Box/position/w < 0.35 m\"}\n");
  const Outcome outcome = rehearse({"sweep", "box.yaml", "--cases", "2", "-o", "run"});
  EXPECT_EQ(outcome.status, bad_input) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("Box/Box/position/w"));
}

TEST_F(Sweep, StopsOnAFullDiskAndGoesOn) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "300", "-o", "whole"});
  const Outcome stopped = with_small_files(40000, {"sweep", "box.yaml", "--cases", "300", "-o", "full"});
  EXPECT_EQ(stopped.status, bad_input);
  EXPECT_THAT(stopped.err, HasSubstr("can't be written: File too large"));
  EXPECT_THAT(stopped.err, HasSubstr("sweep resume"));
  rehearse({"sweep", "resume", "full"});
  EXPECT_EQ(results("full"), results("whole"));
}

TEST_F(Sweep, GivesNoResultToACaseThatTheMachinePrevents) {
  box("  length: {path: duration, choice: [0.02, 4]}\n");  // the recordings of the longer runs don't fit
  rehearse({"sweep", "box.yaml", "--cases", "12", "-o", "whole"});
  ASSERT_THAT(results("whole"), HasSubstr(",4,"));
  const Outcome stopped = with_small_files(60000, {"sweep", "box.yaml", "--cases", "12", "-o", "full"});
  EXPECT_EQ(stopped.status, bad_input);
  EXPECT_THAT(stopped.err, HasSubstr("can't be run here: can't write the trace: File too large"));
  EXPECT_THAT(stopped.err, HasSubstr("it has no result; remove the cause, then: rehearse sweep resume full"));
  const auto status = rehearse({"sweep", "status", "full", "--json"}).json();
  EXPECT_EQ(status["verdicts"]["invalid"], 0);
  EXPECT_GT(status["missing"], 0);
  rehearse({"sweep", "resume", "full"});
  EXPECT_EQ(results("full"), results("whole"));

  // nor does a case that is made again blame its values
  for (int number = 0; number < 12; ++number) {
    const auto again = rehearse({"sweep", "case", std::to_string(number), "full", "--json"}).json();
    if (again["values"]["length"] != "4") continue;
    const Outcome refused = with_small_files(60000, {"sweep", "case", std::to_string(number), "full"});
    EXPECT_EQ(refused.status, bad_input);
    EXPECT_THAT(refused.err, HasSubstr("it can't be run here: can't write the trace: File too large"));
    return;
  }
}

TEST_F(Sweep, ReportsTheShareThatPassesOfEachWord) {
  deeds("none, throw 5, 7, none, refuse, none");  // the controller does nothing for a 7
  rehearse({"sweep", "deeds.yaml", "-o", "run"});
  const auto deed = nlohmann::json::parse(read_file(folder() / "run/report.json"))["parameters"][0];
  EXPECT_TRUE(deed["correlation_with_passing"].is_null());
  EXPECT_NEAR(deed["association_with_passing"].get<double>(), 1.0, 1e-12);
  std::vector<std::string> words;
  std::vector<std::pair<int, int>> counts;
  for (const auto& word : deed["words"]) {
    words.push_back(word["word"]);
    counts.emplace_back(word["passed"], word["cases"]);
  }
  EXPECT_EQ(words, (std::vector<std::string>{"7", "none", "refuse", "throw 5"}));
  EXPECT_EQ(counts, (std::vector<std::pair<int, int>>{{1, 1}, {3, 3}, {0, 1}, {0, 1}}));
  EXPECT_THAT(read_file(folder() / "run/report.md"), HasSubstr("| deed | none | 3 | 3 | 100 % |"));
  EXPECT_THAT(read_file(folder() / "run/report.html"), HasSubstr(">throw 5</text>"));
}

TEST_F(Sweep, NamesWhatElseDiffersBetweenTwoCampaigns) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "5", "-o", "before"});
  rehearse({"sweep", "box.yaml", "--cases", "5", "-o", "again"});
  const auto compared = [&](const std::string& campaign) {
    rehearse({"sweep", "report", campaign, "--against", "before"});
    const auto report = nlohmann::json::parse(read_file(folder() / campaign / "report.json"));
    return report["against"]["differences"].get<std::vector<std::string>>();
  };
  EXPECT_EQ(compared("again"), std::vector<std::string>());
  EXPECT_THAT(read_file(folder() / "again/report.md"),
              HasSubstr("| neither the scenario, nor a controller, a model or an option |"));
  std::string text = "# longer, and on the Moon\n" + read_file(folder() / "box.yaml") + "gravity: [0, 0, -1.6]\n";
  text.replace(text.find("duration: 0.02"), 14, "duration: 0.03");
  text.replace(text.find("size: [2, 2, 0.2]"), 17, "size: [3, 3, 0.2]");
  write("moon.yaml", text);
  rehearse({"sweep", "moon.yaml", "--cases", "5", "-o", "moon", "--case-limit", "60"});
  EXPECT_EQ(compared("moon"),
            (std::vector<std::string>{"in the scenario bodies", "in the scenario duration: 0.03, was 0.02",
                                      "in the scenario gravity: [0, 0, -1.6], was not stated",
                                      "case limit: 60 s, was 600 s"}));
}

/// Some of 200 boxes that stay above 0.3 m don't stay above 0.32 m; none does that only the other limit lets pass.
TEST_F(Sweep, AnswersAClaimThatAChangeMadeNothingWorseInThreeWays) {
  box();
  std::string changed = read_file(folder() / "box.yaml");
  changed.replace(changed.find("above: 0.3"), 10, "above: 0.32");
  write("changed.yaml", changed);
  rehearse({"sweep", "box.yaml", "--cases", "200", "-o", "before"});
  rehearse({"sweep", "changed.yaml", "--cases", "200", "-o", "after"});
  const auto judged = [this](const std::string& campaign, const std::string& margin, int status) {
    const Outcome outcome =
        rehearse({"sweep", "report", campaign, "--against", "before", "--margin", margin, "--json"});
    EXPECT_EQ(outcome.status, status) << margin << ": " << outcome.out << outcome.err;
    return outcome.json();
  };
  const auto passes = judged("after", "0.3", 0), fails = judged("after", "0.001", 1),
             undecided = judged("after", "0.06", 4);
  EXPECT_EQ(passes["non_inferiority"]["answer"], "passes");
  EXPECT_EQ(passes["non_inferiority"]["margin"], 0.3);
  EXPECT_EQ(passes["non_inferiority"]["confidence"], 0.95);
  EXPECT_EQ(fails["non_inferiority"]["answer"], "fails");
  EXPECT_EQ(undecided["non_inferiority"]["answer"], "undecided");
  EXPECT_GT(undecided["non_inferiority"]["more_cases"], 0);
  EXPECT_THAT(undecided["verdict"].get<std::string>(),
              HasSubstr("; undecided whether it is inferior, with a margin of 6 % and 95 % confidence: "));
  const auto against = nlohmann::json::parse(read_file(folder() / "after/report.json"))["against"];
  EXPECT_EQ(against["interval"], undecided["non_inferiority"]["interval"]);
  EXPECT_NEAR(against["difference"].get<double>(), -against["broken"].get<double>() / 200.0, 1e-12);
  EXPECT_THAT(read_file(folder() / "after/report.md"), HasSubstr("| difference of the shares that pass | -"));

  // without a margin the campaign is judged alone: cases fail
  EXPECT_EQ(rehearse({"sweep", "report", "after", "--against", "before"}).status, 1);
  EXPECT_EQ(rehearse({"sweep", "report", "after", "--json"}).json()["non_inferiority"], nullptr);
  EXPECT_EQ(rehearse({"sweep", "report", "after", "--margin", "0.1"}).status, bad_input) << "against which?";
}

TEST_F(Sweep, RefusesAMarginOfWorkThatEndedWithAFailure) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "60", "-o", "before"});
  rehearse({"sweep", "box.yaml", "--cases", "60", "--until-failures", "1", "-j", "1", "-o", "after"});
  EXPECT_EQ(rehearse({"sweep", "report", "after", "--against", "before"}).status, 1);
  const Outcome refused = rehearse({"sweep", "report", "after", "--against", "before", "--margin", "0.1"});
  EXPECT_EQ(refused.status, bad_input);
  EXPECT_THAT(refused.err, HasSubstr("the work ended with failure 1: its cases aren't a fair sample for a margin"));
  EXPECT_THAT(refused.err, HasSubstr("rehearse sweep resume after"));
  rehearse({"sweep", "resume", "after"});
  EXPECT_EQ(rehearse({"sweep", "report", "after", "--against", "before", "--margin", "0.1"}).status, 0);
}

TEST_F(Sweep, SaysThatAControllerHasChangedSinceTheCampaign) {
  fs::copy_file(MISBEHAVING, folder() / "controller.so");
  std::string own = read_file(deeds("none, throw 5"));
  own.replace(own.find(MISBEHAVING), std::string(MISBEHAVING).size(), "./controller.so");
  write("own.yaml", own);
  rehearse({"sweep", "own.yaml", "-o", "run"});
  const auto same = rehearse({"sweep", "case", "1", "run", "--json"});
  EXPECT_EQ(same.json()["changed_controllers"], nlohmann::json::array());
  EXPECT_EQ(same.err, "");
  // a byte after the end changes nothing but the hash, as a rebuild may
  fs::copy_file(folder() / "controller.so", folder() / "rebuilt.so");
  std::ofstream(folder() / "rebuilt.so", std::ios::app) << '\n';
  fs::rename(folder() / "rebuilt.so", folder() / "controller.so");
  const std::string warning = "warning: the controller Pendulum/Swing has changed since the campaign began";
  const auto again = rehearse({"sweep", "case", "1", "run", "--json"});
  EXPECT_EQ(again.json()["changed_controllers"], nlohmann::json::array({"Pendulum/Swing"}));
  EXPECT_THAT(again.err, HasSubstr(warning));
  const auto shrunk = rehearse({"sweep", "shrink", "1", "run", "--json"});
  EXPECT_EQ(shrunk.json()["changed_controllers"], nlohmann::json::array({"Pendulum/Swing"}));
  EXPECT_THAT(shrunk.err, HasSubstr(warning));
  EXPECT_THAT(rehearse({"sweep", "shrink", "0", "run"}).err,
              HasSubstr("case 0 passes (the controller Pendulum/Swing has changed since the campaign began)"));
}

TEST_F(Sweep, CountsCasesWithErrorsOfControllers) {
  deeds("none, nan 5, complain 7, complain 9, throw 5");
  const Outcome swept = rehearse({"sweep", "deeds.yaml", "-o", "run"});
  EXPECT_THAT(swept.out,
              HasSubstr("in 3 cases controllers wrote errors or numbers that aren't finite; 3 of them pass\n"));
  const auto report = nlohmann::json::parse(read_file(folder() / "run/report.json"));
  EXPECT_EQ(report["summary"]["with_errors"], 3);
  EXPECT_EQ(report["summary"]["passed_with_errors"], 3);
  ASSERT_EQ(report["errors"].size(), 2u) << report["errors"].dump();
  EXPECT_EQ(report["errors"][0]["error"], "Pendulum/Swing: [ERROR] no map");
  EXPECT_EQ(report["errors"][0]["cases"], nlohmann::json::array({2, 3}));
  EXPECT_THAT(report["errors"][1]["example"].get<std::string>(), HasSubstr("wrote nan into u of joint"));
  EXPECT_EQ(report["errors"][1]["passed"], 1);
  EXPECT_THAT(read_file(folder() / "run/report.md"), HasSubstr("## Errors of controllers"));
  box();
  EXPECT_THAT(rehearse({"sweep", "box.yaml", "--cases", "5", "-o", "sound"}).out, ::testing::Not(HasSubstr("finite")));
}

}  // namespace
}  // namespace rehearse::test
