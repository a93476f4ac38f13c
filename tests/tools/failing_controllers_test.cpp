// Runs whose controller can't be loaded, or fails: the message, the exit status, and the trace.
#include "command.h"
#include "support/sanitized.h"

#include <gmock/gmock.h>

#include <set>
#include <sstream>
#include <tuple>

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
  EXPECT_THAT(refusal(NOT_A_CONTROLLER), HasSubstr("is not a controller: it defines neither createSimpleController nor "
                                                   "rehearse_controller (end its source with "));
}

TEST_F(Library, OfAnotherMemoryLayoutIsRefused) {
  EXPECT_THAT(refusal(OTHER_LAYOUT),
              HasSubstr("was compiled with the <cnoid/...> headers of another version of Rehearse"));
  EXPECT_THAT(refusal(FOREIGN_LAYOUT), HasSubstr("was not compiled with Rehearse's <cnoid/...> headers"));
}

TEST_F(Library, ThatLacksASymbolIsRefusedWithItsName) {
  EXPECT_THAT(refusal(UNDEFINED_SYMBOL), HasSubstr("it needs the symbol 'gait_phase(double)'"));
}

/// The options for misbehaving.cpp, in the record and in the replay of a healthy recording.
class FailingController : public Command {
 protected:
  // Memory of a crashed controller is never freed; a leak checker would report this, with its own exit status.
  const std::string no_leak_check_ = "ASAN_OPTIONS=detect_leaks=0";

  Outcome record(const std::string& options, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"record", pendulum(MISBEHAVING, options).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rehearse(arguments, no_leak_check_);
  }
  /// The recording is complete, and states how it ended.
  nlohmann::json kept_trace() const { return done({"info", "pendulum.mcap", "--json"}).json(); }

  static nlohmann::json outcome_of(const nlohmann::json& info) {
    for (const nlohmann::json& record : info["metadata"])
      if (record["name"] == "rehearse.outcome") return record["values"];
    return {};
  }
  /// The begin of the message of a crash in the line of the controller that has this code.
  static std::string crash_at(const std::string& code) {
    std::istringstream source(read_file(MISBEHAVING_SOURCE));
    int line = 0;
    for (std::string text; std::getline(source, text);) {
      ++line;
      if (text.find(code) != std::string::npos) break;
    }
    return "misbehaving.cpp:" + std::to_string(line) + ": controller 'Pendulum/Swing' crashed: ";
  }
  /// Fails in the 13th call of control(): the trace is kept up to tick 12.
  void expect_failure(const std::string& deed, const std::string& message,
                      const std::vector<std::string>& more = {}) const {
    const Outcome outcome = record(deed + " 12", more);
    expect_failed(outcome, message);
    EXPECT_THAT(outcome.out, HasSubstr("\n13 ticks, "));
  }

 private:
  void expect_failed(const Outcome& outcome, const std::string& message) const {
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_THAT(outcome.err, ContainsRegex("^error: (misbehaving.cpp:[0-9]+: |)controller 'Pendulum/Swing' " + message +
                                           ".* in control\\(\\) at tick 12 \\(0.012 s\\)\n$"));
    const nlohmann::json info = kept_trace();
    EXPECT_EQ(outcome_of(info)["complete"], "false");
    EXPECT_EQ(info["ticks"], 13);
    ASSERT_EQ(info["events"].size(), 1u);
    EXPECT_EQ(info["events"][0]["tick"], 12);
    EXPECT_EQ(info["events"][0]["severity"], "error");
  }
};

TEST_F(FailingController, ThatRefusesHasRecordedNothing) {
  const Outcome outcome = record("refuse");
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_EQ(outcome.out, "pendulum didn't run: a controller refused to take part; pendulum.mcap has no tick\n");
}

