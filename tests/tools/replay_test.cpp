// rehearse replay: from the trace alone, without physics; a changed gain is found at its first effect.
#include "command.h"

#include <gmock/gmock.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Replay : public Command {
 protected:
  void record_sr1() const { done({"record", sr1_without_cameras().string(), "-o", "sr1.mcap"}); }
};

TEST_F(Replay, RepeatsEveryCommand) {
  record_sr1();
  const Outcome outcome = done({"replay", "sr1.mcap"});
  EXPECT_THAT(outcome.out, StartsWith("replayed sr1.mcap: 100 ticks without physics in "));
  EXPECT_THAT(outcome.out,
              HasSubstr("\nequal bit for bit: 100 ticks, 3000 commanded numbers\n"));  // 29 joints, 1 result
}

TEST_F(Replay, RepeatsARunWithCameras) {
  done({"record", sr1_scenario.string(), "--duration", "0.1", "-o", "sr1.mcap"});
  EXPECT_THAT(done({"replay", "sr1.mcap"}).out, HasSubstr("\nequal bit for bit: "));
}

TEST_F(Replay, NeedsNothingButTheTrace) {
  record_sr1();
  fs::create_directory(folder() / "elsewhere");
  fs::rename(folder() / "sr1.mcap", folder() / "elsewhere/renamed.mcap");
  fs::remove(folder() / "sr1.yaml");
  done({"replay", "elsewhere/renamed.mcap"});
}

TEST_F(Replay, AnswersInJson) {
  record_sr1();
  const nlohmann::json report = done({"replay", "sr1.mcap", "--json"}).json();
  EXPECT_EQ(report["equal"], true);
  EXPECT_EQ(report["within"], true);
  EXPECT_EQ(report["first"], nullptr);
  EXPECT_EQ(report["ticks"], 100);
  EXPECT_EQ(report["verdict"], "equal bit for bit: 100 ticks, 3000 commanded numbers");
}

TEST_F(Replay, FindsAChangedGainAtTheFirstTickInWhichItActs) {
  record_sr1();
  // the gain multiplies the knee's distance from its position in the scenario
  const auto scenario = Scenario::load(sr1_without_cameras());
  ASSERT_TRUE(scenario.ok());
  const double reference = scenario->bodies[1].joints[3];
  const auto trace = Trace::load(folder() / "sr1.mcap");
  ASSERT_TRUE(trace.ok());
  const std::vector<double> knee = trace->values("SR1/SR1Minimum/input/RLEG_KNEE/q");
  std::size_t first = 0;
  while (first < knee.size() && knee[first] == reference) ++first;
  ASSERT_LT(first, knee.size());

  const Outcome outcome = rehearse({"replay", "sr1.mcap", "--json", "--controller", "SR1Minimum=" CHANGED_GAIN});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const nlohmann::json report = outcome.json();
  EXPECT_EQ(report["equal"], false);
  EXPECT_EQ(report["within"], false);
  EXPECT_EQ(report["first"]["tick"], first);
  EXPECT_DOUBLE_EQ(report["first"]["time"], static_cast<double>(first) * 0.001);
  EXPECT_EQ(report["first"]["channel"], "/SR1/SR1Minimum/output/joints");
  EXPECT_EQ(report["first"]["element"], "RLEG_KNEE/u");
  EXPECT_EQ(report["first"]["stage"], "controller");
  EXPECT_EQ(report["first"]["expected"],
            trace->at("SR1/SR1Minimum/output/RLEG_KNEE/u", static_cast<double>(first) * 0.001));
  EXPECT_NE(report["first"]["actual"], report["first"]["expected"]);
  EXPECT_GT(report["first"]["ulps"], 0);
}

TEST_F(Replay, SaysInASentenceWhereItDiffers) {
  record_sr1();
  const Outcome outcome = rehearse({"replay", "sr1.mcap", "--controller", "SR1/SR1Minimum=" CHANGED_GAIN});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      ContainsRegex(
          "\ndiffers: RLEG_KNEE/u is beyond .*\nits bits differ from tick 0 on\nworst: .*\n100 of 100 ticks and 100 of "
          "3000 commanded numbers differ\n$"));
}

