// rehearse sweep: campaigns from the command line, killed and resumed, and the mistakes that users make.
#include "sweep_fixture.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <set>
#include <thread>

namespace rehearse::test {
namespace {

/// A case's number is none of its inputs, and neither are the cases before it in its process.
TEST_F(Sweep, BeginsEachCaseInAProcessThatHasRunNoController) {
  for (const char* library : {COUNTS_RUNS, DRAWS}) {
    const std::string text = read_file(pendulum(library));
    write("runs.yaml", text + "vary:\n  mass: {path: duration, grid: [0.05, 0.05, 0.05, 0.05]}\n");
    const std::string campaign = fs::path(library).stem();
    const Outcome ended = rehearse({"sweep", "runs.yaml", "-o", campaign, "-j", "1"});
    EXPECT_EQ(ended.status, 0) << ended.out << ended.err;
    std::set<std::string> hashes;
    std::istringstream lines(read_file(folder() / campaign / "results.jsonl"));
    int cases = 0;
    for (std::string line; std::getline(lines, line); ++cases)
      hashes.insert(nlohmann::json::parse(line).at("hash").get<std::string>());
    EXPECT_GE(cases, 4);
    EXPECT_EQ(hashes.size(), 1u) << library;
  }
}

TEST_F(Sweep, RefusesAnExpectationWhoseSeriesDoesNotExist) {
  std::string text = read_file(box());
  write("box.yaml", text.replace(text.find("/position/z"), 11, "/positon/z"));
  const Outcome refused = rehearse({"sweep", "box.yaml", "--cases", "6", "-o", "run"});
  EXPECT_EQ(refused.status, bad_input);
  EXPECT_THAT(refused.err, HasSubstr("the scenario can't run with its nominal values: no run of this scenario has a "
                                     "series 'Box/Box/positon/z' (the nearest are Box/Box/position/z, "));
}

TEST_F(Sweep, VariesADefault) {
  box("  gravity: {path: \"gravity[2]\", choice: [-9, -1.6]}\n");
  const Outcome swept = rehearse({"sweep", "box.yaml", "--cases", "6", "-o", "run"});
  EXPECT_LE(swept.status, 1) << swept.err;
  EXPECT_THAT(results("run"), HasSubstr(",-1.6,"));
}

TEST_F(Sweep, RunsJudgesAndReports) {
  box();
  const Outcome swept = rehearse({"sweep", "box.yaml", "--cases", "60", "--seed", "3", "-o", "run", "--json"});
  EXPECT_EQ(swept.status, 1) << swept.err;
  const auto summary = swept.json();
  EXPECT_EQ(summary["cases"], 60);
  EXPECT_EQ(summary["missing"], 0);
  EXPECT_GE(summary["repeated"], 1);
  EXPECT_EQ(summary["unrepeated"].size(), 0u);
  EXPECT_EQ(summary["verdicts"]["passed"].get<int>() + summary["verdicts"]["violated"].get<int>(), 60);
  const auto report = nlohmann::json::parse(read_file(folder() / "run/report.json"));
  ASSERT_EQ(report["failures"].size(), 1u);
  EXPECT_EQ(report["failures"][0]["reason"], "Box/Box/position/z above 0.3 m");
  EXPECT_EQ(report["parameters"][0]["name"], "height");
  EXPECT_NEAR(report["parameters"][0]["correlation_with_margin"]["correlation"].get<double>(), 1.0, 1e-9)
      << "the margin is the height, less what it falls";
  EXPECT_LT(std::abs(report["parameters"][1]["correlation_with_margin"]["correlation"].get<double>()), 0.5);
  for (const char* file : {"run/report.html", "run/report.md", "run/results.csv", "run/plan.csv"})
    EXPECT_GT(fs::file_size(folder() / file), 100u) << file;
  EXPECT_THAT(read_file(folder() / "run/plan.csv"), HasSubstr("case,height,mass,again\n0,"));
  int traces = 0;
  for (const auto& entry : fs::directory_iterator(folder() / "run/traces")) traces += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(traces, 3) << "of the first failures";
  EXPECT_FALSE(exists("run/running"));
}

TEST_F(Sweep, GivesTheSameResultsWithAnyWorkersInAnyOrder) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "40", "-o", "one", "-j", "1"});
  rehearse({"sweep", "box.yaml", "--cases", "40", "-o", "two", "-j", "2"});
  EXPECT_EQ(results("one"), results("two"));
  // slices, as tasks of a cluster; the last before the first
  done({"sweep", "box.yaml", "--cases", "40", "-o", "slices", "--plan"});
  EXPECT_THAT(done({"sweep", "status", "slices"}).out, HasSubstr("none of 40 cases has a result"));
  for (const char* slice : {"3/3", "1/3", "2/3"}) done({"sweep", "work", "slices", "--slice", slice});
  rehearse({"sweep", "report", "slices"});
  EXPECT_EQ(results("one"), results("slices"));
  const auto kept = [&](const char* campaign) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder() / campaign / "traces"))
      names.insert(entry.path().filename().string());
    return names;
  };
  EXPECT_EQ(kept("one").size(), 3u);
  EXPECT_THAT(*kept("one").begin(), ::testing::StartsWith("violated-"));
  EXPECT_EQ(kept("one"), kept("two"));
  EXPECT_EQ(kept("one"), kept("slices"));
  const auto failures = [&](const char* campaign) {
    return nlohmann::json::parse(read_file(folder() / campaign / "report.json"))["failures"];
  };
  EXPECT_EQ(failures("one"), failures("slices")) << "the example is that of the lowest case";
}

