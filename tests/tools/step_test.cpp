// rehearse step: by scripts on stdin, and once at a terminal.
#include "command.h"

#include <gmock/gmock.h>
#include <poll.h>
#include <pty.h>
#include <rehearse/trace.h>
#include <signal.h>
#include <termios.h>
#include <unistd.h>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Step : public Command {
 protected:
  void record_sr1() const { done({"record", sr1_without_cameras().string(), "-o", "sr1.mcap"}); }  // 100 ticks
  Outcome step(const std::string& script, const std::string& arguments = "") const {
    write("script", script);
    return run("/bin/sh", {"-c", command.string() + " step sr1.mcap " + arguments + " < script"});
  }
  /// The last line of the output for a script.
  std::string last(const std::string& script, const std::string& arguments = "") const {
    const Outcome outcome = step(script, arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::string text = outcome.out;
    while (text.ends_with('\n')) text.pop_back();
    return text.substr(text.rfind('\n') + 1);
  }
  static std::string with_changed_gain() { return "--controller SR1Minimum=" CHANGED_GAIN; }
};

TEST_F(Step, MovesForwardsAndBackwards) {
  record_sr1();
  EXPECT_EQ(last(""), "tick 0, 0 s");
  EXPECT_EQ(last("next 5\n"), "tick 5, 0.005 s");
  EXPECT_EQ(last("n 5\nn\nb 2\nb\n"), "tick 3, 0.003 s");
  EXPECT_EQ(last("goto 50\n"), "tick 50, 0.05 s");
  EXPECT_EQ(last("g 0.06s\n"), "tick 60, 0.06 s");
  EXPECT_EQ(last("g 60\ng +5\ng -2\n"), "tick 63, 0.063 s");
  EXPECT_EQ(last("g end\n"), "tick 99, 0.099 s");
  EXPECT_EQ(last("g end\ng start\n"), "tick 0, 0 s");
  EXPECT_EQ(last("n 1000\n"), "tick 99, 0.099 s") << "not beyond the end";
  EXPECT_EQ(last("", "--from 0.02"), "tick 20, 0.02 s");
}

TEST_F(Step, PrintsNoPromptToAScript) {
  record_sr1();
  const Outcome outcome = step("n\n# a remark\n\nquit\nn\n");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, Not(HasSubstr("(step)")));
  EXPECT_EQ(std::ranges::count(outcome.out, '\n'), 2) << outcome.out;  // where it was and is; then quit
}

TEST_F(Step, SearchesInBothDirections) {
  record_sr1();
  EXPECT_EQ(last("until tick > 30\n"), "tick 31, 0.031 s");
  EXPECT_EQ(last("g 90\nback until tick < 31\n"), "tick 30, 0.03 s");
  EXPECT_THAT(last("until tick > 300\n"), StartsWith("it doesn't become true after here; still at tick 0"));
}

TEST_F(Step, ContinuesToWhereSomethingHappens) {
  record_sr1();
  // both feet come down
  EXPECT_THAT(last("continue\n"), ContainsRegex("^tick [0-9]+, [0-9.]+ s  Floor/Floor begins to touch SR1/"));
  EXPECT_THAT(last("g 20\nback continue\n", with_changed_gain()),
              StartsWith("tick 0, 0 s  differs: SR1/SR1Minimum/output/"));
}

TEST_F(Step, WatchesAndPrints) {
  record_sr1();
  const auto trace = Trace::load(folder() / "sr1.mcap");
  ASSERT_TRUE(trace.ok());
  const double q = trace->values("SR1/RLEG_KNEE/q")[11];
  std::ostringstream text;
  text << nlohmann::json(q);
  EXPECT_EQ(last("watch SR1/RLEG_KNEE/q\ng 11\n"), "  SR1/RLEG_KNEE/q = " + text.str() + " rad");
  EXPECT_EQ(last("g 11\np SR1/RLEG_KNEE/q\n"), "SR1/RLEG_KNEE/q = " + text.str() + " rad");
  EXPECT_EQ(last("watch SR1/RLEG_KNEE/q\nunwatch\ng 11\n"), "tick 11, 0.011 s");
  EXPECT_EQ(last("g 11\np tick * 2\n"), "tick * 2 = 22");
  EXPECT_EQ(last("g 50\np contact(RLEG_ANKLE_R)\n"), "contact(RLEG_ANKLE_R) = true");
  EXPECT_THAT(last("g 11\np output/RLEG_KNEE/u\n", with_changed_gain()),
              ContainsRegex(" N·m \\(replayed [-0-9.e]+\\)$"));
}

