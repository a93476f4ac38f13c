// gdb, with the commands that a user types: stopped in control() at a tick, forwards, back, tables, printers.
#include <gmock/gmock.h>
#include <rehearse/controller_bench.h>
#include <rehearse/trace.h>

#include <bit>
#include <cstdint>

#include "gdb_command.h"

namespace rehearse::test {
namespace {

#ifdef LINE_NUMBERS_ALONE
constexpr bool gdb_knows_types = false;
#else
constexpr bool gdb_knows_types = true;
#endif

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const fs::path source = LOOKED_AT_SOURCE;

/// "looked_at.cpp:41": the line with that comment.
std::string line_of(const std::string& comment) {
  std::ifstream stream(source);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.ends_with("// " + comment)) return "looked_at.cpp:" + std::to_string(number);
  }
  ADD_FAILURE() << "no line ends with // " << comment;
  return "";
}

/// The message on arrival, as a regular expression.
std::string arrival(int tick, const std::string& place, const std::string& of = "Pendulum/Swing") {
  return "tick " + std::to_string(tick) + " [^\n]*, in control\\(\\) of " + of + "\n#0 [^\n]*" + place + "[^\n]*\n";
}

class Gdb : public GdbCommand {
 protected:
  Outcome quiet(const std::vector<std::string>& words) const { return rehearse(words, environment); }

  /// `script`: a command of gdb's a line; one that fails doesn't keep the next from being executed.
  Outcome in_gdb(std::vector<std::string> words, const std::string& script) const {
    words.insert(words.end(), {"--", "-nx", "-batch"});
    std::istringstream lines(script);
    for (std::string line; std::getline(lines, line);) words.insert(words.end(), {"-ex", line});
    return quiet(words);
  }

  /// 50 ticks of the pendulum under looked_at.
  void record(const std::string& options = "none") const {
    const Outcome outcome = quiet({"record", pendulum(LOOKED_AT, options).string(), "-o", "pendulum.mcap"});
    ASSERT_THAT(outcome.status, ::testing::AnyOf(0, 3)) << outcome.err;
  }
  /// gdb's output for the bits of an input of that tick.
  std::string recorded_bits(const std::string& quantity, std::size_t tick) const {
    const auto trace = Trace::load(folder() / "pendulum.mcap");
    EXPECT_TRUE(trace.ok());
    if (!trace.ok()) return "";
    const double number = trace->values("Pendulum/Swing/input/hinge/" + quantity).at(tick);
    return " = " + std::to_string(std::bit_cast<std::int64_t>(number)) + "\n";
  }
};

/// A planner that waits has its line and its reason; where it runs, it has the turn, and the call waits.
TEST_F(Gdb, ListsThreadsThatTakeTurns) {
  ASSERT_EQ(quiet({"record", pendulum(PLANNER, "none").string(), "-o", "pendulum.mcap"}).status, 0);
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "20"}, R"(rehearse-threads
break planner.cpp:57
continue
rehearse-threads
)");
  EXPECT_THAT(outcome.out, AllOf(ContainsRegex("\n\\* +[0-9]+ the call itself at planner.cpp:[0-9]+ has the turn\n"
                                               " +[0-9]+ 'planner' at planner.cpp:53 waits for a condition\n"),
                                 ContainsRegex("\n\\* +[0-9]+ 'planner' at planner.cpp:57 has the turn\n")))
      << outcome.err;
}

