#include <fmt/format.h>
#include <rehearse/clock.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "checkpoint_trial.h"
#include "host/controller_host.h"
#include "host/float_mode.h"
#include "plant.h"
#include "host/process_guard.h"
#include "recording/provenance.h"
#include "recording/recorder.h"

namespace rehearse {

struct Session::Impl {
  const Scenario& scenario;
  std::unique_ptr<Plant> plant;
  std::unique_ptr<ControllerHost> host;
  std::unique_ptr<Recorder> recorder;
  std::optional<ProtectedDescriptor> descriptor;  // the recorder's
  std::filesystem::path file;
  Command command;
  std::int64_t checkpoint_interval = 0;  // [ticks]; 0: none
  CheckpointTrial trial;
  RunSummary summary;

  explicit Impl(const Scenario& of) : scenario(of), trial(of) {}
  Result<void> save_checkpoint();
  Result<void> record_tick(std::int64_t tick);
  Diagnostics stopped_recording(Diagnostics errors) const;
  Result<void> record_events();
  Result<void> record_remarks();
};

Session::Session(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Session::~Session() = default;
std::int64_t Session::tick() const { return impl_->plant->tick(); }

Result<std::unique_ptr<Session>> Session::create(const Scenario& scenario, const std::filesystem::path& trace,
                                                 const RecordOptions& options) {
  const StandardFloatMode float_mode;
  auto impl = std::make_unique<Impl>(scenario);
  impl->summary.remarks = float_mode.remarks();
  auto plant = Plant::create(scenario);
  if (!plant) return plant.errors();
  impl->plant = std::move(*plant);
  auto host = ControllerHost::create(scenario, options);
  if (!host) return host.errors();
  impl->host = std::move(*host);
  auto recorder = Recorder::create(trace, scenario,
                                   provenance(scenario, impl->host.get(), World::engine_description(),
                                              impl->plant->renderer_description()));
  if (!recorder) return recorder.errors();
  impl->recorder = std::move(*recorder);
  impl->descriptor.emplace(impl->recorder->descriptor(), "the recording");
  impl->file = trace;
  if (options.nudge) impl->plant->world().nudge(*options.nudge);
  if (options.checkpoint_period > 0.0)
    impl->checkpoint_interval =
        std::max<std::int64_t>(1, std::llround(options.checkpoint_period / scenario.time_step));
  impl->command = impl->host->initialize(initial_observation(scenario));
  for (const HostedController& hosted : impl->host->controllers())
    if (hosted.running)
      for (const int link : hosted.io->contact_links()) impl->plant->world().watch(hosted.body, link);
  impl->plant->obey(-1, impl->command);
  impl->recorder->declare(impl->host.get());
  impl->host->start();
  if (auto done = impl->record_remarks(); !done) return done.errors();
  if (auto done = impl->record_events(); !done) return done.errors();
  return std::unique_ptr<Session>(new Session(std::move(impl)));
}

/// What the world has to say of its bodies is an event of the run as well.
Result<void> Session::Impl::record_remarks() {
  std::vector<msg::Event> events;
  for (const Diagnostic& remark : plant->world().remarks()) {
    msg::Event& event = events.emplace_back();
    event.severity = to_string(remark.severity);
    event.source = "world";
    event.text = remark.message;
  }
  append_remarks(events, summary.remarks);
  return recorder->record_events(events);
}

/// Of the state at the beginning of this tick, which has been sensed.
Result<void> Session::Impl::save_checkpoint() {
  const std::int64_t tick = plant->tick();
  if (checkpoint_interval == 0 || tick % checkpoint_interval != 0) return {};
  const std::vector<std::byte> state = plant->world().save();
  trial.begin(tick / checkpoint_interval, state);
  return recorder->record_checkpoint(tick, state);
}

Result<bool> Session::step() {
  const StandardFloatMode float_mode;
  Impl& run = *impl_;
  Plant& plant = *run.plant;
  const std::int64_t tick = plant.tick();
  if (tick >= run.scenario.ticks() || run.host->failure() || run.summary.failure) return false;

  plant.sense();
  if (auto done = run.save_checkpoint(); !done) return run.stopped_recording(done.errors());
  const bool alive = run.host->control(tick, plant.read());  // input, control, output of each controller
  run.host->output(ControllerHost::Timing::same_step, run.command);
  if (auto done = run.record_tick(tick); !done) return run.stopped_recording(done.errors());
  if (!alive) return false;

  run.trial.step(run.command);
  if (!plant.step(run.command))
    run.summary.failure =
        error(fmt::format("the simulation exploded in the step after tick {}: a position or velocity "
                          "is no longer finite",
                          tick));
  run.trial.compare(plant.world());
  run.host->output(ControllerHost::Timing::next_step, run.command);
  plant.obey(tick, run.command);
  return true;
}

Result<void> Session::Impl::record_tick(std::int64_t tick) {
  if (auto done = recorder->record_state(tick, plant->seen(), plant->read()); !done) return done;
  if (auto done = recorder->record_contacts(tick, plant->world().touching()); !done) return done;
  const TickHashes hashes{plant->world().state_hash(), host->input_hash(plant->read()), host->output_hash()};
  if (auto done = recorder->record_tick(tick, host.get(), hashes); !done) return done;
  return record_events();
}

/// A disk that is full, or a file that somebody closed: when, and who ran.
Diagnostics Session::Impl::stopped_recording(Diagnostics errors) const {
  std::string labels;
  for (const HostedController& hosted : host->controllers()) labels += (labels.empty() ? "" : ", ") + hosted.label;
  errors.push_back(
      error(fmt::format("the recording ends: noticed at tick {} ({} s), under {}", plant->tick(),
                        time_of(plant->tick(), scenario.time_step), labels.empty() ? "no controller" : labels)));
  return errors;
}

Result<void> Session::Impl::record_events() {
  const std::vector<msg::Event> events = host->take_events();
  append_remarks(events, summary.remarks);
  return recorder->record_events(events);
}

Result<RunSummary> Session::finish() {
  const StandardFloatMode float_mode;
  Impl& run = *impl_;
  const std::int64_t tick = run.plant->tick();
  run.host->stop();
  if (!run.summary.failure && run.host->failure()) run.summary.failure = *run.host->failure();
  if (!run.summary.failure) {  // the state after the last step closes a complete run
    run.plant->sense();
    if (auto done = run.recorder->record_state(tick, run.plant->seen(), run.plant->read()); !done)
      return done.errors();
    if (auto done = run.recorder->record_contacts(tick, run.plant->world().touching()); !done) return done.errors();
    if (auto done = run.recorder->record_tick(tick, nullptr, {run.plant->world().state_hash(), 0, 0}); !done)
      return done.errors();
  }
  if (auto done = run.record_events(); !done) return done.errors();
  const RecordingSize& size = run.recorder->size();
  mcap::StringMap outcome{{"ticks", std::to_string(size.ticks)}, {"complete", run.summary.failure ? "false" : "true"}};
  if (run.summary.failure) outcome["failure"] = run.summary.failure->message;
  outcome["checkpoints"] = run.checkpoint_interval > 0 ? run.trial.verdict() : "none";
  run.descriptor.reset();
  if (auto done = run.recorder->close(outcome); !done) return done.errors();
  run.summary.ticks = size.ticks;
  run.summary.channels = size.channels;
  run.summary.frames = size.frames;
  run.summary.controller_refused = run.host->any_refused();
  std::error_code ignored;
  run.summary.bytes = std::filesystem::file_size(run.file, ignored);
  return run.summary;
}

Result<RunSummary> record(const Scenario& scenario, const std::filesystem::path& trace, const RecordOptions& options) {
  auto session = Session::create(scenario, trace, options);
  if (!session) return session.errors();
  const std::int64_t all = scenario.ticks();
  const std::int64_t stride = std::max<std::int64_t>(1, all / 100);
  for (;;) {
    const Result<bool> going_on = (*session)->step();
    if (!going_on) return going_on.errors();
    if (!*going_on) break;
    const std::int64_t done = (*session)->tick();
    if (options.progress && done % stride == 0) options.progress(done, all);
  }
  return (*session)->finish();
}

}  // namespace rehearse