TEST_F(Step, ShowsATickAsReplayDoes) {
  record_sr1();
  const std::string tick = done({"replay", "sr1.mcap", "--tick", "50"}).out;
  EXPECT_THAT(step("g 50\ninfo\n").out, HasSubstr(tick));
  const std::string inputs = step("g 50\ninputs\n").out;
  EXPECT_THAT(inputs, HasSubstr("SR1/SR1Minimum reads\n"));
  EXPECT_THAT(inputs, Not(HasSubstr("sensors")));
  EXPECT_THAT(step("g 50\ncommands\n").out, HasSubstr("SR1/SR1Minimum commands\n"));
  EXPECT_THAT(step("g 50\ncontacts\n").out, HasSubstr("Floor/Floor touches SR1/RLEG_ANKLE_R\n"));
  EXPECT_THAT(last("g 50\ndiff\n"), "the replay gives the same bits as the recording");
  EXPECT_THAT(last("g 50\ndiff\n", with_changed_gain()), StartsWith("  SR1/SR1Minimum/output/RLEG_KNEE/u: replayed "));
  EXPECT_EQ(last("g 50\nmessages\n"), "there is no message in tick 50");
}

TEST_F(Step, PlotsASeriesAroundTheTick) {
  record_sr1();
  const std::string out = step("g 50\nplot SR1/RLEG_KNEE/q\n").out;
  EXPECT_THAT(out, HasSubstr("SR1/RLEG_KNEE/q [rad], "));
  EXPECT_THAT(out, HasSubstr("▲"));
  EXPECT_THAT(out, HasSubstr("0.05 s"));
  const std::string span = step("g 50\nplot SR1/RLEG_KNEE/q 0.02s 30\n").out;
  EXPECT_THAT(span, HasSubstr("0.02 s"));
  EXPECT_THAT(span, Not(HasSubstr("▲"))) << "the tick isn't in it";
  EXPECT_THAT(step("plot output/RLEG_KNEE/u\n", with_changed_gain()).out, HasSubstr("░ recorded, █ replayed"));
}

TEST_F(Step, WritesAFrame) {
  done({"record", sr1_scenario.string(), "--duration", "0.1", "-o", "sr1.mcap"});
  const Outcome none = step("frame picture.png\n");
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, ContainsRegex("error: there are [0-9]+ cameras \\(one of "));
  write("notes.png", "mine");
  const std::string camera =
      none.err.substr(none.err.find("one of ") + 7, none.err.find(',') - none.err.find("one of ") - 7);
  const Outcome outcome = step("g end\nframe " + camera + " picture.png\nframe " + camera + " notes.png\n");
  EXPECT_EQ(outcome.status, 2) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("picture.png: /" + camera));
  EXPECT_EQ(read_file(folder() / "picture.png").substr(1, 3), "PNG");
  EXPECT_EQ(read_file(folder() / "notes.png"), "mine") << "nothing else is replaced";
}

TEST_F(Step, TellsHowToStopGdbThere) {
  record_sr1();
  EXPECT_EQ(last("g 50\ngdb-hint\n"), "rehearse replay sr1.mcap --gdb --tick 50");
}

TEST_F(Step, CommandsAreFoundByTheirBeginning) {
  record_sr1();
  const Outcome unclear = step("co\n");
  EXPECT_EQ(unclear.status, 2);
  EXPECT_EQ(unclear.err, "error: 'co' may be continue, commands, contacts\n");
  EXPECT_EQ(last("nex 3\n"), "tick 3, 0.003 s");
  EXPECT_THAT(step("help\n").out, ContainsRegex("n +next \\[N\\] "));
  EXPECT_THAT(last("help unti\n"), StartsWith("until EXPR: "));
}

