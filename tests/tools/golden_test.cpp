// rehearse golden, as a person and as a script uses it: list, review, accept, reject, prune.
#include <gmock/gmock.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <chrono>
#include <sstream>
#include <thread>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string golden_file = "golden/Box.Falls.mcap";
const std::string digest_file = "golden/Box.Falls.txt";
const std::string pending_file = "rehearse-pending/Box.Falls.mcap";

/// A repository with a box that falls, its golden, and whatever a test lets wait.
class GoldenVerbs : public Command {
 protected:
  GoldenVerbs() {
    fs::create_directories(folder() / "fixtures/scenarios");
    fs::create_directories(folder() / "golden");
    scene(0.5);
    EXPECT_EQ(rehearse({"check", scenario_}).status, 1);
    done({"golden", "accept", "Box.Falls"});
  }

  /// A box that falls from that height [m], for 20 ms.
  void scene(double height, const std::string& name = "box", const std::string& golden = "Box.Falls") const {
    write("fixtures/scenarios/" + name + ".yaml",
          "rehearse: 1\nname: " + name + "\ngolden: " + golden + "\nduration: 0.02\nbodies:\n  - name: Box\n" +
              "    box: {size: [0.2, 0.2, 0.2]}\n    mass: 1\n    position: [0, 0, " + std::to_string(height) + "]\n");
  }
  /// A run that differs waits.
  void change() const {
    scene(0.6);
    EXPECT_EQ(rehearse({"check", scenario_}).status, 1);
    EXPECT_TRUE(exists(pending_file));
  }

  /// The verb on a terminal of its own, with these keys pressed, an entry for each question that it asks.
  /// `columns`: of the terminal; 0: it has no size.
  Outcome on_terminal(const std::vector<std::string>& arguments, const std::vector<std::string>& keys,
                      unsigned short columns = 0) const;

  const std::string scenario_ = "fixtures/scenarios/box.yaml";
};

