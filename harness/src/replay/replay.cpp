#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "altered_inputs.h"
#include "host/controller_host.h"
#include "host/float_mode.h"
#include "host/opened_files.h"
#include "host/virtualised.h"
#include "mcap/whole_input.h"
#include "model/clock.h"
#include "recorded_files.h"
#include "recorded_inputs.h"
#include "recording/provenance.h"
#include "recording/recorder.h"
#include "recording_source.h"
#include "replay_comparison.h"
#include "replay_recording.h"
#include "run/hosted_commands.h"
#include "run/run.h"
#include "scenario/trace_scenario.h"
#include "trace/channel_name.h"
#include "trace/run_facts.h"

namespace rehearse {
namespace {

// The conditions under which a replay repeats its recording: all inputs were recorded, and controllers, files and
// arithmetic are unchanged.

/// An error for each input that controllers read and the recording lacks. The controllers must be initialised.
Diagnostics unrecorded_inputs(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host,
                              const RecordedInputs& inputs) {
  Diagnostics missing;
  if (scenario.joystick && !inputs.has_joystick())
    missing.push_back(
        in_recording(recording, error("the run has a joystick, but its input was not recorded: there is no /joy",
                                      "record the scenario again")));
  for (const HostedController& hosted : host.controllers()) {
    if (!hosted.running) continue;
    const Model& model = *scenario.bodies[hosted.body].model;
    const auto report = [&](const std::string& what) {
      missing.push_back(in_recording(
          recording, error(fmt::format("controller '{}' reads {}, which was not recorded", hosted.label, what),
                           "record again with this controller")));
    };
    for (const IoField& field : hosted.io->inputs().fields)
      if (!inputs.has(hosted.body, field))
        report(fmt::format("{} of link '{}'", name_of(field.quantity), model.links[field.link].name));
    for (const int link : hosted.io->contact_links())
      if (!inputs.has_contacts(hosted.body, link))
        report(fmt::format("the contact points of link '{}'", model.links[link].name));
    for (const int device : hosted.io->input_devices()) {
      const DeviceKind& kind = model.devices[device].kind;
      const bool is_still_camera = std::holds_alternative<Camera>(kind) &&
                                   !scenario.runs_camera(scenario.bodies[hosted.body].name, model.devices[device].name);
      const bool said_nothing = is_still_camera || std::holds_alternative<Light>(kind);
      if (!said_nothing && !inputs.has_device(hosted.body, device))
        report(fmt::format("device '{}'", model.devices[device].name));
    }
  }
  return missing;
}

/// BODY/NAME of the controllers whose libraries differ from the recorded libraries, by their hashes.
std::vector<std::string> other_controllers(const mcap::Reader& recording, const ControllerHost& host) {
  const RunFacts recorded = RunFacts::of(recording);
  std::vector<std::string> others;
  for (const HostedController& hosted : host.controllers())
    if (!recorded.had_library(hosted.label, hosted.library->content_hash())) others.push_back(hosted.label);
  return others;
}

/// True if a recording of these controllers would have the same channels of inputs and outputs as `recording`, with
/// equal metadata. The controllers must be initialised.
bool has_channels_of(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host) {
  std::map<std::string, mcap::StringMap> here = Recorder::channels_of(scenario, host), there;
  const auto is_of_side = [](const ChannelName& name) {
    return name.side == ChannelSide::input || name.side == ChannelSide::output;
  };
  std::erase_if(here, [&](const auto& entry) { return !is_of_side(ChannelName::parse(entry.first)); });
  for (const auto& [id, channel] : recording.channels()) {
    const ChannelName name = ChannelName::parse(channel.topic);
    // the channel of a device's commands is added by the first command
    if (!is_of_side(name) || name.kind == ChannelKind::device_state) continue;
    there[channel.topic] = channel.metadata;
    there[channel.topic].erase("offered_qos_profiles");  // added by the writer
  }
  return here == there;
}

/// A sentence for each file that controllers read and that has changed since the recording, or may have changed.
/// If a failure ended the run, the files that it would have read later are unknown. Recordings from before files were
/// recorded don't contain the content of files.
std::vector<std::string> changed_files(const mcap::Reader& recording, const ControllerHost& host) {
  const std::optional<mcap::StringMap> recorded = RunFacts::of(recording).files;
  std::vector<std::string> changes;
  for (const auto& [file, content] : host.files_read()) {
    const auto before = recorded ? recorded->find(file) : mcap::StringMap::const_iterator();
    const bool is_known = recorded && before != recorded->end();
    if (is_known && before->second == content) continue;
    if (content == missing_file)
      changes.push_back(fmt::format("{} wasn't found", file));
    else if (is_known)
      changes.push_back(fmt::format("{} has changed since the recording", file));
    else
      changes.push_back(fmt::format("{} is read, but the recording doesn't state its content", file));
  }
  return changes;
}

/// Differences of this process's arithmetic that may change last bits without a change of the controllers.
Diagnostics other_arithmetic_than(const mcap::Reader& recording, const Scenario& scenario) {
  const auto recorded = RunFacts::of(recording).provenance;
  if (!recorded) return {};
  const std::string other = other_arithmetic(*recorded, provenance(scenario, nullptr, "", ""));
  if (other.empty()) return {};
  return {error(fmt::format("this process may round differently than the process that recorded: {}", other),
                "last bits may differ for this reason alone; rehearse check compares within tolerance then")};
}

/// An error if the recorded controllers got simulated time and random numbers, and the controllers here get the
/// system's.
Diagnostics other_clock_than(const mcap::Reader& recording) {
  if (!virtualised_seed(recording) || !virtualisation().empty()) return {};
  return {in_recording(
      recording, error("its controllers got simulated time and seeded random numbers, but here they get the system's: "
                       "their commands may differ for this reason",
                       "rehearse replay gives them simulated time and seeded numbers"))};
}

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
  append_as_warnings(other_clock_than(recording), report.remarks);
  SeriesScales scales;  // before a controller can change the working folder
  if (options.tolerances) scales = scales_of(recording.name(), *options.tolerances);
  host.initialize(initial_observation(scenario));
  host.start();
  AlteredInputs altered;
  RecordingSource source(scenario, recording, host, altered);
  if (auto known = check_inputs(recording, scenario, host, source); !known) return known.errors();
  auto parsed = AlteredInputs::parse(options.set, scenario);
  if (!parsed) return parsed.errors();
  altered = *std::move(parsed);
  if (auto read = altered.check_read_by(host); !read) return read.errors();
  if (options.until) source.end_before(static_cast<std::uint64_t>(std::llround(std::max(0.0, *options.until) * 1e9)));

