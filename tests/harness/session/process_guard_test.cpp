// Changes of controllers to the process are undone and reported once each; the recorded data are kept.
#include <fcntl.h>
#include <fenv.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/time.h>

#include <clocale>
#include <utility>

#include "core/guard/float_mode.h"
#include "core/guard/process_guard.h"
#include "runs.h"
#include "support/printed_by_name.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The properties of a process that controllers may change.
struct Process {
  std::string directory = std::filesystem::current_path();
  std::string locale = std::setlocale(LC_ALL, nullptr);
  sighandler_t on_usr1 = handler_of(SIGUSR1), on_pipe = handler_of(SIGPIPE);
  bool blocks_term = blocks(SIGTERM);
  bool has_timer = is_set(ITIMER_REAL);
  mode_t mask = umask_now();
  FloatMode mode = float_mode();
  bool has_stdout = fcntl(1, F_GETFD) >= 0;
  bool has_variable = std::getenv("REHEARSE_TEST_TRESPASS") != nullptr;

  static sighandler_t handler_of(int number) {
    struct sigaction action {};
    sigaction(number, nullptr, &action);
    return action.sa_handler;
  }
  static bool blocks(int number) {
    sigset_t set;
    pthread_sigmask(SIG_BLOCK, nullptr, &set);
    return sigismember(&set, number);
  }
  static bool is_set(__itimer_which which) {
    itimerval timer{};
    getitimer(which, &timer);
    return timer.it_value.tv_sec != 0;
  }
  static mode_t umask_now() {
    const mode_t mask = umask(0);
    umask(mask);
    return mask;
  }
  bool operator==(const Process&) const = default;
};

struct Deed {
  const char* name;
  const char* told;  // after "control() at tick 7 "
};
class Trespass : public RunTest, public ::testing::WithParamInterface<Deed> {
 protected:
  const Process before_{};
};

INSTANTIATE_TEST_SUITE_P(
    Of, Trespass,
    ::testing::Values(
        Deed{"chdir", "changed the working directory to '/'; it was set back"},
        Deed{"current_path", "changed the working directory to '/'; it was set back"},
        Deed{"handler", "installed a handler of its own for SIGUSR1; it was set back"},
        Deed{"ignore", "ignored SIGPIPE; it was set back"},
        Deed{"own_segv", "took over SIGABRT, SIGSEGV, by which a crash or a hang is survived; it was not let"},
        Deed{"block", "blocked SIGTERM; it was set back"},
        Deed{"alarm", "set a timer of the process (alarm or setitimer); it was stopped"},
        Deed{"timer", "set a timer of the process (alarm or setitimer); it was stopped"},
        Deed{"locale", "set the locale to 'LC_NUMERIC=C.UTF-8'; it was set back"},
        Deed{"environment",
             "changed the environment of the whole process: REHEARSE_TEST_TRESPASS; it is set back after the run"},
        Deed{"umask", "changed the umask to 000; it was set back"},
        Deed{"close", "closed file descriptors that are not its own (the recording); they were kept open"},
        Deed{"close_range", "closed file descriptors that are not its own (the recording); they were kept open"},
        Deed{"stdout", "closed file descriptors that are not its own (stdout); they were kept open"},
        Deed{"round", "left another floating-point mode behind (rounding up); it was set back"},
        Deed{"trap",
             "left another floating-point mode behind (traps on invalid operations, division by zero); it was "
             "set back"}),
    test::by_name);

TEST_P(Trespass, InATickIsPutRightAndToldOnce) {
  const Trace trace = record_run(rig_with(std::string("trespass ") + GetParam().name + " control 7"));
  EXPECT_FALSE(summary_.failure.has_value());
  EXPECT_EQ(summary_.ticks, 20);
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: control() at tick 7 " + std::string(GetParam().told)));
  ASSERT_EQ(summary_.remarks.size(), 1u);
  EXPECT_EQ(summary_.remarks[0].severity, Severity::warning);
  EXPECT_TRUE(Process() == before_);
}

