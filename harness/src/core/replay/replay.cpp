#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "altered_inputs.h"
#include "base/clock.h"
#include "core/guard/float_mode.h"
#include "core/host/controller_host.h"
#include "core/mcap/whole_input.h"
#include "core/recording/mathematics.h"
#include "core/run/hosted_commands.h"
#include "core/run/run.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "recorded_files.h"
#include "recorded_inputs.h"
#include "recording_source.h"
#include "replay_comparison.h"
#include "replay_conditions.h"
#include "replay_recording.h"

namespace rehearse {
namespace {

/// Fails if inputs of the controllers weren't recorded.
Result<void> check_inputs(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host,
                          const RecordingSource& source) {
  if (!source.has_ticks()) return in_recording(recording, error("it has no ticks: nothing of the run was recorded"));
  if (Diagnostics missing = unrecorded_inputs(recording, scenario, host, source.inputs()); !missing.empty())
    return missing;
  return {};
}

/// True if the requested part was replayed: damage after it has no effect.
bool is_enough(const ReplayOptions& options, const RecordingSource& source, double reached) {
  return source.was_cut_short() || (options.until && reached >= *options.until);
}

/// Lets the run make all ticks. An early end or omitted data is an error or, if damage is tolerated, a warning.
Result<void> replay_ticks(Run& run, RecordingSource& source, ReplayComparison& comparison, const Scenario& scenario,
                          const ReplayOptions& options, Damage damage, ReplayReport& report) {
  std::vector<std::uint16_t> channels = source.channels();
  channels.insert(channels.end(), comparison.channels().begin(), comparison.channels().end());
  const auto take = [&](const mcap::Message& message) { return comparison.take(message); };
  const auto driven = source.drive(run, take, channels);
  Diagnostics errors = source.damage();
  errors.insert(errors.end(), driven.errors().begin(), driven.errors().end());
  if (run.interruption()) errors = {*run.interruption()};
  if (damage == Damage::tolerate) {
    append_as_warnings(std::move(errors), report.remarks);
    return {};
  }
  if (!driven || run.interruption()) return errors;
  if (source.damage().empty() || is_enough(options, source, time_of(run.tick(), scenario.time_step))) return {};
  return source.damage();
}

Result<ReplayReport> replay_into(mcap::Reader& recording, const Scenario& scenario, const ReplayOptions& options,
                                 Damage damage, ControllerHost& host) {
  ReplayReport report;
  report.controllers = static_cast<int>(host.controllers().size());
  append_as_warnings(other_clock_than(recording), report.remarks);
  const std::vector<ToleranceRule>& rules = options.tolerances ? *options.tolerances : scenario.tolerances;
  SeriesScales scales = scales_of(recording.name(), rules);  // before a controller can change the working folder
  const Command first = host.initialize(initial_observation(scenario));
  host.start();
  AlteredInputs altered;
  RecordingSource source(scenario, recording, host, altered);
  REHEARSE_TRY(check_inputs(recording, scenario, host, source));
  altered = REHEARSE_TRY(AlteredInputs::parse(options.set, scenario));
  REHEARSE_TRY(altered.check_read_by(host));
  if (options.until) source.end_before(static_cast<std::uint64_t>(std::llround(std::max(0.0, *options.until) * 1e9)));

  report.other_inputs = other_inputs(recording, scenario, host, source.inputs());
  ReplayComparison comparison(options, rules, scenario, recording, host, source, std::move(scales), report);
  HostedCommands commands(host, HostedCommands::Written::never);
  Run run(scenario.time_step, source, commands, comparison, 0, Run::no_end);
  run.report_progress(options.progress, scenario.ticks());
  const bool same_channels = has_channels_of(recording, scenario, host);
  comparison.take_events();
  comparison.compare_initial(first);
  if (!host.failure()) REHEARSE_TRY(replay_ticks(run, source, comparison, scenario, options, damage, report));
  if (source.was_cut_short()) comparison.end_lines();  // the recorded controllers were not stopped there
  host.stop(report.ticks);
  comparison.take_events();
  if (!source.was_cut_short()) comparison.end_lines();
  REHEARSE_TRY(comparison.finish());
  append_as_warnings(altered.unused(), report.remarks);
  report.failure = host.failure();
  report.controller_refused = host.any_refused();
  report.control_times = host.control_times();
  report.repeats_the_run = same_channels && report.other_inputs.empty() && comparison.repeats_all() && report.equal() &&
                           report.words.different == 0 && !report.controller_refused &&
                           (source.last_state() || host.controllers().empty()) && options.from == 0.0 &&
                           !source.alters();
  report.other_controllers = other_controllers(recording, host);
  report.changed_files = changed_files(recording, host);
  report.same_controllers = report.other_controllers.empty() && !host.has_other_options();
  return report;
}

}  // namespace

Result<ReplayReport> replay_recording(mcap::Reader& recording, const Scenario& scenario, const ReplayOptions& options,
                                      Damage damage) {
  const StandardFloatMode float_mode;
  std::optional<RecordedFiles> files;  // outlives the controllers
  if (options.provides_files) files.emplace(recording);
  auto host = REHEARSE_TRY(ControllerHost::create(scenario, options));
  auto report = replay_into(recording, scenario, options, damage, *host);
  if (!report) return report;
  if (report->first) append_as_warnings(other_arithmetic_than(recording, scenario), report->remarks);
  if (const auto flight = RunFacts::of(recording).flight) report->other_mathematics = other_mathematics(*flight);
  for (Diagnostic& remark : float_mode.remarks()) report->remarks.push_back(std::move(remark));
  return report;
}

Result<ReplayReport> replay_by(
    const std::filesystem::path& trace, const ReplayOptions& options,
    const std::function<Result<ReplayReport>(const std::function<Result<ReplayReport>()>& part)>& run) {
  auto reader = REHEARSE_TRY(mcap::Reader::open(trace));
  if (!reader->damage().empty()) return mcap::with_recover_hint(reader->damage());
  const auto scenario = REHEARSE_TRY(scenario_of(*reader));
  return run([&] { return replay_recording(*reader, scenario, options); });
}

Result<ReplayReport> replay(const std::filesystem::path& trace, const ReplayOptions& options) {
  return replay_by(trace, options, [](const auto& part) { return part(); });
}

}  // namespace rehearse
