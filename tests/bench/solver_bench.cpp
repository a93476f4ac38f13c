// The cost of a step with the direct solver relative to one with ODE's quick solver: SR1 standing, held by PD torques
// and by drives with limited efforts, SR1 with fingers, a recorded second, and chains of links.

#include <rehearse/session.h>
#include <rehearse/world.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pairs.h"
#include "sr1_run.h"
#include "standing.h"

namespace rehearse {
namespace {

constexpr int slice = 50;  // steps measured at a time

void direct_over_quick(benchmark::State& state, Standing::Held held) {
  Standing direct(SolverSettings::Method::direct, held), quick(SolverSettings::Method::quick, held);
  Pairs pairs;
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { direct.steps(slice); }, [&] { quick.steps(slice); }));
  if (direct.height() < 0.7) state.SkipWithError("SR1 fell");
  pairs.report(state, slice, slice);
}

/// Work: a step of SR1 standing with the direct solver. Base: the same with 50 iterations of the quick solver.
void direct_step_over_quick(benchmark::State& state) { direct_over_quick(state, Standing::Held::by_torque); }
BENCHMARK(direct_step_over_quick)->UseManualTime()->Unit(benchmark::kMillisecond);

/// The same, every joint moved by a drive with a limited effort.
void direct_step_of_limited_drives_over_quick(benchmark::State& state) {
  direct_over_quick(state, Standing::Held::by_limited_drive);
}
BENCHMARK(direct_step_of_limited_drives_over_quick)->UseManualTime()->Unit(benchmark::kMillisecond);

/// The same for 43 joints.
void direct_step_of_43_joints_over_quick(benchmark::State& state) {
  direct_over_quick(state, Standing::Held::by_torque_with_fingers);
}
BENCHMARK(direct_step_of_43_joints_over_quick)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: SR1 recorded for a second with the direct solver, without cameras. Base: the same with the quick solver.
void direct_record_over_quick(benchmark::State& state) {
  Scenario quick = Sr1Run::instance().scenario();
  quick.duration = 1.0;
  Scenario direct = quick;
  direct.solver.method = SolverSettings::Method::direct;
  const std::filesystem::path file = Sr1Run::instance().folder() / "second.mcap";
  Pairs pairs;
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { must(record(direct, file)); }, [&] { must(record(quick, file)); }));
  pairs.report(state, quick.ticks(), quick.ticks());
}
BENCHMARK(direct_record_over_quick)->UseManualTime()->Unit(benchmark::kMillisecond);

/// A chain of links that hangs from the world and swings.
std::unique_ptr<World> chain(int links) {
  Model model;
  model.name = "Chain";
  model.links.resize(static_cast<std::size_t>(links) + 1);
  model.links[0].name = "BASE";
  model.links[0].joint.type = JointType::fixed;
  for (int i = 1; i <= links; ++i) {
    Link& link = model.links[static_cast<std::size_t>(i)];
    link.name = link.joint.name = "LINK" + std::to_string(i);
    link.parent = i - 1;
    link.inertial = {1.0, Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Matrix3d::Identity() * 0.01};
    link.joint.type = JointType::revolute;
    link.joint.axis = i % 2 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    if (i > 1) link.joint.origin.translation().x() = 0.2;
    link.joint.id = i - 1;
    model.joints.push_back(i);
  }
  WorldBody body;
  body.name = "Chain";
  body.joints.assign(static_cast<std::size_t>(links), 0.0);
  body.model = std::make_shared<const Model>(std::move(model));
  WorldSettings settings;
  settings.solver.method = SolverSettings::Method::direct;
  return must(World::create(settings, {std::move(body)}));
}

/// Work: a step of a chain of 200 links, for each link. Base: a step of a chain of 10 links.
void direct_step_per_link(benchmark::State& state) {
  constexpr int many = 200, few = 10;
  const std::unique_ptr<World> longer = chain(many), shorter = chain(few);
  const auto steps = [](World& world, int count) {
    for (int i = 0; i < count; ++i)
      if (!world.step()) std::abort();
  };
  Pairs pairs;
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { steps(*longer, slice); }, [&] { steps(*shorter, slice * many / few); }));
  pairs.report(state, slice * many, slice * many);
}
BENCHMARK(direct_step_per_link)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