TEST_P(Trespass, BeforeTheRunIsPutRightToo) {
  const Trace trace = record_run(rig_with(std::string("trespass ") + GetParam().name + " start"));
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: start() at tick 0 " + std::string(GetParam().told)));
  EXPECT_TRUE(Process() == before_);
}

TEST_P(Trespass, IsRepeatedByAReplay) {
  record_run(rig_with(std::string("trespass ") + GetParam().name + " control 7"));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal());
  if (std::string(GetParam().told).find("(the recording)") != std::string::npos) {
    EXPECT_THAT(report->remarks, IsEmpty()) << "a replay has none that it could close";
    return;
  }
  ASSERT_EQ(report->remarks.size(), 1u);
  EXPECT_EQ(report->remarks[0].message, summary_.remarks[0].message);
}

TEST(ProcessGuard, LeavesAHandlerThatTheProgramSetsBetweenTwoCalls) {
  ProcessGuard& guard = ProcessGuard::instance();
  const sighandler_t mine = [](int) {};
  for (const bool by_signal : {false, true}) {
    guard.begin(nullptr, true);
    EXPECT_THAT(guard.put_right(), IsEmpty());
    struct sigaction action {};
    action.sa_handler = mine;
    if (by_signal)
      signal(SIGUSR2, mine);
    else
      sigaction(SIGUSR2, &action, nullptr);
    guard.begin(nullptr, true);
    EXPECT_THAT(guard.put_right(), IsEmpty());
    EXPECT_EQ(Process::handler_of(SIGUSR2), mine);
    signal(SIGUSR2, SIG_DFL);
  }
}

class Guest : public RunTest {
 protected:
  ~Guest() override { std::filesystem::current_path(directory_); }
  const std::filesystem::path directory_ = std::filesystem::current_path();
};

TEST_F(Guest, ThatDoesTheSameInEachTickIsAccusedOnce) {
  const Trace trace = record_run(rig_with("trespass chdir control 3"));
  EXPECT_EQ(trace.events().size(), 1u);
}

TEST_F(Guest, WhoseHandlersWereNotLetStillCrashesSafely) {
  record_run(rig(behaviour("Own", "trespass own_segv start") + ", " + behaviour("Bad", "fail null control 3")));
  ASSERT_TRUE(summary_.failure.has_value());
  EXPECT_THAT(summary_.failure->message, HasSubstr("controller 'Rig/Bad' crashed: segmentation fault"));
}

TEST_F(Guest, ThatOpensAFileWhereTheRecordingWasWritesIntoItsOwn) {
  std::filesystem::current_path(folder_.path());
  record_run(rig_with("trespass close_open start"));
  EXPECT_EQ(summary_.ticks, 20);
  EXPECT_EQ(bytes("own.txt"), "mine");
}

/// A system call that closes the file can't be prevented; but then no byte is written to the file that has its number
/// now.
TEST_F(Guest, ThatClosesTheRecordingPastTheLibraryEndsTheRunWithASentence) {
  std::filesystem::current_path(folder_.path());
  const Scenario scenario = load(rig(behaviour("C", "trespass close_raw control 7"), "cameras: none\n", "3"));
  const auto summary = record(scenario, path("run.mcap"));
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(to_string(summary.errors()),
              HasSubstr("run.mcap: error: the trace can't be written any further: something in this process has closed "
                        "its file descriptor"));
  EXPECT_THAT(to_string(summary.errors()), HasSubstr("noticed at tick "));
  EXPECT_THAT(to_string(summary.errors()), HasSubstr("Rig/C"));
  EXPECT_EQ(bytes("own.txt"), "mine");
}

TEST_F(Guest, ThatJoinsItsThreadIsNotAccused) {
  EXPECT_THAT(record_run(rig_with("thread joined")).events(), IsEmpty());
  EXPECT_THAT(record_run(rig_with("thread late")).events(), IsEmpty()) << "it may take a moment";
}