TEST_F(FailingController, ThatThrowsEndsTheRun) {
  expect_failure("throw", "threw std::runtime_error: no gait for this slope");
}
TEST_F(FailingController, ThatFollowsANullPointerEndsTheRun) { expect_failure("crash", "crashed: segmentation fault"); }
/// The library has debug information, as in all builds but those without it.
TEST_F(FailingController, ThatFollowsANullPointerIsNamedWithItsLine) {
  const std::string begin = crash_at("missing_->u() = 1.0");
  EXPECT_THAT(record("crash 12").err, ::testing::StartsWith("error: " + begin));
  const Outcome replayed = rehearse({"replay", "pendulum.mcap"}, no_leak_check_);
  EXPECT_THAT(replayed.out, HasSubstr("failed: " + begin));
}
TEST_F(FailingController, ThatGivesANullPointerToTheCLibraryIsNamedWithItsLine) {
  for (const auto& [deed, code] :
       {std::pair("memcpy_null", "std::memcpy(nowhere"), {"strlen_null", "std::strlen(nowhere"}}) {
    const std::string begin = "error: " + crash_at(code) + "segmentation fault";
    EXPECT_THAT(record(std::string(deed) + " 12").err, ::testing::StartsWith(begin));
    const Outcome replayed = rehearse({"replay", "pendulum.mcap", "-o", "again.mcap"}, no_leak_check_);
    EXPECT_EQ(replayed.status, 3);
    EXPECT_THAT(replayed.err, ::testing::StartsWith(begin)) << "in a process of its own";
  }
}
TEST_F(FailingController, ThatAbortsEndsTheRun) { expect_failure("abort", "crashed: it called abort"); }
TEST_F(FailingController, ThatExitsEndsTheRun) { expect_failure("exit", "called exit\\(0\\)"); }
TEST_F(FailingController, ThatClosesAllFilesIsToldAndTheRunGoesOn) {
  const Outcome outcome = record("close 12");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(
      outcome.err,
      "warning: Pendulum/Swing: control() at tick 12 closed file descriptors that are not its own (stderr, stdout); "
      "they were kept open\n");
  EXPECT_THAT(outcome.out, HasSubstr("\n50 ticks, "));
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "true");
}
TEST_F(FailingController, ThatOverflowsItsStackEndsTheRun) {
  expect_failure("overflow", "crashed: its stack overflowed");
}
TEST_F(FailingController, WhoseTextIsLongHasItShortAndWithoutControlCharacters) {
  for (const char* deed : {"throw_long 12", "throw_nowhere 12", "thread_throw_long 12", "words_long 12"}) {
    const Outcome outcome = record(deed, {"--quiet"});
    EXPECT_EQ(outcome.status, 3) << deed;
    EXPECT_LT(outcome.err.size(), 1500u) << deed;
    EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos) << deed;
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos) << deed;
    EXPECT_THAT(outcome.err, HasSubstr("no \\x1b[31mgait | at \\x1b]0;slope\\x07\\x1b]0;slope")) << deed;
    EXPECT_THAT(outcome.err, HasSubstr("...")) << deed;
  }
}

TEST_F(FailingController, ThatNeverReturnsEndsTheRun) {
  expect_failure("hang", "did not return within 0.3", {"--call-limit", "0.3"});
}

TEST_F(FailingController, ThatMakesTheSystemCallToExitEndsTheRun) {
  expect_failure("syscall_exit", "called exit_group\\(0\\)");
}
TEST_F(FailingController, ThatBecomesAnotherProgramEndsTheRun) { expect_failure("execl", "called execl"); }
TEST_F(FailingController, ThatOverrunsAnArrayEndsTheRun) { expect_failure("overrun", "crashed: "); }
TEST_F(FailingController, WhoseThreadCrashesEndsTheRun) {
  if (is_sanitized) GTEST_SKIP() << why_free;
  expect_failure("thread_crash", "started a thread that crashed: segmentation fault");
}
TEST_F(FailingController, WhoseThreadOverflowsItsStackEndsTheRun) {
  if (is_sanitized) GTEST_SKIP() << why_free;
  expect_failure("thread_overflow", "started a thread that crashed: its stack overflowed");
}
TEST_F(FailingController, ThatFollowsANullPointerDeepInItsStackOverflowsNothing) {
  expect_failure("crash_deep", "crashed: segmentation fault");
}
TEST_F(FailingController, ThatWritesToAPipeOfItsOwnWithoutReaderIsNamed) {
  const Outcome outcome = record("own_pipe 12");
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("error: controller 'Pendulum/Swing' ended the process by SIGPIPE in control() at "
                                     "tick 12"));
}
TEST_F(FailingController, WhoseThreadThrowsEndsTheRun) {
  if (is_sanitized) GTEST_SKIP() << why_free;
  expect_failure("thread_throw", "started a thread that threw an exception that nobody catches: no map");
}
TEST_F(FailingController, WhoseTimerNobodyHandlesEndsTheRun) { expect_failure("timer", "was ended by SIGALRM"); }

