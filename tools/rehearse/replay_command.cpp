// rehearse replay: feeds recorded inputs to the controllers, without physics, and compares their commands bit for bit.
// For the log of a real robot see replay_log.h, for single ticks replay_ticks.h, for gdb debugger.h.
#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "audit_mode.h"
#include "base/replaceable.h"
#include "command.h"
#include "control_times.h"
#include "core/check/check_json.h"
#include "core/check/own_run.h"
#include "core/guard/child_process.h"
#include "core/guard/interruption.h"
#include "core/guard/own_process.h"
#include "core/guard/supervise.h"
#include "core/host/source_age.h"
#include "core/host/turn_order_file.h"
#include "core/host/virtualised.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "debugger.h"
#include "flight.h"
#include "lockstep.h"
#include "log_verbs.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "replay_ticks.h"
#include "replay_verdict.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

struct ReplaySettings {
  std::string trace;
  bool json = false;
  bool instructions = false, coverage = false;
  CoverageFiles coverage_files;
  std::string beside;
  std::string order;  // the file of an order of threads
  ReplayOptions replay;
  std::optional<double> deadline;  // of control() [s]
  std::string output;
  TickSettings ticks;
  DebuggerOptions debugger;
  // for a log
  std::string controller, model, map, scenario;
  TimeSpan span;

  std::optional<Flight> flight;

  bool is_of_a_flight() const { return flight.has_value(); }
  bool is_of_a_log() const { return !map.empty() || !model.empty(); }
};

void tell(const ReplaySettings& settings, const ReplayReport& report, double seconds) {
  fmt::print("replayed {}: {} without physics in {:.3f} s with loading\n", settings.trace,
             count_text(report.ticks, "tick"), seconds);
  if (settings.flight) fmt::print("{}\n", mathematics_line(*settings.flight));
  tell_control_times(report.control_times);
  fmt::print("{}{}\n", settings.replay.set.empty() ? "" : "with inputs altered: ", replay_verdict(report));
  if (report.words.first)
    fmt::print("their messages differ, too, which doesn't change the verdict: {}\n", to_string(*report.words.first));
  if (!report.first) return;
  if (report.beyond && report.first->tick < report.beyond->tick)
    fmt::print("its bits differ from tick {} on\n", report.first->tick);
  fmt::print("worst: {}\n", to_string(*report.worst));
  fmt::print("{} of {} and {} of {} differ\n", report.ticks_different, count_text(report.ticks, "tick"),
             report.values_different, count_text(report.values, "commanded number"));
}

/// Continues in gdb with the same arguments.
Exit run_in_gdb(const ReplaySettings& settings, const CLI::App& options) {
  const std::vector<std::string> words = words_without_debugger("replay", options);
  if (settings.is_of_a_log()) return replay_log_in_gdb(settings.debugger, words, settings.ticks.tick);
  return replay_in_gdb(settings.debugger, settings.trace, settings.replay, words, settings.ticks.tick);
}

/// Continues as a mode of audit with the same arguments.
Exit audit_recording(std::string_view mode, const ReplaySettings& settings, const CLI::App& options) {
  if (settings.is_of_a_log())
    return refuse(
        error(fmt::format("{} is for recordings", mode), "replay the log into one with -o, and examine that"));
  return continue_in_audit(mode, {std::filesystem::path(settings.trace)}, options);
}

/// Checks options that only a log needs, or only a recording.
Result<void> check_usage(const ReplaySettings& settings) {
  if (settings.debugger.is_wanted() &&
      (settings.ticks.at || !settings.ticks.watch.empty() || !settings.ticks.when.empty()))
    return error("--gdb goes with none of --at, --watch and --when", "--gdb --tick N stops at that tick");
  if (!settings.replay.set.empty() && (settings.ticks.is_asked() || settings.debugger.is_wanted()))
    return error("--set with --tick, --at, --watch, --when or --gdb",
                 "write the altered run with -o BRANCH, and look at that");
  if (!settings.output.empty() && (settings.ticks.is_asked() || settings.debugger.is_wanted()))
    return error("-o with --tick, --at, --watch, --when or --gdb: these write nothing", "leave one of them out");
  if (!settings.beside.empty() &&
      (settings.is_of_a_log() || settings.instructions || settings.coverage || settings.ticks.is_asked() ||
       settings.debugger.is_wanted() || !settings.output.empty() || settings.span.from))
    return error("--beside compares two libraries in whole recordings, or with --until in the beginning of one",
                 "leave out the other options that choose what replay does");
  if (!settings.order.empty() &&
      (settings.is_of_a_log() || settings.instructions || settings.coverage || !settings.beside.empty()))
    return error("--order with --beside, --instructions, --coverage or a robot's log: these replay in the usual order",
                 "leave one of them out");
  if (!settings.is_of_a_log()) {
    if (!settings.scenario.empty() && !settings.is_of_a_flight())
      return error("--scenario is for a flight, or for a robot's log, with --model and --map");
    if (!settings.scenario.empty() && settings.controller.empty())
      return error("--scenario without --controller", "--controller LIB is the controller of the scenario");
    if (!settings.controller.empty() && !settings.is_of_a_flight())
      return error(fmt::format("--controller '{}' is not NAME=LIB", settings.controller),
                   "a library alone is for a robot's log, with --model and --map");
    if (settings.output.empty()) return {};
    return check_replaceable(settings.output, mcap_magic, "trace");
  }
  if (!settings.replay.set.empty()) return error("--set is for recordings: the map of a log determines its inputs");
  if (settings.map.empty()) return error("--model without --map", "--map FILE assigns topics to inputs");
  if (settings.model.empty()) return error("--map without --model", "--model ROBOT.urdf is the robot of the log");
  if (settings.controller.empty() || !settings.replay.libraries.empty())
    return error("a robot's log names no controllers", "expected --controller LIB, a name or a path, once");
  return {};
}

