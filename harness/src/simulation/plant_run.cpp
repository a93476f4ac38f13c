#include <fmt/format.h>
#include <rehearse/clock.h>
#include <rehearse/interruption.h>
#include <rehearse/ode_messages.h>
#include <rehearse/plant_run.h>

#include <algorithm>

#include "check/scenario_changes.h"
#include "host/float_mode.h"
#include "plant.h"
#include "recorded_checkpoints.h"
#include "recorded_commands.h"
#include "recording/provenance.h"
#include "recording/recorder.h"

namespace rehearse {
namespace {

/// The last tick whose state the recording has.
std::int64_t last_tick_of(const Trace& recording, double time_step) {
  const TraceChannel* ticks = recording.find_channel("/tick");
  if (!ticks || ticks->times.empty()) return -1;
  return std::llround(static_cast<double>(ticks->times.back()) * 1e-9 / time_step);
}

struct PlantRun {
  const Scenario& scenario;
  const PlantOptions& options;
  RecordedCheckpoints checkpoints;
  RecordedCommands commands;
  std::unique_ptr<Plant> plant;
  std::unique_ptr<Recorder> recorder;
  Command command;
  PlantSummary summary;

  Result<void> begin();
  Result<void> set_back();
  Result<bool> step(std::int64_t last);
};

/// Controllers' words until the first tick, so that devices are as they were there.
Result<void> PlantRun::begin() {
  command = commands.initial();
  plant->obey(-1, command);
  if (options.from == 0) {
    if (options.nudge) plant->world().nudge(*options.nudge);
    return {};
  }
  for (std::int64_t tick = 0; tick < options.from; ++tick) {
    commands.put(tick, RecordedCommands::Timing::same_step, command);
    for (BodyCommand& body : command.bodies) std::fill(body.external.begin(), body.external.end(), Wrench{});
    commands.put(tick, RecordedCommands::Timing::next_step, command);
    plant->obey(tick, command);
  }
  const auto restored = checkpoints.restore(options.from, plant->world());
  if (!restored) return restored.errors();
  if (!*restored) return error(fmt::format("the recording has no checkpoint at tick {}", options.from));
  plant->begin_at(options.from);
  ++summary.restored;
  return {};
}

/// To the recorded state, if there is a checkpoint at this tick.
Result<void> PlantRun::set_back() {
  if (!options.resync || !summary.from_the_start.empty()) return {};
  const auto restored = checkpoints.restore(plant->tick(), plant->world());
  if (!restored) return restored.errors();
  if (!*restored) return {};
  ++summary.restored;
  if (options.nudge) plant->world().nudge(*options.nudge + static_cast<std::uint32_t>(plant->tick()));
  return {};
}

/// One tick of the loop: sense, record, set back, command, step. False: it was the last.
Result<bool> PlantRun::step(std::int64_t last) {
  const std::int64_t tick = plant->tick();
  if (auto interrupted = interrupted_at(tick, scenario.time_step)) return *std::move(interrupted);
  plant->sense();
  if (auto done = recorder->record_state(tick, plant->seen(), plant->read()); !done) return done.errors();
  // what touches is known after a step; of a run that begins in the middle, the first that is known begins nothing
  if (options.from > 0 && tick <= options.from + 1)
    recorder->begin_with_contacts(plant->world().touching());
  else if (auto done = recorder->record_contacts(tick, plant->world().touching()); !done)
    return done.errors();
  if (auto done = recorder->record_tick(tick, nullptr, {plant->world().state_hash(), 0, 0}); !done)
    return done.errors();
  if (tick >= last) return false;
  if (auto done = set_back(); !done) return done.errors();
  commands.put(tick, RecordedCommands::Timing::same_step, command);
  const bool alive = plant->step(command);
  take_ode_messages();  // a session tells them
  if (!alive) {
    summary.failure = error(fmt::format("the simulation exploded in the step after tick {}", tick));
    return false;
  }
  commands.put(tick, RecordedCommands::Timing::next_step, command);
  plant->obey(tick, command);
  ++summary.ticks;
  return true;
}

}  // namespace

Result<PlantSummary> run_plant(const Scenario& scenario, const Trace& recording, const std::filesystem::path& trace,
                               const PlantOptions& options) {
  const StandardFloatMode float_mode;
  if (const auto change = changed_time_step(scenario, recording)) {
    Diagnostic finding = error(fmt::format("its time step is {} s, and that of {} is {} s: no tick of it can be repeated",
                                           change->expected, scenario.name, change->actual));
    finding.file = recording.file();
    return finding;
  }
  auto commands = RecordedCommands::find(scenario, recording);
  if (!commands) return commands.errors();
  auto plant = options.noise_of ? Plant::create(scenario, *options.noise_of) : Plant::create(scenario);
  if (!plant) return plant.errors();
  auto recorder = Recorder::create(
      trace, scenario, provenance(scenario, nullptr, World::engine_description(), (*plant)->renderer_description()));
  if (!recorder) return recorder.errors();
  (*recorder)->declare(nullptr);
  PlantRun run{scenario, options, {recording, scenario}, std::move(*commands), std::move(*plant),
               std::move(*recorder), {}, {}};
  auto objection = run.checkpoints.objection();
  if (!objection) return objection.errors();
  run.summary.from_the_start = *std::move(objection);
  if (auto begun = run.begin(); !begun) return begun.errors();

  const std::int64_t end = last_tick_of(recording, scenario.time_step);
  if (end < 0) {
    Diagnostic finding = error("it has no ticks: nothing of the run was recorded");
    finding.file = recording.file();
    return finding;
  }
  const std::int64_t last = std::min(end, options.until.value_or(end));
  const std::int64_t stride = std::max<std::int64_t>(1, (last - options.from) / 100);
  for (bool going_on = last >= options.from; going_on;) {
    const auto done = run.step(last);
    if (!done) return done.errors();
    going_on = *done;
    if (options.progress && run.summary.ticks % stride == 0)
      options.progress(run.summary.ticks, last - options.from);
  }
  mcap::StringMap outcome{{"ticks", std::to_string(run.summary.ticks)},
                          {"complete", run.summary.failure ? "false" : "true"}};
  if (run.summary.failure) outcome["failure"] = run.summary.failure->message;
  if (auto closed = run.recorder->close(outcome); !closed) return closed.errors();
  return run.summary;
}

}  // namespace rehearse