TEST_F(FailingController, WhoseDetachedThreadCrashesEndsTheRunSoon) {
  const Outcome outcome = record("detached_crash 12");
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("controller 'Pendulum/Swing' started a thread that crashed: segmentation fault"));
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "false");
}

TEST_F(FailingController, ThatSetsALimitIsToldAndTheRunGoesOn) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer calls setrlimit itself, before ours can run";
#endif
  const Outcome outcome = record("file_limit 12");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(
      outcome.err,
      "warning: Pendulum/Swing: control() at tick 12 asked for another resource limit of the process (setrlimit); "
      "it stays as it is\n");
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "true");
}

/// Failures that only the parent process can report: the deed, and how the process ended.
class EndOfTheProcess : public FailingController,
                        public ::testing::WithParamInterface<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(By, EndOfTheProcess,
                         ::testing::Values(std::pair("exit_group", "with exit status 0"),
                                           std::pair("raw_exec", "with exit status 0"), std::pair("kill", "by SIGKILL"),
                                           std::pair("term", "by SIGTERM"),
                                           std::pair("thread_exit_group", "with exit status 0")),
                         [](const auto& end) { return std::string(end.param.first); });

TEST_P(EndOfTheProcess, IsAFailureOfTheControllerWithItsTick) {
  const auto& [deed, how] = GetParam();
  ASSERT_EQ(record("none", {"-o", "golden.mcap"}).status, 0);
  const std::string sentence = std::string("error: controller 'Pendulum/Swing' ended the process ") + how +
                               " in control() at tick 12 (0.012 s)\n";
  const Outcome recorded = record(std::string(deed) + " 12");
  EXPECT_EQ(recorded.status, 3);
  EXPECT_THAT(recorded.err, HasSubstr(sentence));
  EXPECT_EQ(kept_trace()["ticks"], 13);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"check", "pendulum.yaml", "--golden", "golden.mcap", "--level", "closed"},
        {"replay", "pendulum.mcap"}}) {
    const Outcome outcome = rehearse(words, no_leak_check_);
    EXPECT_EQ(outcome.status, 3) << words[0] << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(sentence)) << words[0];
  }
}

TEST_F(FailingController, ThatCanNotBeInterruptedIsKilled) {
  const Outcome outcome = record("block_and_hang 12", {"--call-limit", "0.2"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err,
              HasSubstr("error: controller 'Pendulum/Swing' did not return within 0.2 s in control() at tick 12 "
                        "(0.012 s)\n"));
}

TEST_F(FailingController, ThatEndsATestProgramLeavesACountOfTestsThatWereNotRun) {
  pendulum(MISBEHAVING, "exit_group 12");
  const Outcome outcome = run(ENDED_IN_A_TEST, {"--gtest_color=no"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(
      outcome.err,
      "error: controller 'Pendulum/Swing' ended the process with exit status 0 in control() at tick 12 (0.012 s)\n"
      "error: it was in test Walk.Ended; 2 after it were not run\n"
      "the trace up to there: ended.mcap (0.012 s)\n");
  EXPECT_THAT(outcome.out, HasSubstr("[       OK ] Walk.Before"));
  pendulum(MISBEHAVING, "none");
  EXPECT_EQ(run(ENDED_IN_A_TEST, {}).status, 0) << "and one that ends none is as before";
}

/// Its child must neither go on with the run nor hold what we write to.
class ForkingController : public FailingController, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(By, ForkingController,
                         ::testing::Values("fork", "syscall_clone", "raw_fork", "vfork", "fork_and_spin",
                                           "fork_and_exit"),
                         [](const auto& deed) { return std::string(deed.param); });

TEST_P(ForkingController, IsToldAndTheRunGoesOnOnce) {
  const Outcome outcome = record(std::string(GetParam()) + " 12");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, GetParam() == std::string("raw_fork")
                             ? ""
                             : "warning: Pendulum/Swing: control() at tick 12 forked; the run is the parent's, and the "
                               "child ends where the call ends in it\n");
  EXPECT_EQ(outcome.out.find("recorded "), outcome.out.rfind("recorded ")) << outcome.out;
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "true");
  EXPECT_EQ(kept_trace()["ticks"], 50);
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
  EXPECT_THAT(
      outcome.err,
      ContainsRegex(
          "^error: (misbehaving.cpp:[0-9]+: |)controller 'Pendulum/Swing' crashed: .* in initialize\\(\\) at tick 0"));
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "false");
}