TEST_F(Gdb, StopsInControlAtTheTickAndGoesOnAndBack) {
  record();
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "20"}, R"(next
print *(long*)&angle
echo [on]\n
rehearse-next-tick
rehearse-next-tick 4
next
next
print *(long*)&rate
print calls_
echo [back]\n
break )" + line_of("has commanded") + R"(
rehearse-back
next
print *(long*)&angle
rehearse-tick 4
print calls_
next
print *(long*)&angle
rehearse-back 0
print calls_
rehearse-tick
echo [breakpoints]\n
continue
rehearse-next-tick 2
info breakpoints)");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const std::string begins = line_of("begins");
  EXPECT_THAT(outcome.out, StartsWith("tick 20 (0.02 s), in control() of Pendulum/Swing\n#0 "));
  EXPECT_THAT(outcome.out, ContainsRegex(arrival(20, "LookedAt::control \\(this=0x[0-9a-f]+\\) at .*" + begins) +
                                         "[0-9]+\t    const double angle = joint_->q\\(\\);"));
  const std::size_t on = outcome.out.find("[on]"), back = outcome.out.find("[back]"),
                    breakpoints = outcome.out.find("[breakpoints]");
  ASSERT_NE(breakpoints, std::string::npos) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out.substr(0, on), HasSubstr("$1" + recorded_bits("q", 20)));
  EXPECT_THAT(outcome.out.substr(on, back - on),
              AllOf(ContainsRegex(arrival(21, begins)), ContainsRegex(arrival(25, begins)),
                    HasSubstr("$2" + recorded_bits("dq", 25)), HasSubstr("$3 = 25\n")));
  const std::string backwards = outcome.out.substr(back, breakpoints - back);
  EXPECT_THAT(backwards,
              AllOf(ContainsRegex(arrival(24, begins)), HasSubstr("$4" + recorded_bits("q", 24)),
                    ContainsRegex(arrival(4, begins)), HasSubstr("$5 = 4\n"), HasSubstr("$6" + recorded_bits("q", 4)),
                    HasSubstr("$7 = 4\ntick 4 (0.004 s), in control() of Pendulum/Swing\n")));
  EXPECT_THAT(backwards, Not(HasSubstr("Breakpoint 1, "))) << "it stops nothing on the way back";
  EXPECT_THAT(outcome.out.substr(breakpoints),
              AllOf(ContainsRegex("Breakpoint 1, .*" + line_of("has commanded")),
                    HasSubstr("stopped on the way to tick 6: tick 5 (0.005 s), in control() of Pendulum/Swing"),
                    HasSubstr("breakpoint already hit 2 times")));
}

TEST_F(Gdb, SaysWhatTheControllerReadsAndCommands) {
  if (!gdb_knows_types) GTEST_SKIP() << "built with line numbers alone, as builds with sanitizers are";
  record();
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "30"},
                                 R"(rehearse-inputs
rehearse-commands
echo [later]\n
tbreak )" + line_of("has commanded") +
                                     R"(
continue
set var joint_.object_->q_ = 0.25
rehearse-inputs
rehearse-commands)");
  const std::size_t later = outcome.out.find("[later]");
  ASSERT_NE(later, std::string::npos) << outcome.out << outcome.err;
  const auto trace = Trace::load(folder() / "pendulum.mcap");
  ASSERT_TRUE(trace.ok());
  const auto number = [&](const std::string& series, std::size_t tick) {
    return nlohmann::json(trace->values("Pendulum/Swing/" + series).at(tick)).dump();  // with the shortest digits
  };
  const std::string before = outcome.out.substr(0, later), after = outcome.out.substr(later);
  EXPECT_THAT(before, HasSubstr("inputs of Pendulum/Swing, tick 30 (0.03 s)\n"));
  EXPECT_THAT(before, ContainsRegex("  joint +q +dq\n  hinge +" + number("input/hinge/q", 30) + " +" +
                                    number("input/hinge/dq", 30) + "\n"));
  EXPECT_THAT(before, ContainsRegex("  gyro +RateGyroSensor +w \\[0, -?[0-9.e-]+, 0\\]\n"));
  EXPECT_THAT(before,
              ContainsRegex("commands of Pendulum/Swing, tick 30 \\(0.03 s\\), so far\n +now +tick 29\n  hinge +u +" +
                            number("output/hinge/u", 29) + " +" + number("output/hinge/u", 29) + "\n"))
      << "it has commanded nothing yet";
  EXPECT_THAT(after, ContainsRegex("hinge +0.25\\* +" + number("input/hinge/dq", 30) + "\n"));
  EXPECT_THAT(after,
              ContainsRegex("hinge +u +" + number("output/hinge/u", 30) + "\\* +" + number("output/hinge/u", 29)));
}

