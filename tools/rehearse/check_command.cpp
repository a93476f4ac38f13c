// rehearse check: runs scenarios and compares them with their goldens.
#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/report.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "check/compared.h"
#include "ci_output.h"
#include "command.h"
#include "debugger.h"
#include "golden/run_folder.h"
#include "golden/stale_report.h"
#include "host/interruption.h"
#include "host/supervise.h"
#include "host/virtualised.h"
#include "options.h"
#include "output.h"
#include "png/png.h"
#include "progress.h"
#include "report/report_index.h"
#include "scenario/project.h"
#include "scenario/trace_scenario.h"
#include "scenario_text.h"
#include "simulation/recorded_view.h"
#include "trace/run_facts.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct CheckSettings {
  std::vector<std::string> scenarios;
  std::string golden;  // a trace to compare with; empty: the golden of each scenario
  bool json = false;
  bool no_report = false;
  std::string junit;  // output file; empty: none
  bool github = is_github();
  CheckOptions check;
  bool has_levels = false;  // the user named levels
  DebuggerOptions debugger;
  std::int64_t tick = 0;  // where gdb stops
};

/// The result of one scenario.
struct Checked {
  std::string scenario;  // name
  std::string file;
  CheckReport report;
  std::optional<FailureReport> page;  // the report for a browser
  std::string no_page;                // the reason why there is no report although one was requested
  double seconds = 0.0;               // wall time [s]
};

bool can_be_checked(const Scenario& scenario) { return !scenario.golden.empty() || !scenario.expectations.empty(); }

/// All scenarios of the project that name a golden or have expectations, by path.
Result<std::vector<Scenario>> all_of_project() {
  const auto project = find_project("./");
  if (!project)
    return error("this folder is of no project: no folder above it has a folder 'golden' or a CMakeLists.txt",
                 "name a scenario, or go to a project's folder");
  std::vector<Scenario> scenarios;
  std::error_code ignored;
  for (const fs::path& file : scenario_files(*project)) {
    Result<Scenario> scenario = Scenario::load(fs::proximate(file, ignored));
    if (!scenario) return scenario.errors();
    if (can_be_checked(*scenario)) scenarios.push_back(*std::move(scenario));
  }
  if (scenarios.empty())
    return error(
        fmt::format("no scenario below scenarios or fixtures/scenarios of {} names a golden or expects something",
                    project->string()),
        "name a scenario");
  return scenarios;
}

/// The replay of a log has no scenario file: the scenario is read from its recording.
Result<Scenario> scenario_of_a_log(const std::string& file) {
  const auto trace = mcap::Reader::open(file);
  if (!trace) return trace.errors();
  if (RunFacts::of(**trace).is_of_log) return scenario_of(**trace);
  Diagnostic finding =
      error("it isn't a recording of a robot's log", "check the scenario, with --golden and this trace");
  finding.file = file;
  return finding;
}

Result<std::vector<Scenario>> load(const CheckSettings& settings) {
  if (settings.scenarios.empty()) return all_of_project();
  std::vector<Scenario> scenarios;
  for (const std::string& file : settings.scenarios) {
    Result<Scenario> scenario = file.ends_with(".mcap") ? scenario_of_a_log(file) : Scenario::load(file);
    if (!scenario) return scenario.errors();
    scenarios.push_back(*std::move(scenario));
  }
  return scenarios;
}

/// An error if a different scenario names the same golden, anywhere in the golden's repository: each check would
/// compare with the other scenario's run.
Result<void> check_owner(const Scenario& scenario) {
  const auto folder = find_golden_folder(scenario.file);
  if (scenario.golden.empty() || !folder) return {};  // check_golden reports that the scenario names no golden
  std::error_code ignored;
  const fs::path repository = fs::absolute(*folder / "..", ignored).lexically_normal();
  const fs::path inside = fs::absolute(scenario.file, ignored).lexically_normal().lexically_relative(repository);
  if (inside.empty() || *inside.begin() == "..") return {};  // the goldens are outside: REHEARSE_GOLDEN_DIR
  const auto owners = find_golden_owners(*folder, {*folder / ".."});
  const auto known = owners.find(scenario.golden);
  if (known == owners.end() || known->second.scenarios.size() < 2) return {};
  Diagnostic finding =
      error(fmt::format("the golden '{}' isn't this scenario's alone: {}", scenario.golden, known->second.conflict()),
            "give each a golden of its own");
  finding.file = scenario.file;
  return finding;
}

