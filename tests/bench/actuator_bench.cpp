// The cost of actuators and sensors as they are built relative to ideal ones: SR1 with 29 joints and 5 sensors, under
// recorded commands.

#include <rehearse/scenario.h>
#include <rehearse/world.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/simulation/sensor_errors.h"
#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

constexpr std::int64_t actuated_slice = 100;  // steps measured at a time

struct BuiltParts {
  bool friction = false;
  bool backlash = false;
};

/// SR1 and its floor; each of its joints has 3 ms of delay, and these parts.
std::vector<WorldBody> built_bodies(const BuiltParts& parts) {
  std::vector<WorldBody> bodies = Sr1Run::instance().bodies();
  Actuator actuator;
  actuator.delay = 0.003;
  if (parts.friction) {
    actuator.damping = 0.1;
    actuator.coulomb = 0.1;
    actuator.stiction = 0.15;
    actuator.stribeck = 0.1;
  }
  if (parts.backlash) {
    actuator.armature = 0.01;
    actuator.backlash = 0.001;
    actuator.contact_damping = 10.0;
  }
  for (WorldBody& body : bodies) body.actuators.assign(body.model->joints.size(), actuator);
  return bodies;
}

/// A world that is told the recorded commands, and begins again at their end.
class CommandedWorld {
 public:
  explicit CommandedWorld(std::vector<WorldBody> bodies) : bodies_(std::move(bodies)) {}
  /// `look` is called with the world before each step.
  template <class Look>
  void run(Look look) {
    const std::vector<Command>& commands = Sr1Run::instance().commands();
    for (std::int64_t i = 0; i < actuated_slice; ++i) {
      look(*world_);
      world_->actuate(commands[static_cast<std::size_t>(world_->tick())]);
      world_->step();
    }
  }
  void run() {
    run([](const World&) {});
  }
  /// True if the world is new.
  bool prepare() {
    const Sr1Run& sr1 = Sr1Run::instance();
    if (world_ && world_->tick() + actuated_slice <= sr1.ticks() / 10) return false;  // it stands in the first second
    world_ = sr1.make_world(SolverSettings(), bodies_);                               // the direct one, as in scenarios
    return true;
  }

 private:
  const std::vector<WorldBody> bodies_;
  std::unique_ptr<World> world_;
};

/// Work: World::actuate() and World::step() with such actuators. Base: without.
void over_ideal_actuators(benchmark::State& state, const BuiltParts& parts) {
  CommandedWorld built(built_bodies(parts)), ideal(Sr1Run::instance().bodies());
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    built.prepare();
    ideal.prepare();
    state.SetIterationTime(pairs.measure([&] { built.run(); }, [&] { ideal.run(); }));
  }
  pairs.report(state, actuated_slice, actuated_slice);
}
void actuators_with_delay_over_ideal(benchmark::State& state) { over_ideal_actuators(state, {}); }
void actuators_with_friction_over_ideal(benchmark::State& state) { over_ideal_actuators(state, {true, false}); }
void actuators_with_backlash_over_ideal(benchmark::State& state) { over_ideal_actuators(state, {true, true}); }
BENCHMARK(actuators_with_delay_over_ideal)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(actuators_with_friction_over_ideal)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(actuators_with_backlash_over_ideal)->UseManualTime()->Unit(benchmark::kMillisecond);

constexpr const char* errors_of_all = R"(
noise:
  - {joint: "SR1/*", displacement: {counts: 4096}, velocity: {stddev: 0.01}, latency: 2 ms}
  - {sensor: "SR1/Waist*", angular_velocity: {density: 0.01 deg/s/sqrt(Hz), bias_walk: 0.001 deg/s/sqrt(s)},
     acceleration: {density: 100 ug/sqrt(Hz), bias_walk: 1 mg/sqrt(s)}, latency: 5 ms}
  - {sensor: "SR1/*ForceSensor", force: {stddev: 0.1}, torque: {stddev: 0.01}, latency: 2 ms}
)";

/// Work: the same with the readings of World::sense(), and the errors of all joints and sensors but cameras. Base:
/// without the errors.
void errors_of_sensors_over_none(benchmark::State& state) {
  const Sr1Run& sr1 = Sr1Run::instance();
  const Scenario scenario = must(Scenario::load_text(sr1.scenario().text + errors_of_all, sr1.scenario().file));
  std::optional<SensorErrors> errors;
  Observation read;
  CommandedWorld with(sr1.bodies()), without(sr1.bodies());
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    if (with.prepare()) errors.emplace(scenario);
    without.prepare();
    const auto disturb = [&](const World& world) {
      read = world.sense();
      errors->disturb_devices(world.tick(), read);
      errors->disturb_joints(world.tick(), read);
    };
    const auto copy = [&](const World& world) { read = world.sense(); };
    state.SetIterationTime(pairs.measure([&] { with.run(disturb); }, [&] { without.run(copy); }));
  }
  pairs.report(state, actuated_slice, actuated_slice);
}
BENCHMARK(errors_of_sensors_over_none)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