TEST_F(Sweep, HasAColumnForEachWayToFail) {
  deeds("none, refuse, throw 5, crash 5, hang 5, exit 5, close 5, kill 5");
  const Outcome swept =
      rehearse({"sweep", "deeds.yaml", "-o", "run", "--call-limit", "0.3", "--case-limit", "20", "--json"});
  EXPECT_EQ(swept.status, 1) << swept.err;
  const auto verdict = verdicts("run");
  EXPECT_EQ(verdict.at("none"), "passed");
  EXPECT_EQ(verdict.at("refuse"), "failed");
  EXPECT_EQ(verdict.at("throw 5"), "failed");
  EXPECT_EQ(verdict.at("exit 5"), "failed");
  EXPECT_EQ(verdict.at("crash 5"), "crashed");
  EXPECT_EQ(verdict.at("hang 5"), "hung");
  EXPECT_EQ(verdict.at("kill 5"), "crashed") << "its process is gone";
  EXPECT_EQ(verdict.at("close 5"), "passed") << "it can't close the socket of its worker";
}

TEST_F(Sweep, FailsIfACaseGivesOtherBitsInAnotherProcess) {
  deeds("chance 5, none");
  const Outcome swept = rehearse({"sweep", "deeds.yaml", "-o", "run", "--json"});
  EXPECT_EQ(swept.status, 1);
  EXPECT_EQ(swept.json()["unrepeated"], nlohmann::json::array({0})) << "the first case always runs twice";
  EXPECT_THAT(swept.err, HasSubstr("case 0 gave different bits in another process"));
  EXPECT_THAT(swept.err, HasSubstr("rehearse audit"));
}

TEST_F(Sweep, CountsACaseThatTakesTooLongAsHung) {
  deeds("none, slow 1");  // each call takes 0.2 s
  rehearse({"sweep", "deeds.yaml", "-o", "run", "--case-limit", "1", "-j", "2"});
  EXPECT_EQ(verdicts("run").at("slow 1"), "hung");
  EXPECT_EQ(verdicts("run").at("none"), "passed");
}

TEST_F(Sweep, EndsACaseThatTakesTooMuchMemory) {
  deeds("none, leak 1");
  rehearse({"sweep", "deeds.yaml", "-o", "run", "--memory-limit", "600"});
  EXPECT_EQ(verdicts("run").at("leak 1"), "crashed");
  EXPECT_EQ(verdicts("run").at("none"), "passed");
  EXPECT_THAT(read_file(folder() / "run" / "report.json"), HasSubstr("the case took more than 600 MB of memory"));
}

