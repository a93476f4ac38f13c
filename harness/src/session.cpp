#include <fmt/format.h>
#include <rehearse/clock.h>
#include <rehearse/scanner.h>
#include <rehearse/session.h>
#include <rehearse/vision.h>
#include <rehearse/world.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "controller_host.h"
#include "noise_maker.h"
#include "provenance.h"
#include "recorder.h"

namespace rehearse {
namespace {

constexpr double checkpoint_period = 0.1;  // [s] of simulated time

std::vector<WorldBody> world_bodies(const Scenario& scenario) {
  std::vector<WorldBody> bodies;
  for (const ScenarioBody& body : scenario.bodies)
    bodies.push_back({body.name, body.model, body.fixed, body.position, body.rotation, body.joints, body.kinematic,
                      body.joint_limits, body.effort_limits, body.trimesh, body.self_collision});
  return bodies;
}

std::vector<std::shared_ptr<const Model>> models_of(const Scenario& scenario) {
  std::vector<std::shared_ptr<const Model>> models;
  for (const ScenarioBody& body : scenario.bodies) models.push_back(body.model);
  return models;
}

/// Null if no camera runs: then nothing needs a renderer.
Result<std::unique_ptr<Vision>> make_vision(const Scenario& scenario) {
  std::vector<std::vector<bool>> active;
  bool any = false;
  for (const ScenarioBody& body : scenario.bodies) {
    std::vector<bool>& of_body = active.emplace_back();
    for (const Device& device : body.model->devices) {
      of_body.push_back(std::holds_alternative<Camera>(device.kind) && scenario.runs_camera(body.name, device.name));
      any |= of_body.back();
    }
  }
  if (!any) return std::unique_ptr<Vision>();
  return Vision::create(scenario.time_step, models_of(scenario), std::move(active), scenario.look);
}

/// Wrenches act for one step only.
void clear_wrenches(Command& command) {
  for (BodyCommand& body : command.bodies) std::fill(body.external.begin(), body.external.end(), Wrench{});
}

/// Words to devices are said once.
void clear_words(Command& command) {
  for (BodyCommand& body : command.bodies)
    for (DeviceCommand& device : body.devices) device.fresh = false;
}

}  // namespace

struct Session::Impl {
  const Scenario& scenario;
  std::unique_ptr<World> world;
  std::unique_ptr<Vision> vision;  // null: no camera runs
  std::unique_ptr<Scanner> scanner;
  std::unique_ptr<ControllerHost> host;
  std::unique_ptr<Recorder> recorder;
  std::filesystem::path file;
  NoiseMaker noise;
  Observation seen;       // the joints as they are, devices as they are read
  Observation disturbed;  // the joints as they are read too; used only if there is a difference
  Command command;
  std::vector<std::vector<std::optional<DeviceReading>>> told;  // by body and device: a light's new state
  std::int64_t checkpoint_interval = 1;                         // [ticks]
  RunSummary summary;

