#include "closed_loop.h"

#include <fmt/format.h>

#include <utility>

#include "base/clock.h"
#include "core/guard/float_mode.h"
#include "core/mcap/sink.h"
#include "core/recording/provenance.h"

namespace rehearse {

Result<void> ClosedLoop::create(const std::filesystem::path& trace, const HostOptions& options) {
  plant = REHEARSE_TRY(Plant::create(scenario));
  host = REHEARSE_TRY(ControllerHost::create(scenario, options));
  auto recording = REHEARSE_TRY(Recorder::create(
      trace, scenario, provenance(scenario, host.get(), World::engine_description(), plant->renderer_description())));
  recorder = std::move(recording);
  descriptor.emplace(recorder->descriptor(), "the recording");
  file = trace;
  world.emplace(scenario, *plant);
  commands.emplace(*host, HostedCommands::Written::in_time);
  sink.emplace(*recorder, &summary.remarks);
  run.emplace(scenario.time_step, *world, *commands, *sink, 0, scenario.ticks());
  return {};
}

void ClosedLoop::initialize() {
  run->command = host->initialize(initial_observation(scenario));
  for (const HostedController& hosted : host->controllers()) {
    if (!hosted.running) continue;
    for (const int link : hosted.io->contact_links()) plant->world().watch(hosted.body, link);
    const ScenarioBody& body = scenario.bodies[static_cast<std::size_t>(hosted.body)];
    for (const int index : hosted.io->input_devices()) {
      const Device& device = body.model->devices[static_cast<std::size_t>(index)];
      if (std::holds_alternative<Camera>(device.kind) && !scenario.runs_camera(body.name, device.name))
        world->add_idle_camera(hosted.label, hosted.body, index);
    }
  }
}

void ClosedLoop::start() {
  recorder->declare(host.get());
  host->start();
}

Result<bool> ClosedLoop::step() {
  const StandardFloatMode float_mode;
  const auto going_on = run->step();
  if (!going_on) return stopped_recording(going_on.errors());
  if (*going_on && scenario.ends_when_done && host->all_done()) run->end();
  return going_on;
}

/// Adds the time to the error of a full disk or of a closed file. Only the latter can be a controller's deed.
Diagnostics ClosedLoop::stopped_recording(Diagnostics errors) const {
  std::string labels;
  if (!errors.empty() && errors.front().message == mcap::closed_by_others)
    for (const HostedController& hosted : host->controllers())
      labels += (labels.empty() ? ", under " : ", ") + hosted.label;
  errors.push_back(error(fmt::format("the recording ends: noticed at tick {} ({} s){}", plant->tick(),
                                     time_of(plant->tick(), scenario.time_step), labels)));
  return errors;
}

RunEnding ClosedLoop::end() const {
  if (run->interruption()) return RunEnding::interrupted;
  if (run->broke_down()) return RunEnding::exploded;
  if (host->any_refused()) return RunEnding::refused;
  if (!host->failure()) return RunEnding::complete;
  switch (host->failed_by()) {
    case CallEnd::threw: return RunEnding::threw;
    case CallEnd::hung: return RunEnding::hung;
    case CallEnd::exited: return RunEnding::exited;
    case CallEnd::returned:
    case CallEnd::crashed: break;
  }
  return RunEnding::crashed;
}

/// The failure that ended the run early.
std::optional<Diagnostic> ClosedLoop::failure() const {
  if (run->interruption()) return run->interruption();
  if (run->broke_down())
    return error(fmt::format(
        "the simulation exploded in the step after tick {}: a position or velocity is no longer finite or above 1e8",
        run->tick() - 1));
  return host->failure();
}

Result<RunSummary> ClosedLoop::finish() {
  const StandardFloatMode float_mode;
  if (plant->tick() > 1)  // remarks that no recording contains
    for (const std::string& sentence : host->unread_inputs()) summary.remarks.push_back(warning(sentence));
  host->stop(plant->tick());
  summary.failure = failure();
  summary.end = end();
  if (!summary.failure)  // a complete run ends with the state after the last step
    REHEARSE_TRY(run->close());
  REHEARSE_TRY(sink->record_events(host->take_events()));
  if (auto done = close_file(); !done) {
    if (!recorder->is_changed_by_others()) return done.errors();
    summary.trace_changed = true;
    summary.failure = done.errors().front();
    summary.end = RunEnding::crashed;
  }
  const RecordingSize& size = recorder->size();
  summary.ticks = size.ticks;
  summary.channels = size.channels;
  summary.pictures = size.pictures;
  summary.controller_refused = host->any_refused();
  summary.control_times = host->control_times();
  std::error_code failed;
  const std::uintmax_t bytes = std::filesystem::file_size(file, failed);
  summary.bytes = failed ? 0 : bytes;  // a pipe has no size
  return summary;
}

Result<RunSummary> ClosedLoop::go_on(Command led, std::int64_t interval, Run::Progress progress) {
  for (std::size_t body = 0; body < led.bodies.size(); ++body)
    for (std::size_t joint = 0; joint < led.bodies[body].joints.size(); ++joint)
      led.bodies[body].joints[joint].drive = run->command.bodies[body].joints[joint].drive;
  run->command = std::move(led);
  host->read_back();
  world->save_checkpoints(interval);
  world->alter(altered);
  run->change(*world, *sink, scenario.ticks());
  run->report_progress(std::move(progress), scenario.ticks() - run->tick());
  for (;;) {
    const bool going_on = REHEARSE_TRY(step());
    if (!going_on) return finish();
  }
}

Result<void> ClosedLoop::close_file() {
  RunOutcome outcome{.ticks = recorder->size().ticks, .complete = !summary.failure};
  if (summary.failure) outcome.failure = summary.failure->message;
  outcome.checkpoints = world->checkpoint_verdict();
  descriptor.reset();
  if (const auto files = host->files_read(); !files.empty())
    REHEARSE_TRY(recorder->add_metadata(records::files, files));
  for (const auto& [name, text] : host->input_copies())
    REHEARSE_TRY(recorder->attach(name, "application/octet-stream", text));
  REHEARSE_TRY(recorder->close(outcome));
  return {};
}

}  // namespace rehearse