TEST_F(Guest, ThatLeavesAThreadKeepsItsLibrary) {
  const Trace trace = record_run(rig_with("thread left"));
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: leaves a thread running after stop(): Behaviours.so stays loaded"));
  record_run(rig_with("end_threads"));
}

TEST_F(Guest, WhoseThreadEndsTheProcessLosesThatThreadOnly) {
  const Trace trace = record_run(rig_with("trespass thread_exit initialize"));
  EXPECT_EQ(summary_.ticks, 20);
  EXPECT_THAT(said(trace),
              Contains("Rig/C: initialize() at tick 0 started a thread that called exit(0); that thread was "
                       "stopped for good"));
}

TEST_F(Guest, LinkedWithFastMathIsNamedWhenItIsLoaded) {
  const std::string scenario = rig("{name: Fast, library: FastMath}, " + behaviour("Tester", "denormals"));
  for (int i = 0; i < 2; ++i) {  // the second time it may be in memory already
    const Trace trace = record_run(scenario);
    EXPECT_THAT(said(trace), ElementsAre("Rig/Fast: controller library 'FastMath.so' switches the whole process to "
                                         "flush-to-zero and denormals-are-zero when it is loaded: it was linked with "
                                         "-ffast-math; it was set back"));
    EXPECT_THAT(trace.values("Rig/Tester/output/SHOULDER/u"), ::testing::Each(1.0));
  }
  EXPECT_TRUE(float_mode() == FloatMode());
}

bool linker_interrupted = false;  // in this process

class LoadingBadly : public RunTest {
 protected:
  ~LoadingBadly() override { unsetenv("LOADS_BADLY"); }
  /// A file with a separate name for each test, because a library that is already in memory is not loaded again.
  LoadingBadly() {
    std::filesystem::copy_file(std::filesystem::path(TEST_CONTROLLERS) / "LoadsBadly.so", path(library_));
  }
  const std::string library_ =
      "LoadsBadly" +
      std::filesystem::path(::testing::UnitTest::GetInstance()->current_test_info()->name()).filename().string() +
      ".so";
  const std::string scenario_ = rig("{name: Bad, library: " + library_ + "}");
};

TEST_F(LoadingBadly, IsToldAndPutRight) {
  const std::filesystem::path before = std::filesystem::current_path();
  setenv("LOADS_BADLY", "chdir", 1);
  EXPECT_THAT(said(record_run(scenario_)), ElementsAre("Rig/Bad: controller library '" + library_ +
                                                       "', while it was loaded, "
                                                       "changed the working directory to '/'; it was set back"));
  EXPECT_EQ(std::filesystem::current_path(), before);
}

TEST_F(LoadingBadly, ByExitAtTheEndIsSurvived) {
  if (std::exchange(linker_interrupted, true)) GTEST_SKIP() << "after one of them the dynamic linker unloads nothing";
  setenv("LOADS_BADLY", "exit_at_end", 1);
  ::testing::internal::CaptureStderr();
  const Trace trace = record_run(scenario_);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("warning: controller library '" + library_ +
                                                                  "' failed while it was unloaded: it called exit(4)"));
  EXPECT_EQ(summary_.ticks, 20);
}

TEST_F(LoadingBadly, ByExitIsRefused) {
  setenv("LOADS_BADLY", "exit", 1);
  const auto summary = record(load(scenario_), path("run.mcap"));
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(to_string(summary.errors()), HasSubstr("controller library '" + library_ +
                                                     "' failed while it was loaded: it "
                                                     "called exit(4)"));
  EXPECT_FALSE(std::filesystem::exists(path("run.mcap")));
}

TEST_F(LoadingBadly, ByAnEndlessLoopIsEnded) {
  setenv("LOADS_BADLY", "hang", 1);
  RecordOptions options;
  options.call_limit = 0.3;
  const auto summary = record(load(scenario_), path("run.mcap"), options);
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(to_string(summary.errors()), HasSubstr("controller library '" + library_ +
                                                     "' failed while it was loaded: it did not return within 0.3 s"));
}

