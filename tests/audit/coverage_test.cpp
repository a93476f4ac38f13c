// Coverage: which lines and branches of a controller the replays of recordings execute, and when first. gcov, which
// instruments the code instead, has to find the same lines.
#include "audited.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "../harness/report/decoded_report.h"

namespace rehearse::test {
namespace {

using nlohmann::json;
using rehearse::testing::DecodedReport;
using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const fs::path source = ZOO_SOURCES "/partly.cpp";

class Coverage : public Audited {
 protected:
  /// The line of the controller's source with this mark.
  static int line_of(const std::string& mark) {
    std::ifstream stream(source);
    int number = 1;
    for (std::string line; std::getline(stream, line); ++number)
      if (line.ends_with("// " + mark)) return number;
    ADD_FAILURE() << "no line has the mark " << mark;
    return 0;
  }
  static json file_of(const json& report) {
    for (const json& file : report["files"])
      if (std::string(file["file"]).ends_with("/partly.cpp")) return file;
    ADD_FAILURE() << report;
    return {};
  }
  static json lines_of(const json& report) { return file_of(report)["lines"]; }
  static json line_at(const json& report, int number) {
    for (const json& line : lines_of(report))
      if (line["line"] == number) return line;
    ADD_FAILURE() << "no line " << number;
    return {};
  }
  static json line(const json& report, const std::string& mark) { return line_at(report, line_of(mark)); }
  /// `partly.so`, compiled from a copy of the controller's source with these lines at its end.
  void compile_copy(const std::string& more) const {
    write("partly.cpp", read_file(source) + more);
    const std::string compile = fmt::format(
        "{} -std=c++17 -O0 -g -fPIC -shared -DEIGEN_MAX_ALIGN_BYTES=16 -I{} {} partly.cpp -o partly.so -L{} "
        "-lrehearse_cnoid",
        quoted(CXX_COMPILER), quoted(ZOO_SOURCES), CNOID_INCLUDES, quoted(LIBRARIES));
    ASSERT_EQ(run("/bin/sh", {"-c", compile}).status, 0);
  }
  /// The coverage in a page or a report, which was written with page().
  json coverage_in(const std::string& file) const {
    const DecodedReport report(folder() / file);
    const std::vector<std::uint8_t> bytes = report.bytes(report["coverage"]);
    json coverage = json::parse(bytes.begin(), bytes.end());
    EXPECT_EQ(report["coverage"]["lines"], coverage["lines"]);
    EXPECT_EQ(report["coverage"]["lines_executed"], coverage["lines_executed"]);
    return coverage;
  }
  /// The environment with an empty page, so that no npm is needed.
  std::string page() const {
    return "REHEARSE_REPORT_PAGE=" + rehearse::testing::plain_page(folder() / "page.html").string();
  }
  /// The object that --json prints.
  static json without_sources(json coverage) {
    coverage["schema"] = 1;
    for (json& file : coverage["files"]) {
      file.erase("source");
      file.erase("unread");
    }
    return coverage;
  }
  json coverage(std::vector<std::string> recordings) const {
    recordings.insert(recordings.begin(), {"audit", "--coverage", "--json"});
    const Outcome outcome = rehearse(recordings);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.json();
  }
};

TEST_F(Coverage, KnowsTheTickInWhichALineRunsFirst) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  const json report = coverage({"near.mcap"});
  EXPECT_EQ(line(report, "static_initialiser")["first"]["tick"], -1);
  EXPECT_EQ(line(report, "begin")["first"]["tick"], -1);
  EXPECT_EQ(line(report, "one_way")["first"]["tick"], 0);
  EXPECT_EQ(line(report, "late")["first"]["tick"], 100);
  EXPECT_EQ(line(report, "late")["first"]["recording"], "near.mcap");
  EXPECT_THAT(std::string(line(report, "late")["function"]), HasSubstr("Partly::late()"));
  for (const char* mark : {"far", "never", "fail"}) {
    EXPECT_TRUE(line(report, mark)["first"].is_null()) << mark;
    EXPECT_EQ(line(report, mark)["recordings"], 0) << mark;
  }
  EXPECT_TRUE(report["remarks"].empty()) << "a jump was executed in a wrong way: " << report["remarks"];
}

TEST_F(Coverage, KnowsBranchesThatOnlyWentOneWay) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  const json report = coverage({"near.mcap"});
  const json ways = line(report, "one_way")["ways"];
  ASSERT_EQ(ways.size(), 2u);
  EXPECT_NE(ways[0]["first"].is_null(), ways[1]["first"].is_null());
  EXPECT_TRUE(ways[0]["known"]);
  for (const json& way : line(report, "watched_in_part")["ways"])
    EXPECT_FALSE(way["known"]) << "10,000 times one way, and then unknown";
}

