#include <fmt/format.h>
#include <rehearse/replay.h>

#include <algorithm>
#include <utility>

#include "base/clock.h"
#include "copying_sink.h"
#include "core/guard/float_mode.h"
#include "core/guard/process_guard.h"
#include "core/host/controller_host.h"
#include "core/mcap/whole_input.h"
#include "core/recording/initial_commands.h"
#include "core/recording/provenance.h"
#include "core/recording/recorder.h"
#include "core/run/hosted_commands.h"
#include "core/scenario/branch_origin.h"
#include "core/scenario/trace_scenario.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The provenance of this process, with the engine and the renderer of the recording: they made the recorded world.
mcap::StringMap facts_of(const Scenario& scenario, const ControllerHost& host, const mcap::Reader& recording) {
  mcap::StringMap stated = provenance(scenario, &host, "", "");
  const RunFacts recorded = RunFacts::of(recording);
  for (const char* fact : {facts::physics, facts::renderer})
    if (recorded.provenance && recorded.provenance->contains(fact)) stated[fact] = recorded.stated(fact);
  return stated;
}

Result<void> write_trace(mcap::Reader& reader, const Scenario& scenario, const std::string& source,
                         const fs::path& trace, const ReplayOptions& options) {
  auto host = REHEARSE_TRY(ControllerHost::create(scenario, options));
  auto altered = REHEARSE_TRY(AlteredInputs::parse(options.set, scenario));
  Command at_rest = host->initialize(initial_observation(scenario));
  REHEARSE_TRY(altered.check_read_by(*host));
  auto recorder = REHEARSE_TRY(Recorder::create(trace, scenario, facts_of(scenario, *host, reader)));
  std::optional<ProtectedDescriptor> descriptor(std::in_place, recorder->descriptor(), "the recording");
  BranchOrigin origin;
  origin.source = source;
  origin.simulated = false;
  origin.set = options.set;
  for (const auto& [name, library] : options.libraries)
    origin.controllers.push_back(name + "=" + fs::path(library).filename().string());
  REHEARSE_TRY(recorder->add_metadata(records::branch, origin.metadata()));
  if (scenario.initial_commands)
    REHEARSE_TRY(recorder->add_metadata(records::initial_commands, metadata_of_initial_commands(scenario, at_rest)));
  for (std::size_t body = 0; body < scenario.bodies.size(); ++body)
    if (altered.alters_joints(static_cast<int>(body))) recorder->measure_joints(static_cast<int>(body));
  recorder->declare(host.get());
  host->start();
  RecordingSource inputs(scenario, reader, *host, altered);
  HostedCommands commands(*host, HostedCommands::Written::in_time);
  CopyingSink copy(scenario, reader, *host, *recorder, altered);
  Run run(scenario.time_step, inputs, commands, copy, 0, Run::no_end);
  run.command = std::move(at_rest);
  REHEARSE_TRY(copy.copy(inputs, run, std::nullopt));
  const std::optional<msg::Tick>& last = inputs.last_state();
  host->stop(last ? last->tick : run.tick());
  if (last) REHEARSE_TRY(recorder->record_tick(last->tick, nullptr, {last->state_hash, 0, 0}));
  REHEARSE_TRY(recorder->record_events(host->take_events()));
  RunOutcome outcome{.ticks = run.tick(), .complete = last.has_value(), .checkpoints = "none"};
  if (host->failure()) outcome.failure = host->failure()->message;
  descriptor.reset();
  return recorder->close(outcome);
}

}  // namespace

Result<void> write_replay(const fs::path& recording, const fs::path& trace, const ReplayOptions& options) {
  const StandardFloatMode float_mode;
  std::error_code ignored;
  if (fs::equivalent(recording, trace, ignored))
    return error_in(trace.string(), "it is the recording itself", "name another file for the replay");
  auto reader = REHEARSE_TRY(mcap::Reader::open(recording));
  if (!reader->damage().empty()) return mcap::with_recover_hint(reader->damage());
  const auto scenario = REHEARSE_TRY(scenario_of(*reader));
  const auto source = REHEARSE_TRY(name_and_hash(recording));
  return write_trace(*reader, scenario, source, trace, options);
}

}  // namespace rehearse
