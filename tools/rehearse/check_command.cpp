// rehearse check: runs scenarios and compares them with their goldens.
#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "audit_mode.h"
#include "check_flight.h"
#include "check_history.h"
#include "check_outcome.h"
#include "command.h"
#include "control_times.h"
#include "core/check/compared.h"
#include "core/golden/run_folder.h"
#include "core/golden/stale_report.h"
#include "core/guard/interruption.h"
#include "core/guard/own_process.h"
#include "core/guard/supervise.h"
#include "core/host/source_age.h"
#include "core/host/virtualised.h"
#include "core/scenario/project.h"
#include "debugger.h"
#include "explanation.h"
#include "golden_conflicts.h"
#include "golden_verbs.h"
#include "line_advice.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "scenario_text.h"
#include "scenario_words.h"
#include "side_by_side.h"
#include "viewing/report/call_stack.h"
#include "viewing/report/report_index.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct CheckSettings {
  std::vector<std::string> scenarios;
  std::string golden;  // a trace to compare with; empty: the golden of each scenario
  std::string flight;  // instead, a robot's flight to compare with; empty: none
  bool json = false;
  bool no_report = false;
  std::string junit;  // output file; empty: none
  bool github = is_github();
  CheckOptions check;
  bool has_levels = false;    // the user named levels
  bool coverage = false;      // instead, list the lines that no golden executes
  bool instructions = false;  // instead, compare the instructions of control() with those kept beside goldens
  CoverageFiles coverage_files;
  StatedValues values;
  fs::path pending;                // where runs wait: in the project of the first scenario
  bool simulate = false;           // nothing is proved
  bool strict = false;             // goldens without an owner fail, too
  bool explain = false;            // also find the places that explain a failure
  bool verbose = false;            // the first differences are also printed in full
  std::optional<double> deadline;  // of control() [s]; none: any time is right
  std::int64_t jobs = 0;           // scenarios at a time; 0: as many as there are processors
  HistoryOptions history;
  std::optional<HistoryStamp> stamp;  // of the lines of the history; none: no history is kept
  DebuggerOptions debugger;
  std::int64_t tick = 0;  // where gdb stops
};

bool can_be_checked(const Scenario& scenario) { return !scenario.golden.empty() || !scenario.expectations.empty(); }

/// The golden that the scenario names; empty: none, or not known yet.
fs::path golden_in_store(const Scenario& scenario) {
  const auto folder = find_golden_folder(scenario.file);
  if (scenario.golden.empty() || !folder) return {};
  const GoldenStore store(*folder);
  return store.has(scenario.golden) ? store.trace_file(scenario.golden) : fs::path();
}

/// The trace that replaces the store's golden: --golden, or the log's recording from which the scenario was read;
/// empty: none. With --with it is the store's own: such a run can't become a golden, because the scenario doesn't make
/// it.
fs::path named_golden(const CheckSettings& settings, const Scenario& scenario) {
  if (!settings.golden.empty()) return settings.golden;
  if (!settings.values.empty()) return golden_in_store(scenario);
  const fs::path within = fs::path(scenario.file).parent_path();  // scenario_of() names it RECORDING/scenario.yaml
  return within.extension() == ".mcap" ? within : fs::path();
}

/// The trace with which the scenario will be compared; empty: none, or not known yet.
fs::path golden_of(const CheckSettings& settings, const Scenario& scenario) {
  fs::path named = named_golden(settings, scenario);
  return named.empty() ? golden_in_store(scenario) : named;
}

/// A golden whose controllers had simulated time and seeded random numbers is checked with them, which requires a
/// separate process. `several`: this process checks others, too.
Result<void> virtualise_like_golden(const CheckSettings& settings, const Scenario& scenario, bool several) {
  const fs::path golden = golden_of(settings, scenario);
  if (golden.empty()) return {};
  const auto trace = mcap::Reader::open(golden);
  if (!trace || !virtualised_seed(**trace)) return {};
  if (!several) return virtualise_process_like(golden);
  return error_in(scenario.file, "its golden was recorded with simulated time and seeded random numbers",
                  "check it by itself");
}