  ReplayComparison comparison(options, scenario, recording, host, source, std::move(scales), report);
  HostedCommands commands(host, HostedCommands::Written::never);
  Run run(scenario.time_step, source, commands, comparison, 0, Run::no_end);
  run.report_progress(options.progress, scenario.ticks());
  const bool same_channels = has_channels_of(recording, scenario, host);
  comparison.take_events();
  if (!host.failure())
    if (auto done = replay_ticks(run, source, comparison, scenario, options, damage, report); !done)
      return done.errors();
  if (source.was_cut_short()) comparison.end_lines();  // the recorded controllers were not stopped there
  host.stop(report.ticks);
  comparison.take_events();
  if (!source.was_cut_short()) comparison.end_lines();
  append_as_warnings(altered.unused(), report.remarks);
  report.failure = host.failure();
  report.controller_refused = host.any_refused();
  report.repeats_the_run = same_channels && comparison.repeats_all() && report.equal() && report.words.different == 0 &&
                           !report.controller_refused && (source.last_state() || host.controllers().empty()) &&
                           options.from == 0.0 && !source.alters();
  report.other_controllers = other_controllers(recording, host);
  report.changed_files = changed_files(recording, host);
  report.same_controllers = report.other_controllers.empty() && !host.has_other_options();
  return report;
}

}  // namespace

Result<ReplayReport> replay_recording(mcap::Reader& recording, const Scenario& scenario, const ReplayOptions& options,
                                      Damage damage) {
  const StandardFloatMode float_mode;
  const RecordedFiles files(recording);  // outlives the controllers
  auto host = ControllerHost::create(scenario, options);
  if (!host) return host.errors();
  auto report = replay_into(recording, scenario, options, damage, **host);
  if (!report) return report;
  if (report->first) append_as_warnings(other_arithmetic_than(recording, scenario), report->remarks);
  for (Diagnostic& remark : float_mode.remarks()) report->remarks.push_back(std::move(remark));
  return report;
}

Result<ReplayReport> replay(const std::filesystem::path& trace, const ReplayOptions& options) {
  auto reader = mcap::Reader::open(trace);
  if (!reader) return reader.errors();
  if (!(*reader)->damage().empty()) return mcap::with_recover_hint((*reader)->damage());
  const auto scenario = scenario_of(**reader);
  if (!scenario) return scenario.errors();
  return replay_recording(**reader, *scenario, options);
}

}  // namespace rehearse