TEST_F(Gdb, PrintsBodiesAndVectors) {
  if (!gdb_knows_types) GTEST_SKIP() << "built with line numbers alone, as builds with sanitizers are";
  record();
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "2"}, R"(print *body_
print joint_
print *joint_
print no_link_
print *gyro_
print body_->devices_[0]
print ahead_
print turn_
print by_rows_
print pose_
print half_
print gains_
print empty_
print about_
print $7
print $2
print tree_
print *tree_
print /r ahead_
print *(cnoid::Body*)0
set var gains_.m_storage.m_rows = -5
print gains_
set var *(long*)&body_.object_->linkTraverse_.links_ = 8
print *body_
print *(Eigen::VectorXd*)$sp
print *this)");
  const auto printed = [&](const std::string& text) { EXPECT_THAT(outcome.out, HasSubstr(text)); };
  printed(
      "Body \"Pendulum\" (model pendulum): 2 links, 1 joint, 2 devices = {root = p [0, 0, 0] R [[1, 0, 0], [0, 1, "
      "0], ");
  EXPECT_THAT(outcome.out, ContainsRegex("\\$1 = Body .*, hinge = q 0\\.34[0-9]+, dq -?[0-9.e-]+, u -?[0-9.e-]+.\n"));
  EXPECT_THAT(outcome.out,
              ContainsRegex("\\$2 = \\(cnoid::Link\\*\\) 0x[0-9a-f]+ Link \"rod\" \\(joint 0 hinge, revolute\\)\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("\\$3 = Link \"rod\" .* = .q = 0\\.34.*, dq = .*, u = .*, T = p \\["));
  printed("$4 = null\n");
  printed("$5 = RateGyroSensor \"gyro\" on link \"rod\" = {w = [0, ");
  EXPECT_THAT(outcome.out,
              ContainsRegex("\\$6 = \\(cnoid::Device\\*\\) 0x[0-9a-f]+ RateGyroSensor \"gyro\" on link \"rod\"\n"));
  printed("$7 = [1, 2.5, -3]\n");
  printed("$8 = [[1, 0, 0], [0, 2, 0], [0, 0, 3]]\n");
  printed("$9 = [[1, 2, 3], [4, 5, 6]]\n");
  printed("$10 = p [0.5, 0, 1] R [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n");
  printed("$11 = (w 0, x 1, y 0, z 0)\n");
  printed("$12 = [0, 0.5, 1, 1.5]\n");
  printed("$13 = []\n");
  printed("$14 = (0.25 about [0, 0, 1])\n");
  printed("$15 = [1, 2.5, -3]\n");
  printed("{feet: [left], gain: 2.5}\n");
  printed("m_storage");
  EXPECT_THAT(outcome.err, HasSubstr("Cannot access memory at address 0x"));
  printed("<Eigen::Matrix<double, -1, 1, 0, -1, 1>: a matrix of impossible size>\n");
  printed("<cnoid::Body: a list of impossible length>");
  printed("calls_ = 2");
  EXPECT_THAT(outcome.err, Not(HasSubstr("Python")));
}

TEST_F(Gdb, StopsInARecordingWhichIsTheSameThen) {
  record();
  const std::string plain = read_file(folder() / "pendulum.mcap");
  const Outcome outcome = in_gdb({"record", "pendulum.yaml", "-o", "other.mcap", "--gdb=Swing", "--tick=7"},
                                 R"(print calls_
rehearse-next-tick
rehearse-back 2
print calls_
continue)");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(ContainsRegex(arrival(7, line_of("begins"))), HasSubstr("$1 = 7\n"), HasSubstr("tick 8 "),
                    HasSubstr("tick 6 "), HasSubstr("$2 = 6\n"), HasSubstr("exited normally")));
  EXPECT_TRUE(read_file(folder() / "other.mcap") == plain) << "not the same bytes as without gdb";
}

TEST_F(Gdb, StopsInTheClosedLoopOfACheck) {
  record();
  const Outcome outcome = in_gdb({"check", "pendulum.yaml", "--golden", "pendulum.mcap", "--gdb", "--tick", "11"},
                                 R"(print calls_
continue)");
  EXPECT_THAT(outcome.out, AllOf(StartsWith("stopping in the closed loop; the other levels are not compared\n"),
                                 ContainsRegex(arrival(11, line_of("begins"))), HasSubstr("$1 = 11\n"),
                                 HasSubstr("pendulum: equal bit for bit: 50 ticks"), HasSubstr("exited normally")));
}