TEST_F(Step, MistakesAreToldAndTheSessionGoesOn) {
  record_sr1();
  const std::vector<std::string> mistakes{"foo",
                                          "goto",
                                          "goto x",
                                          "goto 100",
                                          "goto 7s",
                                          "goto -1",
                                          "goto nans",
                                          "next x",
                                          "next 0",
                                          "back x",
                                          "back",
                                          "until",
                                          "until tick",
                                          "until tick >",
                                          "print",
                                          "print no_such",
                                          "watch no_such",
                                          "unwatch no_such",
                                          "plot",
                                          "plot no_such",
                                          "plot SR1/RLEG_KNEE/q 30",
                                          "plot SR1/RLEG_KNEE/q 30 20",
                                          "info x",
                                          "frame",
                                          "frame x.png",
                                          "help foo",
                                          "goto 99999999999999999999999",
                                          "next 99999999999999999999999"};
  std::string script;
  for (const std::string& mistake : mistakes) script += mistake + "\n";
  const Outcome outcome = step(script + "next\n");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "tick 0, 0 s\ntick 1, 0.001 s\n");
  std::size_t told = 0;
  for (std::size_t at = 0; (at = outcome.err.find("error: ", at)) != std::string::npos; ++at) ++told;
  EXPECT_EQ(told, mistakes.size()) << outcome.err;
  EXPECT_THAT(step("until tick > KNEEE\n").err, HasSubstr("\n  tick > KNEEE\n         ^\n"));
}

TEST_F(Step, ARunThatFailedIsThereUpToItsEnd) {
  EXPECT_EQ(rehearse({"record", pendulum(MISBEHAVING, "throw 7").string(), "-o", "sr1.mcap"}).status, 3);
  const Outcome outcome = step("g end\nback\n");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("\ntick 7, 0.007 s  Pendulum/Swing: error: controller 'Pendulum/Swing' threw "));
  EXPECT_THAT(outcome.out, HasSubstr("  (the replay failed here)\ntick 6, 0.006 s\n"));
  EXPECT_THAT(outcome.err,
              HasSubstr("\nthe replay ended at tick 7: from there on commands are those of the recording\n"));
}

TEST_F(Step, WhatIsNoRecordingIsRefused) {
  record_sr1();
  const Outcome late = step("n\n", "--from 7");
  EXPECT_EQ(late.status, 2);
  EXPECT_THAT(late.err, HasSubstr("sr1.mcap: error: nothing was recorded in the span that is asked for"));
  write("sr1.mcap", "not one");
  EXPECT_EQ(step("n\n").status, 2);
}