/// An interrupted run gets no verdict.
Result<RunSummary> record_whole(const Scenario& scenario, const fs::path& trace, const RecordOptions& options) {
  auto run = record(scenario, trace, options);
  if (run && run->failure && interruption() != 0) return *run->failure;
  return run;
}

/// As record_whole().
Result<ResumedRun> record_whole_from(const Scenario& scenario, const Trace& golden, std::int64_t moment,
                                     const fs::path& trace, const RecordOptions& options) {
  auto run = record_from(scenario, golden, moment, trace, options);
  if (run && run->summary.failure && interruption() != 0) return *run->summary.failure;
  return run;
}

/// `folder`: used by this run alone.
Result<CheckReport> check(const CheckSettings& settings, const Scenario& scenario, const fs::path& folder) {
  InterposerWatch watch;
  Progress progress("checking " + scenario.name,
                    settings.check.controller + settings.check.plant + settings.check.closed);
  CheckOptions options = settings.check;
  const auto proving = REHEARSE_TRY(proof_mode());
  if (proving.on && !settings.simulate) options.certificates = settings.pending / "proofs";
  options.sampled = proving.sampled;
  options.run.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
  if (is_interposed()) options.run.watch = &watch;
  const Simulation simulation{record_whole, run_plant, describe_plant, record_whole_from};
  if (const fs::path golden = named_golden(settings, scenario); !golden.empty())
    return check_scenario(scenario, golden, folder / (scenario.name + ".mcap"), options, simulation);
  const auto mode = REHEARSE_TRY(golden_mode());
  // check_golden reports a scenario that names no golden
  const auto goldens =
      REHEARSE_TRY(scenario.golden.empty() ? Result<fs::path>(fs::path()) : find_golden_folder(scenario.file));
  GoldenStore store(goldens, folder);
  return check_golden(scenario, store, mode, options, simulation);
}

/// The file name of a run's trace.
std::string name_of(const CheckSettings& settings, const Scenario& scenario) {
  const bool has_store = named_golden(settings, scenario).empty() && !scenario.golden.empty();
  return has_store ? scenario.golden : scenario.name;
}

/// Writes the report of a failed check. If it can't be written, the verdict doesn't change.
void add_page(const CheckSettings& settings, const Scenario& scenario, const fs::path& actual, Checked& checked) {
  if constexpr (has_viewing) {
    if (settings.no_report) return;
    if (checked.report.within() && !checked.report.failed()) return;
    if (const auto page = report_page(); !page) {
      if (!checked.report.within()) checked.no_page = page.errors()[0].message;
      return;
    }
    const auto allowed =
        check_replaceable(settings.pending / actual.filename().replace_extension(".html"), report_magic, "report");
    const fs::path golden = golden_of(settings, scenario);
    ReportOptions options;
    options.notes = checked.notes;
    if (!checked.line_advice.empty()) options.notes.push_back("this command finds the line: " + checked.line_advice);
    if (checked.report.controller == LevelState::differs)
      options.call_stack = call_stack_of(golden, settings.check.run);
    auto written = allowed ? write_failure_report(checked.report, scenario, golden, actual, std::move(options))
                           : Result<std::optional<FailureReport>>(allowed.errors());
    if (written) {
      checked.page = *std::move(written);
      return;
    }
    for (Diagnostic problem : written.errors()) {
      problem.severity = Severity::warning;
      fmt::print(stderr, "{}\n", to_string(problem));
    }
  } else if (!checked.report.within()) {
    checked.no_page = "this build leaves out the wing viewing";
  }
}