TEST_F(Gdb, StopsWhereAControllerCrashes) {
  record("crash 12");
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb"},
                                 R"(print calls_
rehearse-tick
print nothing_
continue)");
  EXPECT_THAT(outcome.out, HasSubstr("in control() at tick 12 (0.012 s): stopping there\n"));
  EXPECT_THAT(outcome.out,
              AllOf(ContainsRegex(arrival(12, line_of("begins"))), HasSubstr("$1 = 12\n"),
                    ContainsRegex("received signal SIGSEGV.*" + line_of("crashes")),
                    HasSubstr("tick 12 (0.012 s), in control() of Pendulum/Swing"), HasSubstr("(cnoid::Link *) 0x0"),
                    ContainsRegex("failed: looked_at.cpp:[0-9]+: controller 'Pendulum/Swing' crashed")));
}

TEST_F(Gdb, IsNoHang) {
  record();
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--call-limit", "0.05", "--gdb", "--tick", "5"},
                                 R"(next
shell sleep 0.3
next
continue)");
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("\nequal bit for bit: 50 ticks"), HasSubstr("exited normally")));
  EXPECT_THAT(outcome.out, Not(HasSubstr("SIGXCPU")));
}

TEST_F(Gdb, StopsWhereAnotherLibraryDiffersFirst) {
  record();
  const Outcome outcome =
      in_gdb({"replay", "pendulum.mcap", "--controller", std::string("Swing=") + STIFFER, "--gdb"}, R"(print calls_)");
  EXPECT_THAT(outcome.out,
              AllOf(StartsWith(std::string(STIFFER) + " is not the library that Pendulum/Swing was recorded with\n"),
                    HasSubstr("differs first from the recording at tick 9 (0.009 s), in hinge/u of "),
                    ContainsRegex(arrival(9, line_of("begins"))), HasSubstr("$1 = 9\n")));
}

TEST_F(Gdb, ShowsTheLineOfTheFirstDifferingCommandInAReport) {
  if (!gdb_knows_types) GTEST_SKIP() << "built with line numbers alone, as builds with sanitizers are";
  done({"record", pendulum(LOOKED_AT).string(), "-o", "golden.mcap"});
  done({"record", pendulum(LOOKED_AT).string(), "-o", "stiffer.mcap", "--controller", std::string("Swing=") + STIFFER});
  const fs::path page = write("page.html", "<!doctype html><html><!-- REHEARSE DATA --></html>");
  const Outcome outcome = rehearse(
      {"report", "stiffer.mcap", "golden.mcap", "--call-stack", "--controller", std::string("Swing=") + STIFFER},
      std::string(environment) + " REHEARSE_REPORT_PAGE=" + page.string());
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const std::string report = read_file(folder() / "stiffer.html");
  EXPECT_THAT(report, HasSubstr("\"call_stack\":{\"controller\":\"Pendulum/Swing\",\"command\":\"hinge/u\",\"tick\":9,"
                                "\"frames\":[{"));
  const std::string line = line_of("commands");
  EXPECT_THAT(report, ContainsRegex("looked_at.cpp\",\"line\":" + line.substr(line.find(':') + 1) +
                                    ",\"begin\":[0-9]+,\"source\":\\[\".*// commands\""));
}

