// Output of controllers other than commands: lines to os(), and variables.
#include <cmath>
#include <map>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class WordsTest : public RunTest {
 protected:
  /// The times at which a series has a value [ticks of 1 ms].
  static std::vector<std::int64_t> ticks_of(const Trace& trace, const std::string& series) {
    std::vector<std::int64_t> ticks;
    for (const double time : trace.times(series)) ticks.push_back(std::llround(time / 0.001));
    return ticks;
  }

  static ReplayOptions with_options(const std::string& options) {
    ReplayOptions other;
    other.controllers["Rig/C"] = {"Behaviours", options, true, false, {}};
    return other;
  }

  /// "tick: text" of the controllers' lines.
  static std::vector<std::string> lines(const Trace& trace) {
    std::vector<std::string> all;
    for (const msg::Event& event : trace.events())
      if (event.severity == "note") all.push_back(std::to_string(event.tick) + ": " + event.text);
    return all;
  }
};

TEST_F(WordsTest, VariablesAreChannelsWithAMessageInEachTickThatSetsThem) {
  const Trace trace = record_run(rig(behaviour("C", "variables 0.25"), "cameras: none\n", "0.005"));
  EXPECT_THAT(topics(trace, "/Rig/C/variable/"), ElementsAre("/Rig/C/variable/gain", "/Rig/C/variable/phase",
                                                             "/Rig/C/variable/even", "/Rig/C/variable/odd%2Fname%25"));
  EXPECT_EQ(trace.find_channel("/Rig/C/variable/phase")->type, "std_msgs/msg/Float64");
  EXPECT_THAT(ticks_of(trace, "Rig/C/variable/gain"), ElementsAre(0));
  EXPECT_EQ(trace.first("Rig/C/variable/gain"), 2.5);
  EXPECT_THAT(ticks_of(trace, "Rig/C/variable/phase"), ElementsAre(0, 1, 2, 3, 4));
  const std::vector<double> phase = trace.values("Rig/C/variable/phase");
  EXPECT_EQ(phase[2], 0.5);
  EXPECT_TRUE(std::isnan(phase[3]));
  EXPECT_THAT(ticks_of(trace, "Rig/C/variable/even"), ElementsAre(0, 2, 4));
  EXPECT_THAT(said(trace), IsEmpty());
}

TEST_F(WordsTest, VariablesArePartOfNoHash) {
  const Trace with = record_run(rig_with("variables 0.25"), "with.mcap");
  const Trace without = record_run(rig_with("push 1"), "without.mcap");
  EXPECT_EQ(with.integers("output_hash"), without.integers("output_hash"));
  EXPECT_EQ(with.integers("input_hash"), without.integers("input_hash"));
}

TEST_F(WordsTest, WhatMayNotBeAVariableIsOneWarning) {
  const Trace trace = record_run(rig(behaviour("C", "misnaming"), "cameras: none\n", "0.003"));
  EXPECT_THAT(said(trace),
              ElementsAre("Rig/C: set a variable without a name: it isn't recorded",
                          HasSubstr("begins with 'xxxxxxxxxxxxxxxxxxxx' and has more than 200 bytes"),
                          HasSubstr("isn't UTF-8"), HasSubstr("more than 1000 variables: 'v1000' and those")));
  EXPECT_EQ(topics(trace, "/Rig/C/variable/").size(), 1000u);
  EXPECT_EQ(trace.last("Rig/C/variable/v999"), 999.0);
}

TEST_F(WordsTest, WhatIsSetOutsideOfATickIsOneWarning) {
  for (const char* how : {"thread", "stop"}) {
    const Trace trace = record_run(rig_with(std::string("stray ") + how));
    EXPECT_THAT(said(trace), ElementsAre(HasSubstr("rehearse_variable: was called where no controller is called")))
        << how;
    EXPECT_THAT(topics(trace, "/Rig/C/variable/"), IsEmpty());
  }
}

TEST_F(WordsTest, LinesHaveTheirTickWhateverTheirEnd) {
  const Trace trace = record_run(rig_with("lines"));
  EXPECT_THAT(lines(trace), ElementsAre("0: before", "0: the run", "0: one 0", "0: ", "0: three 0", "1: one 1",
                                        "1: ", "1: three 1", "2: last words", "19: over"));
}

TEST_F(WordsTest, TheLastWordsOfAControllerThatFailsAreRecorded) {
  for (const char* end : {"throw", "crash"}) {
    const Trace trace = record_run(rig_with(std::string("lines ") + end));
    ASSERT_TRUE(summary_.failure) << end;
    EXPECT_EQ(lines(trace).back(), "2: last words") << end;
    EXPECT_EQ(trace.last("Rig/C/variable/doom"), 13.0) << end;
  }
}

TEST_F(WordsTest, AReplaySaysTheSame) {
  record_run(rig_with("lines"));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->words.lines, 10);
  EXPECT_EQ(report->words.different, 0) << to_string(*report->words.first);
}

