// The end of a process whose controller stays in memory: its static destructors run, under the guard and the limit.
#include "command.h"
#include "support/sanitized.h"

#include <gmock/gmock.h>
#include <rehearse/trace.h>

#include <chrono>
#include <csignal>
#include <utility>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

class ProcessEnd : public Command {
 protected:
  /// Runs a verb with a limit of 0.5 s, which it must keep.
  Outcome in_time(std::vector<std::string> arguments, const std::string& environment = "") const {
    arguments.insert(arguments.end(), {"--call-limit", "0.5"});
    const auto begin = Clock::now();
    Outcome outcome = rehearse(arguments, "timeout -s KILL 60 env ASAN_OPTIONS=detect_leaks=0 " + environment);
    EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10)) << arguments[0];
    return outcome;
  }
  /// The controller, as a user compiles it. Empty: the compiler can't.
  std::string compiled(const std::vector<std::string>& flags) const {
    std::vector<std::string> words{"-std=c++17",
                                   "-O0",
                                   "-g",
                                   "-shared",
                                   "-fPIC",
                                   "-DEIGEN_MAX_ALIGN_BYTES=16",
                                   "-I" CNOID_INCLUDE,
                                   "-isystem" EIGEN_INCLUDE};
    words.insert(words.end(), flags.begin(), flags.end());
    words.insert(words.end(), {STAYS_SOURCE, "-o", "built.so"});
    const Outcome built = run(CXX_COMPILER, words);
    return built.status == 0 ? (folder() / "built.so").string() : "";
  }
  bool has_counts() const {
    for (const auto& file : fs::recursive_directory_iterator(folder()))
      if (file.path().extension() == ".gcda") return true;
    return false;
  }
};

struct Deed {
  const char* name;
  const char* words;
};

TEST_F(ProcessEnd, IsTheStatusOfTheVerbWhateverAStaticDestructorDoes) {
  for (const Deed& deed :
       {Deed{"join", "waits for threads that wait for each other"}, Deed{"spin", "did not return within 0.5 s"},
        Deed{"block", "did not return within 0.5 s"}, Deed{"crash", "crashed: segmentation fault"},
        Deed{"abort", "crashed: it called abort"},
        Deed{"throw", "crashed: it called abort, as it threw std::runtime_error: the pool is \\x1b[31mbusy"},
        Deed{"exit", "called _exit(5)"}, Deed{"raw_exit", "ended the process with exit status 5"},
        Deed{"kill", "ended the process by SIGKILL"}}) {
    SCOPED_TRACE(deed.name);
    if (is_sanitized && deed.name == std::string("join")) continue;  // no deadlock is known of free threads
    fs::remove_all(folder() / "golden");
    fs::create_directory(folder() / "golden");
    write("p.yaml", read_file(pendulum(STAYS, deed.name)) + "golden: P.one\n");
    for (const std::vector<std::string>& verb : std::vector<std::vector<std::string>>{
             {"record", "p.yaml", "-o", "run.mcap"}, {"replay", "run.mcap"}, {"check", "p.yaml", "--simulate"}}) {
      const Outcome outcome = in_time(verb, verb[0] == "check" ? "REHEARSE_GOLDEN=new" : "");
      EXPECT_EQ(outcome.status, 0) << verb[0] << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr(std::string("warning: controller 'Pendulum/Swing' ") + deed.words));
      EXPECT_THAT(outcome.err, HasSubstr("while its static objects were destroyed\n"));
      EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("a thread, timer or limit")));
    }
    EXPECT_EQ(rehearse({"doctor", "run.mcap"}).status, 0);
  }
}

TEST_F(ProcessEnd, ComesAfterStaticDestructors) {
  write("p.yaml", read_file(pendulum(STAYS, "print")));
  const Outcome outcome = done({"record", "p.yaml", "-o", "run.mcap"});
  EXPECT_THAT(outcome.out, ::testing::EndsWith("the pool is destroyed\n"));
}