TEST_F(Coverage, AddsUpRecordings) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  done({"record", scenario("partly", "far").string(), "-o", "far.mcap"});
  const json report = coverage({"near.mcap", "far.mcap"});
  EXPECT_EQ(line(report, "begin")["recordings"], 2);
  EXPECT_EQ(line(report, "begin")["first"]["recording"], "near.mcap");
  EXPECT_EQ(line(report, "far")["recordings"], 1);
  EXPECT_EQ(line(report, "far")["first"]["recording"], "far.mcap");
  for (const json& way : line(report, "one_way")["ways"]) EXPECT_FALSE(way["first"].is_null());
  EXPECT_THAT(std::string(report["verdict"]), HasSubstr(" are executed by 2 recordings; never: partly.cpp:"));
}

/// The lines of gcov's listing of the controller's source, and whether they were executed.
std::map<int, bool> lines_in_listing(const fs::path& file) {
  std::map<int, bool> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::string count = line.substr(0, 9);
    const int number = std::atoi(line.substr(10, 5).c_str());
    const std::size_t begin = count.find_first_not_of(' ');
    if (number > 0 && count[begin] != '-') lines[number] = count[begin] != '#' && count[begin] != '=';
  }
  return lines;
}

TEST_F(Coverage, HasTheLinesOfGcov) {
  const std::string compile = fmt::format(
      "{} -std=c++17 -O0 -g --coverage -fPIC -shared -DEIGEN_MAX_ALIGN_BYTES=16 {} {} -o partly.so -L{} "
      "-lrehearse_cnoid",
      quoted(CXX_COMPILER), CNOID_INCLUDES, quoted(source.string()), quoted(LIBRARIES));
  ASSERT_EQ(run("/bin/sh", {"-c", compile}).status, 0);
  done({"record", scenario("partly").string(), "--controller", "Zoo=./partly.so", "-o", "near.mcap"});
  const Outcome outcome = rehearse({"audit", "near.mcap", "--coverage", "--json", "--controller", "Zoo=./partly.so"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  ASSERT_EQ(run("/bin/sh", {"-c", "rm -f *.gcda"}).status, 0);  // of those two
  done({"replay", "near.mcap", "--controller", "Zoo=./partly.so"});
  ASSERT_EQ(run("/bin/sh", {"-c", "gcov *.gcda >gcov.txt"}).status, 0);
  const std::map<int, bool> counted = lines_in_listing(folder() / "partly.cpp.gcov");
  ASSERT_GT(counted.size(), 30u);
  const json report = outcome.json();
  std::map<int, bool> watched;
  for (const json& line : lines_of(report)) watched[line["line"]] = !line["first"].is_null();
  for (const auto& [number, executed] : counted) {
    if (!watched.contains(number)) continue;  // gcov adds lines of declarations
    EXPECT_EQ(watched[number], executed) << "line " << number;
    watched.erase(number);
  }
  // gcov leaves out the ends of functions, and functions that the compiler adds.
  std::ifstream stream(source);
  int number = 1;
  for (std::string line; std::getline(stream, line); ++number) {
    if (!watched.contains(number)) continue;
    EXPECT_THAT(line, ContainsRegex("^ *}|^class |^const double scale|^CNOID_IMPLEMENT")) << "line " << number;
  }
}

/// The optimiser keeps no code for some lines, and moves that of others.
TEST_F(Coverage, CallsNoLineOfAnOptimisedLibraryNeverExecutedThatIs) {
  const auto report_of = [this](const std::string& level) {
    const std::string compile = fmt::format(
        "{} -std=c++17 {} -g -fPIC -shared -DEIGEN_MAX_ALIGN_BYTES=16 {} {} -o partly.so -L{} -lrehearse_cnoid",
        quoted(CXX_COMPILER), level, CNOID_INCLUDES, quoted(source.string()), quoted(LIBRARIES));
    EXPECT_EQ(run("/bin/sh", {"-c", compile}).status, 0);
    done({"record", scenario("partly").string(), "--controller", "Zoo=./partly.so", "-o", "near.mcap"});
    return done({"audit", "near.mcap", "--coverage", "--json", "--controller", "Zoo=./partly.so"}).json();
  };
  std::set<int> executed;
  const json plain = report_of("-O0");
  EXPECT_EQ(plain["lines_unknown"], 0);
  EXPECT_TRUE(plain["remarks"].empty()) << plain["remarks"];
  for (const json& line : lines_of(plain))
    if (!line["first"].is_null()) executed.insert(line["line"].get<int>());
  for (const char* level : {"-O1", "-O2", "-O3"}) {
    const json report = report_of(level);
    ASSERT_EQ(report["remarks"].size(), 1u) << report["remarks"];
    EXPECT_THAT(std::string(report["remarks"][0]["message"]), StartsWith("partly.so is optimised: "));
    int wrong = 0;
    for (const json& line : lines_of(report)) {
      if (!line["first"].is_null() || !executed.contains(line["line"])) continue;
      ++wrong;
      ADD_FAILURE() << level << ": line " << line["line"] << " is executed";
    }
    std::printf("| %s | %d lines | %d not known | %d wrongly never executed |\n", level, report["lines"].get<int>(),
                report["lines_unknown"].get<int>(), wrong);
    EXPECT_GT(report["lines_executed"], 10) << level;
    std::size_t unknown = 0;
    for (const json& file : report["files"]) unknown += file["unknown"].size();
    EXPECT_EQ(report["lines_unknown"], unknown);
  }
}

TEST_F(Coverage, WritesATracefile) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  done({"audit", "near.mcap", "--coverage", "--lcov", "partly.info"});
  const std::string text = read_file(folder() / "partly.info");
  EXPECT_THAT(text, StartsWith("TN:rehearse\nSF:/"));
  EXPECT_THAT(text, HasSubstr(fmt::format("\nDA:{},1\n", line_of("late"))));
  EXPECT_THAT(text, HasSubstr(fmt::format("\nDA:{},0\n", line_of("never"))));
  EXPECT_THAT(text, ContainsRegex(fmt::format("\nBRDA:{},0,[01],0\n", line_of("one_way"))));
  EXPECT_THAT(text, EndsWith("end_of_record\n"));
}

TEST_F(Coverage, WritesAPageOfRecordings) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  done({"record", scenario("partly", "far").string(), "-o", "far.mcap"});
  const Outcome outcome = rehearse({"audit", "near.mcap", "far.mcap", "--coverage", "--html", "lines.html"}, page());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, ContainsRegex("\nin a browser: file:///.*/lines.html\n$"));
  const json shown = coverage_in("lines.html");
  EXPECT_EQ(without_sources(shown), coverage({"near.mcap", "far.mcap"}));
  EXPECT_EQ(line(shown, "far")["first"]["recording"], "far.mcap");
  EXPECT_EQ(line(shown, "late")["first"]["recording"], "near.mcap");
  EXPECT_EQ(line(shown, "late")["first"]["time"], 0.1);
  EXPECT_TRUE(line(shown, "begin")["first"]["time"].is_null());
  const DecodedReport report(folder() / "lines.html");
  EXPECT_EQ(report["verdict"]["state"], "coverage");
  EXPECT_EQ(report["verdict"]["sentence"], shown["verdict"]);
  EXPECT_TRUE(report["runs"].empty());
  EXPECT_THAT(std::string(file_of(shown)["source"][line_of("late") - 1]), HasSubstr("return 2.0;  // late"));
}