/// A run writes into a separate folder and is moved to the pending runs when it is complete; so other processes in this
/// folder never read a partial run. Prints the verdict before the report is written, which may wait seconds for gdb.
/// `notes`: on old libraries.
Result<Checked> check_beside_others(const CheckSettings& settings, const Scenario& scenario,
                                    const std::vector<std::string>& notes) {
  const std::string name = name_of(settings, scenario);
  const Stopwatch stopwatch;
  // of this process, which makes one run at a time: most are proved, and write nothing there
  static const auto own_folder = RunFolder::make(settings.pending);
  if (!own_folder) return own_folder.errors();
  WaitingRun waiting(*own_folder, name);
  auto report = check(settings, scenario, waiting.folder());
  end_if_reader_is_gone();
  if (interruption() != 0)
    return error(fmt::format("interrupted by SIG{}: {} was not judged", sigabbrev_np(interruption()), scenario.name));
  if (!report) return report.errors();
  Checked checked;
  checked.scenario = scenario.name;
  checked.file = scenario.file;
  checked.report = *std::move(report);
  checked.notes = notes;
  if (!compared_anything(checked.report))
    checked.report.verdict.lead(VerdictCode::undecided_nothing_compared, "nothing was compared");
  checked.seconds = stopwatch.seconds();
  if (!settings.json) tell_verdict(checked, settings.verbose);
  const fs::path golden = golden_of(settings, scenario);
  const bool explains = settings.explain && exit_of(checked.report) != Exit::done;
  if (!explains) checked.line_advice = line_advice(scenario, checked.report, golden, settings.check.run);
  add_page(settings, scenario, waiting.folder() / (name + ".mcap"), checked);
  const auto told = REHEARSE_TRY(waiting.publish(checked.report.message));
  if (!told.empty()) checked.report.remarks.push_back(told);
  if (checked.page) checked.page->file = settings.pending / checked.page->file.lexically_relative(waiting.folder());
  if (explains) checked.explanation = explain(scenario, checked.report, golden, settings.check.run);
  return checked;
}

/// Checks one scenario and prints the result.
Result<CheckOutcome> check_one(const CheckSettings& settings, const Scenario& scenario,
                               const std::vector<std::string>& notes) {
  tell_warnings(scenario);
  const auto checked = REHEARSE_TRY(check_beside_others(settings, scenario, notes));
  if (!settings.json) tell_files(checked, settings.verbose);
  tell_missed_deadlines(control_times_of(checked.report), settings.deadline);
  CheckOutcome outcome = outcome_of(scenario, checked, settings.json);
  outcome.history = history_line(settings.stamp, scenario.name, checked.report);
  return outcome;
}

/// Reads one of several scenarios and checks it. One that can't be judged doesn't end the others. None: the project's
/// file has nothing to check. `tells`: prints notes on old libraries.
Result<std::optional<CheckOutcome>> check_file(const CheckSettings& settings, const std::string& file, bool tells) {
  const auto scenario = read_scenario(file, settings.values);
  if (!scenario) {
    std::fputs(to_string(scenario.errors()).c_str(), stderr);
    const std::string name = fs::path(file).stem().string();
    auto unread = outcome_without_verdict(name, file, true, scenario.errors());
    unread.history = history_line(settings.stamp, name);
    return std::optional(std::move(unread));
  }
  if (settings.scenarios.empty() && !can_be_checked(*scenario)) return std::optional<CheckOutcome>();
  const std::vector<std::string> notes = notes_on_old_libraries(*scenario, settings.check.run);
  if (tells) tell_old_libraries(notes);
  const auto ready = virtualise_like_golden(settings, *scenario, true);
  auto outcome = ready ? check_one(settings, *scenario, notes) : Result<CheckOutcome>(ready.errors());
  if (outcome) return std::optional(*std::move(outcome));
  if (interruption() != 0) return outcome.errors();
  std::fputs(to_string(outcome.errors()).c_str(), stderr);
  auto unjudged = outcome_without_verdict(scenario->name, file, !scenario->golden.empty(), outcome.errors());
  unjudged.notes = notes;
  unjudged.history = history_line(settings.stamp, scenario->name);
  return std::optional(std::move(unjudged));
}

