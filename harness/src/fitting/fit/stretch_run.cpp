#include "stretch_run.h"

#include <algorithm>
#include <utility>

#include "base/clock.h"
#include "core/simulation/plant.h"

namespace rehearse {

std::vector<std::size_t> movable_joints(const Model& model) {
  std::vector<std::size_t> ids;
  for (std::size_t id = 0; id < model.joints.size(); ++id)
    if (is_movable(model.links[static_cast<std::size_t>(model.joints[id])].joint.type)) ids.push_back(id);
  return ids;
}

StretchRun::StretchRun(const Scenario& scenario, const Scenario& nominal, const FlownMotion& motion)
    : scenario_(scenario), nominal_(nominal), motion_(motion), bodies_(world_bodies(scenario)) {}

/// Sets the world to the first state of the stretch.
Result<void> StretchRun::begin(const FlownStretch& stretch, const Eigen::VectorXd& start) {
  if (!stretch.state.empty()) {
    if (!saved_) saved_ = REHEARSE_TRY(World::create(nominal_, world_bodies(nominal_)));
    if (!world_) world_ = REHEARSE_TRY(World::create(scenario_, bodies_));
    REHEARSE_TRY(saved_->restore(stretch.state));
    return world_->take_state(*saved_);
  }
  WorldBody& flown = bodies_[motion_.body()];
  const std::vector<std::size_t> ids = movable_joints(*flown.model);
  flown.joint_velocities.resize(flown.joints.size(), 0.0);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    flown.joints[ids[i]] = start[static_cast<Eigen::Index>(i)];
    flown.joint_velocities[ids[i]] = start[static_cast<Eigen::Index>(ids.size() + i)];
  }
  world_ = REHEARSE_TRY(World::create(scenario_, bodies_));
  return {};
}

/// Takes the numbers of a tick. Before its first step a world measures no velocity: it has that of the start.
void StretchRun::take(std::int64_t tick, const FlownStretch& stretch, const Eigen::VectorXd& start,
                      Eigen::VectorXd& numbers) {
  const std::vector<FlownSeries>& series = motion_.series();
  const Eigen::Index row = static_cast<Eigen::Index>(tick - stretch.first) * static_cast<Eigen::Index>(series.size());
  if (tick > stretch.begin) {
    const BodyObservation& seen = world_->sense().bodies[motion_.body()];
    for (std::size_t i = 0; i < series.size(); ++i)
      numbers[row + static_cast<Eigen::Index>(i)] = value_of(series[i], seen);
    return;
  }
  const std::vector<std::size_t> ids = movable_joints(*bodies_[motion_.body()].model);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto joint = std::ranges::find(ids, static_cast<std::size_t>(series[i].index)) - ids.begin();
    const bool is_velocity = series[i].quantity == FlownSeries::Quantity::velocity;
    numbers[row + static_cast<Eigen::Index>(i)] =
        start[joint + (is_velocity ? static_cast<Eigen::Index>(ids.size()) : 0)];
  }
}

Result<std::optional<Eigen::VectorXd>> StretchRun::predict(const FlownStretch& stretch, const Eigen::VectorXd& start) {
  REHEARSE_TRY(begin(stretch, start));
  const auto rows = static_cast<Eigen::Index>(stretch.last - stretch.first + 1);
  Eigen::VectorXd numbers(rows * static_cast<Eigen::Index>(motion_.series().size()));
  for (std::int64_t tick = stretch.begin; tick <= stretch.last; ++tick) {
    if (tick >= stretch.first) take(tick, stretch, start, numbers);
    if (tick == stretch.last) break;
    world_->actuate(motion_.command(tick));
    const double now = time_of(tick, scenario_.time_step);
    for (const Push& push : scenario_.pushes)
      if (push.from <= now && now < push.until) world_->push(push.body, push.link, push.force, push.point, push.torque);
    if (!world_->step()) {
      world_.reset();
      return std::optional<Eigen::VectorXd>();
    }
    const Command& devices = motion_.device_command(tick);
    for (std::size_t body = 0; body < devices.bodies.size(); ++body)
      for (std::size_t device = 0; device < devices.bodies[body].devices.size(); ++device)
        if (const DeviceCommand& wanted = devices.bodies[body].devices[device];
            wanted.fresh && is_actuator(scenario_.bodies[body].model->devices[device]))
          world_->command_device(static_cast<int>(body), static_cast<int>(device), wanted.values);
  }
  return std::optional(std::move(numbers));
}

}  // namespace rehearse