TEST_F(ProcessEnd, FollowsTheFirstSigterm) {
  for (const auto& [library, deed] : {std::pair(STAYS, "spin"), std::pair(GOES, "spin")}) {
    pendulum(library, deed);
    const Outcome outcome = run("bash",
                                {"-c",
                                 "\"$0\" record pendulum.yaml -o run.mcap --call-limit 50 & "
                                 "sleep 1.5; kill -TERM $!; wait $!",
                                 command.string()},
                                "ASAN_OPTIONS=detect_leaks=0 timeout -s KILL 20");
    EXPECT_EQ(outcome.status, 128 + SIGTERM) << deed << outcome.err;
  }
  EXPECT_EQ(rehearse({"doctor", "run.mcap"}).status, 0);
  fs::create_directory(folder() / "golden");
  write("p.yaml", read_file(pendulum(STAYS, "nothing")) + "golden: P.one\n");
  EXPECT_EQ(rehearse({"check", "p.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  write("p.yaml", read_file(pendulum(STAYS, "spin")) + "golden: P.one\n");
  for (const char* jobs : {"p.yaml", "p.yaml p.yaml -j2"}) {
    const Outcome outcome = run(
        "bash",
        {"-c", std::string("\"$0\" check --simulate --call-limit 50 ") + jobs + " & sleep 1.5; kill -TERM $!; wait $!",
         command.string()},
        "ASAN_OPTIONS=detect_leaks=0 timeout -s KILL 20");
    EXPECT_EQ(outcome.status, 128 + SIGTERM) << jobs << outcome.err;
  }
}

/// A call that computes, one that waits in the C library, and one that blocks all signals.
TEST_F(ProcessEnd, OfAHangingCallFollowsTheFirstSigterm) {
  for (const char* deed : {"hang", "wait", "block_and_hang"}) {
    pendulum(MISBEHAVING, std::string(deed) + " 12");
    const Outcome outcome = run("bash",
                                {"-c",
                                 "\"$0\" record pendulum.yaml -o run.mcap --call-limit 50 & "
                                 "sleep 1; kill -TERM $!; wait $!",
                                 command.string()},
                                "ASAN_OPTIONS=detect_leaks=0 timeout -s KILL 20");
    EXPECT_EQ(outcome.status, 128 + SIGTERM) << deed << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("did not return within 1 s after SIGTERM in control() at tick 12 (0.012 s)"));
    EXPECT_EQ(rehearse({"doctor", "run.mcap"}).status, 0) << deed;
    EXPECT_EQ(Trace::load(folder() / "run.mcap")->duration(), 0.012) << deed;
    fs::remove(folder() / "run.mcap");
  }
}

TEST_F(ProcessEnd, WritesTheCountsOfAControllerBuiltForCoverage) {
  const std::string library = compiled({"--coverage"});
  if (library.empty()) GTEST_SKIP() << "the compiler has no --coverage";
  fs::create_directory(folder() / "golden");
  write("p.yaml", read_file(pendulum(library, "nothing")) + "golden: P.one\n");
  const auto expect_counts = [&](const std::vector<std::string>& verb, const std::string& environment = "") {
    const Outcome outcome = rehearse(verb, environment);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(has_counts()) << verb[0];
    for (const auto& file : fs::directory_iterator(folder()))
      if (file.path().extension() == ".gcda") fs::remove(file.path());
  };
  expect_counts({"record", "p.yaml", "-o", "run.mcap"});
  expect_counts({"replay", "run.mcap"});
  expect_counts({"check", "p.yaml"}, "REHEARSE_GOLDEN=new");
  expect_counts({"check", "p.yaml", "--simulate"});
}

TEST_F(ProcessEnd, ReportsTheLeaksOfAControllerBuiltWithAsan) {
  const Outcome runtime = run(CXX_COMPILER, {"-print-file-name=libasan.so"});
  const std::string preloaded = runtime.out.substr(0, runtime.out.find('\n'));
  if (preloaded.find('/') == std::string::npos) GTEST_SKIP() << "the compiler has no shared runtime of ASan";
  const std::string library = compiled({"-fsanitize=address"});
  if (library.empty()) GTEST_SKIP() << "the compiler has no ASan";
  fs::create_directory(folder() / "golden");
  write("p.yaml", read_file(pendulum(library, "leak")) + "golden: P.one\n");
  const std::string with_asan = "LD_PRELOAD=" + preloaded + " ASAN_OPTIONS=detect_leaks=1 ";
  const Outcome probe = run("/bin/true", {}, with_asan);
  if (probe.status != 0) GTEST_SKIP() << "LeakSanitizer doesn't work here: " << probe.err;
  const Outcome recorded = rehearse({"record", "p.yaml", "-o", "run.mcap"}, with_asan);
  EXPECT_THAT(recorded.err, HasSubstr("LeakSanitizer: detected memory leaks"));
  EXPECT_THAT(recorded.err, HasSubstr("stays.cpp:"));
  EXPECT_NE(recorded.status, 0);
  const Outcome checked = rehearse({"check", "p.yaml"}, with_asan + "REHEARSE_GOLDEN=new");
  EXPECT_THAT(checked.err, HasSubstr("stays.cpp:"));
}

}  // namespace
}  // namespace rehearse::test