TEST_F(FailingController, ThatReadsAnInputItNeverEnabledIsWarnedOf) {
  const std::string sentence =
      "Pendulum/Swing calls dq() of joint 'hinge' and never enabled that input: the value stays 0 in all ticks "
      "(io->enableInput(joint, cnoid::Link::JointVelocity) in initialize())";
  EXPECT_EQ(record("unread").err, "warning: " + sentence + "\n");
  EXPECT_EQ(rehearse({"record", "pendulum.yaml", "--json"}).json()["remarks"][0]["message"], sentence);
  EXPECT_EQ(record("nothing 0").err, "") << "it reads q, which it has enabled";
}

TEST_F(FailingController, ThatCommandsNanIsReportedAndTheRunGoesOn) {
  const Outcome outcome = record("nan 12");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err,
            "error: Pendulum/Swing: wrote nan into u of joint 'hinge' at tick 12 (0.012 s); it was recorded, but "
            "the robot keeps the command before it\n");
  EXPECT_EQ(outcome_of(kept_trace())["complete"], "true");
  done({"replay", "pendulum.mcap"});  // NaN is repeated bit for bit
}

/// Ended from outside, long before its end: the signal, its number, and whom it is sent to.
class Interrupted : public FailingController,
                    public ::testing::WithParamInterface<std::tuple<const char*, int, const char*>> {
 protected:
  /// Ends what follows when it has begun to record.
  std::string before(const std::string& trace) const {
    const auto& [name, number, group] = GetParam();
    return "bash -c 'set -m; \"$@\" & exec 2>/dev/null; until test -e " + trace +
           "; do sleep 0.1; done; sleep 0.5; kill -s " + name + " -- " + group + "$!; wait $!' bash ";
  }
  int status() const { return 128 + std::get<1>(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(By, Interrupted,
                         ::testing::Values(std::tuple("INT", 2, "-"), std::tuple("TERM", 15, "-"),
                                           std::tuple("INT", 2, ""), std::tuple("TERM", 15, ""),
                                           std::tuple("HUP", 1, "-"), std::tuple("HUP", 1, "")),
                         [](const auto& end) {
                           const bool of_process = *std::get<2>(end.param) == '\0';
                           return std::string(std::get<0>(end.param)) + (of_process ? "OfTheProcess" : "OfTheGroup");
                         });

TEST_P(Interrupted, RecordClosesItsTraceAndSaysSo) {
  const Outcome outcome =
      run(command, {"record", pendulum(MISBEHAVING, "none").string(), "--duration", "86400"}, before("pendulum.mcap"));
  EXPECT_EQ(outcome.status, status());
  EXPECT_THAT(outcome.err, ContainsRegex("^error: interrupted by SIG[A-Z]+ before tick [0-9]+ \\([0-9.]+ s\\)\n$"));
  EXPECT_THAT(outcome.out, HasSubstr(" in pendulum.mcap\n"));
  const nlohmann::json info = kept_trace();
  EXPECT_EQ(outcome_of(info)["complete"], "false");
  EXPECT_GT(info["ticks"], 0);
}

TEST_P(Interrupted, CheckJudgesNothingAndLeavesNothing) {
  ASSERT_EQ(record("none", {"-o", "golden.mcap"}).status, 0);
  pendulum(MISBEHAVING, "slow");
  const Outcome outcome = run(command, {"check", "pendulum.yaml", "--golden", "golden.mcap"},
                              before("rehearse-pending/.run-*/pendulum.mcap"));
  EXPECT_EQ(outcome.status, status());
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, ContainsRegex("^error: interrupted by SIG[A-Z]+: pendulum was not judged\n$"));
  std::set<std::string> left;
  for (const auto& entry : fs::recursive_directory_iterator(folder()))
    if (entry.is_regular_file()) left.insert(entry.path().filename());
  EXPECT_THAT(left, ::testing::ElementsAre("golden.mcap", "pendulum.yaml"));
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