TEST_F(Sweep, LosesAndDoublesNoCaseWhenItIsKilled) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "600", "-o", "whole", "-j", "2"});
  const std::string campaign = (folder() / "killed").string();
  const auto start = [&](const std::vector<std::string>& words) {
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder().c_str()) != 0) _exit(1);
      const int nothing = open("/dev/null", O_RDWR);
      dup2(nothing, STDOUT_FILENO);
      dup2(nothing, STDERR_FILENO);
      std::vector<char*> arguments;
      for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
      arguments.push_back(nullptr);
      execv(command.c_str(), arguments.data());
      _exit(1);
    }
    return child;
  };
  const auto lines = [&] {
    const std::string text = read_file(campaign + "/results.jsonl");
    return std::ranges::count(text, '\n');
  };
  long wanted = 100;
  std::vector<std::string> words{command.string(), "sweep", "box.yaml", "--cases", "600", "-o", campaign, "-j", "2"};
  for (int kill_number = 0; kill_number < 3; ++kill_number, wanted += 120) {
    const pid_t child = start(words);
    for (int i = 0; i < 3000 && lines() < wanted; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ASSERT_GE(lines(), wanted);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it was still at work";
    words = {command.string(), "sweep", "resume", campaign, "-j", "2"};
  }
  // the power failed in the middle of a line
  std::ofstream(campaign + "/results.jsonl", std::ios::app) << R"({"case":599,"verdict":"pas)";
  const Outcome resumed = rehearse({"sweep", "resume", "killed"});
  EXPECT_EQ(resumed.status, 1) << resumed.err;
  EXPECT_EQ(results("killed"), results("whole"));
  const auto found = counts("killed");
  EXPECT_EQ(found.size(), 600u);
  for (const auto& [number, count] : found) EXPECT_EQ(count, 1) << number;
}

TEST_F(Sweep, EndsAfterSoManyFailures) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "100", "-o", "whole"});
  const Outcome ended =
      rehearse({"sweep", "box.yaml", "--cases", "100", "-o", "few", "--until-failures", "3", "-j", "1"});
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("go on: rehearse sweep resume few"));
  const auto status = rehearse({"sweep", "status", "few", "--json"}).json();
  EXPECT_EQ(status["verdicts"]["violated"], 3);
  EXPECT_GT(status["missing"], 50);
  EXPECT_EQ(status["until_failures"], 3);
  const double judged = 3.0 + status["verdicts"]["passed"].get<double>();
  EXPECT_NEAR(status["share"].get<double>(), 1.0 - 2.0 / (judged - 1.0), 1e-12) << "of inverse sampling";
  EXPECT_THAT(ended.out, HasSubstr("; the work ended with failure 3, so the share that passes is about "));
  EXPECT_EQ(rehearse({"sweep", "resume", "few", "--until-failures", "3", "--json"}).json()["missing"],
            status["missing"]);
  EXPECT_EQ(rehearse({"sweep", "resume", "few", "--json"}).json()["until_failures"], nullptr);
  EXPECT_EQ(results("few"), results("whole"));
  EXPECT_THAT(rehearse({"sweep", "box.yaml", "--cases", "100", "-o", "one", "--until-failures", "1"}).out,
              HasSubstr("; the work ended with the first failure, so the share that passes is within "));
}

TEST_F(Sweep, JudgesByTheGoldenToo) {
  box("golden: Box.Falls\ntolerances:\n  - {channel: \"*\", atol: 0.05}\n");
  fs::create_directory(folder() / "golden");
  EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 1) << "it waits";
  done({"golden", "accept", "Box.Falls"});
  const auto plain = rehearse({"sweep", "box.yaml", "--cases", "40", "-o", "plain", "--json"}).json();
  const auto compared = rehearse({"sweep", "box.yaml", "--cases", "40", "-o", "compared", "--golden", "--json"}).json();
  EXPECT_EQ(plain["verdicts"]["differs"], 0);
  EXPECT_GT(compared["verdicts"]["differs"], 10);
  EXPECT_EQ(compared["verdicts"]["violated"], plain["verdicts"]["violated"]) << "an expectation comes first";
  EXPECT_GT(compared["verdicts"]["passed"], 0) << "within 5 cm";
}

TEST_F(Sweep, MakesACaseAgainBitForBit) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "20", "-o", "run"});
  const auto again = rehearse({"sweep", "case", "7", "run", "-o", "seven.mcap", "--json"}).json();
  EXPECT_EQ(again["same"], true);
  EXPECT_TRUE(exists("seven.mcap"));
  const Outcome replayed = rehearse({"info", "seven.mcap"});
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_THAT(rehearse({"sweep", "case", "7", "run", "-o", "seven.mcap"}).out,
              HasSubstr("the same bits as in the campaign"));
}