Outcome GoldenVerbs::on_terminal(const std::vector<std::string>& arguments, const std::vector<std::string>& keys,
                                 unsigned short columns) const {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  EXPECT_TRUE(terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
  const winsize size{24, columns, 0, 0};
  if (columns > 0) ioctl(terminal, TIOCSWINSZ, &size);
  const std::string name = ptsname(terminal);
  const pid_t child = fork();
  if (child == 0) {
    setsid();
    const int side = open(name.c_str(), O_RDWR);  // becomes the controlling terminal
    for (const int stream : {0, 1, 2}) dup2(side, stream);
    if (chdir(folder().c_str()) != 0) _exit(126);
    std::vector<char*> words{const_cast<char*>(command.c_str())};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execv(command.c_str(), words.data());
    _exit(127);
  }
  Outcome outcome;
  std::size_t answered = 0;
  for (;;) {
    pollfd ready{terminal, POLLIN, 0};
    if (poll(&ready, 1, 20000) <= 0) break;
    char part[4096];
    const ssize_t got = read(terminal, part, sizeof part);
    if (got <= 0) break;  // the other side was closed
    outcome.out.append(part, static_cast<std::size_t>(got));
    const bool asks = outcome.out.ends_with("[q]uit ") || outcome.out.ends_with("[n]o ");
    if (!asks || answered == keys.size()) continue;
    const std::string& key = keys[answered++];
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // keys typed before the question are discarded
    EXPECT_EQ(::write(terminal, key.data(), key.size()), std::ssize(key));
  }
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::erase(outcome.out, '\r');
  return outcome;
}

TEST_F(GoldenVerbs, TheDigestTellsWhatMovedAndWhen) {
  change();
  const std::string before = read_file(folder() / digest_file);
  EXPECT_THAT(before, ContainsRegex("\n\naccepted 20[0-9-]+, first\n\n"));
  EXPECT_EQ(rehearse({"golden", "accept", "Box.Falls"}, "SOURCE_DATE_EPOCH=1763640000").status, 0);
  EXPECT_THAT(read_file(folder() / digest_file),
              ContainsRegex("\naccepted 2025-11-20, replaced: [^\n]* is beyond [^\n]* from tick 0 [^\n]*\n"
                            "  /Box/Box/pose position/z: 0.1 m at tick 0, 21 of [0-9]+ values\n"));
  EXPECT_EQ(rehearse({"golden", "accept", "Box.Falls"}, "SOURCE_DATE_EPOCH=now").status, 2);
}

TEST_F(GoldenVerbs, ReviewAndDigestStateTheVerdictOfTheCheckAndNoOther) {
  change();
  const std::string said = rehearse({"check", scenario_, "--json"}).json()["verdict"];
  EXPECT_EQ(rehearse({"golden", "review", "--json"}).json()["waiting"][0]["verdict"], said);
  EXPECT_THAT(rehearse({"golden", "review"}).out, HasSubstr("\n" + said + "\n"));
  done({"golden", "accept", "Box.Falls"});
  EXPECT_THAT(read_file(folder() / digest_file), HasSubstr(", replaced: " + said + "\n"));
}

TEST_F(GoldenVerbs, ADigestInAnOlderFormIsWrittenAnewByAnAcceptanceThatLeavesTheRecording) {
  const std::string golden = read_file(folder() / golden_file), digest = read_file(folder() / digest_file);
  std::ofstream(folder() / digest_file) << "digest 1 of a recording; derived from it, not to be edited\n";
  EXPECT_THAT(rehearse({"check", scenario_}).err, HasSubstr("is in an older form"));
  EXPECT_EQ(rehearse({"check", scenario_}, "REHEARSE_GOLDEN=accept").status, 0);
  EXPECT_EQ(read_file(folder() / digest_file), digest);
  EXPECT_EQ(read_file(folder() / golden_file), golden);
}

TEST_F(GoldenVerbs, ReviewWithoutATerminalShowsAllAndTheCommands) {
  EXPECT_EQ(done({"golden", "review"}).out, "nothing waits\n");
  change();
  const Outcome outcome = rehearse({"golden", "review"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("1/1  Box.Falls\n"));
  EXPECT_THAT(outcome.out, HasSubstr("from tick 0 (0 s) on"));
  EXPECT_THAT(outcome.out, HasSubstr("\n  Box/Box/position/z [m]: "));
  EXPECT_THAT(outcome.out, HasSubstr("accept it: rehearse golden accept Box.Falls\n"));
  EXPECT_THAT(outcome.out, HasSubstr("reject it: rehearse golden reject Box.Falls\n"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("[a]ccept")));
  EXPECT_TRUE(exists(pending_file));
  const nlohmann::json report = rehearse({"golden", "review", "--json"}).json();
  EXPECT_EQ(report["waiting"][0]["name"], "Box.Falls");
  EXPECT_THAT(report["waiting"][0]["verdict"].get<std::string>(), HasSubstr("from tick 0 (0 s) on"));
  EXPECT_EQ(rehearse({"golden", "review", "Box.Flies"}).status, 2);
}

TEST_F(GoldenVerbs, ReviewOnATerminalAcceptsWithOneKey) {
  change();
  const Outcome outcome = on_terminal({"golden", "review"}, {"a"});
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("[a]ccept [r]eject [s]kip [d]etails [q]uit a\naccepted: look at " + digest_file));
  EXPECT_FALSE(exists(pending_file));
  EXPECT_EQ(rehearse({"check", scenario_}).status, 0);
}

TEST_F(GoldenVerbs, ReviewOnATerminalBreaksTheVerdictBetweenWords) {
  change();
  const std::string said = rehearse({"check", scenario_, "--json"}).json()["verdict"];
  ASSERT_GT(said.size(), 40U);
  const std::string out = on_terminal({"golden", "review"}, {"q"}, 40).out;
  std::istringstream lines(out.substr(out.find(said.substr(0, said.find(' ')))));
  std::string together;
  for (std::string line; together.size() < said.size() && std::getline(lines, line);) {
    EXPECT_LE(line.size(), 40U) << line;
    together += (together.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(together, said) << out;
}

TEST_F(GoldenVerbs, ReviewOnATerminalRejectsSkipsShowsAndQuits) {
  change();
  const std::string golden = read_file(folder() / golden_file);
  const Outcome skipped = on_terminal({"golden", "review"}, {"d", "s"});
  EXPECT_EQ(skipped.status, 1);
  EXPECT_THAT(skipped.out, HasSubstr("changes\n  /Box/Box/pose position/z: 0.1 m at tick 0"));
  EXPECT_THAT(skipped.out, HasSubstr("1 run waits on"));
  EXPECT_EQ(on_terminal({"golden", "review"}, {"q"}).status, 1);
  EXPECT_EQ(on_terminal({"golden", "review"}, {"\x03"}).status, 1);  // Ctrl-C
  EXPECT_TRUE(exists(pending_file));
  EXPECT_EQ(on_terminal({"golden", "review"}, {"x\x1b[Ar"}).status, 0);  // other keys are ignored
  EXPECT_FALSE(exists(pending_file));
  EXPECT_TRUE(read_file(folder() / golden_file) == golden);
}

TEST_F(GoldenVerbs, ReviewOfARunThatIsDamagedSaysSoAndItCanBeRejected) {
  change();
  fs::resize_file(folder() / pending_file, 500);
  const Outcome outcome = rehearse({"golden", "review"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("can't be compared: truncated at byte 500"));
  EXPECT_EQ(rehearse({"golden", "accept", "Box.Falls"}).status, 2);
  EXPECT_THAT(done({"golden", "reject", "Box.Falls"}).out, HasSubstr("the golden stays as it is"));
}

TEST_F(GoldenVerbs, ReviewOfARunWithoutAGoldenSaysThatItIsTheFirst) {
  change();
  fs::remove(folder() / golden_file);
  EXPECT_THAT(rehearse({"golden", "review"}).out, HasSubstr("this run would be the first\n  21 ticks, 0.02 s, "));
}

TEST_F(GoldenVerbs, AcceptAndRejectTakeSeveralOrAll) {
  scene(0.7, "other", "Box.Drops");
  change();
  EXPECT_EQ(rehearse({"check"}).status, 1);
  const nlohmann::json rejected = done({"golden", "reject", "Box.Drops", "--json"}).json();
  EXPECT_EQ(rejected["rejected"], nlohmann::json({"Box.Drops"}));
  EXPECT_EQ(rehearse({"check"}).status, 1);
  const nlohmann::json accepted = done({"golden", "accept", "--all", "--json"}).json();
  ASSERT_EQ(accepted["accepted"].size(), 2u);
  EXPECT_EQ(accepted["accepted"][0]["name"], "Box.Drops");
  EXPECT_EQ(accepted["accepted"][0]["verdict"], nullptr);
  EXPECT_EQ(accepted["accepted"][1]["changed"], true);
  EXPECT_EQ(done({"golden", "accept", "--all"}).out, "nothing waits\n");
  EXPECT_EQ(done({"check"}).status, 0);
}

TEST_F(GoldenVerbs, AcceptTellsOfEachThatIsRefused) {
  change();
  const Outcome outcome = rehearse({"golden", "accept", "Box.Flies", "Box.Falls"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nothing waits to be accepted as 'Box.Flies'"));
  EXPECT_THAT(outcome.out, HasSubstr("accepted " + golden_file));
}

TEST_F(GoldenVerbs, AcceptOfTheSameRunChangesNothing) {
  const std::string golden = read_file(folder() / golden_file), digest = read_file(folder() / digest_file);
  done({"record", scenario_, "-o", pending_file});
  EXPECT_THAT(done({"golden", "accept", "Box.Falls"}).out, HasSubstr("is this run already: nothing was changed\n"));
  EXPECT_TRUE(read_file(folder() / golden_file) == golden);
  EXPECT_TRUE(read_file(folder() / digest_file) == digest);
}

TEST_F(GoldenVerbs, AcceptOfAPartSaysWhyNoRunIsLikeThat) {
  change();
  const std::string golden = read_file(folder() / golden_file);
  const Outcome outcome = rehearse({"golden", "accept", "Box.Falls", "--from", "0.01"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, StartsWith("error: no run can produce this golden: it would begin in another state"));
  EXPECT_THAT(outcome.err, HasSubstr("/Box/Box/pose"));
  const nlohmann::json report = rehearse({"golden", "accept", "Box.Falls", "--channel", "/tf", "--json"}).json();
  EXPECT_EQ(report["accepted"].size(), 0u);
  EXPECT_EQ(report["refused"][0]["name"], "Box.Falls");
  EXPECT_TRUE(read_file(folder() / golden_file) == golden);
  EXPECT_TRUE(exists(pending_file));
}

TEST_F(GoldenVerbs, DecisionsAreRefusedUnderCi) {
  change();
  for (const char* verb : {"accept", "reject"}) {
    const Outcome outcome = rehearse({"golden", verb, "--all"}, "CI=true");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, StartsWith("error: goldens are only checked where CI is 'true'"));
  }
  EXPECT_EQ(rehearse({"golden", "prune", "--yes", "--no-tests"}, "CI=true").status, 2);
  EXPECT_EQ(rehearse({"golden", "review"}, "CI=true").status, 1);
  EXPECT_TRUE(exists(pending_file));
}

TEST_F(GoldenVerbs, PruneRemovesOrphansWhenItIsAllowedTo) {
  EXPECT_EQ(done({"golden", "prune", "--no-tests"}).out, "nothing to remove\n");
  fs::remove(folder() / scenario_);
  fs::copy_file(folder() / digest_file, folder() / "golden/Box.Lost.txt");
  const Outcome asked = rehearse({"golden", "prune", "--no-tests"});
  EXPECT_EQ(asked.status, 1);
  EXPECT_THAT(asked.out, HasSubstr(golden_file + " and its digest, "));
  EXPECT_THAT(asked.out, HasSubstr("Box.Lost: left alone, because only one of its two files is there\n"));
  EXPECT_THAT(asked.out, HasSubstr("--yes removes them\n"));
  EXPECT_TRUE(exists(golden_file));
  EXPECT_EQ(on_terminal({"golden", "prune", "--no-tests"}, {"n"}).status, 1);
  EXPECT_TRUE(exists(golden_file));
  EXPECT_THAT(done({"golden", "prune", "--yes", "--no-tests"}).out, HasSubstr("moved 1 golden to pruned-goldens\n"));
  EXPECT_TRUE(exists("pruned-goldens/Box.Falls.mcap"));
  EXPECT_FALSE(exists(golden_file));
  EXPECT_FALSE(exists(digest_file));
  EXPECT_TRUE(exists("golden/Box.Lost.txt"));
  EXPECT_EQ(done({"golden", "prune", "--yes", "--no-tests", "--json"}).json()["removed"].size(), 0u);
}

TEST_F(GoldenVerbs, PruneOnATerminalAsks) {
  fs::remove(folder() / scenario_);
  EXPECT_THAT(on_terminal({"golden", "prune", "--no-tests"}, {"y"}).out,
              HasSubstr("remove them? [y]es [n]o yes\nmoved 1 golden to pruned-goldens\n"));
  EXPECT_FALSE(exists(golden_file));
}

TEST_F(GoldenVerbs, TwoScenariosThatNameOneGoldenAreToldByListAndCheck) {
  scene(0.5, "copy");
  EXPECT_EQ(done({"golden", "list", "--json"}).json()["goldens"][0]["problem"],
            "2 scenarios name it: fixtures/scenarios/box.yaml, fixtures/scenarios/copy.yaml");
  const Outcome outcome = rehearse({"check", scenario_});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, StartsWith(scenario_ + ": error: the golden 'Box.Falls' isn't this scenario's alone: 2 "));
}

TEST_F(GoldenVerbs, ScenariosOfPackagesOfNpmOwnNoGolden) {
  write("tools/node_modules/robots/box.yaml", read_file(folder() / scenario_));
  done({"check", scenario_});
}

TEST_F(GoldenVerbs, ChecksThatAreProvedStillFailOfAnEditedDigest) {
  const std::string digest = read_file(folder() / digest_file);
  const std::vector<std::string> proved{"check", scenario_, "--json"};
  done(proved);
  EXPECT_EQ(done(proved).json()["levels"]["closed"], "proved");
  write(digest_file, digest + "  one more line\n");
  for (int time = 0; time < 2; ++time) {  // a failure certifies nothing
    const Outcome outcome = rehearse(proved);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, StartsWith(digest_file + ": error: the digest doesn't describe " + golden_file));
  }
  write(digest_file, digest);
  done(proved);
}

TEST_F(GoldenVerbs, ListSaysHowOldAGoldenIs) {
  const Outcome outcome = done({"golden", "list"});
  EXPECT_THAT(outcome.out,
              ContainsRegex("\n  Box.Falls +[0-9.]+ kB +20[0-9-]+ +in use +fixtures/scenarios/box.yaml\n"));
  EXPECT_THAT(outcome.out, HasSubstr("all: recorded with rehearse " REHEARSE_VERSION ", ODE "));
  EXPECT_THAT(outcome.out, Not(HasSubstr("this is")));
  std::string bytes = read_file(folder() / golden_file);
  const nlohmann::json entry = done({"golden", "list", "--json"}).json()["goldens"][0];
  EXPECT_EQ(entry["acceptances"], 1);
  EXPECT_TRUE(entry["notes"].empty());
}

TEST_F(GoldenVerbs, ReviewOfManyIsShortAndNamesTheCommandThatShowsAll) {
  for (int i = 0; i < 6; ++i) {
    const std::string number = std::to_string(i);
    scene(0.5, "box" + number, "Box.N" + number);
    EXPECT_EQ(rehearse({"check", "fixtures/scenarios/box" + number + ".yaml"}, "REHEARSE_GOLDEN=new").status, 0);
    scene(0.6, "box" + number, "Box.N" + number);
  }
  EXPECT_EQ(rehearse({"check"}).status, 1);
  const Outcome many = rehearse({"golden", "review"});
  EXPECT_EQ(many.status, 1);
  EXPECT_LT(many.out.size(), 6 * 300 + 300);
  EXPECT_THAT(many.out, ContainsRegex("3/6  Box.N2\n.*\nall of it: rehearse golden review Box.N2\n"));
  EXPECT_THAT(many.out, HasSubstr("accept it: rehearse golden accept NAME\n"));
  const Outcome one = rehearse({"golden", "review", "Box.N2"});
  EXPECT_THAT(one.out, HasSubstr("golden golden/Box.N2.mcap, run "));
  EXPECT_GT(one.out.size(), 600U);
}

}  // namespace
}  // namespace rehearse::test