/// Checks each scenario in one of several processes, and adds the outcomes to `all`, in order.
Exit check_side_by_side(const CheckSettings& settings, const std::vector<std::string>& files, std::size_t jobs,
                        std::vector<CheckOutcome>& all) {
  std::size_t done = 0;
  const auto make = [&](std::size_t i) -> Result<MadePart> {
    begin_own_processes();
    const auto outcome = REHEARSE_TRY(check_file(settings, files[i], false));
    if (!outcome) return MadePart{};
    return MadePart{form_of(*outcome), outcome->exit == Exit::controller_failed};
  };
  const auto take = [&](const std::string& form) {
    const std::string& file = files[done++];
    if (form.empty()) return;
    auto outcome = outcome_in(form);
    if (!outcome)
      outcome = outcome_without_verdict(fs::path(file).stem().string(), file, true,
                                        {error("its process passed a damaged outcome", "check it alone: -j1")});
    all.push_back(*std::move(outcome));
    tell_old_libraries(all.back().notes);
  };
  const Exit ended = work_side_by_side(files.size(), jobs, make, take);
  if (ended == Exit::done || interruption() != 0 || done == files.size()) return ended;
  // a controller ended its process, which could pass no notes on
  if (const auto scenario = read_scenario(files[done], settings.values))
    tell_old_libraries(notes_on_old_libraries(*scenario, settings.check.run));
  return ended;
}

/// Checks the scenarios and adds their outcomes to `all`, in order.
Exit check_several(const CheckSettings& settings, const std::vector<std::string>& files,
                   std::vector<CheckOutcome>& all) {
  const std::size_t jobs = settings.jobs > 0 ? static_cast<std::size_t>(settings.jobs) : processors();
  if (jobs > 1) return check_side_by_side(settings, files, jobs, all);
  supervise_process();
  begin_own_processes();
  end_runs_on_signals();
  for (const std::string& file : files) {
    auto outcome = check_file(settings, file, true);
    if (!outcome) return refuse(outcome.errors());
    if (*outcome) all.push_back(**std::move(outcome));
  }
  return Exit::done;
}

/// Checks the only scenario, and adds its outcome to `all`.
Exit check_alone(const CheckSettings& settings, const Scenario& scenario, std::vector<CheckOutcome>& all) {
  if (const auto ready = virtualise_like_golden(settings, scenario, false); !ready) return refuse(ready.errors());
  const std::vector<std::string> notes = notes_on_old_libraries(scenario, settings.check.run);
  tell_old_libraries(notes);
  supervise_process();
  begin_own_processes();
  end_runs_on_signals();
  auto outcome = check_one(settings, scenario, notes);
  if (!outcome) return refuse(outcome.errors());
  all.push_back(*std::move(outcome));
  return Exit::done;
}

/// Compares only the closed loop unless the user named levels: otherwise the level in which gdb stops would be
/// undefined.
Exit run_in_gdb(const CheckSettings& settings, const Scenario& scenario, const CLI::App& options) {
  if (const auto able = check_debugger(settings.debugger, scenario); !able) return refuse(able.errors());
  if (const auto there = check_tick(settings.tick, scenario.ticks(), scenario.time_step); !there)
    return refuse(there.errors());
  std::vector<std::string> words = words_without_debugger("check", options);
  if (!settings.has_levels) {
    words.insert(words.begin() + 1, "--level=closed");
    fmt::print("stopping in the closed loop; the other levels are not compared\n");
  }
  words.insert(words.begin() + 1, "--simulate");
  return become_gdb(settings.debugger, words, settings.tick);
}

/// Reports goldens that no check and no test compares with, and goldens that can't be used.
Exit check_strictly() {
  const auto store = open_store();
  if (!store) return refuse(store.errors());
  const auto entries = list_goldens(*store, {store->folder() / ".."}, {});
  if (!entries) return refuse(entries.errors());
  Diagnostics found;
  for (const GoldenEntry& entry : *entries) {
    const std::string file = store->trace_file(entry.name).string();
    if (entry.orphan())
      found.push_back(error_in(file, "no test that ran here and no scenario names this golden",
                               "rehearse golden prune removes it; --strict comes after the tests"));
    if (!entry.problem.empty()) found.push_back(error_in(file, "this golden can't be used: " + entry.problem));
  }
  std::fputs(to_string(found).c_str(), stderr);
  return found.empty() ? Exit::done : Exit::differs;
}