TEST_F(Sweep, ComparesTwoCampaignsCaseByCase) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "50", "-o", "before"});
  std::string text = read_file(folder() / "box.yaml");
  text.replace(text.find("above: 0.3"), 10, "above: 0.4");
  write("stricter.yaml", text);
  rehearse({"sweep", "stricter.yaml", "--cases", "50", "-o", "after"});
  const Outcome compared = rehearse({"sweep", "report", "after", "--against", "before"});
  EXPECT_EQ(compared.status, 1) << compared.err;
  const auto change = nlohmann::json::parse(read_file(folder() / "after/report.json"))["against"];
  EXPECT_EQ(change["compared"], 50);
  EXPECT_EQ(change["same_bits"], 50);
  EXPECT_EQ(change["mended"], 0);
  EXPECT_GT(change["broken"].get<int>(), 5);
  EXPECT_LT(change["p"].get<double>(), 0.05);
  const std::vector<std::string> differences{"a new expectation: Box/Box/position/z above 0.4 m",
                                             "an expectation that is gone: Box/Box/position/z above 0.3 m"};
  EXPECT_EQ(change["differences"].get<std::vector<std::string>>(), differences);
  EXPECT_THAT(compared.out, HasSubstr("differs from before: a new expectation: Box/Box/position/z above 0.4 m\n"));
  rehearse({"sweep", "box.yaml", "--cases", "40", "-o", "smaller"});
  EXPECT_THAT(rehearse({"sweep", "report", "after", "--against", "smaller"}).err,
              HasSubstr("plan differs from that of"));
}

TEST_F(Sweep, ShrinksAFailingCaseToAScenario) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "30", "-o", "run"});
  const auto report = nlohmann::json::parse(read_file(folder() / "run/report.json"));
  const std::string number = std::to_string(report["failures"][0]["cases"][0].get<int>());
  const auto shrunk = rehearse({"sweep", "shrink", number, "run", "-o", "small.yaml", "--json"}).json();
  ASSERT_EQ(shrunk["differs"].size(), 1u) << shrunk.dump();
  EXPECT_NEAR(std::stod(shrunk["differs"]["height"].get<std::string>()), 0.3, 0.01) << "bisected";
  const std::string text = read_file(folder() / "small.yaml");
  EXPECT_THAT(text, HasSubstr("#   height: "));
  EXPECT_THAT(text, HasSubstr("mass: 2    # [kg]")) << "as written";
  EXPECT_THAT(text, ::testing::Not(HasSubstr("vary:")));
  const Outcome checked = rehearse({"check", "small.yaml"});
  EXPECT_EQ(checked.status, 1);
  EXPECT_THAT(checked.out + checked.err, HasSubstr("expected Box/Box/position/z above 0.3 m"));
  const auto cut = rehearse({"sweep", "shrink", number, "run", "-o", "cut.yaml", "--budget", "1", "--json"}).json();
  EXPECT_EQ(cut["finished"], false);
  EXPECT_EQ(cut["differs"].size(), 2u) << "the best so far is the case";
  EXPECT_EQ(rehearse({"check", "cut.yaml"}).status, 1);
  const std::string passing = std::to_string([&] {
    for (int i = 0;; ++i)
      if (rehearse({"sweep", "case", std::to_string(i), "run", "-o", "x.mcap", "--json"}).json()["verdict"] == "passed")
        return i;
  }());
  EXPECT_THAT(rehearse({"sweep", "shrink", passing, "run"}).err, HasSubstr("case " + passing + " passes"));
}

TEST_F(Sweep, CutsTheDurationOfAFailure) {
  deeds("none, throw 5");
  rehearse({"sweep", "deeds.yaml", "-o", "run"});
  const auto shrunk = rehearse({"sweep", "shrink", "1", "run", "--json"}).json();
  EXPECT_EQ(shrunk["differs"], nlohmann::json({{"deed", "throw 5"}}));
  EXPECT_LT(shrunk["duration"].get<double>(), 0.01) << "of 0.05 s";
  EXPECT_EQ(shrunk["verdict"], "failed");
  EXPECT_EQ(rehearse({"record", "run/shrunk-1.yaml", "-o", "again.mcap"}).status, 3);
}