TEST_F(Coverage, IsInTheReportOfARun) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  const Outcome outcome = rehearse({"report", "near.mcap", "--coverage", "-o", "run.html"}, page());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(without_sources(coverage_in("run.html")), coverage({"near.mcap"}));
  EXPECT_EQ(rehearse({"report", "near.mcap", "-o", "plain.html"}, page()).status, 0);
  EXPECT_TRUE(DecodedReport(folder() / "plain.html")["coverage"].is_null());
  EXPECT_EQ(rehearse({"report", "near.mcap", "--coverage", "--until", "0.05", "-o", "run.html"}, page()).status, 0);
  EXPECT_TRUE(line(coverage_in("run.html"), "late")["first"].is_null());
}

TEST_F(Coverage, IsInTheReportUntilTheControllerFails) {
  EXPECT_EQ(rehearse({"record", scenario("partly", "throw").string(), "-o", "failed.mcap"}).status, 3);
  EXPECT_EQ(rehearse({"report", "failed.mcap", "--coverage", "-o", "failed.html"}, page()).status, 0);
  const json shown = coverage_in("failed.html");
  EXPECT_THAT(std::string(shown["failure"]), HasSubstr("fails on purpose"));
  EXPECT_EQ(line(shown, "fail")["first"]["tick"], 20);
}