TEST_F(Gdb, ShowsTheLineInTheReportOfAFailedCheck) {
  if (!gdb_knows_types) GTEST_SKIP() << "built with line numbers alone, as builds with sanitizers are";
  const std::string scenario = pendulum(LOOKED_AT).string();
  done({"record", scenario, "-o", "golden.mcap"});
  const fs::path page = write("page.html", "<!doctype html><html><!-- REHEARSE DATA --></html>");
  const std::vector<std::string> words{"check",       scenario,       "--golden",
                                       "golden.mcap", "--controller", std::string("Swing=") + STIFFER};
  const std::string with_page = std::string(environment) + " REHEARSE_REPORT_PAGE=" + page.string();
  const fs::path report = folder() / "rehearse-pending/pendulum.html";
  EXPECT_EQ(rehearse(words, with_page).status, 1);
  EXPECT_THAT(read_file(report),
              AllOf(HasSubstr("\"call_stack\":null"),
                    ContainsRegex("\"control_times\":\\[\\{\"controller\":\"Pendulum/Swing\",.*\"histogram\":\\[\\[")));
  EXPECT_EQ(rehearse(words, with_page + " REHEARSE_CALL_STACK=").status, 1);
  EXPECT_THAT(read_file(report),
              AllOf(HasSubstr("\"call_stack\":{\"controller\":\"Pendulum/Swing\",\"command\":\"hinge/u\",\"tick\":9,"),
                    ContainsRegex("looked_at.cpp\",\"line\":" + line_of("commands").substr(14) + ",")));
}

TEST_F(Gdb, NamesNoLineOfACommandThatNoneChanges) {
  if (!gdb_knows_types) GTEST_SKIP() << "built with line numbers alone, as builds with sanitizers are";
  record();
  const Outcome outcome =
      in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "20"}, "rehearse-stack knee/u\nrehearse-stack hinge/dq");
  EXPECT_THAT(outcome.out,
              HasSubstr(R"({"frames": [], "reason": "no line of control() changes hinge/dq in that tick"})"));
  EXPECT_THAT(outcome.out, HasSubstr(R"({"frames": [], "reason": "'knee/u' is no command of a joint )"));
}

TEST_F(Gdb, IsAskedForALineWhenTheVerdictIsPrinted) {
  const std::string scenario = pendulum(LOOKED_AT).string();
  done({"record", scenario, "-o", "golden.mcap"});
  const fs::path page = write("page.html", "<!doctype html><html><!-- REHEARSE DATA --></html>");
  fs::create_directory(folder() / "bin");
  write("bin/gdb", "#!/bin/sh\ncp " + quoted(folder().string() + ".stdout") + " printed\n");
  fs::permissions(folder() / "bin/gdb", fs::perms::owner_all);
  const Outcome outcome = rehearse(
      {"check", scenario, "--golden", "golden.mcap", "--controller", std::string("Swing=") + STIFFER},
      "REHEARSE_CALL_STACK= PATH=" + quoted(folder() / "bin") + ":$PATH REHEARSE_REPORT_PAGE=" + page.string());
  const std::string printed = read_file(folder() / "printed");
  EXPECT_THAT(printed,
              AllOf(StartsWith("pendulum: "), HasSubstr("controller: differs; plant: equal; closed: differs")));
  EXPECT_THAT(printed, Not(HasSubstr("in a browser")));
  EXPECT_THAT(outcome.out, AllOf(StartsWith(printed), HasSubstr("in a browser: ")));
}

TEST_F(Gdb, StopsAtTheLineThatChangesACommand) {
  if (!gdb_knows_types) GTEST_SKIP() << "built with line numbers alone, as builds with sanitizers are";
  record();
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "20"}, R"(rehearse-write hinge/u
print calls_
rehearse-write calls_
rehearse-write hinge/u
rehearse-tick
rehearse-write knee/u
rehearse-next-tick
print calls_
echo [breakpoint]\n
tbreak )" + line_of("commands") + R"(
rehearse-write hinge/u
echo [behind]\n
rehearse-write hinge/u
finish
rehearse-write hinge/u)");
  EXPECT_THAT(outcome.out, ContainsRegex("hinge/u is written in .*LookedAt::control, .*" + line_of("commands") + "\n"));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("$1 = 20\n"), HasSubstr("hinge/u doesn't change in the rest of this call\n"),
                                 HasSubstr("$2 = 21\n")));
  EXPECT_THAT(outcome.err, HasSubstr("'knee/u' is no command of a joint (JOINT/u, /q or /dq; see rehearse-commands)"));
  EXPECT_THAT(outcome.out,
              ContainsRegex("calls_ is written in .*LookedAt::control, .*" + line_of("has commanded") + "\n"));
  const std::size_t breakpoint = outcome.out.find("[breakpoint]"), behind = outcome.out.find("[behind]");
  ASSERT_NE(behind, std::string::npos) << outcome.out << outcome.err;
  EXPECT_THAT(
      outcome.out.substr(breakpoint, behind - breakpoint),
      AllOf(ContainsRegex("hit Temporary breakpoint 1, .*" + line_of("commands")), Not(HasSubstr("doesn't change"))));
  EXPECT_THAT(outcome.out.substr(behind), ContainsRegex("hinge/u is written in .*" + line_of("commands") + "\n"));
  EXPECT_THAT(outcome.err, HasSubstr("gdb isn't in code of a controller here"));
}

