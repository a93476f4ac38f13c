#include "sr1_run.h"

#include <rehearse/session.h>
#include <rehearse/trace.h>
#include <unistd.h>

namespace rehearse {

const Sr1Run& Sr1Run::instance() {
  static const Sr1Run run;
  return run;
}

Sr1Run::Sr1Run()
    : folder_(std::filesystem::temp_directory_path() / ("rehearse_bench_" + std::to_string(getpid()))),
      trace_(folder_ / "sr1.mcap") {
  std::filesystem::create_directories(folder_);
  scenario_ = must(Scenario::load(std::filesystem::path(FIXTURES_DIR) / "scenarios/sr1_minimum.yaml"));
  scenario_.cameras.emplace();  // none
  // budgets are shares of this loop, whose cost is that of ODE's solver: they stay comparable whatever ours costs
  scenario_.solver.method = SolverSettings::Method::quick;
  scenario_.duration = 10.0;
  must(record(scenario_, trace_));

  const Trace trace = must(Trace::load(trace_));
  Command command;
  for (const ScenarioBody& body : scenario_.bodies) {
    BodyCommand& told = command.bodies.emplace_back();
    told.external.resize(body.model->links.size());
    for (const double q : body.joints) told.joints.push_back({drive_effort, q, 0.0, 0.0});
  }
  commands_.assign(static_cast<std::size_t>(ticks()), command);
  const Model& robot = *scenario_.bodies[1].model;
  for (std::size_t id = 0; id < robot.joints.size(); ++id) {
    const auto u = trace.values("SR1/SR1Minimum/output/" + robot.links[robot.joints[id]].joint.name + "/u");
    for (std::size_t tick = 1; tick < commands_.size(); ++tick)  // commands act one tick late
      commands_[tick].bodies[1].joints[id].u = u[tick - 1];
  }
}

Sr1Run::~Sr1Run() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::vector<WorldBody> Sr1Run::bodies() const {
  std::vector<WorldBody> bodies;
  for (const ScenarioBody& body : scenario_.bodies)
    bodies.push_back({body.name, body.model, body.fixed, body.position, body.rotation, body.joints, body.kinematic,
                      body.joint_limits.value_or(true), body.effort_limits, body.self_collision});
  return bodies;
}

std::unique_ptr<World> Sr1Run::make_world(const SolverSettings& solver, std::vector<WorldBody> bodies) const {
  return must(World::create({scenario_.time_step, scenario_.gravity, scenario_.seed, solver}, std::move(bodies)));
}

}  // namespace rehearse
