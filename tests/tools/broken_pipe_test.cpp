// The reader of a verb's output is gone: the verb ends by SIGPIPE, says nothing and blames nobody.
#include "command.h"

#include <gmock/gmock.h>

#include <csignal>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

constexpr int ended_by_pipe = 128 + SIGPIPE;

class BrokenPipe : public Command {
 protected:
  BrokenPipe() { record("none", "run.mcap"); }

  Outcome record(const std::string& deed, const std::string& trace) const {
    return rehearse({"record", pendulum(MISBEHAVING, deed).string(), "-o", trace});
  }
  /// Runs the verb with its stdout in a pipe whose reader has ended; the status is the verb's.
  Outcome without_reader(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{
        "-c", "{ sleep 0.2; \"$@\"; echo $? > ended_in; } | true; read status < ended_in; exit $status", "bash",
        command.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run("bash", words, "REHEARSE_CALL_STACK=never");
  }
  void expect_silence(const std::vector<std::string>& arguments) const {
    const Outcome outcome = without_reader(arguments);
    EXPECT_EQ(outcome.status, ended_by_pipe) << arguments[0];
    EXPECT_EQ(outcome.err, "") << arguments[0];
  }
};

TEST_F(BrokenPipe, EndsVerbsThatReadTraces) {
  expect_silence({"cat", "run.mcap"});
  expect_silence({"info", "run.mcap"});
  expect_silence({"diff", "run.mcap", "run.mcap"});
  fs::create_directory(folder() / "golden");
  expect_silence({"golden", "list"});
  expect_silence({"--help"});
}

TEST_F(BrokenPipe, EndsVerbsThatRunControllers) {
  expect_silence({"check", "pendulum.yaml", "--golden", "run.mcap"});
  expect_silence({"check", "pendulum.yaml", "--golden", "run.mcap", "--simulate"});
  expect_silence({"replay", "run.mcap"});
  expect_silence({"audit", "run.mcap"});
  write("varied.yaml", read_file(pendulum(MISBEHAVING, "none")) +
                           "vary:\n  deed: {path: bodies.Pendulum.controllers.Swing.options, grid: [none, nan]}\n");
  expect_silence({"sweep", "varied.yaml", "-j", "1", "-o", "swept"});
}

TEST_F(BrokenPipe, LeavesTheTraceOfARecordWhole) {
  expect_silence({"record", "pendulum.yaml", "-o", "other.mcap"});
  EXPECT_EQ(done({"info", "other.mcap", "--json"}).json()["ticks"], 50);
}

TEST_F(BrokenPipe, EndsARunWhoseControllerPrintsAtATickWithAClosedTrace) {
  pendulum(MISBEHAVING, "print 12");
  expect_silence({"record", "pendulum.yaml", "-o", "other.mcap"});
  const nlohmann::json info = done({"info", "other.mcap", "--json"}).json();
  EXPECT_EQ(info["ticks"], 13);
  expect_silence({"check", "pendulum.yaml", "--golden", "run.mcap", "--simulate"});
}

TEST_F(BrokenPipe, HidesNoControllerThatCrashes) {
  pendulum(MISBEHAVING, "exit_group 12");
  const Outcome outcome = without_reader({"record", "pendulum.yaml", "-o", "other.mcap"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, HasSubstr("controller 'Pendulum/Swing' ended the process"));
}

TEST_F(BrokenPipe, EndsAVerbThatWasStartedWithSigpipeIgnored) {
  const Outcome outcome =
      run("bash", {"-c", "trap '' PIPE; { sleep 0.2; " + quoted(command.string()) +
                             " cat run.mcap; echo $? > ended_in; } | true; read s < ended_in; exit $s"});
  EXPECT_EQ(outcome.status, ended_by_pipe);
  EXPECT_EQ(outcome.err, "");
}

}  // namespace
}  // namespace rehearse::test
