// The cost of copying a robot's inputs to its controller and the commands back.

#include "core/host/controller_host.h"
#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

constexpr std::int64_t slice = 100;          // ticks measured at a time
constexpr std::int64_t copies = 50 * slice;  // so that both sides take about as long

/// Work: displacements and velocities of SR1's 29 joints in, their efforts out. Base: World::actuate() and
/// World::step().
void copying_over_bare_loop(benchmark::State& state) {
  const Sr1Run& sr1 = Sr1Run::instance();
  const ScenarioBody& robot = sr1.scenario().bodies[1];
  IoBody body(robot, initial_observation(sr1.scenario()).bodies[1]);
  ControllerIo io("Copying", "", "", sr1.scenario().time_step);
  io.attach(body);
  for (cnoid::Link* joint : body.body().joints()) {
    io.enableInput(joint, cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity);
    io.enableOutput(joint, cnoid::Link::JointEffort);
  }
  io.freeze();
  const auto world = sr1.make_world();
  const BodyObservation seen = world->sense().bodies[1];
  std::size_t tick = 0;
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    const auto copy = [&] {
      for (std::int64_t i = 0; i < copies; ++i) {
        io.input(seen);
        io.output();
        benchmark::DoNotOptimize(io.output_values().data());
      }
    };
    const auto step = [&] {
      for (std::int64_t i = 0; i < slice; ++i) {
        world->actuate(sr1.commands()[tick++ % sr1.commands().size()]);
        world->step();
      }
    };
    state.SetIterationTime(pairs.measure(copy, step));
  }
  pairs.report(state, copies, slice);
}
BENCHMARK(copying_over_bare_loop)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