/// Other rules don't: a controller must repeat its commands.
TEST_F(Replay, EndsWithZeroIfARuleForCommandsAllowsTheDifference) {
  const auto replay_with_rule = [&](const std::string& pattern) {
    const fs::path scenario = sr1_without_cameras();
    const std::string rule = "\"SR1/*/u\", atol: 2.0e-3";
    std::string text = read_file(scenario);
    text.replace(text.find(rule), rule.size(), "\"" + pattern + "\", atol: 1000");
    write(scenario.filename().string(), text);
    done({"record", scenario.string(), "-o", "sr1.mcap"});
    return rehearse({"replay", "sr1.mcap", "--json", "--controller", "SR1Minimum=" CHANGED_GAIN});
  };
  const Outcome allowed = replay_with_rule("SR1/*/output/*");
  EXPECT_EQ(allowed.status, 0) << allowed.out;
  EXPECT_EQ(allowed.json()["equal"], false);
  EXPECT_EQ(allowed.json()["within"], true);
  EXPECT_THAT(allowed.json()["verdict"].get<std::string>(),
              StartsWith("the rules for commands allow the differences: "));
  EXPECT_EQ(replay_with_rule("*/u").status, 0);
  EXPECT_EQ(replay_with_rule("*").status, 1);
}

TEST_F(Replay, ComparesTheAskedSpanOnly) {
  record_sr1();
  const nlohmann::json late =
      rehearse({"replay", "sr1.mcap", "--json", "--from", "0.05", "--controller", "SR1Minimum=" CHANGED_GAIN}).json();
  EXPECT_EQ(late["first"]["tick"], 50);
  const nlohmann::json early = done({"replay", "sr1.mcap", "--json", "--until", "0.04"}).json();
  EXPECT_EQ(early["ticks"], 40);
}

TEST_F(Replay, RefusesATruncatedTrace) {
  record_sr1();
  fs::resize_file(folder() / "sr1.mcap", fs::file_size(folder() / "sr1.mcap") / 2);
  const Outcome outcome = rehearse({"replay", "sr1.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, ContainsRegex("^sr1.mcap: error: truncated at byte [0-9]+"));
  EXPECT_THAT(outcome.err, HasSubstr("(rehearse recover makes a whole file of the undamaged data)"))
      << "what to do next";
}

/// Channels of a recovered recording end at different times: lost inputs aren't different ones.
TEST_F(Replay, ComparesARecoveredTraceAsFarAsItsInputsGo) {
  done({"record", (fixtures / "scenarios/rover.yaml").string(), "-o", "rover.mcap"});
  const std::string whole = read_file(folder() / "rover.mcap");
  int warned = 0;
  for (int part = 1; part < 12; ++part) {
    write("cut.mcap", whole.substr(0, whole.size() * part / 12));
    fs::remove(folder() / "saved.mcap");
    ASSERT_LE(rehearse({"recover", "cut.mcap", "-o", "saved.mcap"}).status, 1);
    const Outcome outcome = rehearse({"replay", "saved.mcap"});
    if (outcome.out.find("nothing was compared") != std::string::npos) continue;
    EXPECT_EQ(outcome.status, 0) << part << ": " << outcome.out;
    EXPECT_THAT(outcome.out, ContainsRegex("equal bit for bit: [1-9]"));
    warned += outcome.err.find("and later ones are lost: commands are compared up to there") != std::string::npos;
  }
  EXPECT_GT(warned, 0);
}

TEST_F(Replay, RefusesATraceWithOneFlippedBit) {
  record_sr1();
  std::string bytes = read_file(folder() / "sr1.mcap");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write("flipped.mcap", bytes);
  const Outcome outcome = rehearse({"replay", "flipped.mcap"});
  EXPECT_EQ(outcome.status, 2) << outcome.out;
  EXPECT_THAT(outcome.err, StartsWith("flipped.mcap: error: "));
}

TEST_F(Replay, NamesAControllerThatTheTraceHasNot) {
  record_sr1();
  const Outcome outcome = rehearse({"replay", "sr1.mcap", "--controller", "Walker=x.so"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "error: there is no controller 'Walker' in sr1_minimum (there is: SR1/SR1Minimum)\n");
}

}  // namespace
}  // namespace rehearse::test