TEST_F(Coverage, EndsNoElementOfThePageByASource) {
  compile_copy("// </script><script>alert(1)</script>\n");
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  const std::vector<std::string> words{"audit",           "near.mcap", "--coverage", "--controller",
                                       "Zoo=./partly.so", "--html",    "partly.html"};
  ASSERT_EQ(rehearse(words, page()).status, 0);
  const DecodedReport report(folder() / "partly.html");
  EXPECT_THAT(report.text(), ::testing::Not(HasSubstr("alert(1)")));
  const json shown = coverage_in("partly.html");
  EXPECT_EQ(file_of(shown)["source"].back(), "// </script><script>alert(1)</script>");
  fs::remove(folder() / "partly.cpp");
  ASSERT_EQ(rehearse(words, page()).status, 0);
  const json unread = file_of(coverage_in("partly.html"));
  EXPECT_TRUE(unread["source"].is_null());
  EXPECT_THAT(std::string(unread["unread"]), EndsWith("/partly.cpp can't be read: No such file or directory"));
  EXPECT_EQ(unread["lines"], lines_of(shown));
}

TEST_F(Coverage, RemarksThatTheSourceIsNewer) {
  fs::create_directories(folder() / "golden");  // a project
  compile_copy("");
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  const std::vector<std::string> words{"audit", "near.mcap", "--coverage", "--json", "--controller", "Zoo=./partly.so"};
  EXPECT_TRUE(done(words).json()["remarks"].empty());
  write("partly.cpp", "// another line\n" + read_file(source));
  fs::last_write_time(folder() / "partly.cpp", fs::file_time_type::clock::now() + std::chrono::seconds(10));
  const json remarks = done(words).json()["remarks"];
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_THAT(std::string(remarks[0]["message"]), HasSubstr("partly.cpp is newer than partly.so"));
}

TEST_F(Coverage, OverwritesNoOtherFileByAPage) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  write("notes.html", "<p>mine</p>");
  const Outcome outcome = rehearse({"replay", "near.mcap", "--coverage", "--html", "notes.html"}, page());
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(outcome.out.empty()) << "before the replay";
  EXPECT_THAT(outcome.err, HasSubstr("notes.html"));
  EXPECT_EQ(read_file(folder() / "notes.html"), "<p>mine</p>");
}

TEST_F(Coverage, ListsLinesWithTheirSource) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  const Outcome outcome = done({"replay", "near.mcap", "--coverage"});
  EXPECT_THAT(outcome.out,
              ContainsRegex("^[0-9]+ of [0-9]+ lines and [0-9]+ of [0-9]+ ways of branches are executed by "
                            "1 recording; never: partly.cpp:[0-9]+ and [0-9]+ more lines\n"));
  EXPECT_THAT(outcome.out, HasSubstr("never executed"));
  EXPECT_THAT(outcome.out, ContainsRegex("partly.cpp:[0-9]+-[0-9]+ +Partly::never\\(\\) +double never\\(\\) \\{"));
  EXPECT_THAT(outcome.out, ContainsRegex("only one way +function +source"));
  EXPECT_THAT(outcome.out, HasSubstr("if (is_far_) return far();  // one_way"));
}

