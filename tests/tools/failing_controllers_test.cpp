// What becomes of a run whose controller can't be loaded, or fails: the message, the exit status, and the trace.
#include "command.h"

#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class Library : public Command {
 protected:
  /// Records with that library; it has to be refused and nothing written.
  std::string refusal(const std::string& library) const {
    const Outcome outcome = rehearse({"record", pendulum(library).string()});
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(exists("pendulum.mcap"));
    return outcome.err;
  }
};

TEST_F(Library, ThatIsMissingIsNamedWithItsPlaceAndWhereItWasLookedFor) {
  EXPECT_THAT(refusal("Walker"), ContainsRegex("pendulum.yaml:9:18: error: controller library 'Walker' not found "
                                               "\\(looked for .*/Walker.so.*\\)\n$"));
}

TEST_F(Library, ThatIsNoLibraryIsRefused) {
  EXPECT_THAT(refusal(write("text.so", "not ELF").string()), HasSubstr("'text.so' is not a shared library"));
}

TEST_F(Library, ThatIsNoControllerIsRefused) {
  EXPECT_THAT(refusal(NOT_A_CONTROLLER),
              HasSubstr("is not a controller: it defines no createSimpleController (end its source with "));
}

TEST_F(Library, OfAnotherMemoryLayoutIsRefused) {
  EXPECT_THAT(refusal(OTHER_LAYOUT),
              HasSubstr("was compiled with the <cnoid/...> headers of another version of Rehearse"));
  EXPECT_THAT(refusal(FOREIGN_LAYOUT), HasSubstr("was not compiled with Rehearse's <cnoid/...> headers"));
}

TEST_F(Library, ThatLacksASymbolIsRefusedWithItsName) {
  EXPECT_THAT(refusal(UNDEFINED_SYMBOL), HasSubstr("it needs the symbol 'gait_phase(double)'"));
}

/// What misbehaving.cpp is told to do, in the record and in the replay of a healthy recording.
class FailingController : public Command {
 protected:
  // What a controller that crashed held stays held; a leak checker would say so, with an exit status of its own.
  const std::string no_leak_check_ = "ASAN_OPTIONS=detect_leaks=0";

  Outcome record(const std::string& options, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"record", pendulum(MISBEHAVING, options).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rehearse(arguments, no_leak_check_);
  }
  /// The recording is whole, and says how it ended.
  nlohmann::json kept_trace() const { return done({"info", "pendulum.mcap", "--json"}).json(); }

  static nlohmann::json outcome_of(const nlohmann::json& info) {
    for (const nlohmann::json& record : info["metadata"])
      if (record["name"] == "rehearse.outcome") return record["values"];
    return {};
  }
  /// Fails in the 13th call of control(): the trace is kept up to tick 12.
  void expect_failure(const std::string& deed, const std::string& message,
                      const std::vector<std::string>& more = {}) const {
    const Outcome outcome = record(deed + " 12", more);
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_THAT(outcome.err, ContainsRegex("^error: controller 'Pendulum/Swing' " + message +
                                           ".* in control\\(\\) at tick 12 \\(0.012 s\\)\n$"));
    EXPECT_THAT(outcome.out, HasSubstr("\n13 ticks, "));
    const nlohmann::json info = kept_trace();
    EXPECT_EQ(outcome_of(info)["complete"], "false");
    EXPECT_EQ(info["ticks"], 13);
    ASSERT_EQ(info["events"].size(), 1u);
    EXPECT_EQ(info["events"][0]["tick"], 12);
    EXPECT_EQ(info["events"][0]["severity"], "error");
  }
};

TEST_F(FailingController, ThatThrowsEndsTheRun) {
  expect_failure("throw", "threw std::runtime_error: no gait for this slope");
}
TEST_F(FailingController, ThatFollowsANullPointerEndsTheRun) { expect_failure("crash", "crashed: segmentation fault"); }
TEST_F(FailingController, ThatAbortsEndsTheRun) { expect_failure("abort", "crashed: it called abort"); }
TEST_F(FailingController, ThatExitsEndsTheRun) { expect_failure("exit", "called exit\\(0\\)"); }
TEST_F(FailingController, ThatClosesAllFilesIsToldAndTheRunGoesOn) {
  const Outcome outcome = record("close 12");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(
      outcome.err,
      "warning: Pendulum/Swing: control() at tick 12 closed file descriptors that are not its own (stderr, stdout, "
      "the recording); they were kept open\n");
  EXPECT_THAT(outcome.out, HasSubstr("\n50 ticks, "));
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "true");
}
TEST_F(FailingController, ThatOverflowsItsStackEndsTheRun) {
  expect_failure("overflow", "crashed: segmentation fault");
}
TEST_F(FailingController, ThatNeverReturnsEndsTheRun) {
  expect_failure("hang", "did not return within 0.3", {"--call-limit", "0.3"});
}

TEST_F(FailingController, ThatRefusesEndsTheRunBeforeItsFirstTick) {
  const Outcome outcome = record("refuse");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err,
              HasSubstr("error: controller 'Pendulum/Swing' refuses to take part: initialize() returned false"));
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "false");
}

TEST_F(FailingController, ThatCrashesInInitializeLeavesAReadableTrace) {
  const Outcome outcome = record("crash");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err,
              ContainsRegex("^error: controller 'Pendulum/Swing' crashed: .* in initialize\\(\\) at tick 0"));
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "false");
}

TEST_F(FailingController, ThatCommandsNanIsReportedAndTheRunGoesOn) {
  const Outcome outcome = record("nan 12");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err,
            "error: Pendulum/Swing: wrote nan into u of link 'rod' at tick 12; it was recorded, but the robot "
            "keeps the command before it\n");
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "true");
  done({"replay", "pendulum.mcap"});  // NaN is repeated bit for bit
}

TEST_F(FailingController, InAReplayIsSaidLikewise) {
  ASSERT_EQ(record("none").status, 0);
  const std::string changed = pendulum(MISBEHAVING, "throw 7").string();  // the trace has its own copy of the scenario
  const Outcome calm = rehearse({"replay", "pendulum.mcap"});
  EXPECT_EQ(calm.status, 0) << calm.err;

  fs::rename(folder() / "pendulum.mcap", folder() / "calm.mcap");
  ASSERT_EQ(rehearse({"record", changed}, no_leak_check_).status, 3);
  const Outcome outcome = rehearse({"replay", "pendulum.mcap"}, no_leak_check_);
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out, HasSubstr("\nfailed: controller 'Pendulum/Swing' threw std::runtime_error: no gait for this "
                                     "slope in control() at tick 7 (0.007 s)\n"));
  EXPECT_EQ(outcome.err, "");
}

TEST_F(FailingController, ThatHangsInAReplayIsStoppedByTheLimit) {
  ASSERT_EQ(record("hang 5", {"--call-limit", "0.3"}).status, 3);
  const Outcome outcome = rehearse({"replay", "pendulum.mcap", "--call-limit", "0.3"}, no_leak_check_);
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out, HasSubstr("did not return within 0.3"));
}

}  // namespace
}  // namespace rehearse::test
