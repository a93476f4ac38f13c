// rehearse fuzz: goes on with the search of a fuzz test (<rehearse/fuzz.h>), which the test's program makes.
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "base/text.h"
#include "command.h"
#include "core/guard/child_process.h"
#include "core/guard/interruption.h"
#include "options.h"
#include "output.h"
#include "scratch_folder.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct FuzzSettings {
  std::string test;
  std::string build = "build";
  std::int64_t runs = 20000;
  double seconds = 0.0;  // 0: `runs` counts
  std::optional<std::int64_t> seed;
  std::int64_t jobs = 0;
  bool anew = false;
  bool json = false;
};

/// "10min", "30 s" or "2h" in seconds.
double parse_duration(const std::string& text) {
  const std::size_t end = text.find_first_not_of("0123456789.");
  const std::string number = text.substr(0, end);
  std::string unit = end == std::string::npos ? "s" : text.substr(end);
  unit.erase(0, unit.find_first_not_of(' '));
  const double factor = unit == "s" ? 1.0 : unit == "min" ? 60.0 : unit == "h" ? 3600.0 : 0.0;
  if (factor == 0.0)
    throw CLI::ValidationError("--for", fmt::format("{} is no time: expected as 30s, 10min or 2h", in_quotes(text)));
  return factor * parse_number("--for", number, 0.001, 1e6);
}

struct TestProgram {
  std::vector<std::string> command;
  std::string folder;
};

/// The program of a test, as ctest knows it.
Result<TestProgram> program_of(const FuzzSettings& settings) {
  const fs::path ctest = find_program("ctest");
  if (ctest.empty()) return error("ctest isn't on the PATH, by which the program of a test is found");
  std::error_code failed;
  if (!fs::exists(fs::path(settings.build) / "CTestTestfile.cmake", failed))
    return error_in(settings.build, "this is no build with tests", "name the folder of the build: --build DIR");
  ChildProcess asking{{ctest.string(), "--test-dir", settings.build, "--show-only=json-v1"}, environment_with({})};
  asking.errors = ChildProcess::Errors::discarded;
  const auto output = REHEARSE_TRY(output_of(std::move(asking)));
  const std::size_t begin = output.text.find("{\n");
  const Json tests = begin == std::string::npos ? Json() : Json::parse(output.text.substr(begin), nullptr, false);
  if (!tests.is_object() || !tests.contains("tests"))
    return error_in(settings.build, "ctest doesn't list the tests of this build", "build it first");
  for (const Json& test : tests["tests"]) {
    if (test.value("name", "") != settings.test || !test.contains("command")) continue;
    TestProgram found{test["command"].get<std::vector<std::string>>(), {}};
    for (const Json& property : test.value("properties", Json::array()))
      if (property.value("name", "") == "WORKING_DIRECTORY") found.folder = property.value("value", "");
    return found;
  }
  return error(fmt::format("there is no test {} in {}", in_quotes(settings.test), settings.build),
               "expected SUITE.TEST of a FUZZ_CONTROLLER: ctest --test-dir " + settings.build + " -N lists all");
}

/// As a user names the file, who is in the working folder.
std::string name_of(const Json& file) {
  std::error_code failed;
  const fs::path path = file.get<std::string>(), near = fs::proximate(path, failed);
  return failed || near.native().starts_with("..") ? path.string() : near.string();
}

void tell(const FuzzSettings& settings, const Json& result) {
  const auto count = static_cast<std::int64_t>(result["findings"].size());
  const std::string before = result["resumed_from"] > 0
                                 ? fmt::format(", {} of them earlier", result["resumed_from"].get<std::int64_t>())
                                 : std::string();
  fmt::print("{}: {} in {}{}, seed {}\n", settings.test, count == 0 ? "no finding" : count_text(count, "finding"),
             count_text(result["runs"].get<std::int64_t>(), "run"), before, result["seed"].get<std::int64_t>());
  fmt::print("  {} reached something new{}\n", count_text(result["kept"].get<std::int64_t>(), "sequence"),
             result["points"] > 0
                 ? fmt::format(", {} of the code", count_text(result["points"].get<std::int64_t>(), "place"))
                 : std::string("; build the controller with FUZZ to guide the search by its code"));
  for (const Json& kept : result["kept_findings"])
    if (!kept["sentence"].get<std::string>().empty())
      fmt::print("a kept finding fails again: {}: {}\n", name_of(kept["file"]),
                 plain_text(kept["sentence"].get<std::string>()));
  for (const Json& finding : result["findings"]) {
    fmt::print("{}: {}\n", finding["kind"].get<std::string>(), plain_text(finding["sentence"].get<std::string>()));
    fmt::print("  run {}, shrunk from {} and {} to {} and {}\n", finding["run"].get<std::int64_t>(),
               count_text(finding["ticks_before"].get<std::int64_t>(), "tick"),
               count_text(finding["changes_before"].get<std::int64_t>(), "change"),
               count_text(finding["ticks"].get<std::int64_t>(), "tick"),
               count_text(finding["changes"].get<std::int64_t>(), "change"));
    if (!finding["repeats"].get<bool>()) fmt::print("  it doesn't repeat its bits\n");
    fmt::print("  its inputs: {}\n", name_of(finding["file"]));
    if (!finding["recording"].get<std::string>().empty())
      fmt::print("  tick by tick: rehearse step {}\n", name_of(finding["recording"]));
  }
}