TEST_F(Coverage, HasTheGoldensOfAProject) {
  fs::create_directories(folder() / "scenarios");
  fs::create_directories(folder() / "golden");
  for (const char* option : {"", "far"}) {
    const std::string name = *option ? option : "near";
    write("scenarios/" + name + ".yaml",
          read_file(scenario("partly", option)) + fmt::format("name: {}\ngolden: Partly.{}\n", name, name));
    EXPECT_EQ(rehearse({"check", "scenarios/" + name + ".yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  }
  fs::remove(folder() / "zoo.yaml");
  const Outcome outcome = done({"check", "--coverage", "--json"});
  EXPECT_EQ(outcome.json()["recordings"].size(), 2u);
  EXPECT_EQ(line(outcome.json(), "far")["recordings"], 1);
  const Outcome one = done({"check", "scenarios/near.yaml", "--coverage", "--json"});
  EXPECT_EQ(line(one.json(), "far")["recordings"], 0);
  EXPECT_EQ(
      rehearse({"check", "--coverage", "--strict"}).err,
      "error: --coverage goes without --strict (it examines whole recordings, or with replay --until the beginning "
      "of one)\n");
}

TEST_F(Coverage, CountsWhatAFailingControllerExecutes) {
  EXPECT_EQ(rehearse({"record", scenario("partly", "throw").string(), "-o", "failed.mcap"}).status, 3);
  const Outcome outcome = rehearse({"audit", "failed.mcap", "--coverage", "--json"});
  EXPECT_EQ(outcome.status, 3) << outcome.out;
  EXPECT_THAT(std::string(outcome.json()["failure"]), HasSubstr("fails on purpose"));
  EXPECT_EQ(line(outcome.json(), "fail")["first"]["tick"], 20);
}

/// The jumps of a destructor that the compiler adds, and of a conversion, are no branches of the source.
TEST_F(Coverage, HasOnlyBranchesOfTheSource) {
  const std::string controller = R"(#include <cnoid/SimpleController>
#include <map>
#include <memory>
#include <string>
#include <vector>
class Mean : public cnoid::SimpleController {
  cnoid::Link* joint_ = nullptr;
  std::unique_ptr<std::vector<double>> last_ = std::make_unique<std::vector<double>>();
  std::map<std::string, double> gains_{{"a", 1.0}, {"b", 2.0}};
  bool initialize(cnoid::SimpleControllerIO* io) override {
    joint_ = io->body()->joint(0);
    joint_->setActuationMode(cnoid::Link::JointEffort);
    io->enableOutput(joint_);
    io->enableInput(joint_, cnoid::Link::JointDisplacement);
    return true;
  }
  bool control() override {
    last_->push_back(joint_->q());
    joint_->u() = last_->back() / last_->size();
    if (last_->size() == 7)
      last_->shrink_to_fit();
    return true;
  }
};
CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Mean)
)";
  write("mean.cpp", controller);
  const std::string compile = fmt::format(
      "{} -std=c++17 -O2 -g -fPIC -shared -DEIGEN_MAX_ALIGN_BYTES=16 {} mean.cpp -o mean.so -L{} "
      "-lrehearse_cnoid",
      quoted(CXX_COMPILER), CNOID_INCLUDES, quoted(LIBRARIES));
  ASSERT_EQ(run("/bin/sh", {"-c", compile}).status, 0);
  done({"record", scenario("partly").string(), "--controller", "Zoo=./mean.so", "-o", "mean.mcap"});
  const Outcome outcome = done({"audit", "mean.mcap", "--coverage", "--json", "--controller", "Zoo=./mean.so"});
  std::vector<std::string> source_lines;
  std::istringstream stream(controller);
  for (std::string line; std::getline(stream, line);) source_lines.push_back(line);
  int branches = 0;
  const json report = outcome.json();
  for (const json& file : report["files"])
    for (const json& line : file["lines"]) {
      if (line["ways"].empty()) continue;
      EXPECT_THAT(source_lines.at(line["line"].get<std::size_t>() - 1), HasSubstr("if (")) << line;
      ++branches;
    }
  EXPECT_EQ(branches, 1) << report;
}

TEST_F(Coverage, NeedsDebugInformation) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  ASSERT_EQ(run("/bin/sh", {"-c", "strip -o stripped.so " ZOO "/zoo_partly.so"}).status, 0);
  const Outcome outcome = rehearse({"audit", "near.mcap", "--coverage", "--controller", "Zoo=./stripped.so"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err,
            "error: controller library 'stripped.so' has no lines in its debug information (compile it with -g; "
            "CMake's RelWithDebInfo has it)\n");
}

TEST_F(Coverage, OfAReportNeedsDebugInformation) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  ASSERT_EQ(run("/bin/sh", {"-c", "strip -o stripped.so " ZOO "/zoo_partly.so"}).status, 0);
  const Outcome outcome =
      rehearse({"report", "near.mcap", "--coverage", "--controller", "Zoo=./stripped.so", "-o", "run.html"}, page());
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err,
            "error: controller library 'stripped.so' has no lines in its debug information (compile it with -g; "
            "CMake's RelWithDebInfo has it)\n");
  EXPECT_FALSE(fs::exists(folder() / "run.html"));
  EXPECT_EQ(rehearse({"report", "near.mcap", "--controller", "Zoo=./stripped.so", "-o", "run.html"}).err,
            "error: --controller is of a replay, and this report needs none (--call-stack and --coverage replay the "
            "recording)\n");
}