Exit run_log(const ReplaySettings& settings) {
  LogSettings log;
  log.log = settings.trace;
  log.trace = settings.output;
  log.scenario = settings.scenario;
  log.json = settings.json;
  log.deadline = settings.deadline;
  static_cast<HostOptions&>(log.replay) = settings.replay;
  log.replay.controller = settings.controller;
  log.replay.model = settings.model;
  log.replay.map = settings.map;
  log.replay.from = settings.span.from;
  log.replay.until = settings.span.until;
  return replay_log_of(std::move(log));
}

Exit run_ticks(ReplaySettings& settings) {
  if (settings.is_of_a_log())
    return refuse(error("a robot's log has no ticks before it is replayed",
                        "replay it into a recording, and look at that: rehearse replay LOG.replay.mcap --tick N"));
  TickSettings& ticks = settings.ticks;
  ticks.trace = settings.trace;
  ticks.host = settings.replay;
  ticks.from = settings.replay.from;
  ticks.until = settings.replay.until;
  ticks.json = settings.json;
  if constexpr (has_viewing) {
    if (const auto usable = check_usage(ticks); !usable) return refuse(usable.errors());
    return show_ticks(ticks);
  } else {
    return refuse(left_out("--tick, --at, --watch and --when", "viewing"));
  }
}

/// A recording that can't be read is reported by its replay.
std::vector<std::string> notes_on_libraries_of(const ReplaySettings& settings) {
  const auto reader = mcap::Reader::open(settings.trace);
  const auto scenario = reader ? scenario_of(**reader) : Result<Scenario>(reader.errors());
  return scenario ? notes_on_old_libraries(*scenario, settings.replay) : std::vector<std::string>();
}

Exit run_replay(ReplaySettings& settings, const CLI::App& options) {
  settings.flight = settings.is_of_a_log() ? std::nullopt : flight_in(settings.trace);
  if (settings.is_of_a_flight()) {
    take_mathematics_of(*settings.flight);
    if (!settings.controller.empty())
      settings.replay.libraries.emplace(settings.flight->controller, settings.controller);
  }
  if (const auto usable = check_usage(settings); !usable) return refuse(usable.errors());
  if (settings.is_of_a_flight() && !settings.scenario.empty())
    if (const auto ended = continue_with_logs("the scenario of a flight")) return *ended;
  if (!settings.order.empty())
    if (const auto order = take_turn_order(settings.order); !order) return refuse(order.errors());
  if (settings.instructions) return audit_recording("--instructions", settings, options);
  if (settings.coverage) return audit_recording("--coverage", settings, options);
  if (!settings.beside.empty())
    return replay_beside(settings.trace, settings.beside, settings.replay, settings.json, options);
  if (settings.debugger.is_wanted()) return run_in_gdb(settings, options);
  std::vector<std::string> notes;
  if (!settings.is_of_a_log()) {
    const auto span = seconds_in(settings.span, settings.trace);
    if (!span) return refuse(span.errors());
    settings.replay.from = span->from.value_or(0.0);
    settings.replay.until = span->until;
    if (const auto ready = virtualise_process_like(settings.trace); !ready) return refuse(ready.errors());
    notes = notes_on_libraries_of(settings);
    tell_old_libraries(notes);
  }
  if (settings.is_of_a_log()) return settings.ticks.is_asked() ? run_ticks(settings) : run_log(settings);
  supervise_process();
  if (!settings.output.empty()) begin_own_processes();  // the file is written by a second replay
  end_runs_on_signals();
  InterposerWatch watch;
  if (is_interposed()) settings.replay.watch = &watch;
  if (settings.ticks.is_asked() || settings.ticks.every != 1 || settings.ticks.full) return run_ticks(settings);
  const Stopwatch stopwatch;
  const Result<ReplayReport> report = [&] {
    Progress progress("replaying");
    settings.replay.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    return settings.output.empty() ? replay(settings.trace, settings.replay)
                                   : own_replay(settings.trace, settings.replay);
  }();
  end_if_reader_is_gone();
  if (!report) return refuse(report.errors());
  if (!settings.output.empty())
    if (const auto written = own_run([&] { return write_replay(settings.trace, settings.output, settings.replay); });
        !written)
      return refuse(written.errors());
  if (!settings.scenario.empty())
    if (const auto saved = save_scenario_of_flight(settings.trace, settings.controller, settings.scenario); !saved)
      return refuse(saved.errors());
  if (settings.json) {
    print(replay_json(*report, notes));
  } else {
    tell(settings, *report, stopwatch.seconds());
    std::fflush(stdout);  // before related output on stderr
    tell_remarks(report->remarks, report->failure);
    tell_missed_deadlines(report->control_times, settings.deadline);
  }
  if (report->failure || report->controller_refused) return Exit::controller_failed;
  if (report->equal() && report->values == 0) return Exit::bad_input;
  return replay_holds(*report) ? Exit::done : Exit::differs;
}

