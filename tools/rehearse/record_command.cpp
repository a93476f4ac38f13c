// rehearse record: records one closed-loop run, or with --from-checkpoint a branch of a recording, in a trace.
#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/replaceable.h"
#include "command.h"
#include "control_times.h"
#include "core/check/check_json.h"
#include "core/check/own_run.h"
#include "core/check/unknown_series.h"
#include "core/guard/interruption.h"
#include "core/guard/own_process.h"
#include "core/guard/supervise.h"
#include "core/host/interposer.h"
#include "core/host/source_age.h"
#include "core/host/virtualised.h"
#include "core/scenario/scenario_variations.h"
#include "debugger.h"
#include "live_view.h"
#include "model_scenario.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "scenario_text.h"
#include "scenario_words.h"

namespace rehearse::tool {
namespace {

/// The options of a branch.
struct BranchSettings {
  bool quiet = false, json = false;
  std::string from;   // "TRACE@3.2s"; empty: not a branch
  std::string trace;  // empty: named like the source, in the working directory
  BranchOptions options;
};

struct RecordSettings {
  bool quiet = false;  // lines that controllers write aren't printed
  std::string scenario;
  ModelScenario model;        // instead of a scenario, if it names a model
  std::string alone;          // a library given without the name of a controller, for the model
  std::string save_scenario;  // output file for the model's scenario
  bool json = false;
  std::string trace;  // empty: named like the scenario, in the working directory
  std::optional<std::uint32_t> seed;
  std::optional<double> duration;  // [s]
  StatedValues values;
  bool no_frames = false;
  bool verify = false;
  std::optional<double> checkpoints;  // [s]
  std::optional<double> deadline;     // of control() [s]
  RecordOptions record;
  DebuggerOptions debugger;
  std::int64_t tick = 0;      // where gdb stops
  bool live = false;          // viewers see the run
  std::uint16_t port = 8765;  // of their server; 0: any free one
  BranchSettings branch;
};

/// Sets a different duration. Expectations at times that the run no longer reaches are removed, and so are expectations
/// at the end.
void set_duration(Scenario& scenario, double duration) {
  std::erase_if(scenario.expectations, [&](const Expectation& expectation) {
    const double last =
        std::max({expectation.from.value_or(0.0), expectation.until.value_or(0.0), expectation.at.value_or(0.0)});
    return last > duration || (expectation.at_end && duration < scenario.duration);
  });
  scenario.duration = duration;
}

/// Replaces the name of a scenario by its file.
Result<void> name_scenario(RecordSettings& settings) {
  std::error_code ignored;
  if (!settings.model.model.empty() || std::filesystem::is_directory(settings.scenario, ignored)) return {};
  const auto files = REHEARSE_TRY(files_named(settings.scenario));
  if (files.size() != 1) return error(fmt::format("{} has {} scenarios", settings.scenario, files.size()), "name one");
  settings.scenario = files[0];
  return {};
}

/// The scenario with all options applied.
Result<Scenario> load(const RecordSettings& settings) {
  Result<Scenario> scenario =
      settings.model.model.empty() ? load_with(settings.scenario, settings.values) : scenario_of_model(settings.model);
  if (!scenario) return scenario;
  if (settings.seed) scenario->seed = *settings.seed;
  if (settings.duration) set_duration(*scenario, *settings.duration);
  if (settings.no_frames) scenario->record_frames = false;
  if (scenario->ticks() < 1)
    return error(fmt::format("--duration {} is no tick", scenario->duration),
                 fmt::format("expected at least one time step, {} s", scenario->time_step));
  return scenario;
}

void tell_recording(const Scenario& scenario, const std::string& trace, const RunSummary& summary, double seconds) {
  if (summary.controller_refused && summary.ticks == 0) {
    fmt::print("{} didn't run: a controller refused to take part; {} has no tick\n", scenario.name, trace);
    return;
  }
  const double simulated = time_of(summary.ticks, scenario.time_step);
  fmt::print("recorded {}: {}\n", scenario.name, cast_of(scenario));
  fmt::print("{}, {:g} s of simulation, in {:.2f} s with loading: {:.3g} times real time\n",
             count_text(summary.ticks, "tick"), simulated, seconds, simulated / seconds);
  fmt::print("{}, {}{} in {}\n", count_text(summary.channels, "channel"), count_text(summary.pictures, "picture"),
             summary.bytes > 0 ? ", " + file_size_text(summary.bytes) : "", trace);
  tell_control_times(summary.control_times);
}

Json json_of_run(const RecordSettings& settings, const Scenario& scenario, const std::string& trace,
                 const RunSummary& summary, const std::vector<ExpectationResult>& judged,
                 const std::optional<Reproduction>& verified) {
  Json expectations = Json::array();
  for (const ExpectationResult& result : judged) expectations.push_back(json_of(result));
  return {{"scenario", scenario.name},
          {"trace", trace},
          {"ticks", summary.ticks},
          {"duration", time_of(summary.ticks, scenario.time_step)},
          {"channels", summary.channels},
          {"pictures", summary.pictures},
          {"bytes", summary.bytes},
          {"expectations", expectations},
          {"repeats_itself", verified ? Json(verified->reproduced()) : Json(nullptr)},
          {"failure", summary.failure ? json_of(Diagnostics{*summary.failure})[0] : Json(nullptr)},
          {"controller_refused", summary.controller_refused},
          {"control_times", json_of(summary.control_times)},
          {"remarks", json_of_remarks(summary.remarks, notes_on_old_libraries(scenario, settings.record))}};
}

/// Evaluates the scenario's expectations. Violations are only remarks, because the recording itself is valid. A run
/// that failed is not evaluated.
Result<std::vector<ExpectationResult>> judge(const Scenario& scenario, const std::string& trace, bool failed) {
  if (failed || scenario.expectations.empty()) return std::vector<ExpectationResult>();
  return judge_expectations(scenario.expectations, std::filesystem::path(trace));
}

/// Executes a sample of the recording again, to verify that it repeats itself.
Result<Reproduction> verify(const RecordSettings& settings, const Scenario& scenario, const std::string& trace) {
  const auto recording = REHEARSE_TRY(Trace::load(trace));
  Progress progress("verifying");
  ReproductionOptions trying;
  static_cast<HostOptions&>(trying) = settings.record;
  trying.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
  return reproduce(scenario, recording, trace + ".again", trying, {rehearse::record, run_plant});
}

Exit run_in_gdb(const RecordSettings& settings, const Scenario& scenario, const CLI::App& options) {
  if (const auto able = check_debugger(settings.debugger, scenario); !able) return refuse(able.errors());
  if (const auto there = check_tick(settings.tick, scenario.ticks(), scenario.time_step); !there)
    return refuse(there.errors());
  return become_gdb(settings.debugger, words_without_debugger("record", options), settings.tick);
}

/// Prints what controllers write to os() as it comes, on stderr.
auto teller(Progress& progress) {
  return [&progress](const std::string& controller, const std::string& line) {
    progress.hide();
    fmt::print(stderr, "{}: {}\n", plain_text(controller), plain_text(line));
  };
}

void tell_branch(const BranchSettings& settings, const BranchSummary& branch, double seconds) {
  fmt::print("branched off {} at tick {} ({:g} s): {}\n", settings.from.substr(0, settings.from.rfind('@')),
             branch.tick, branch.time, branch.world);
  const ReplayReport& before = branch.before;
  if (before.ticks > 0)
    fmt::print("before it the controllers, on the recorded inputs, {}\n",
               before.equal() ? "repeat their commands bit for bit" : "differ first at " + to_string(*before.first));
  fmt::print("{} simulated from there, in {:.2f} s\n", count_text(branch.run.ticks - branch.tick, "tick"), seconds);
  fmt::print("{}, {}, {}{} in {}\n", count_text(branch.run.ticks, "tick"), count_text(branch.run.channels, "channel"),
             count_text(branch.run.pictures, "picture"),
             branch.run.bytes > 0 ? ", " + file_size_text(branch.run.bytes) : "", settings.trace);
  tell_control_times(branch.run.control_times);
}

Json json_of_branch(const BranchSettings& settings, const BranchSummary& branch) {
  const ReplayReport& before = branch.before;
  return {{"from", settings.from},
          {"tick", branch.tick},
          {"time", branch.time},
          {"world", branch.world},
          {"first_before", before.ticks > 0 ? json_of(before.first) : Json(nullptr)},
          {"trace", settings.trace},
          {"ticks", branch.run.ticks},
          {"channels", branch.run.channels},
          {"pictures", branch.run.pictures},
          {"bytes", branch.run.bytes},
          {"failure", branch.run.failure ? json_of(Diagnostics{*branch.run.failure})[0] : Json(nullptr)},
          {"controller_refused", branch.run.controller_refused},
          {"control_times", json_of(branch.run.control_times)},
          {"remarks", json_of(branch.run.remarks)}};
}

/// Executes the branch and prints its report.
Exit record_branch_of(BranchSettings settings, std::optional<double> deadline) {
  const auto from = BranchPoint::parse(settings.from);
  if (!from) return refuse(error("--from-checkpoint: " + from.errors()[0].message));
  if (settings.trace.empty()) settings.trace = from->trace.stem().string() + ".branch.mcap";
  if (const auto allowed = check_replaceable(settings.trace, mcap_magic, "trace"); !allowed)
    return refuse(allowed.errors());
  if (const auto ready = virtualise_process_like(from->trace.string()); !ready) return refuse(ready.errors());
  InterposerWatch watch;
  if (is_interposed()) settings.options.watch = &watch;
  const Stopwatch stopwatch;
  const auto branch = [&] {
    Progress progress("branching");
    settings.options.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    if (!settings.quiet) settings.options.on_message = teller(progress);
    return record_branch(*from, settings.trace, settings.options);
  }();
  if (!branch) return refuse(branch.errors());
  if (branch->run.trace_changed) {
    refuse(*branch->run.failure);
    return Exit::controller_failed;
  }
  if (settings.json)
    print(json_of_branch(settings, *branch));
  else
    tell_branch(settings, *branch, stopwatch.seconds());
  std::fflush(stdout);  // before related output on stderr
  tell_remarks(branch->run);
  tell_missed_deadlines(branch->run.control_times, deadline);
  return branch->run.failure || branch->run.controller_refused ? Exit::controller_failed : Exit::done;
}

/// Records a branch of a recording. Refuses options that a branch can't have.
Exit run_branch(RecordSettings& settings) {
  for (const auto& [said, option] : {std::pair(settings.seed.has_value(), "--seed"),
                                     {!settings.values.empty(), "--with"},
                                     {settings.no_frames, "--no-frames"},
                                     {settings.verify, "--verify"},
                                     {settings.live, "--live"},
                                     {settings.checkpoints.has_value(), "--checkpoints"}})
    if (said)
      return refuse(error(fmt::format("{} with --from-checkpoint: a branch goes on as it was recorded", option)));
  if (settings.debugger.is_wanted())
    return refuse(error("--gdb with --from-checkpoint",
                        "record the branch, and look at it: rehearse replay BRANCH --gdb --tick N"));
  if (settings.duration && settings.branch.options.until)
    return refuse(error("--duration and --until: a branch has one end", "--duration counts from the moment"));
  static_cast<HostOptions&>(settings.branch.options) = settings.record;
  settings.branch.options.scenario = settings.scenario;
  settings.branch.options.duration = settings.duration;
  settings.branch.trace = settings.trace;
  settings.branch.quiet = settings.quiet;
  settings.branch.json = settings.json;
  supervise_process();
  end_runs_on_signals();
  return record_branch_of(settings.branch, settings.deadline);
}

/// Checks options that are valid only together with others.
Result<void> check_model_options(const RecordSettings& settings) {
  const bool has_model = !settings.model.model.empty();
  if (has_model && !settings.scenario.empty())
    return error("SCENARIO and --model: a run has one of them", "name the model in the scenario");
  if (!has_model && !settings.alone.empty())
    return error(fmt::format("--controller: '{}' is not NAME=LIB", settings.alone), "LIB alone goes with --model");
  const UrdfOptions& loading = settings.model.urdf;
  const bool has_loading = !loading.packages.empty() || loading.default_mass || loading.allow_missing_meshes ||
                           loading.allow_unknown_devices || loading.allow_unsupported || loading.mesh_z_up;
  if (!has_model && (has_loading || !settings.model.solver.empty()))
    return error(
        "--package, --default-mass, --mesh-up, --allow-missing-meshes, --allow-unknown-devices, --allow-unsupported "
        "and "
        "--solver go with --model",
        "a scenario states packages, default_mass, mesh_up, allow_missing_meshes, allow_unknown_devices and "
        "allow_unsupported of its bodies, and its solver");
  if (has_model && !settings.values.empty())
    return error("--with and --model: --with goes with a SCENARIO", "--save-scenario FILE makes one of the model");
  if (!has_model && !settings.save_scenario.empty())
    return error("--save-scenario writes the scenario of a --model", "expected --model URDF as well");
  if (!has_model && settings.scenario.empty())
    return error("rehearse record: SCENARIO is required, or --model URDF (see rehearse record --help)");
  return {};
}

/// Writes the scenario of a model if requested; then it is run like any other scenario.
Result<void> prepare_model(RecordSettings& settings) {
  if (!settings.alone.empty()) settings.model.controllers.push_back(settings.alone);
  settings.model.duration = settings.duration;
  if (settings.save_scenario.empty()) return {};
  settings.scenario = settings.save_scenario;
  auto saved = save_scenario(settings.model, settings.save_scenario);
  settings.model.model.clear();
  return saved;
}

/// Checks that the trace may be written, and can be read again if needed.
Result<void> check_trace(const RecordSettings& settings, const Scenario& scenario, const std::string& trace) {
  REHEARSE_TRY(check_replaceable(trace, mcap_magic, "trace"));
  std::error_code none;
  const bool readable = !std::filesystem::exists(trace, none) || std::filesystem::is_regular_file(trace, none);
  if (readable || (!settings.verify && scenario.expectations.empty())) return {};
  return error(fmt::format("{} can't be read again, as {} needs it", trace,
                           settings.verify ? "--verify" : "the check of expectations"),
               "write a file");
}

/// Executes the run and prints its report.
Exit record_scenario(RecordSettings& settings, const Scenario& scenario, const std::string& trace) {
  InterposerWatch watch;
  if (is_interposed()) settings.record.watch = &watch;
  const Stopwatch stopwatch;
  const Result<RunSummary> summary = [&] {
    Progress progress("recording");
    settings.record.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    if (!settings.quiet) settings.record.on_message = teller(progress);
    return own_run([&]() -> Result<RunSummary> { return record(scenario, trace, settings.record); });
  }();
  settings.record.on_message = nullptr;
  end_if_reader_is_gone();
  if (!summary) return refuse(summary.errors());
  if (summary->trace_changed) {
    refuse(*summary->failure);
    return Exit::controller_failed;
  }
  const double seconds = stopwatch.seconds();
  const bool failed = summary->failure || summary->controller_refused;
  const auto judged = judge(scenario, trace, failed);
  if (!judged) return refuse(judged.errors());
  CheckReport report;
  report.expectations = *judged;
  const Diagnostics mistakes = refuse_unknown_series(scenario, report, {trace}).errors();
  if (!settings.json) {
    tell_recording(scenario, trace, *summary, seconds);
    const std::string closest = closest_of(*judged);
    if (!judged->empty() && !first_violation(*judged))
      fmt::print("{}{}{}\n", verdict(*judged), closest.empty() ? "" : "; ", closest);
  }
  Exit exit = failed ? Exit::controller_failed : Exit::done;
  std::optional<Reproduction> verified;
  if (settings.verify && !failed) {
    auto tried = verify(settings, scenario, trace);
    if (!tried) return refuse(tried.errors());
    verified = *std::move(tried);
    if (!settings.json) fmt::print("{}\n", verified->verdict);
    if (!verified->reproduced()) exit = verified->failure ? Exit::controller_failed : Exit::differs;
  }
  if (settings.json) print(json_of_run(settings, scenario, trace, *summary, *judged, verified));
  std::fflush(stdout);  // before related output on stderr
  tell_remarks(*summary);
  tell_missed_deadlines(summary->control_times, settings.deadline);
  tell_violations(*judged, mistakes);
  return mistakes.empty() ? exit : Exit::bad_input;
}

/// True if an option was given that has a meaning only with --from-checkpoint, besides --set.
bool is_about_a_branch(const BranchSettings& settings) {
  return settings.options.until || !settings.options.push.empty();
}

Exit run_record(RecordSettings& settings, const CLI::App& options) {
  if (!settings.branch.from.empty()) return run_branch(settings);
  if (const auto whole = check_model_options(settings); !whole) return refuse(whole.errors());
  if (!settings.branch.options.set.empty())
    return refuse(
        error("--set changes the inputs of a branch",
              fmt::format("another value in the scenario: --with {}; a branch: --from-checkpoint TRACE@MOMENT",
                          settings.branch.options.set[0])));
  if (is_about_a_branch(settings.branch))
    return refuse(error("--until and --push are for branches", "expected --from-checkpoint TRACE@MOMENT as well"));
  if (const auto ready = prepare_model(settings); !ready) return refuse(ready.errors());
  if (const auto named = name_scenario(settings); !named) return refuse(named.errors());
  if (settings.checkpoints) settings.record.checkpoint_period = *settings.checkpoints;
  const Result<Scenario> scenario = load(settings);
  if (!scenario) return refuse(scenario.errors());
  if (settings.debugger.is_wanted()) return run_in_gdb(settings, *scenario, options);
  tell_warnings(*scenario);
  tell_old_libraries(notes_on_old_libraries(*scenario, settings.record));
  const std::string trace =
      settings.trace.empty() ? std::filesystem::path(scenario->file).stem().string() + ".mcap" : settings.trace;
  if (const auto allowed = check_trace(settings, *scenario, trace); !allowed) return refuse(allowed.errors());
  std::unique_ptr<LiveView> view;
  if (settings.live) {
    auto started = LiveView::start(trace, settings.port);
    if (!started) return refuse(started.errors());
    view = *std::move(started);
  }
  supervise_process();
  if (settings.verify) begin_own_processes();  // for the replay
  end_runs_on_signals();
  return record_scenario(settings, *scenario, trace);
}

/// Declares --from-checkpoint, --until, --set and --push.
void add_branch_options(CLI::App& options, BranchSettings& settings) {
  options
      .add_option(
          "--from-checkpoint", settings.from,
          "begin as this recording and go on from the moment, as TRACE@3.2s or TRACE@tick:640; scenario and models "
          "are the recording's (SCENARIO only if these have meshes), --duration counts from the moment")
      ->type_name("TRACE@MOMENT");
  add_number(options, "--until", "of a branch: the end as time of the run [s]", 0.0, Scenario::max_duration,
             [&settings](double until) { settings.options.until = until; });
  options
      .add_option("--set", settings.options.set,
                  "of a branch: alter inputs of controllers, as 'Walker/KNEE/q+=0.05@3.2s..3.4s'; repeatable")
      ->type_name("SERIES=VALUE")
      ->allow_extra_args(false);
  options
      .add_option("--push", settings.options.push,
                  "of a branch: push a link, as 'Walker/TRUNK force=0,0,50 @3.2s..3.3s'; torque=, at=; repeatable")
      ->type_name("PUSH")
      ->allow_extra_args(false);
}

std::function<Exit()> declare_record(CLI::App& options) {
  const auto settings = std::make_shared<RecordSettings>();
  options.add_option("SCENARIO", settings->scenario, "a YAML file")->type_name("");
  options.add_option("--model", settings->model.model, "instead of a scenario: this robot, standing on a floor")
      ->type_name("URDF");
  add_model_options(options, settings->model.urdf);
  options
      .add_option("--solver", settings->model.solver,
                  "with --model: direct (by the tree of joints; the default), quick (iterative) or exact (by ODE)")
      ->type_name("METHOD")
      ->check(CLI::IsMember({"quick", "exact", "direct"}));
  options
      .add_option("--save-scenario", settings->save_scenario,
                  "with --model: write the equivalent scenario to a new file, and run that")
      ->type_name("FILE");
  options.add_option("-o,--output", settings->trace, "the trace to write (SCENARIO.mcap in this folder)")
      ->type_name("TRACE");
  add_integer(options, "--seed", "instead of the scenario's", 0, std::numeric_limits<std::uint32_t>::max(),
              [=](std::int64_t seed) { settings->seed = static_cast<std::uint32_t>(seed); });
  add_number(options, "--duration", "simulated time [s], instead of the scenario's", 0.0, Scenario::max_duration,
             [=](double duration) { settings->duration = duration; });
  add_value_option(options, settings->values);
  add_number(options, "--checkpoints", "simulated time from one checkpoint to the next [s], 0: none (0.1)", 0.0,
             Scenario::max_duration, [=](double period) { settings->checkpoints = period; });
  options.add_flag("--verify", settings->verify,
                   "then run a sample of it again, from its checkpoints, and all its commands: does it repeat itself?");
  options.add_flag("--no-frames", settings->no_frames, "record no pictures; the cameras run all the same");
  CLI::Option* live = options.add_flag("--live", settings->live,
                                       "serve the run to Foxglove and Lichtblick while it goes on, as rehearse serve");
  add_integer(options, "--port", "of --live: a port of this machine; 0: any free one (8765)", 0, 65535,
              [=](std::int64_t port) { settings->port = static_cast<std::uint16_t>(port); })
      ->needs(live);
  options.add_flag("--quiet", settings->quiet, "don't print what controllers write to os(); the trace has it");
  add_host_options(options, settings->record, &settings->alone);
  add_timing_options(options, settings->deadline, settings->record);
  add_json_flag(options, settings->json);
  add_branch_options(options, settings->branch);
  add_debugger_options(options, settings->debugger);
  add_integer(options, "--tick", "with --gdb: where to stop (0)", 0, std::numeric_limits<std::uint32_t>::max(),
              [=](std::int64_t tick) { settings->tick = tick; });
  options.get_option("--tick")->needs("--gdb");
  return [settings, &options] { return run_record(*settings, options); };
}

}  // namespace

extern const Verb record_verb{
    "record",
    "  rehearse record fixtures/scenarios/sr1_minimum.yaml -o sr1.mcap\n"
    "  rehearse record --model robot.urdf --controller build/MyWalker.so --save-scenario walk.yaml\n"
    "  rehearse record walk.yaml --duration 5 --controller Walker=build/MyWalker.so\n"
    "  rehearse record --from-checkpoint walk.mcap@3.2s --push 'Walker/TRUNK force=0,80,0 @3.2s..3.3s'\n",
    declare_record};

}  // namespace rehearse::tool