TEST_F(Coverage, OfOneControllerSaysWhyOthersHaveNone) {
  ASSERT_EQ(run("/bin/sh", {"-c", "strip -o stripped.so " ZOO "/zoo_partly.so"}).status, 0);
  const std::string two = read_file(scenario("partly")) + "      - {name: Other, library: ./stripped.so}\n";
  ASSERT_EQ(rehearse({"record", write("two.yaml", two).string(), "-o", "two.mcap"}).status, 0);
  const json report = coverage({"two.mcap"});
  EXPECT_FALSE(line(report, "late")["first"].is_null());
  ASSERT_EQ(report["remarks"].size(), 2u) << report["remarks"];
  EXPECT_THAT(std::string(report["remarks"][0]["message"]), ContainsRegex("commands joint 'hinge' by JointEffort"));
  EXPECT_THAT(std::string(report["remarks"][1]["message"]),
              ContainsRegex("stripped.so' has no lines in its debug information: its lines aren't known"));
}

TEST_F(Coverage, WarnsOfTheFirstCommandBeyondItsTolerance) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  const auto said_of = [&](const std::string& other) {
    return rehearse({"audit", "near.mcap", "--coverage", "--json", "--controller", "Zoo=" ZOO "/zoo_" + other + ".so"})
        .out;
  };
  EXPECT_THAT(said_of("good_own_generator"),
              HasSubstr("the replay isn't the recorded run: the commands leave their tolerances first at tick 0"));
  EXPECT_THAT(said_of("static_state"),
              HasSubstr("the replay isn't the recorded run: the commands are within tolerance, and differ first at"));
}

TEST_F(Coverage, RefusesControllersInPython) {
  if (!fs::exists(LIBRARIES "/rehearse/librehearse_python.so")) GTEST_SKIP() << "no controllers in Python";
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  write("hold.py",
        "import rehearse\n\nclass Hold(rehearse.Controller):\n    def control(self):\n        return True\n");
  const char* expected =
      "error: controller 'hold.py:Hold' is written in Python: it has no machine code, in which lines are watched "
      "(Python's own package coverage lists its lines)\n";
  for (const char* verb : {"audit", "report"}) {
    const Outcome outcome = rehearse({verb, "near.mcap", "--coverage", "--controller", "Zoo=./hold.py:Hold"}, page());
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, expected);
  }
}

TEST_F(Coverage, IsTheOnlyModeWithSeveralRecordings) {
  done({"record", scenario("partly").string(), "-o", "near.mcap"});
  const Outcome outcome = rehearse({"audit", "near.mcap", "near.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("only --coverage examines several recordings"));
}

/// Breakpoints change no command: optimised code, threads, matrices.
TEST_F(Coverage, ChangesNothing) {
  for (const char* name : {"good_thread_pool", "good_own_generator", "good_joined_thread", "lengthy"}) {
    done({"record", scenario(name, "many_sines").string(), "-o", "run.mcap"});
    const json report = coverage({"run.mcap"});
    ASSERT_EQ(report["remarks"].size(), 1u) << name << ": " << report["remarks"];
    EXPECT_THAT(std::string(report["remarks"][0]["message"]), HasSubstr(" is optimised: ")) << name;
    EXPECT_GT(report["lines_executed"], 5) << name;
  }
}

}  // namespace
}  // namespace rehearse::test