/// The trace that the user named: --golden, or the log's recording from which the scenario was read; empty: none.
fs::path named_golden(const CheckSettings& settings, const Scenario& scenario) {
  if (!settings.golden.empty()) return settings.golden;
  const fs::path within = fs::path(scenario.file).parent_path();  // scenario_of() names it RECORDING/scenario.yaml
  return within.extension() == ".mcap" ? within : fs::path();
}

/// The trace with which the scenario will be compared; empty: none, or not known yet.
fs::path golden_of(const CheckSettings& settings, const Scenario& scenario) {
  if (fs::path named = named_golden(settings, scenario); !named.empty()) return named;
  const auto folder = find_golden_folder(scenario.file);
  if (scenario.golden.empty() || !folder) return {};
  const GoldenStore store(*folder);
  return store.has(scenario.golden) ? store.trace_file(scenario.golden) : fs::path();
}

/// A golden whose controllers had simulated time and seeded random numbers is checked with them, which requires a
/// separate process.
Result<void> virtualise_like_goldens(const CheckSettings& settings, const std::vector<Scenario>& scenarios) {
  for (const Scenario& scenario : scenarios) {
    const fs::path golden = golden_of(settings, scenario);
    if (golden.empty()) continue;
    const auto trace = mcap::Reader::open(golden);
    if (!trace || !virtualised_seed(**trace)) continue;
    if (scenarios.size() > 1)
      return error(
          fmt::format("the golden of {} was recorded with simulated time and seeded random numbers", scenario.name),
          "check it by itself");
    return virtualise_process_like(golden);
  }
  return {};
}

/// An interrupted run gets no verdict.
Result<RunSummary> record_whole(const Scenario& scenario, const fs::path& trace, const RecordOptions& options) {
  auto run = record(scenario, trace, options);
  if (run && run->failure && interruption() != 0) return *run->failure;
  return run;
}

/// `folder`: used by this run alone.
Result<CheckReport> check(const CheckSettings& settings, const Scenario& scenario, const fs::path& folder) {
  InterposerWatch watch;
  Progress progress("checking " + scenario.name,
                    settings.check.controller + settings.check.plant + settings.check.closed);
  CheckOptions options = settings.check;
  options.run.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
  if (is_interposed()) options.run.watch = &watch;
  if (const fs::path golden = named_golden(settings, scenario); !golden.empty())
    return check_scenario(scenario, golden, folder / (scenario.name + ".mcap"), options, {record_whole, run_plant});
  const auto mode = golden_mode();
  if (!mode) return mode.errors();
  if (auto alone = check_owner(scenario); !alone) return alone.errors();
  // check_golden reports a scenario that names no golden
  const auto goldens = scenario.golden.empty() ? Result<fs::path>(fs::path()) : find_golden_folder(scenario.file);
  if (!goldens) return goldens.errors();
  GoldenStore store(*goldens, folder);
  return check_golden(scenario, store, *mode, options, {record_whole, run_plant});
}

bool failed(const CheckReport& report) {
  const bool run_failed = report.run && (report.run->failure || report.run->controller_refused);
  return run_failed || (report.replay && (report.replay->failure || report.replay->controller_refused));
}

Exit exit_of(const CheckReport& report) {
  if (failed(report)) return Exit::controller_failed;
  if (!compared_anything(report)) return Exit::bad_input;
  return report.within() ? Exit::done : Exit::differs;
}

/// The file name of a run's trace.
std::string name_of(const CheckSettings& settings, const Scenario& scenario) {
  const bool has_store = named_golden(settings, scenario).empty() && !scenario.golden.empty();
  return has_store ? scenario.golden : scenario.name;
}

/// Writes the report of a failed check. If it can't be written, the verdict doesn't change.
void add_page(const CheckSettings& settings, const Scenario& scenario, const fs::path& actual, Checked& checked) {
  if (settings.no_report) return;
  if (const auto page = report_page(); !page) {
    if (!checked.report.within()) checked.no_page = page.errors()[0].message;
    return;
  }
  const auto allowed =
      check_replaceable(pending_folder() / actual.filename().replace_extension(".html"), report_magic, "report");
  auto written = allowed ? write_failure_report(checked.report, scenario, golden_of(settings, scenario), actual)
                         : Result<std::optional<FailureReport>>(allowed.errors());
  if (written) {
    checked.page = *std::move(written);
    return;
  }
  for (Diagnostic problem : written.errors()) {
    problem.severity = Severity::warning;
    fmt::print(stderr, "{}\n", to_string(problem));
  }
}