TEST_F(Gdb, StopsBehindAThunk) {
  const Outcome recorded = quiet({"record", pendulum(BEHIND_ANOTHER).string()});
  ASSERT_EQ(recorded.status, 0) << recorded.err;
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "4"}, R"(print calls_
bt 1)");
  EXPECT_THAT(outcome.out, AllOf(ContainsRegex(arrival(4, line_of("begins"))), HasSubstr("$1 = 4\n")));
}

TEST_F(Gdb, StopsAtTheAddressWithoutDebugInformation) {
  if (!gdb_knows_types) GTEST_SKIP() << "built with line numbers alone, as builds with sanitizers are";
  const Outcome recorded = quiet({"record", pendulum(WITHOUT_DEBUG_INFORMATION).string()});
  ASSERT_EQ(recorded.status, 0) << recorded.err;
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "4"},
                                 R"(rehearse-inputs
rehearse-next-tick
info symbol $pc)");
  EXPECT_THAT(outcome.out,
              ContainsRegex("tick 4 .*looked_at_without_debug_information.so has no debug information \\(build "
                            "it with -g\\): this is the address of control\\(\\)\n"));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("hinge"), HasSubstr("tick 5 "), Not(HasSubstr("looked_at.cpp"))));
}

TEST_F(Gdb, StopsInTheControllerThatIsNamed) {
  const std::string scenario = (fixtures / "scenarios/parent_and_child.yaml").string();
  ASSERT_EQ(quiet({"record", scenario, "--duration", "0.2", "-o", "two.mcap"}).status, 0);
  const Outcome outcome = in_gdb({"replay", "two.mcap", "--gdb=Arm/Child", "--tick", "10"},
                                 R"(rehearse-next-tick
rehearse-tick 20 Parent
rehearse-back
rehearse-tick 20 Child)");
  EXPECT_THAT(outcome.out, AllOf(ContainsRegex(arrival(10, "ChildController.cpp", "Arm/Child")),
                                 ContainsRegex(arrival(11, "ChildController.cpp", "Arm/Child")),
                                 ContainsRegex(arrival(20, "ParentController.cpp", "Arm/Parent")),
                                 ContainsRegex(arrival(19, "ParentController.cpp", "Arm/Parent")),
                                 ContainsRegex(arrival(20, "ChildController.cpp", "Arm/Child"))));
}

TEST_F(Gdb, SaysThatARunEndedBefore) {
  record();
  const Outcome outcome = in_gdb({"replay", "pendulum.mcap", "--gdb", "--tick", "40"},
                                 R"(rehearse-next-tick 100
rehearse-tick
rehearse-tick 40
rehearse-back 41
rehearse-tick 1x
rehearse-back 1 2
help rehearse)");
  EXPECT_THAT(outcome.out, HasSubstr("the program ended before control() of Pendulum/Swing at tick 140\n"));
  EXPECT_THAT(outcome.err, HasSubstr("no run has begun: rehearse-tick N starts the program and stops at tick N\n"));
}

/// Not of the command: what a test program under gdb calls.
TEST(BenchInGdb, HasTwoRuns) {
  for (const int ticks : {5, 12}) {
    ControllerBench bench(LOOKED_AT, (fixtures / "models/pendulum.urdf").string());
    for (int i = 0; i < ticks; ++i) {
      bench.joint("hinge").q = 0.01 * i;
      bench.tick();
    }
  }
}