TEST_F(WordsTest, AReplayThatEndsEarlyDoesNotMissWhatIsSaidAtTheEnd) {
  record_run(rig_with("lines"));
  ReplayOptions options;
  options.until = 0.002;
  const auto report = replay_run(options);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->words.different, 0) << to_string(*report->words.first);
}

TEST_F(WordsTest, OtherLinesInAReplayAreFoundAndMakeNoVerdict) {
  record_run(rig_with("lines quietly famous"));
  const auto report = replay_run(with_options("lines quietly other"));
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal());
  EXPECT_EQ(report->words.different, 1);
  ASSERT_TRUE(report->words.first);
  EXPECT_EQ(report->words.first->tick, 2);
  EXPECT_THAT(to_string(*report->words.first),
              HasSubstr("/events: the line is \"Rig/C: other words\", recorded \"Rig/C: famous words\""));
}

TEST_F(WordsTest, AReplayTellsVariablesAndEvents) {
  record_run(rig(behaviour("C", "variables 0.25"), "cameras: none\n", "0.005"));
  std::map<std::string, std::vector<std::int64_t>> told;
  ReplayOptions options;
  options.on_variable = [&](std::int64_t tick, const std::string& series, double) { told[series].push_back(tick); };
  ASSERT_TRUE(replay_run(options).ok());
  EXPECT_THAT(told["Rig/C/variable/even"], ElementsAre(0, 2, 4));
  EXPECT_THAT(told["Rig/C/variable/gain"], ElementsAre(0));

  record_run(rig_with("lines"));
  std::vector<std::string> events;
  options.on_event = [&](const msg::Event& event) { events.push_back(event.text); };
  ASSERT_TRUE(replay_run(options).ok());
  EXPECT_EQ(events.size(), 10u);
  EXPECT_EQ(events.back(), "over");
}

TEST_F(WordsTest, OtherVariablesInAReplayMakeNoVerdictUnlessARuleAsks) {
  record_run(rig_with("variables 0.25"));
  const auto report = replay_run(with_options("variables 0.5"));
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal());
  EXPECT_EQ(report->words.first->channel, "/Rig/C/variable/phase");
  EXPECT_EQ(report->words.first->tick, 1);

  record_run(rig(behaviour("C", "variables 0.25"),
                 "cameras: none\ntolerances:\n  - {channel: Rig/C/variable/phase, atol: 0.1}\n"));
  const auto asked = replay_run(with_options("variables 0.5"));
  ASSERT_TRUE(asked.ok()) << to_string(asked.errors());
  ASSERT_TRUE(asked->first);
  EXPECT_EQ(asked->first->channel, "/Rig/C/variable/phase");
  EXPECT_EQ(asked->words.different, 0);
}

TEST_F(WordsTest, AComparisonRemarksOnVariablesUnlessARuleAsks) {
  const Trace golden = record_run(rig_with("variables 0.25"), "golden.mcap");
  const Trace other = record_run(rig_with("variables 0.5"), "other.mcap");
  const Trace silent = record_run(rig_with("push 1"), "silent.mcap");
  const auto remark_of = [](const Comparison& comparison) {
    std::string found;
    for (const std::string& remark : comparison.remarks)
      if (remark.find("variable") != std::string::npos) found += remark;
    return found;
  };
  const Comparison unasked = compare(golden, other, {});
  EXPECT_TRUE(unasked.equal) << verdict(unasked);
  EXPECT_EQ(remark_of(unasked),
            "controllers' variables, which no rule compares: Rig/C/variable/phase differs at tick 1");
  const Comparison missing = compare(golden, silent, {});
  EXPECT_TRUE(missing.equal) << verdict(missing);
  EXPECT_THAT(remark_of(missing), HasSubstr("is in the golden only, and 3 more differ"));
  EXPECT_THAT(remark_of(compare(silent, golden, {})), HasSubstr("is in the run only"));
  EXPECT_EQ(remark_of(compare(golden, golden, {})), "");

  ToleranceRule everything;
  everything.channel = "*";
  everything.atol = 1.0;
  EXPECT_TRUE(compare(golden, silent, {everything}).equal) << "a rule for all is no wish to compare variables";
  ToleranceRule rule;
  rule.channel = "Rig/*/variable/phase";
  rule.atol = 0.1;
  const Comparison asked = compare(golden, other, {rule});
  EXPECT_FALSE(asked.within);
  EXPECT_THAT(verdict(asked), HasSubstr("Rig/C/variable/phase is beyond ±0.1 from tick 1"));
  EXPECT_EQ(asked.first->stage, Stage::controller);
  rule.atol = 100.0;
  EXPECT_TRUE(compare(golden, other, {rule}).within);
  const Comparison asked_of_silent = compare(golden, silent, {rule});
  EXPECT_FALSE(asked_of_silent.within);
  EXPECT_THAT(verdict(asked_of_silent), HasSubstr("the channel is missing"));
}

}  // namespace
}  // namespace rehearse
