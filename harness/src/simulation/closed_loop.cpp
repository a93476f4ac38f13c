#include "closed_loop.h"

#include <fmt/format.h>
#include <rehearse/clock.h>
#include <rehearse/interruption.h>
#include <rehearse/ode_messages.h>

#include <utility>

#include "host/float_mode.h"
#include "host/supervisor.h"
#include "recording/provenance.h"

namespace rehearse {

Result<void> ClosedLoop::create(const std::filesystem::path& trace, const HostOptions& options) {
  auto made = Plant::create(scenario);
  if (!made) return made.errors();
  plant = std::move(*made);
  auto hosting = ControllerHost::create(scenario, options);
  if (!hosting) return hosting.errors();
  host = std::move(*hosting);
  auto recording = Recorder::create(
      trace, scenario, provenance(scenario, host.get(), World::engine_description(), plant->renderer_description()));
  if (!recording) return recording.errors();
  recorder = std::move(*recording);
  descriptor.emplace(recorder->descriptor(), "the recording");
  file = trace;
  note_recording(file);
  return {};
}

void ClosedLoop::watch_contacts() {
  for (const HostedController& hosted : host->controllers())
    if (hosted.running)
      for (const int link : hosted.io->contact_links()) plant->world().watch(hosted.body, link);
}

/// Of the state at the beginning of this tick, which has been sensed.
Result<void> ClosedLoop::save_checkpoint() {
  const std::int64_t tick = plant->tick();
  if (checkpoint_interval == 0 || tick % checkpoint_interval != 0) return {};
  const std::vector<std::byte> state = plant->world().save();
  trial.begin(tick / checkpoint_interval, state);
  return recorder->record_checkpoint(tick, state);
}

/// Devices and joystick are recorded as they are read; joints and links as they are, too.
void ClosedLoop::look() {
  seen_ = &plant->seen();
  read_ = &plant->read();
  if (altered.empty()) return;
  altered_read_ = *read_;
  altered.apply(plant->tick(), altered_read_);
  altered_seen_ = *seen_;
  altered_seen_.joystick = altered_read_.joystick;
  for (std::size_t body = 0; body < altered_seen_.bodies.size(); ++body)
    altered_seen_.bodies[body].devices = altered_read_.bodies[body].devices;
  seen_ = &altered_seen_;
  read_ = &altered_read_;
}

Result<bool> ClosedLoop::step() {
  const StandardFloatMode float_mode;
  const std::int64_t tick = plant->tick();
  if (tick >= scenario.ticks() || host->failure() || summary.failure) return false;
  if ((summary.failure = interrupted_at(tick, scenario.time_step))) return false;

  plant->sense();
  look();
  if (auto done = save_checkpoint(); !done) return stopped_recording(done.errors());
  const bool alive = host->control(tick, *read_);  // input, control, output of each controller
  host->output(ControllerHost::Timing::same_step, command);
  if (auto done = record_tick(tick); !done) return stopped_recording(done.errors());
  if (!alive) return false;

  trial.step(command);
  if (!plant->step(command))
    summary.failure =
        error(fmt::format("the simulation exploded in the step after tick {}: a position or velocity "
                          "is no longer finite",
                          tick));
  tell_ode_messages(tick);
  trial.compare(plant->world());
  host->output(ControllerHost::Timing::next_step, command);
  plant->obey(tick, command);
  return true;
}

/// ODE repeats itself from step to step: the first step that it speaks of is told.
void ClosedLoop::tell_ode_messages(std::int64_t tick) {
  const std::vector<std::string> messages = take_ode_messages();
  if (messages.empty() || std::exchange(told_ode_messages_, true)) return;
  Diagnostic& remark =
      summary.remarks.emplace_back(error(fmt::format("world: the step after tick {} ({} s) found no exact solution: {}",
                                                     tick, time_of(tick, scenario.time_step), messages[0]),
                                         "later steps may have done so as well; this is said once"));
  remark.severity = Severity::warning;
}

Result<void> ClosedLoop::record_tick(std::int64_t tick) {
  if (auto done = recorder->record_state(tick, *seen_, *read_); !done) return done;
  if (auto done = recorder->record_contacts(tick, plant->world().touching()); !done) return done;
  const TickHashes hashes{plant->world().state_hash(), host->input_hash(*read_), host->output_hash()};
  if (auto done = recorder->record_tick(tick, host.get(), hashes); !done) return done;
  return record_events();
}

/// A disk that is full, or a file that somebody closed: when, and who ran.
Diagnostics ClosedLoop::stopped_recording(Diagnostics errors) const {
  std::string labels;
  for (const HostedController& hosted : host->controllers()) labels += (labels.empty() ? "" : ", ") + hosted.label;
  errors.push_back(
      error(fmt::format("the recording ends: noticed at tick {} ({} s), under {}", plant->tick(),
                        time_of(plant->tick(), scenario.time_step), labels.empty() ? "no controller" : labels)));
  return errors;
}

Result<void> ClosedLoop::record_events() {
  const std::vector<msg::Event> events = host->take_events();
  append_remarks(events, summary.remarks);
  return recorder->record_events(events);
}

Result<RunSummary> ClosedLoop::finish() {
  const StandardFloatMode float_mode;
  const std::int64_t tick = plant->tick();
  host->stop(tick);
  if (!summary.failure && host->failure()) summary.failure = *host->failure();
  if (!summary.failure) {  // the state after the last step closes a complete run
    plant->sense();
    if (auto done = recorder->record_state(tick, plant->seen(), plant->read()); !done) return done.errors();
    if (auto done = recorder->record_contacts(tick, plant->world().touching()); !done) return done.errors();
    if (auto done = recorder->record_tick(tick, nullptr, {plant->world().state_hash(), 0, 0}); !done)
      return done.errors();
  }
  if (auto done = record_events(); !done) return done.errors();
  const RecordingSize& size = recorder->size();
  mcap::StringMap outcome{{"ticks", std::to_string(size.ticks)}, {"complete", summary.failure ? "false" : "true"}};
  if (summary.failure) outcome["failure"] = summary.failure->message;
  outcome["checkpoints"] = checkpoint_interval > 0 ? trial.verdict() : "none";
  descriptor.reset();
  if (const auto files = host->files_read(); !files.empty())
    if (auto done = recorder->add_metadata(files_record, files); !done) return done.errors();
  if (auto done = recorder->close(outcome); !done) return done.errors();
  note_recording({});
  summary.ticks = size.ticks;
  summary.channels = size.channels;
  summary.frames = size.frames;
  summary.controller_refused = host->any_refused();
  std::error_code failed;
  const std::uintmax_t bytes = std::filesystem::file_size(file, failed);
  summary.bytes = failed ? 0 : bytes;  // a pipe has no size
  return summary;
}

}  // namespace rehearse