std::function<Exit()> declare_replay(CLI::App& options) {
  const auto settings = std::make_shared<ReplaySettings>();
  options.add_option("TRACE", settings->trace, "the recording; or, with --model and --map, a robot's log (MCAP)")
      ->required()
      ->type_name("");
  add_time_span(options, settings->span, "compare from this time on; the replay starts at the beginning anyway",
                "end at this time");
  options
      .add_option(
          "--set", settings->replay.set,
          "alter inputs of the controllers, as 'Walker/KNEE/q=0.3@tick:1200..1300'; +=, *=, nan, 30deg; repeatable")
      ->type_name("SERIES=VALUE")
      ->allow_extra_args(false);
  add_host_options(options, settings->replay, &settings->controller);
  add_timing_options(options, settings->deadline, settings->replay);
  options.add_flag("--instructions", settings->instructions,
                   "instead: count the instructions of each control() under valgrind, as audit --instructions does");
  options.add_flag("--coverage", settings->coverage,
                   "instead: list the lines of the controllers that the recording never executes, as audit --coverage "
                   "does");
  add_coverage_files(options, settings->coverage_files);
  options
      .add_option("--beside", settings->beside,
                  "instead: find the first number and line in which a controller differs from its old library: a file, "
                  "a commit that is built, or 'recorded'; by gdb")
      ->type_name("[NAME=]OLD");
  add_integer(options, "--tick",
              "show this tick: inputs, commands, measurements, messages, changes, differences; with --gdb: stop there",
              0, std::numeric_limits<std::int64_t>::max() / 2, [=](std::int64_t tick) { settings->ticks.tick = tick; });
  add_number(options, "--at", "the same by its time [s]", 0.0, longest_time,
             [=](double at) { settings->ticks.at = at; });
  options
      .add_option("--order", settings->order,
                  "the threads of controllers take turns in the order of this file, which audit --orders writes")
      ->type_name("FILE");
  options.add_flag("--full", settings->ticks.full, "of a tick: also unchanged values");
  options.add_option("--watch", settings->ticks.watch, "print these series, a row a tick; of a tick: these only")
      ->type_name("GLOB");
  add_integer(options, "--every", "of --watch: a row each so many ticks", 1, 1'000'000'000,
              [=](std::int64_t every) { settings->ticks.every = every; });
  options
      .add_option("--when", settings->ticks.when,
                  "find the ticks in which this is true: 'KNEE/u > 100 && contact(FOOT)'")
      ->type_name("EXPR");
  options.add_option("--model", settings->model, "of a log: the robot")->type_name("URDF");
  options.add_option("--map", settings->map, "of a log: the YAML file that assigns topics to inputs")
      ->type_name("FILE");
  options
      .add_option("--scenario", settings->scenario,
                  "of a log or a flight: write a scenario that begins as it did, with its posture and joystick")
      ->type_name("FILE");
  options
      .add_option(
          "-o,--output", settings->output,
          "the trace to write: the recording with the present commands (of a log: LOG.replay.mcap in this folder)")
      ->type_name("TRACE");
  add_json_flag(options, settings->json);
  add_debugger_options(options, settings->debugger);
  return [settings, &options] { return run_replay(*settings, options); };
}

}  // namespace

extern const Verb replay_verb{
    "replay",
    "  rehearse replay sr1.mcap\n"
    "  rehearse replay failed.mcap --controller Walker=build/MyWalker.so --from 3.0 --until 3.5\n"
    "  rehearse replay failed.mcap --tick 3200\n"
    "  rehearse replay failed.mcap --watch 'Walker/KNEE/*' --from 3.0 --until 3.5 --every 10\n"
    "  rehearse replay failed.mcap --when 'Walker/KNEE/u > 100 && contact(LEFT_FOOT)'\n"
    "  rehearse replay failed.mcap --gdb --tick 3204\n"
    "  rehearse replay walk.mcap --set 'Walker/KNEE/q=nan@tick:1200' -o what_if.mcap\n"
    "  rehearse replay flight.mcap --controller build/libWalk.so\n"
    "  rehearse replay robot.mcap --controller build/MyWalker.so --model walker.urdf --map walker.map.yaml\n",
    declare_replay};

}  // namespace rehearse::tool