void tell(const Checked& checked) {
  const CheckReport& report = checked.report;
  const std::string sentence = fmt::format("{}: {}", checked.scenario, report.verdict);
  const std::string shown = terminal_width() > 0 ? wrapped(sentence, terminal_width(), 0) : sentence;
  fmt::print("{}\n", colored(shown, report.within() ? TextColor::green : TextColor::red));
  fmt::print("  controller on recorded inputs: {}; world under recorded commands: {}; closed loop: {}; {:.1f} s\n",
             to_string(report.controller), to_string(report.plant), to_string(report.closed), checked.seconds);
  if (report.plant_run && !report.plant_run->from_the_start.empty())
    fmt::print("  without checkpoints, from the start: {}\n", report.plant_run->from_the_start);
  if (report.plant == LevelState::differs && report.plant_comparison)
    fmt::print("  under the recorded commands:\n{}", table(*report.plant_comparison));
  if (report.comparison)
    fmt::print("{}{}", report.plant == LevelState::differs ? "  in the closed loop:\n" : "", table(*report.comparison));
  for (const std::string& remark : report.remarks) fmt::print("  note: {}\n", remark);
  if (!report.message.empty()) fmt::print("{}\n", report.message);
  if (checked.page && is_ci()) fmt::print("report: {}\n", checked.page->file.string());
  if (checked.page && !is_ci())
    fmt::print("in a browser: {}\n", report_link(checked.page->file, checked.page->summary.first_tick));
  if (!checked.no_page.empty()) fmt::print("  note: there is no report to look at: {}\n", checked.no_page);
  std::fflush(stdout);  // before related output on stderr
  if (report.run) tell_remarks(*report.run);
}

Json json_of_check(const Checked& checked) {
  Json object = Json::parse(to_json(checked.report));
  if (!compared_anything(checked.report)) object["equal"] = object["within"] = false;
  object["scenario"] = checked.scenario;
  object["file"] = checked.file;
  object["message"] = checked.report.message;
  object["report"] = checked.page ? Json(checked.page->file.string()) : Json();
  return object;
}

/// A run writes into a separate folder and is moved to the pending runs when it is complete; so other processes in this
/// folder never read a partial run.
Result<Checked> check_beside_others(const CheckSettings& settings, const Scenario& scenario) {
  const std::string name = name_of(settings, scenario);
  auto waiting = WaitingRun::begin(pending_folder(), name);
  if (!waiting) return waiting.errors();
  auto report = check(settings, scenario, waiting->folder());
  if (interruption() != 0)
    return error(fmt::format("interrupted by SIG{}: {} was not judged", sigabbrev_np(interruption()), scenario.name));
  if (!report) return report.errors();
  Checked checked;
  checked.scenario = scenario.name;
  checked.file = scenario.file;
  checked.report = *std::move(report);
  if (!compared_anything(checked.report)) checked.report.verdict = "nothing was compared: " + checked.report.verdict;
  add_page(settings, scenario, waiting->folder() / (name + ".mcap"), checked);
  const auto told = waiting->publish(checked.report.message);
  if (!told) return told.errors();
  if (!told->empty()) checked.report.remarks.push_back(*told);
  if (checked.page) checked.page->file = pending_folder() / checked.page->file.filename();
  return checked;
}

/// A PNG of the robot at the first difference; empty if it can't be drawn.
std::vector<std::uint8_t> thumbnail_of(const Scenario& scenario, const FailureReport& page) {
  const auto trace = Trace::load(fs::path(page.file).replace_extension(".mcap"));
  if (!trace) return {};
  const auto picture = draw_recorded(scenario, *trace, page.summary.first_tick.value_or(0), 320, 240);
  return picture ? encode_png(*picture) : std::vector<std::uint8_t>();
}