  explicit Impl(const Scenario& of) : scenario(of), noise(of) {}
  void sense(std::int64_t tick);
  const Observation& as_read(std::int64_t tick);
  void obey(std::int64_t tick);
  void push();
  Result<void> record_events();
  Result<void> record_remarks();
};

Session::Session(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Session::~Session() = default;
std::int64_t Session::tick() const { return impl_->world->tick(); }

Result<std::unique_ptr<Session>> Session::create(const Scenario& scenario, const std::filesystem::path& trace,
                                                 const HostOptions& options) {
  auto impl = std::make_unique<Impl>(scenario);
  auto world =
      World::create({scenario.time_step, scenario.gravity, scenario.seed, scenario.solver}, world_bodies(scenario));
  if (!world) return world.errors();
  impl->world = std::move(*world);
  impl->scanner = std::make_unique<Scanner>(*impl->world, scenario.time_step, models_of(scenario));
  auto vision = make_vision(scenario);
  if (!vision) return vision.errors();
  impl->vision = std::move(*vision);
  auto host = ControllerHost::create(scenario, options);
  if (!host) return host.errors();
  impl->host = std::move(*host);
  auto recorder = Recorder::create(trace, scenario,
                                   provenance(scenario, *impl->host, World::engine_description(),
                                              impl->vision ? impl->vision->renderer_description() : ""));
  if (!recorder) return recorder.errors();
  impl->recorder = std::move(*recorder);
  impl->file = trace;
  impl->checkpoint_interval = std::max<std::int64_t>(1, std::llround(checkpoint_period / scenario.time_step));
  impl->command = impl->host->initialize(initial_observation(scenario));
  for (const HostedController& hosted : impl->host->controllers())
    if (hosted.running)
      for (const int link : hosted.io->contact_links()) impl->world->watch(hosted.body, link);
  impl->obey(-1);
  impl->recorder->declare(*impl->host);
  impl->host->start();
  if (auto done = impl->record_remarks(); !done) return done.errors();
  if (auto done = impl->record_events(); !done) return done.errors();
  return std::unique_ptr<Session>(new Session(std::move(impl)));
}

void Session::Impl::sense(std::int64_t tick) {
  seen = world->sense();
  if (scenario.joystick) seen.joystick = scenario.joystick->at(time_of(tick, scenario.time_step));
  if (vision) vision->look(tick, seen);
  scanner->look(tick, seen);
  noise.disturb_devices(tick, seen);
  for (std::size_t body = 0; body < told.size(); ++body)
    for (std::size_t device = 0; device < told[body].size(); ++device)
      if (std::optional<DeviceReading> light = std::exchange(told[body][device], std::nullopt))
        seen.bodies[body].devices[device] = std::move(*light);
}

/// What goes to controllers.
const Observation& Session::Impl::as_read(std::int64_t tick) {
  if (!noise.has_joints()) return seen;
  disturbed = seen;
  noise.disturb_joints(tick, disturbed);
  return disturbed;
}

/// Devices do what controllers said to them. A light's new state is what it reads in the next tick, to those who
/// listen.
void Session::Impl::obey(std::int64_t tick) {
  if (vision) vision->obey(tick, command);
  scanner->switch_sensors(tick, command);
  told.resize(command.bodies.size());
  for (std::size_t body = 0; body < told.size(); ++body) {
    told[body].resize(command.bodies[body].devices.size());
    for (std::size_t device = 0; device < told[body].size(); ++device) {
      const DeviceCommand& wanted = command.bodies[body].devices[device];
      if (!wanted.fresh || !std::holds_alternative<Light>(scenario.bodies[body].model->devices[device].kind)) continue;
      DeviceReading& reading = told[body][device].emplace();
      reading.fresh = true;
      reading.measured_at = time_of(tick + 1, scenario.time_step);
      reading.values = wanted.values;
    }
  }
  clear_words(command);
}

void Session::Impl::push() {
  const double now = world->time();
  for (const Push& push : scenario.pushes)
    if (push.from <= now && now < push.until) world->push(push.body, push.link, push.force, push.point, push.torque);
}

/// What the world has to say of its bodies is an event of the run as well.
Result<void> Session::Impl::record_remarks() {
  std::vector<msg::Event> events;
  for (const Diagnostic& remark : world->remarks()) {
    msg::Event& event = events.emplace_back();
    event.severity = to_string(remark.severity);
    event.source = "world";
    event.text = remark.message;
  }
  append_remarks(events, summary.remarks);
  return recorder->record_events(events);
}

Result<bool> Session::step() {
  Impl& run = *impl_;
  const std::int64_t tick = run.world->tick();
  if (tick >= run.scenario.ticks() || run.host->failure() || run.summary.failure) return false;

  run.sense(tick);
  if (tick % run.checkpoint_interval == 0)
    if (auto done = run.recorder->record_checkpoint(tick, run.world->save()); !done) return done.errors();
  const Observation& read = run.as_read(tick);
  const bool alive = run.host->control(tick, read);  // input, control, output of each controller
  run.host->output(ControllerHost::Timing::same_step, run.command);
  if (auto done = run.recorder->record_state(tick, run.seen, read); !done) return done.errors();
  const TickHashes hashes{run.world->state_hash(), run.host->input_hash(read), run.host->output_hash()};
  if (auto done = run.recorder->record_tick(tick, run.host.get(), hashes); !done) return done.errors();
  if (auto done = run.record_events(); !done) return done.errors();
  if (!alive) return false;

  run.world->actuate(run.command);
  run.push();
  if (!run.world->step())
    run.summary.failure =
        error(fmt::format("the simulation exploded in the step after tick {}: a position or velocity "
                          "is no longer finite",
                          tick));
  clear_wrenches(run.command);
  run.host->output(ControllerHost::Timing::next_step, run.command);
  run.obey(tick);
  return true;
}

Result<void> Session::Impl::record_events() {
  const std::vector<msg::Event> events = host->take_events();
  append_remarks(events, summary.remarks);
  return recorder->record_events(events);
}

Result<RunSummary> Session::finish() {
  Impl& run = *impl_;
  const std::int64_t tick = run.world->tick();
  run.host->stop();
  if (!run.summary.failure && run.host->failure()) run.summary.failure = *run.host->failure();
  if (!run.summary.failure) {  // the state after the last step closes a complete run
    run.sense(tick);
    if (auto done = run.recorder->record_state(tick, run.seen, run.as_read(tick)); !done) return done.errors();
    if (auto done = run.recorder->record_tick(tick, nullptr, {run.world->state_hash(), 0, 0}); !done)
      return done.errors();
  }
  if (auto done = run.record_events(); !done) return done.errors();
  const RecordingSize& size = run.recorder->size();
  mcap::StringMap outcome{{"ticks", std::to_string(size.ticks)}, {"complete", run.summary.failure ? "false" : "true"}};
  if (run.summary.failure) outcome["failure"] = run.summary.failure->message;
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