/// `rehearse step` at a terminal of its own.
class Terminal {
 public:
  Terminal(const fs::path& folder, const fs::path& trace, const std::string& controller = "") {
    winsize size{24, 120, 0, 0};
    child_ = forkpty(&terminal_, nullptr, nullptr, &size);
    if (child_ != 0) return;
    setenv("TERM", "vt100", 1);
    const char* const last = controller.empty() ? nullptr : controller.c_str();
    if (chdir(folder.c_str()) == 0)
      execl(command.c_str(), command.c_str(), "step", trace.c_str(), last ? "--controller" : nullptr, last, nullptr);
    _exit(127);
  }
  ~Terminal() {
    if (child_ > 0) kill(child_, SIGKILL), waitpid(child_, nullptr, 0);
    if (terminal_ >= 0) close(terminal_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Sends keys after the line editor has entered single-key mode: it shows its prompt before it sets the mode.
  void type(const std::string& keys) {
    termios modes{};
    for (int i = 0; i < 20'000 && (tcgetattr(terminal_, &modes) != 0 || (modes.c_lflag & ICANON)); ++i) usleep(1000);
    EXPECT_EQ(write(terminal_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  /// Waits until that is on the screen, and forgets what was there up to it. A failure if it doesn't come.
  void expect(const std::string& text) {
    constexpr int patience = 20'000;  // [ms]; a busy machine
    std::size_t at = 0;
    while ((at = screen_.find(text)) == std::string::npos) {
      pollfd input{terminal_, POLLIN, 0};
      char bytes[4096];
      const ssize_t got = poll(&input, 1, patience) > 0 ? read(terminal_, bytes, sizeof bytes) : -1;
      if (got <= 0) {
        ADD_FAILURE() << "'" << text << "' didn't come; there is: " << screen_;
        return;
      }
      screen_.append(bytes, static_cast<std::size_t>(got));
    }
    screen_.erase(0, at + text.size());
  }
  /// Its exit status.
  int end() {
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  int terminal_ = -1;
  pid_t child_ = -1;
  std::string screen_;
};

TEST_F(Step, OpensAtTheFirstDifference) {
  EXPECT_EQ(rehearse({"record", pendulum(MISBEHAVING, "chance 7").string(), "-o", "sr1.mcap"}).status, 0);
  EXPECT_THAT(last(""), StartsWith("tick 7, 0.007 s  differs: Pendulum/Swing/output/hinge/u: replayed "));
  EXPECT_THAT(last("", "--from 0.005"), StartsWith("tick 5, 0.005 s")) << "where it is asked to begin";
}

TEST_F(Step, AtATerminalOpensWithThePlotOfTheFirstDifference) {
  record_sr1();
  Terminal terminal(folder(), "sr1.mcap", "SR1Minimum=" CHANGED_GAIN);
  terminal.expect("sr1.mcap: 100 ticks; this is the first difference\r\ntick 0, 0 s  differs: SR1/SR1Minimum/output/");
  terminal.expect("; ░ recorded, █ replayed, ▒ both");
  terminal.expect("▲");
  terminal.expect("keys: n next tick");
  terminal.expect("(step) ");
  terminal.type("\x04");
  EXPECT_EQ(terminal.end(), 0);
}

TEST_F(Step, AtATerminalHasAPromptHistoryAndCompletion) {
  record_sr1();
  Terminal terminal(folder(), "sr1.mcap");
  terminal.expect("sr1.mcap: 100 ticks\r\ntick 0, 0 s\r\nkeys: n next tick, b back, ");
  terminal.expect("h lists all commands, q quits\r\n(step) ");
  terminal.type("ne\t");  // the only command that begins so
  terminal.expect("xt ");
  terminal.type("\r");
  terminal.expect("tick 1, 0.001 s");
  terminal.expect("(step) ");
  terminal.type("\r");  // again
  terminal.expect("tick 2, 0.002 s");
  terminal.expect("(step) ");
  terminal.type("goto 50\r");
  terminal.expect("tick 50, 0.05 s");
  terminal.expect("(step) ");
  terminal.type("print SR1/RLEG_KNEE/d\t\r");
  terminal.expect("SR1/RLEG_KNEE/dq = ");
  terminal.expect("(step) ");
  terminal.type("print RLEG_KNEE/d\t\r");  // the end of a name
  terminal.expect("RLEG_KNEE/dq = ");
  terminal.expect("(step) ");
  terminal.type("\x1b[A\x1b[A\x1b[A\x1b[A\r");  // up, to: next
  terminal.expect("tick 51, 0.051 s");
  terminal.expect("(step) ");
  terminal.type("half a li\x03");  // Ctrl-C
  terminal.expect("(step) ");
  terminal.type("back\r");
  terminal.expect("tick 50, 0.05 s");
  terminal.expect("(step) ");
  terminal.type("foo\r");  // a mistake changes no exit status at a terminal
  terminal.expect("there is no command 'foo'");
  terminal.expect("(step) ");
  terminal.type("\x04");  // Ctrl-D
  EXPECT_EQ(terminal.end(), 0);
}

}  // namespace
}  // namespace rehearse::test