TestResult result_of(const Scenario& scenario, const Checked& checked) {
  const Exit exit = exit_of(checked.report);
  TestResult result;
  result.test = checked.scenario;
  result.kind = scenario.golden.empty() ? "expectations" : "golden";
  result.state = exit == Exit::done      ? TestResult::State::passed
                 : exit == Exit::differs ? TestResult::State::differs
                                         : TestResult::State::failed;
  result.verdict = checked.report.verdict;
  if (!checked.page) return result;
  result.report = checked.page->file;
  result.tick = checked.page->summary.first_tick;
  result.picture = thumbnail_of(scenario, *checked.page);
  return result;
}

/// Lists the results beside the reports, and prints the address of the list. Without a failure an existing list is
/// renewed, and no new one is made.
void keep_index(const std::vector<Scenario>& scenarios, const std::vector<Checked>& all, bool tells) {
  std::error_code ignored;
  const bool all_passed = std::all_of(all.begin(), all.end(), [](const Checked& one) { return one.report.within(); });
  if (all_passed && !fs::exists(pending_folder() / "index.html", ignored)) return;
  const FolderLock alone(pending_folder());
  for (std::size_t i = 0; i < all.size(); ++i) keep_result(pending_folder(), result_of(scenarios[i], all[i]));
  const auto index = refresh_index(pending_folder());
  if (!index || all_passed || !tells) return;
  fmt::print("all reports: {}\n", is_ci() ? index->string() : report_link(*index));
}

/// The summary of all scenarios: differs if any differs, else within if any is, else equal; skipped if all are skipped.
std::string_view together(const std::vector<Checked>& all, LevelState CheckReport::*level) {
  for (const LevelState state : {LevelState::differs, LevelState::within, LevelState::equal})
    for (const Checked& checked : all)
      if (checked.report.*level == state) return to_string(state);
  return to_string(LevelState::skipped);
}

/// One object for several scenarios: the same members as for one, and each scenario in `scenarios`.
Json json_of_checks(const std::vector<Checked>& all) {
  const auto bad =
      std::find_if(all.begin(), all.end(), [](const Checked& checked) { return !checked.report.within(); });
  Json scenarios = Json::array();
  for (const Checked& checked : all) scenarios.push_back(json_of_check(checked));
  return {{"verdict", bad == all.end() ? fmt::format("{} as they should be", count_text(std::ssize(all), "scenario"))
                                       : bad->scenario + ": " + bad->report.verdict},
          {"equal", std::all_of(all.begin(), all.end(), [](const Checked& checked) { return checked.report.equal(); })},
          {"within", bad == all.end()},
          {"levels",
           {{"controller", together(all, &CheckReport::controller)},
            {"plant", together(all, &CheckReport::plant)},
            {"closed", together(all, &CheckReport::closed)}}},
          {"first", bad == all.end() ? Json(nullptr) : json_of_check(*bad)["first"]},
          {"scenarios", scenarios}};
}

CiCase ci_case(const Checked& checked) {
  const CheckReport& report = checked.report;
  const Exit exit = exit_of(report);
  CiCase one;
  one.name = checked.scenario;
  one.file = checked.file;
  one.verdict = headline(report.verdict);
  one.seconds = checked.seconds;
  one.state = exit == Exit::done      ? CiCase::State::passed
              : exit == Exit::differs ? CiCase::State::differs
                                      : CiCase::State::failed;
  if (const ExpectationResult* violation = first_violation(report.expectations))
    one.line = violation->expectation.place.line;
  one.details = report.verdict + '\n';
  if (report.comparison) one.details += table(*report.comparison);
  one.details += report.message;
  if (checked.page) one.report = checked.page->file.string();
  return one;
}

/// Compares only the closed loop unless the user named levels: otherwise the level in which gdb stops would be
/// undefined.
Exit run_in_gdb(const CheckSettings& settings, const std::vector<Scenario>& scenarios, const CLI::App& options) {
  if (scenarios.size() != 1) return refuse(error("--gdb stops in one scenario", "name that scenario"));
  if (const auto able = check_debugger(settings.debugger, scenarios[0]); !able) return refuse(able.errors());
  if (const auto there = check_tick(settings.tick, scenarios[0].ticks(), scenarios[0].time_step); !there)
    return refuse(there.errors());
  std::vector<std::string> words = words_without_debugger("check", options);
  if (!settings.has_levels) {
    words.insert(words.begin() + 1, "--level=closed");
    fmt::print("stopping in the closed loop; the other levels are not compared\n");
  }
  return become_gdb(settings.debugger, words, settings.tick);
}