/// The dynamic linker would report it as loaded, with static objects that were never constructed.
TEST_F(LoadingBadly, IsRefusedFromThenOn) {
  setenv("LOADS_BADLY", "crash", 1);
  EXPECT_FALSE(record(load(scenario_), path("run.mcap")).ok());
  unsetenv("LOADS_BADLY");
  const auto summary = record(load(scenario_), path("run.mcap"));
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(to_string(summary.errors()),
              HasSubstr("can't be loaded again in this process: before, it failed while it was loaded: it crashed: "
                        "segmentation fault"));
}

/// The dynamic linker is interrupted while it holds its lock: the interposer must work nevertheless.
class UnloadingBadly : public LoadingBadly, public ::testing::WithParamInterface<Deed> {
 protected:
  Trace record_with_limit(const std::string& scenario, const std::string& file) {
    return record_run(scenario, file, 0.3);
  }
};

INSTANTIATE_TEST_SUITE_P(By, UnloadingBadly,
                         ::testing::Values(Deed{"exit_at_end", "called exit(4)"},
                                           Deed{"exit_in_atexit", "called exit(4)"},
                                           Deed{"crash_at_end", "crashed: segmentation fault"},
                                           Deed{"hang_at_end", "did not return within 0.3 s"}),
                         test::by_name);

TEST_P(UnloadingBadly, LeavesTheWatchOverLaterCalls) {
  if (std::exchange(linker_interrupted, true)) GTEST_SKIP() << "after one of them the dynamic linker unloads nothing";
  setenv("LOADS_BADLY", GetParam().name, 1);
  ::testing::internal::CaptureStderr();
  record_with_limit(scenario_, "run.mcap");
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr("'" + library_ + "' failed while it was unloaded: it " + GetParam().told));
  EXPECT_EQ(summary_.ticks, 20);
  unsetenv("LOADS_BADLY");
  for (int i = 0; i < 2; ++i) {
    record_with_limit(rig_with("fail hang control 7"), "hangs.mcap");
    ASSERT_TRUE(summary_.failure.has_value());
    EXPECT_THAT(summary_.failure->message, HasSubstr("did not return within 0.3 s in control() at tick 7"));
  }
  std::filesystem::copy_file(path(library_), path("Other.so"));
  setenv("LOADS_BADLY", "hang", 1);
  RecordOptions options;
  options.call_limit = 0.3;
  EXPECT_FALSE(record(load(rig("{name: Bad, library: Other.so}")), path("run.mcap"), options).ok());
  const auto again = record(load(scenario_), path("run.mcap"), options);
  ASSERT_FALSE(again.ok());
  EXPECT_THAT(to_string(again.errors()), HasSubstr("can't be loaded again in this process"));
}

TEST_F(Guest, RunsInTheStandardModeWhateverTheProgramHas) {
  record_run(rig_with("push 1"), "standard.mcap");
  FloatMode fast;
  fast.sse |= 0x8040;
  set_float_mode(fast);
  const Scenario scenario = load(rig(behaviour("C", "push 1")));
  const auto summary = record(scenario, path("fast.mcap"));
  const auto replayed = replay(path("fast.mcap"));
  EXPECT_TRUE(float_mode() == fast) << "the program keeps its own";
  set_float_mode({});
  ASSERT_TRUE(summary.ok() && replayed.ok());
  EXPECT_EQ(bytes("fast.mcap"), bytes("standard.mcap"));
  for (const Diagnostics& remarks : {summary->remarks, replayed->remarks}) {
    ASSERT_EQ(remarks.size(), 1u);
    EXPECT_EQ(
        to_string(remarks[0]),
        "warning: this process was in another floating-point mode (flush-to-zero and denormals-are-zero) before the "
        "run; the run was made in the standard one (is the program, or a library of it, linked with -ffast-math?)");
  }
}

}  // namespace
}  // namespace rehearse