/// The mistakes that kept the test from a search.
Diagnostics mistakes_of(const Json& errors) {
  Diagnostics mistakes;
  for (const Json& one : errors) {
    Diagnostic& mistake = mistakes.emplace_back();
    mistake.file = one.value("file", "");
    mistake.line = one.value("line", 0);
    mistake.column = one.value("column", 0);
    mistake.message = one.value("message", "");
    mistake.hint = one.value("hint", "");
  }
  return mistakes;
}

Exit exit_of(const Json& result) {
  bool fails = !result["findings"].empty();
  for (const Json& kept : result["kept_findings"]) fails = fails || !kept["sentence"].get<std::string>().empty();
  return fails ? Exit::differs : Exit::done;
}

Exit run_fuzz(const FuzzSettings& settings) {
  end_runs_on_signals();
  const auto program = program_of(settings);
  if (!program) return refuse(program.errors());
  const ScratchFolder scratch = ScratchFolder::temporary();
  if (scratch.path().empty()) return refuse(error("no folder for temporary files can be made", "set TMPDIR"));
  const fs::path file = scratch.path() / "result.json";
  Json asked{
      {"runs", settings.runs}, {"seconds", settings.seconds}, {"anew", settings.anew}, {"result", file.string()}};
  if (settings.seed) asked["seed"] = *settings.seed;
  if (settings.jobs > 0) asked["jobs"] = settings.jobs;
  ChildProcess process{program->command, environment_with({{"REHEARSE_FUZZ", asked.dump()}})};
  process.folder = program->folder;
  const auto output = output_of(std::move(process));
  if (!output) return refuse(output.errors());
  if (interruption() != 0) return static_cast<Exit>(128 + interruption());
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  Json result = Json::parse(text.str(), nullptr, false);
  if (!result.is_object()) {
    std::istringstream lines(output->text);
    for (std::string line; std::getline(lines, line);) fmt::print(stderr, "{}\n", plain_text(line));
    return refuse(error(fmt::format("{} made no search", settings.test),
                        "expected a test by FUZZ_CONTROLLER; its output is above"));
  }
  if (result.contains("errors")) return refuse(mistakes_of(result["errors"]));
  if (settings.json)
    print(result);
  else
    tell(settings, result);
  return exit_of(result);
}

std::function<Exit()> declare_fuzz(CLI::App& options) {
  const auto settings = std::make_shared<FuzzSettings>();
  options.add_option("TEST", settings->test, "SUITE.TEST of a FUZZ_CONTROLLER")->required()->type_name("");
  options.add_option("--build", settings->build, "the folder of the build with the test (build)")->type_name("DIR");
  add_integer(options, "--runs", "of the search, those of earlier calls included (20000)", 1, 1'000'000'000'000,
              [settings](std::int64_t runs) { settings->runs = runs; });
  options
      .add_option_function<std::string>(
          "--for", [settings](const std::string& text) { settings->seconds = parse_duration(text); },
          "wall time of the search instead: 30s, 10min, 2h")
      ->type_name("TIME");
  options.get_option("--for")->excludes("--runs");
  add_integer(options, "--seed", "of the search (that of the test)", 0, std::numeric_limits<std::int64_t>::max(),
              [settings](std::int64_t seed) { settings->seed = seed; });
  add_integer(options, "-j,--jobs", "worker processes (one for each processor)", 1, 16,
              [settings](std::int64_t jobs) { settings->jobs = jobs; });
  options.add_flag("--anew", settings->anew, "forget the search so far");
  add_json_flag(options, settings->json);
  return [settings] { return run_fuzz(*settings); };
}

}  // namespace

extern const Verb fuzz_verb{"fuzz",
                            "  rehearse fuzz Hold.NeverBeyondItsLimits --for 10min\n"
                            "  rehearse fuzz Hold.NeverBeyondItsLimits --runs 100000 --seed 7 --json\n",
                            declare_fuzz};

}  // namespace rehearse::tool