Exit run_check(const CheckSettings& settings, const CLI::App& options) {
  const auto scenarios = load(settings);
  if (!scenarios) return refuse(scenarios.errors());
  if (settings.debugger.is_wanted()) return run_in_gdb(settings, *scenarios, options);
  if (!settings.golden.empty() && scenarios->size() != 1)
    return refuse(error("--golden compares one scenario", "name that scenario"));
  if (const auto ready = virtualise_like_goldens(settings, *scenarios); !ready) return refuse(ready.errors());
  supervise_process();
  end_runs_on_signals();
  Exit worst = Exit::done;
  std::vector<Checked> all;
  for (const Scenario& scenario : *scenarios) {
    tell_warnings(scenario);
    const Stopwatch stopwatch;
    auto checked = check_beside_others(settings, scenario);
    if (!checked) return refuse(checked.errors());
    worst = std::max(worst, exit_of(checked->report));
    checked->seconds = stopwatch.seconds();
    if (!settings.json) tell(*checked);
    all.push_back(*std::move(checked));
  }
  if (settings.json) print(all.size() == 1 ? json_of_check(all[0]) : json_of_checks(all));
  if (!settings.no_report) keep_index(*scenarios, all, !settings.json && all.size() > 1);
  std::vector<CiCase> cases;
  for (const Checked& checked : all) cases.push_back(ci_case(checked));
  if (!settings.junit.empty())
    if (const auto written = write_junit(settings.junit, cases); !written) return refuse(written.errors());
  if (settings.github && !settings.json)
    if (const auto printed = print_for_github(cases); !printed) return refuse(printed.errors());
  return worst;
}

void take_levels(const std::vector<std::string>& levels, CheckOptions& check) {
  check.controller = check.plant = check.closed = false;
  for (const std::string& level : levels) {
    if (level == "controller") {
      check.controller = true;
    } else if (level == "plant") {
      check.plant = true;
    } else if (level == "closed") {
      check.closed = true;
    } else {
      throw CLI::ValidationError("--level", fmt::format("'{}' is not controller, plant or closed", level));
    }
  }
}

std::function<Exit()> declare_check(CLI::App& options) {
  const auto settings = std::make_shared<CheckSettings>();
  options
      .add_option("SCENARIO", settings->scenarios,
                  "YAML files, or recordings of robots' logs; without one, all of the project that name a golden or "
                  "expect something. A project is the nearest folder above this one that has a folder golden, else a "
                  "CMakeLists.txt; its scenarios are below scenarios and fixtures/scenarios, its controllers in the "
                  "newest of the folders build*")
      ->type_name("");
  options.add_option("--golden", settings->golden, "compare with this trace instead of the scenario's golden")
      ->type_name("TRACE");
  options
      .add_option_function<std::vector<std::string>>(
          "--level",
          [=](const std::vector<std::string>& levels) {
            take_levels(levels, settings->check);
            settings->has_levels = true;
          },
          "what to compare: controller (recorded inputs, no physics), plant (recorded commands, no controller), closed "
          "(the whole loop); all three if not given")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LEVEL");
  options.add_flag("--no-report", settings->no_report,
                   "of a run that differs, write no HTML beside its trace to look at it in a browser");
  options.add_option("--junit", settings->junit, "write the verdicts as JUnit's XML, for continuous integration")
      ->type_name("FILE");
  options.add_flag("--github", settings->github,
                   "print workflow commands of GitHub Actions, and write the job's summary; by itself under "
                   "GITHUB_ACTIONS=true");
  add_host_options(options, settings->check.run);
  add_json_flag(options, settings->json);
  add_debugger_options(options, settings->debugger);
  add_integer(options, "--tick", "with --gdb: where to stop in the closed loop (0)", 0,
              std::numeric_limits<std::uint32_t>::max(), [=](std::int64_t tick) { settings->tick = tick; });
  options.get_option("--tick")->needs("--gdb");
  return [settings, &options] { return run_check(*settings, options); };
}

}  // namespace

const Verb check_verb{"check",
                      "  rehearse check\n"
                      "  rehearse check fixtures/scenarios/sr1_minimum.yaml --level controller\n"
                      "  rehearse check walk.yaml --golden yesterday.mcap --controller Walker=build/MyWalker.so\n",
                      declare_check};

}  // namespace rehearse::tool