TEST_F(Gdb, KnowsTheRunsOfATestProgram) {
  std::string script =
      "source " + (fs::path(REHEARSE_COMMAND).parent_path() / "../share/rehearse/gdb/rehearse_gdb.py").string() +
      "\nrehearse-tick 8\nprint calls_\nnext\nprint angle\nrehearse-back 7\nprint calls_\nrehearse-tick\n" +
      "rehearse-tick 8\nrehearse-next-tick 10\n";
  write("script.gdb", script);
  const Outcome outcome = run("/usr/bin/env",
                              {"gdb", "-nx", "-q", "-batch", "-x", "script.gdb", "--args",
                               fs::read_symlink("/proc/self/exe").string(), "--gtest_filter=BenchInGdb.*"},
                              environment);
  EXPECT_THAT(outcome.out, AllOf(ContainsRegex(arrival(8, line_of("begins"), "[^\n]*/[^\n]*")), HasSubstr("$1 = 8\n"),
                                 HasSubstr("$2 = 0.08"), ContainsRegex("tick 1 .* of the process's run 2"),
                                 HasSubstr("$3 = 1\n"), HasSubstr("the program ended before control() of ")));
}

class GdbRefusal : public Command {
 protected:
  std::string refusal(const std::vector<std::string>& words, const std::string& environment = "") const {
    const Outcome outcome = rehearse(words, environment);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_EQ(outcome.out, "");
    return outcome.err;
  }
};

TEST_F(GdbRefusal, OfATickBeyondTheEnd) {
  done({"record", pendulum(LOOKED_AT).string()});
  EXPECT_EQ(refusal({"replay", "pendulum.mcap", "--gdb", "--tick", "50"}),
            "error: --tick 50 is beyond the end: the run has 50 ticks, 0.05 s (expected 0 to 49)\n");
  EXPECT_EQ(refusal({"record", "pendulum.yaml", "--gdb", "--tick", "50"}),
            "error: --tick 50 is beyond the end: the run has 50 ticks, 0.05 s (expected 0 to 49)\n");
}

TEST_F(GdbRefusal, OfAControllerThatIsNotThere) {
  done({"record", pendulum(LOOKED_AT).string()});
  EXPECT_EQ(refusal({"replay", "pendulum.mcap", "--gdb=Walker"}),
            "error: --gdb=Walker: the run has no controller of that name (controllers: Pendulum/Swing)\n");
  EXPECT_EQ(refusal({"record", box_scenario.string(), "--gdb"}),
            "error: --gdb stops in a controller, and this run has none\n");
}

TEST_F(GdbRefusal, WithoutGdb) {
  done({"record", pendulum(LOOKED_AT).string()});
  const std::string problem = "error: there is no gdb on the PATH (apt-get install gdb)\n";
  EXPECT_EQ(refusal({"replay", "pendulum.mcap", "--gdb", "--tick", "5"}, "PATH=/nowhere"), problem);
  EXPECT_EQ(refusal({"record", "pendulum.yaml", "--gdb", "--tick", "5"}, "PATH=/nowhere"), problem);
  EXPECT_EQ(refusal({"check", "pendulum.yaml", "--golden", "pendulum.mcap", "--gdb"}, "PATH=/nowhere"), problem);
}

TEST_F(GdbRefusal, OfWhatCanNotBeStartedAgain) {
  EXPECT_THAT(refusal({"replay", "/dev/stdin", "--gdb"}),
              HasSubstr("can be read only once, and gdb starts the replay anew"));
  EXPECT_THAT(refusal({"check", sr1_scenario.string(), box_scenario.string(), "--gdb"}),
              HasSubstr("--gdb stops in one scenario (name that scenario)"));
}

TEST_F(GdbRefusal, OfItsCompanionsWithoutIt) {
  EXPECT_EQ(refusal({"record", sr1_scenario.string(), "--tick", "5"}),
            "error: rehearse record: --tick requires --gdb (see rehearse record --help)\n");
  EXPECT_EQ(refusal({"check", sr1_scenario.string(), "--tick", "5"}),
            "error: rehearse check: --tick requires --gdb (see rehearse check --help)\n");
  EXPECT_EQ(refusal({"replay", "a.mcap", "--gdb-arg=-batch"}),
            "error: rehearse replay: --gdb-arg requires --gdb (see rehearse replay --help)\n");
}

}  // namespace
}  // namespace rehearse::test