/// Continues as `audit` in this mode with the goldens of these scenarios.
Exit audit_goldens(std::string_view mode, const CheckSettings& settings, const std::vector<std::string>& files,
                   const CLI::App& options, const std::vector<std::string>& more = {}) {
  std::vector<fs::path> goldens;
  for (const std::string& file : files) {
    const auto scenario = read_scenario(file, settings.values);
    if (!scenario) return refuse(scenario.errors());
    if (fs::path golden = golden_of(settings, *scenario); !golden.empty()) goldens.push_back(std::move(golden));
  }
  if (goldens.empty())
    return refuse(error(fmt::format("{} replays goldens, and there is none yet", mode), "record one first"));
  return continue_in_audit(mode, goldens, options, more);
}

Exit run_check(CheckSettings& settings, const CLI::App& options) {
  const auto files = settings.scenarios.empty() ? files_of_project() : files_named(settings.scenarios);
  if (!files) return refuse(files.errors());
  if (files->empty()) return refuse(nothing_to_check());
  settings.pending = pending_folder(settings.scenarios.empty() ? "./" : files->front());
  if (!settings.values.empty())
    if (const auto mode = golden_mode(); mode && *mode != GoldenMode::check)
      return refuse(error("--with changes the scenario, so no run of it becomes a golden",
                          "change the file, or leave REHEARSE_GOLDEN out"));
  if (settings.coverage) return audit_goldens("--coverage", settings, *files, options);
  if (settings.instructions) return audit_goldens("--instructions", settings, *files, options, {"--judge"});
  const bool alone = files->size() == 1;
  if (settings.debugger.is_wanted() && !alone)
    return refuse(error("--gdb stops in one scenario", "name that scenario"));
  if (!settings.flight.empty() && (!alone || settings.debugger.is_wanted()))
    return refuse(error("--flight compares one scenario, without --gdb",
                        "name that scenario; rehearse replay FLIGHT --gdb stops in its controller"));
  if (!settings.golden.empty() && !alone) return refuse(error("--golden compares one scenario", "name that scenario"));
  std::optional<Scenario> only;
  if (alone) {
    auto scenario = read_scenario(files->front(), settings.values);
    if (!scenario) return refuse(scenario.errors());
    if (!settings.flight.empty())
      return check_with_flight(*scenario, settings.flight, settings.check.run, settings.json);
    if (settings.scenarios.empty() && !can_be_checked(*scenario)) return refuse(nothing_to_check());
    if (settings.debugger.is_wanted()) return run_in_gdb(settings, *scenario, options);
    only = *std::move(scenario);
  }
  if (settings.golden.empty())
    if (const auto own = check_owners(*files); !own) return refuse(own.errors());
  if (!settings.history.file.empty()) {
    auto stamp = stamp_of(settings.history);
    if (!stamp) return refuse(stamp.errors());
    settings.stamp = *std::move(stamp);
  }
  std::vector<CheckOutcome> all;
  const Exit ended = only ? check_alone(settings, *only, all) : check_several(settings, *files, all);
  if (ended != Exit::done || interruption() != 0) return ended;
  if (all.empty()) return refuse(nothing_to_check());
  Exit worst = Exit::done;
  for (const CheckOutcome& outcome : all) worst = worse(worst, outcome.exit);
  if (settings.json) print(all.size() == 1 ? all[0].json : json_of_checks(all));
  const bool is_one_failed = all.size() == 1 && all[0].exit == Exit::controller_failed;
  if (!settings.no_report) keep_index(all, settings.pending, !settings.json && !is_one_failed);
  tell_unjudged(all);
  if (settings.stamp)
    if (const auto appended = append_outcomes(settings.history, all); !appended) return refuse(appended.errors());
  if (!settings.junit.empty())
    if (const auto written = write_junit(settings.junit, all); !written) return refuse(written.errors());
  if (settings.github && !settings.json)
    if (const auto printed = print_for_github(all); !printed) return refuse(printed.errors());
  if (!settings.strict) return worst;
  std::fflush(stdout);  // before related output on stderr
  return worse(worst, check_strictly());
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
                  "YAML files, folders of them, names of the project's scenarios or goldens, or recordings of robots' "
                  "logs; without one, all of the project that name a golden or expect something. A project is the "
                  "nearest folder above this one that has a folder golden, else a CMakeLists.txt, a pyproject.toml or "
                  "a pytest.ini; its scenarios are below scenarios and fixtures/scenarios, its controllers in the "
                  "newest of its builds: a folder build*, or another with a CMakeCache.txt")
      ->type_name("");
  add_value_option(options, settings->values);
  options.add_option("--golden", settings->golden, "compare with this trace instead of the scenario's golden")
      ->type_name("TRACE");
  options
      .add_option(
          "--flight", settings->flight,
          "instead: a recording of a robot's loop (rehearse tap): is the controller the robot's, and from which "
          "tick on does the world differ from the robot?")
      ->type_name("FLIGHT")
      ->excludes("--golden");
  options
      .add_option_function<std::vector<std::string>>(
          "--level",
          [=](const std::vector<std::string>& levels) {
            take_levels(levels, settings->check);
            settings->has_levels = true;
          },
          "the levels to compare: controller (recorded inputs, no physics), plant (recorded commands, no controller), "
          "closed (the whole loop); all three if not given")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LEVEL");
  options.add_flag(
      "--simulate", settings->simulate,
      "simulate even if it is proved that the world is the one that made the golden. REHEARSE_PROOF=off has the same "
      "effect; REHEARSE_PROOF=sample:20 in a fifth of the checks");
  options.add_flag(
      "--instructions", settings->instructions,
      "instead: compare the instructions of each control() with those kept beside the goldens, by valgrind; "
      "REHEARSE_GOLDEN=new keeps them where there are none, and accept in place of others");
  options
      .add_flag("--coverage", settings->coverage,
                "instead: list the lines of the controllers that no golden executes, as audit --coverage does")
      ->excludes(options.get_option("--instructions"));
  add_coverage_files(options, settings->coverage_files);
  options.add_flag(
      "--explain", settings->explain,
      "also find where to look after a failure: the changed key, the line of the controller that writes the first "
      "differing command (by gdb), the violated expectation; and name the next commands");
  options.add_flag("-v,--verbose", settings->verbose,
                   "also print the first differences in full, with relative errors and ULPs, and the times of "
                   "control()");
  add_deadline_option(options, settings->deadline);
  options.add_flag("--strict", settings->strict,
                   "fail also (status 1) if the project has a golden that no scenario names and no test that ran here, "
                   "or one that can't be used");
  add_integer(options, "-j,--jobs", "scenarios to check at a time, in as many processes (one for each processor)", 1,
              1024, [=](std::int64_t jobs) { settings->jobs = jobs; });
  options.add_flag("--no-report", settings->no_report,
                   "write no report for a browser (HTML) beside the trace of a run that differs");
  options.add_option("--junit", settings->junit, "write the verdicts as JUnit's XML, for continuous integration")
      ->type_name("FILE");
  options.add_flag("--github", settings->github,
                   "print workflow commands of GitHub Actions, and write the job's summary; by itself under "
                   "GITHUB_ACTIONS=true");
  add_history_options(options, settings->history);
  add_host_options(options, settings->check.run);
  add_json_flag(options, settings->json);
  add_debugger_options(options, settings->debugger);
  add_integer(options, "--tick", "with --gdb: where to stop in the closed loop (0)", 0,
              std::numeric_limits<std::uint32_t>::max(), [=](std::int64_t tick) { settings->tick = tick; });
  options.get_option("--tick")->needs("--gdb");
  return [settings, &options] { return run_check(*settings, options); };
}

}  // namespace

extern const Verb check_verb{
    "check",
    "  rehearse check\n"
    "  rehearse check fixtures/scenarios/sr1_minimum.yaml --level controller\n"
    "  rehearse check walk.yaml --golden yesterday.mcap --controller Walker=build/MyWalker.so\n"
    "  rehearse check walk.yaml --flight friday.mcap\n",
    declare_check};

}  // namespace rehearse::tool
