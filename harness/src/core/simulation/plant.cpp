#include "plant.h"

#include "base/clock.h"

#include <algorithm>
#include <utility>

namespace rehearse {
namespace {

std::vector<std::shared_ptr<const Model>> models_of(const Scenario& scenario) {
  std::vector<std::shared_ptr<const Model>> models;
  for (const ScenarioBody& body : scenario.bodies) models.push_back(body.model);
  return models;
}

/// The models with the exposures that the scenario gives to their cameras.
std::vector<std::shared_ptr<const Model>> exposed_models(const Scenario& scenario) {
  std::vector<std::shared_ptr<const Model>> models = models_of(scenario);
  for (std::size_t b = 0; b < models.size(); ++b) {
    const std::vector<ReadingErrors>& errors = scenario.bodies[b].errors.devices;
    if (std::ranges::all_of(errors, [](const auto& each) { return each.exposure.is_instant(); })) continue;
    Model model = *models[b];
    for (std::size_t i = 0; i < errors.size(); ++i)
      if (auto* camera = std::get_if<Camera>(&model.devices[i].kind)) camera->exposure = errors[i].exposure;
    models[b] = std::make_shared<const Model>(std::move(model));
  }
  return models;
}

/// Null if no camera runs: then no renderer is needed.
Result<std::unique_ptr<Vision>> make_vision(const Scenario& scenario) {
  if (!scenario.runs_a_camera()) return std::unique_ptr<Vision>();
  std::vector<std::vector<bool>> active;
  for (const ScenarioBody& body : scenario.bodies) {
    std::vector<bool>& of_body = active.emplace_back();
    for (const Device& device : body.model->devices)
      of_body.push_back(std::holds_alternative<Camera>(device.kind) && scenario.runs_camera(body.name, device.name));
  }
  return Vision::create(scenario.time_step, exposed_models(scenario), std::move(active), scenario.look);
}

}  // namespace

std::vector<WorldBody> world_bodies(const Scenario& scenario) {
  std::vector<WorldBody> bodies;
  for (const ScenarioBody& body : scenario.bodies) {
    bodies.push_back({body.name, body.model, body.fixed, body.position, body.rotation, body.joints, body.kinematic,
                      body.joint_limits.value_or(true), body.effort_limits, body.drive_limits, body.contact.touches,
                      body.self_collision, body.linear_velocity, body.angular_velocity, body.joint_velocities,
                      body.materials, scenario.planar, body.actuators, body.mass_faults});
    std::vector<std::optional<Actuator>>& actuators = bodies.back().actuators;
    for (std::size_t id = 0; id < actuators.size(); ++id) {
      const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
      if (actuators[id]) actuators[id]->key = key_of("actuator", body.name, joint.name, scenario.seed);
    }
  }
  return bodies;
}

Result<std::unique_ptr<Plant>> Plant::create(const Scenario& scenario, const Scenario* noise_of) {
  std::unique_ptr<Plant> plant(new Plant(scenario, noise_of ? *noise_of : scenario));
  plant->world_ = REHEARSE_TRY(World::create(scenario, world_bodies(scenario)));
  plant->scanner_ = std::make_unique<Scanner>(*plant->world_, scenario.time_step, models_of(scenario));
  plant->vision_ = REHEARSE_TRY(make_vision(scenario));
  return plant;
}

void Plant::sense() {
  const std::int64_t tick = world_->tick();
  seen_ = world_->sense();
  if (scenario_.joystick) seen_.joystick = scenario_.joystick->at(time_of(tick, scenario_.time_step));
  if (vision_) vision_->look(tick, seen_);
  scanner_->look(tick, seen_);
  errors_.disturb_devices(tick, seen_);
  for (std::size_t body = 0; body < told_.size(); ++body)
    for (std::size_t device = 0; device < told_[body].size(); ++device)
      if (std::optional<DeviceReading> light = std::exchange(told_[body][device], std::nullopt))
        seen_.bodies[body].devices[device] = std::move(*light);
  if (!errors_.has_joints()) return;
  read_ = seen_;
  errors_.disturb_joints(tick, read_);
}

bool step_world(World& world, const Scenario& scenario, const Command& command) {
  world.actuate(command);
  const double now = world.time();
  for (const Push& push : scenario.pushes)
    if (push.from <= now && now < push.until) world.push(push.body, push.link, push.force, push.point, push.torque);
  return world.step();
}

void use_up_wrenches(Command& command) {
  for (BodyCommand& body : command.bodies) std::ranges::fill(body.external, Wrench{});
}

bool Plant::step(Command& command) {
  const bool alive = step_world(*world_, scenario_, command);
  use_up_wrenches(command);
  return alive;
}

void Plant::obey(std::int64_t tick, Command& command) {
  if (vision_) vision_->obey(tick, command);
  scanner_->switch_sensors(tick, command);
  told_.assign(command.bodies.size(), {});
  for (std::size_t body = 0; body < told_.size(); ++body) {
    told_[body].resize(command.bodies[body].devices.size());
    for (std::size_t device = 0; device < told_[body].size(); ++device) {
      DeviceCommand& wanted = command.bodies[body].devices[device];
      const bool fresh = std::exchange(wanted.fresh, false);
      if (!fresh || !is_actuator(scenario_.bodies[body].model->devices[device])) continue;
      world_->command_device(static_cast<int>(body), static_cast<int>(device), wanted.values);
      if (!std::holds_alternative<Light>(scenario_.bodies[body].model->devices[device].kind)) continue;
      DeviceReading& reading = told_[body][device].emplace();
      reading.fresh = true;
      reading.measured_at = time_of(tick + 1, scenario_.time_step);
      reading.values = wanted.values;
    }
  }
}

void Plant::begin_at(std::int64_t tick, std::span<const std::byte> readings) {
  REHEARSE_ASSERT(world_->tick() == tick, "the world is at the beginning of that tick");
  if (vision_) vision_->begin_at(tick);
  scanner_->begin_at(tick);
  errors_.restore(readings);
}

}  // namespace rehearse
