// rehearse replay --tick, --at, --watch and --when: inspecting a recording.
#include "command.h"

#include <gmock/gmock.h>
#include <rehearse/trace.h>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string command_series = "SR1/SR1Minimum/output/RLEG_KNEE/u";

class ReplayTicks : public Command {
 protected:
  ReplayTicks() { done({"record", sr1_without_cameras().string(), "-o", "sr1.mcap"}); }  // 100 ticks

  Outcome looks(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"replay", "sr1.mcap"});
    return rehearse(arguments);
  }
  static std::vector<nlohmann::json> lines_of(const std::string& text) {
    std::vector<nlohmann::json> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line, nullptr, false));
    return lines;
  }
  static std::string with_changed_gain() { return "SR1Minimum=" CHANGED_GAIN; }
};

TEST_F(ReplayTicks, ATickShowsAllThatIsOfIt) {
  const Outcome outcome = looks({"--tick", "50"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, StartsWith("tick 50, 0.05 s\nSR1/SR1Minimum reads and commands\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("\n  joints +in q \\[rad\\] +Δ tick +out u \\[N·m\\] +Δ tick\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("\n    RLEG_KNEE +[-0-9.e]+ +[-+][0-9.e-]+ +[-0-9.e]+ +[-+][0-9.e-]+\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nSR1, state\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nSR1, sensors\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\ncontacts\n  Floor/Floor touches SR1/"));
  EXPECT_THAT(outcome.out, HasSubstr("\nthe replay gives the same bits as the recording\n"));
}

TEST_F(ReplayTicks, WhatIsAsBeforeIsFolded) {
  const Outcome folded = looks({"--tick", "50"}), full = looks({"--tick", "50", "--full"});
  EXPECT_THAT(folded.out, HasSubstr("(3 unchanged numbers)"));  // the components that a gyroscope doesn't measure
  EXPECT_THAT(full.out, Not(HasSubstr("unchanged")));
  EXPECT_GT(full.out.size(), folded.out.size());
}

TEST_F(ReplayTicks, ATickShowsWhatAnotherControllerCommands) {
  const Outcome outcome = looks({"--tick", "50", "--controller", with_changed_gain()});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, ContainsRegex("out u \\[N·m\\] +Δ tick +replayed +≠ +ULPs\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\ndiffers from the recording\n  " + command_series + ": replayed "));
  EXPECT_EQ(outcome.err,
            "warning: the library of SR1/SR1Minimum isn't the one that was recorded: commands may differ for that\n");
}

TEST_F(ReplayTicks, ATickIsFoundByItsTime) {
  EXPECT_EQ(looks({"--at", "0.05"}).out, looks({"--tick", "50"}).out);
  EXPECT_EQ(looks({"--at", "0.0504"}).out, looks({"--tick", "50"}).out);
}

TEST_F(ReplayTicks, WatchNarrowsATick) {
  const Outcome outcome = looks({"--tick", "50", "--watch", "SR1Minimum/*/RLEG_KNEE/*"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("RLEG_KNEE"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("LLEG_KNEE")));
  EXPECT_THAT(outcome.out, Not(HasSubstr("contacts")));
}

TEST_F(ReplayTicks, ATickInJsonHasExactNumbers) {
  const auto trace = Trace::load(folder() / "sr1.mcap");
  ASSERT_TRUE(trace.ok());
  const nlohmann::json tick = looks({"--tick", "50", "--json", "--controller", with_changed_gain()}).json();
  EXPECT_EQ(tick["tick"], 50);
  EXPECT_EQ(tick["time"], 0.05);
  EXPECT_EQ(tick["replayed"], true);
  ASSERT_EQ(tick["differences"].size(), 1u);
  EXPECT_EQ(tick["differences"][0]["element"], "RLEG_KNEE/u");
  EXPECT_EQ(tick["remarks"].size(), 1u);
  bool met = false;
  for (const nlohmann::json& channel : tick["channels"])
    for (const nlohmann::json& value : channel["values"]) {
      if (value["series"] != command_series) continue;
      met = true;
      EXPECT_EQ(channel["kind"], "output");
      EXPECT_EQ(value["value"].get<double>(), trace->values(command_series)[50]);
      EXPECT_EQ(value["replayed"], tick["differences"][0]["actual"]);
      EXPECT_EQ(value["changed"], true);
    }
  EXPECT_TRUE(met);
}

TEST_F(ReplayTicks, ATickBeyondTheEndNamesTheLast) {
  const Outcome late = looks({"--tick", "100"});
  EXPECT_EQ(late.status, 2);
  EXPECT_EQ(late.out, "");
  EXPECT_EQ(late.err, "sr1.mcap: error: there is no tick 100: the last is 99 (0.099 s)\n");
  const Outcome later = looks({"--at", "7"});
  EXPECT_EQ(later.status, 2);
  EXPECT_EQ(later.err, "sr1.mcap: error: nothing is recorded at 7 s (its ticks are 0 to 99, up to 0.099 s)\n");
}

TEST_F(ReplayTicks, WatchPrintsARowATick) {
  const Outcome outcome = looks({"--watch", "output/RLEG_KNEE/u", "--from", "0.05", "--until", "0.06", "--every", "3"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  std::istringstream stream(outcome.out);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 5u);  // 50, 53, 56, 59
  EXPECT_THAT(lines[0], HasSubstr(command_series + " [N·m]"));
  EXPECT_THAT(lines[1], StartsWith("      50,       0.05, "));
  EXPECT_THAT(lines[4], StartsWith("      59,      0.059, "));
}

TEST_F(ReplayTicks, WatchInJsonIsAnObjectALine) {
  const auto trace = Trace::load(folder() / "sr1.mcap");
  ASSERT_TRUE(trace.ok());
  const auto lines = lines_of(
      looks({"--watch", "output/RLEG_KNEE/u", "--json", "--until", "0.01", "--controller", with_changed_gain()}).out);
  ASSERT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines[7]["tick"], 7);
  EXPECT_EQ(lines[7]["values"][command_series].get<double>(), trace->values(command_series)[7]);
  EXPECT_NE(lines[7]["replayed"][command_series], lines[7]["values"][command_series]);
}

TEST_F(ReplayTicks, WhenFindsSpans) {
  const Outcome outcome = looks({"--when", "tick >= 10 && tick < 15 || tick == 40"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              ContainsRegex("^ +tick +time \\[s\\] +ticks\n +10 +0.01 +5\n +40 +0.04 +1\n2 spans, 6 of 100 "
                            "ticks\nat tick 10:\n$"));
}

TEST_F(ReplayTicks, WhenTellsTheValuesAtTheFirstTick) {
  const auto trace = Trace::load(folder() / "sr1.mcap");
  ASSERT_TRUE(trace.ok());
  const Outcome outcome = looks({"--when", "tick > 50 && contact(RLEG_ANKLE_R) && output/RLEG_KNEE/u < 1e9"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nat tick 51: contact(RLEG_ANKLE_R) = true, output/RLEG_KNEE/u = "));
  const auto lines = lines_of(looks({"--when", "tick > 20 && output/RLEG_KNEE/u < 1e9", "--json"}).out);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["tick"], 21);
  EXPECT_EQ(lines[0]["last_tick"], 99);
  EXPECT_EQ(lines[0]["ticks"], 79);
  EXPECT_EQ(lines[0]["operands"]["output/RLEG_KNEE/u"].get<double>(), trace->values(command_series)[21]);
}

TEST_F(ReplayTicks, WhenComparesBothSides) {
  const std::string question = "replayed(output/RLEG_KNEE/u) != recorded(output/RLEG_KNEE/u)";
  EXPECT_EQ(looks({"--when", question}).status, 1);
  const Outcome outcome = looks({"--when", question, "--controller", with_changed_gain()});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("1 span, 100 of 100 ticks\n"));
}

TEST_F(ReplayTicks, WhenItNeverHoldsThatIsTheStatus) {
  const Outcome outcome = looks({"--when", "tick > 50", "--until", "0.04"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.out, "never, in 40 ticks\n");
}

TEST_F(ReplayTicks, AMistakeHasACaretBelow) {
  const Outcome outcome = looks({"--when", "tick > 5 && RLEG_KNEEE/q > 1"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, ContainsRegex("^error: there is no series 'RLEG_KNEEE/q' \\(did you mean 'RLEG_KNEE/q'.*\n"
                                         "  tick > 5 && RLEG_KNEEE/q > 1\n              \\^\n$"));
  EXPECT_THAT(looks({"--when", "tick + 1"}).err, HasSubstr("--when takes a condition"));
}

TEST_F(ReplayTicks, WhatDoesNotGoTogetherIsRefused) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--tick", "1", "--at", "0.1"},
                                             {"--tick", "1", "--when", "true"},
                                             {"--watch", "x", "--when", "true"},
                                             {"--tick", "1", "--from", "0.1"},
                                             {"--every", "2"},
                                             {"--full"},
                                             {"--tick", "-1"},
                                             {"--watch", "no_such_series"},
                                             {"--watch", "no*such*series"},
                                             {"--tick", "1", "--controller", "Walker=x.so"},
                                             {"--tick", "1", "--controller", "SR1Minimum=none.so"}}) {
    const Outcome outcome = looks(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err, "");
  }
}

TEST_F(ReplayTicks, ACutRecordingIsShownUpToTheCut) {
  done({"record", sr1_without_cameras().string(), "--duration", "2", "-o", "sr1.mcap"});
  fs::resize_file(folder() / "sr1.mcap", fs::file_size(folder() / "sr1.mcap") / 2);
  const Outcome outcome = looks({"--tick", "50"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, ContainsRegex("^sr1.mcap: warning: truncated at byte [0-9]+"));
  EXPECT_THAT(outcome.out, HasSubstr("\nthe replay gives the same bits as the recording\n"));
  const Outcome late = looks({"--tick", "1999"});
  EXPECT_EQ(late.status, 2);
  EXPECT_THAT(late.err, ContainsRegex("there is no tick 1999: the last is [0-9]+"));
}

TEST_F(ReplayTicks, APartOfARecordingIsShownAsItWasRecorded) {
  done({"filter", "sr1.mcap", "-o", "part.mcap", "--from", "0.05"});
  const Outcome outcome = rehearse({"replay", "part.mcap", "--tick", "60"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nnot replayed: commands are those of the recording\n"));
  EXPECT_THAT(outcome.err, HasSubstr("controllers can't begin in the middle"));
  EXPECT_THAT(outcome.err,
              HasSubstr("it begins at tick 50: it lacks earlier contacts, and has only later changes of contact"));
  EXPECT_THAT(rehearse({"replay", "part.mcap", "--tick", "3"}).err,
              HasSubstr("there is no tick 3: the first is 50 (0.05 s)"));
}

TEST_F(ReplayTicks, ARecordingWithoutTicksIsRefused) {
  done({"filter", "sr1.mcap", "-o", "none.mcap", "--exclude", "/tick"});
  const Outcome outcome = rehearse({"replay", "none.mcap", "--watch", "SR1/RLEG_KNEE/q"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "none.mcap: error: it has no ticks: nothing of the run was recorded\n");
}

TEST_F(ReplayTicks, ALibraryThatIsGoneLeavesWhatWasRecorded) {
  fs::copy_file(MISBEHAVING, folder() / "gone.so");
  done({"record", pendulum((folder() / "gone.so").string()).string(), "-o", "gone.mcap"});
  fs::remove(folder() / "gone.so");
  const Outcome outcome = rehearse({"replay", "gone.mcap", "--tick", "10"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nnot replayed: commands are those of the recording\n"));
  EXPECT_THAT(outcome.err,
              HasSubstr("warning: the controllers can't be replayed: all shown values are recorded ones\n"));
}

}  // namespace
}  // namespace rehearse::test