TEST_F(Sweep, RefusesWhatItCantContinue) {
  box();
  rehearse({"sweep", "box.yaml", "--cases", "20", "-o", "run"});
  const auto refused = [&](const std::vector<std::string>& words, const std::string& message) {
    const Outcome outcome = rehearse(words);
    EXPECT_EQ(outcome.status, bad_input) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  refused({"sweep", "box.yaml", "--cases", "20", "-o", "run"}, "there is a campaign in this folder");
  refused({"sweep", "box.yaml", "--cases", "20", "-o", "."}, "the folder contains other files");
  refused({"sweep", "box.yaml", "-o", "new"}, "number of cases isn't stated");
  refused({"sweep", box_scenario.string(), "--cases", "5", "-o", "new"}, "varies nothing");
  refused({"sweep", "status", "nowhere"}, "no campaign.json");
  refused({"sweep", "case", "20", "run"}, "there is no case 20 (expected a number from 0 to 19)");
  refused({"sweep", "work", "run", "--slice", "4/3"}, "no slice 4 of 3");
  EXPECT_FALSE(exists("new"));

  const std::string facts = read_file(folder() / "run/campaign.json"), plan = read_file(folder() / "run/plan.csv");
  std::string other = facts;
  other.replace(other.find("\"version\": 1"), 12, "\"version\": 9");
  write("run/campaign.json", other);
  refused({"sweep", "resume", "run"}, "the campaign is of version 9");
  write("run/campaign.json", facts);
  std::string changed = plan;
  changed.replace(changed.find("\n5,") + 3, 1, "9");
  write("run/plan.csv", changed);
  refused({"sweep", "resume", "run"}, "the plan was changed");
  write("run/plan.csv", plan);

  const int lock = open((folder() / "run/lock").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  refused({"sweep", "resume", "run"}, "another process works on this campaign");
  close(lock);

  std::string scenario = read_file(folder() / "box.yaml");
  write("box.yaml", scenario + "# changed\n");
  refused({"sweep", "resume", "run"}, "has changed since the campaign began");
}

TEST_F(Sweep, RefusesToGoOnWithAnotherController) {
  fs::copy_file(MISBEHAVING, folder() / "controller.so");
  const std::string text = read_file(deeds("none, throw 5"));
  std::string own = text;
  own.replace(own.find(MISBEHAVING), std::string(MISBEHAVING).size(), "./controller.so");
  write("own.yaml", own);
  rehearse({"sweep", "own.yaml", "-o", "run"});
  EXPECT_EQ(rehearse({"sweep", "resume", "run"}).status, 1) << "a case fails";
  fs::remove(folder() / "controller.so");
  fs::copy_file(CORNERS, folder() / "controller.so");
  const Outcome refused = rehearse({"sweep", "resume", "run"});
  EXPECT_EQ(refused.status, bad_input);
  EXPECT_THAT(refused.err, HasSubstr("the controller Pendulum/Swing has changed since the campaign began"));
}

TEST_F(Sweep, EndsWhenAControllerChangesMeanwhile) {
  fs::copy_file(MISBEHAVING, folder() / "controller.so");
  std::string all = "none";
  for (int i = 1; i < 1000; ++i) all += ", none";
  std::string own = read_file(deeds(all));
  own.replace(own.find(MISBEHAVING), std::string(MISBEHAVING).size(), "./controller.so");
  write("own.yaml", own);
  Outcome ended;
  std::thread sweeping([&] { ended = rehearse({"sweep", "own.yaml", "-o", "run", "-j", "1"}); });
  for (int i = 0; i < 30000 && !exists("run/results.jsonl"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  fs::copy_file(CORNERS, folder() / "other.so");
  fs::rename(folder() / "other.so", folder() / "controller.so");
  sweeping.join();
  EXPECT_EQ(ended.status, bad_input) << ended.out;
  EXPECT_THAT(ended.err, HasSubstr("the controller Pendulum/Swing has changed since the campaign began"));
  EXPECT_LT(counts("run").size(), 1000u);
}

TEST_F(Sweep, FindsARareFailureInRoundsTowardsIt) {
  std::string text = read_file(box());
  text.replace(text.find("above: 0.3"), 10, "above: 0.2495");  // one of two hundred heights
  write("rare.yaml", text);
  const std::vector<std::string> words{"sweep",     "rare.yaml",        "--cases", "40",
                                       "--towards", "position/z above", "--json",  "-o"};
  const auto searched = [&](const std::string& campaign, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = words;
    all.push_back(campaign);
    all.insert(all.end(), more.begin(), more.end());
    return rehearse(all);
  };
  const Outcome found = searched("search");
  EXPECT_EQ(found.status, 1) << found.err;
  const auto rounds = found.json()["rounds"];
  ASSERT_GE(rounds.size(), 2u) << "the first round alone would show nothing";
  ASSERT_LE(rounds.size(), 5u);
  EXPECT_EQ(rounds[0]["failed"], 0);
  EXPECT_GT(rounds.back()["failed"], 0);
  EXPECT_LT(rounds.back()["least_margin"], 0.0);
  const std::string last = rounds.back()["folder"], number = std::to_string(rounds.back()["first_failure"].get<int>());
  EXPECT_THAT(rehearse({"sweep", "case", number, last, "-o", "x.mcap"}).out,
              HasSubstr("the same bits as in the campaign"));

  // the same again: continued, in another folder, and with another parameter, which has no say
  EXPECT_EQ(searched("search").out, found.out);
  const auto cases = [&](const std::string& campaign) {
    return results((fs::path(campaign) / fs::path(last).filename()).string());
  };
  searched("other", {"-j", "1"});
  EXPECT_EQ(cases("search"), cases("other"));
  EXPECT_EQ(searched("mass", {"--over", "mass", "--rounds", "2"}).json()["rounds"][1]["failed"], 0);

  EXPECT_THAT(searched("wrong", {"--over", "heigth"}).err,
              HasSubstr("no parameter 'heigth' can be steered (did you mean 'height'"));
  EXPECT_THAT(rehearse({"sweep", "rare.yaml", "--cases", "40", "--towards", "speed", "-o", "speed"}).err,
              HasSubstr("no expectation has 'speed'"));
  EXPECT_THAT(rehearse({"sweep", "rare.yaml", "--cases", "41", "--towards", "above", "-o", "search"}).err,
              HasSubstr("the round was begun with other options"));
  EXPECT_THAT(searched("search", {"--over", "mass"}).err,
              HasSubstr("search/round-2: error: the round was begun with other options"));
  EXPECT_THAT(searched("search/round-1").err, HasSubstr("there is a campaign in this folder"));
  for (const char* other : {"--slurm", "--plan"}) EXPECT_THAT(searched("new", {other}).err, HasSubstr("excludes"));
  EXPECT_THAT(rehearse({"sweep", "rare.yaml", "--cases", "40", "--over", "mass", "-o", "new"}).err,
              HasSubstr("--over requires --towards"));
  EXPECT_FALSE(exists("new"));
}

TEST_F(Sweep, SaysWhichVariationIsWrong) {
  const auto refused = [&](const std::string& vary, const std::string& message) {
    box(vary, "wrong.yaml");
    const Outcome outcome = rehearse({"sweep", "wrong.yaml", "--cases", "5", "-o", "new"});
    EXPECT_EQ(outcome.status, bad_input) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(message)) << vary;
    EXPECT_FALSE(exists("new"));
  };
  refused("  size: {path: \"bodies.Box.box.size[0]\", uniform: [-1, 1]}\n",
          "wrong.yaml:17:3: error: with 'size' at -1: size[0] is -1");
  refused("  size: {path: \"bodies.Box.box.size[0]\", file: sizes.csv}\n", "the table can't be read");
  write("sizes.csv", "width\n0.1\n");
  refused("  size: {path: \"bodies.Box.box.size[0]\", file: sizes.csv}\n", "no column 'size'");
  refused("  size: {path: \"bodies.Box.box.size[0]\", linked: heigth / 2}\n", "did you mean 'height'");
  std::string grids;
  for (int axis = 0; axis < 3; ++axis)
    grids += "  size" + std::to_string(axis) + ": {path: \"bodies.Box.box.size[" + std::to_string(axis) +
             "]\", grid: {from: 0.1, to: 0.2, steps: 10000}}\n";
  refused(grids, "the grids have 1e+12 or more combinations");
}

}  // namespace
}  // namespace rehearse::test
