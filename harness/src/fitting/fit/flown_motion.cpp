#include "flown_motion.h"

#include <fmt/format.h>
#include <rehearse/trace.h>
#include <rehearse/world.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/compare/scenario_changes.h"
#include "core/kinds/channel_name.h"
#include "core/scenario/trace_scenario.h"
#include "core/simulation/noise_estimate.h"
#include "core/simulation/plant.h"
#include "core/simulation/recorded_checkpoints.h"
#include "core/simulation/recorded_commands.h"

namespace rehearse {
namespace {

constexpr double least_noise = 1e-9;          // in the unit of any series: differences of rounding are below it
constexpr std::size_t most_stretches = 2000;  // of a recording; of more, evenly spaced ones are taken
constexpr double time_constants = 5.0;        // after which a lag has forgotten its first state
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

const Joint& joint_of(const Model& model, std::size_t id) {
  return model.links[static_cast<std::size_t>(model.joints[id])].joint;
}

/// A part of the world's state that can't be estimated from joints; empty: there is none.
std::string unknown_state(const Scenario& scenario, std::size_t flown) {
  for (std::size_t i = 0; i < scenario.bodies.size(); ++i) {
    const ScenarioBody& body = scenario.bodies[i];
    if (!body.fixed)
      return i == flown ? fmt::format("the base of '{}' isn't fixed", body.name)
                        : fmt::format("'{}' can move", body.name);
    for (std::size_t id = 0; id < body.actuators.size(); ++id) {
      if (!body.actuators[id]) continue;
      const char* const part = body.actuators[id]->backlash > 0.0      ? "backlash"
                               : body.actuators[id]->continuous_effort ? "heat"
                                                                       : nullptr;
      if (part) return fmt::format("the actuator of '{}' has a state ({})", joint_of(*body.model, id).name, part);
    }
  }
  return {};
}

}  // namespace

double value_of(const FlownSeries& series, const BodyObservation& body) {
  const auto index = static_cast<std::size_t>(series.index);
  switch (series.quantity) {
    case FlownSeries::Quantity::displacement: return body.joints[index].q;
    case FlownSeries::Quantity::velocity: return body.joints[index].dq;
    case FlownSeries::Quantity::linear_velocity: return body.links[0].velocity[series.index];
    case FlownSeries::Quantity::angular_velocity: return body.links[0].angular_velocity[series.index];
  }
  return no_number;
}

double memory_of_drives(const Scenario& scenario) {
  double longest = 0.0;
  for (const ScenarioBody& body : scenario.bodies)
    for (const std::optional<Actuator>& actuator : body.actuators) {
      if (!actuator) continue;
      const double lag =
          actuator->bandwidth > 0.0 ? time_constants / (2.0 * std::numbers::pi * actuator->bandwidth) : 0.0;
      longest = std::max(longest, actuator->delay + actuator->jitter + actuator->period + lag);
    }
  return longest;
}

void FlownMotion::read_numbers(const Scenario& scenario, const Trace& trace) {
  const ScenarioBody& body = scenario.bodies[body_];
  struct Column {
    const TraceChannel* channel;
    std::size_t column;
  };
  std::vector<Column> columns;
  const auto add = [&](ChannelName name, const std::string& element, FlownSeries::Quantity quantity, int index) {
    const TraceChannel* const channel = trace.find_channel(name.topic());
    if (!channel) return;
    for (std::size_t i = 0; i < channel->columns.size(); ++i)
      if (channel->columns[i].element == element) {
        columns.push_back({channel, i});
        series_.push_back({series_name(channel->topic, element), quantity, index});
      }
  };
  const bool is_measured = trace.find_channel(ChannelName::of_body(body.name, ChannelKind::measured_joints).topic());
  const ChannelName joints =
      ChannelName::of_body(body.name, is_measured ? ChannelKind::measured_joints : ChannelKind::joints);
  for (std::size_t id = 0; id < body.model->joints.size(); ++id) {
    const Joint& joint = joint_of(*body.model, id);
    if (!is_movable(joint.type)) continue;
    add(joints, joint.name + "/q", FlownSeries::Quantity::displacement, static_cast<int>(id));
    add(joints, joint.name + "/dq", FlownSeries::Quantity::velocity, static_cast<int>(id));
  }
  if (!body.fixed) {
    const ChannelName twist = ChannelName::of_owner(body.name, body.model->links[0].name, ChannelKind::twist);
    constexpr const char* axes[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis)
      add(twist, fmt::format("linear/{}", axes[axis]), FlownSeries::Quantity::linear_velocity, axis);
    for (int axis = 0; axis < 3; ++axis)
      add(twist, fmt::format("angular/{}", axes[axis]), FlownSeries::Quantity::angular_velocity, axis);
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const TraceChannel& channel = *columns[i].channel;
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const auto tick = std::llround(static_cast<double>(channel.times[row]) * 1e-9 / scenario.time_step);
      const std::size_t end = static_cast<std::size_t>(tick + 1) * series_.size();
      if (numbers_.size() < end) numbers_.resize(end, no_number);
      numbers_[static_cast<std::size_t>(tick) * series_.size() + i] = channel.number(row, columns[i].column);
    }
  }
}

Result<void> FlownMotion::read_commands(const Scenario& scenario, const Trace& trace) {
  auto commands = REHEARSE_TRY(RecordedCommands::find(scenario, trace));
  Command command = commands.initial();
  const std::size_t ticks = series_.empty() ? 0 : numbers_.size() / series_.size();
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    commands.put(static_cast<std::int64_t>(tick), Timing::same_step, command);
    commands_.push_back(command);
    use_up_wrenches(command);
    commands.put(static_cast<std::int64_t>(tick), Timing::next_step, command);
    Command& devices = device_commands_.emplace_back();
    for (BodyCommand& body : command.bodies) {
      devices.bodies.emplace_back().devices = body.devices;
      for (DeviceCommand& device : body.devices) device.fresh = false;
    }
  }
  return {};
}

void FlownMotion::measure_noise() {
  for (std::size_t i = 0; i < series_.size(); ++i) {
    NoiseEstimate noise;
    for (std::int64_t tick = 0; tick < ticks(); ++tick) {
      const double number = measured(tick, i);
      std::isfinite(number) ? noise.add(number) : noise.interrupt();
    }
    series_[i].noise = std::max(noise.value(), least_noise);
  }
}

/// True if each of these ticks has all numbers.
bool FlownMotion::is_whole(std::int64_t first, std::int64_t last) const {
  for (std::int64_t tick = first; tick <= last; ++tick)
    for (std::size_t i = 0; i < series_.size(); ++i)
      if (!std::isfinite(measured(tick, i))) return false;
  return true;
}

Result<void> FlownMotion::find_complete_stretches(const Scenario& scenario, const Trace& trace, const Extent& extent) {
  // a checkpoint has the commands on their way in the drives of the recorded scenario, which fit no others
  const auto recorded = REHEARSE_TRY(recorded_scenario(trace));
  if (!extent.keeps_memory || memory_of_drives(recorded) != memory_of_drives(scenario))
    return error_in(file_,
                    "the base isn't fixed, or drives have a state, and delays differ from those of the recording",
                    "fit delays, bandwidths and periods to recordings of robots on a fixed base");
  RecordedCheckpoints checkpoints(trace, scenario);
  const std::vector<std::int64_t> begins = checkpoints.ticks();
  const auto world = REHEARSE_TRY(World::create(scenario, world_bodies(scenario)));
  const std::size_t every = begins.size() / most_stretches + 1;
  for (std::size_t i = 0; i < begins.size(); i += every) {
    const std::int64_t next = i + every < begins.size() ? begins[i + every] : ticks();
    const std::int64_t last = std::min({begins[i] + extent.compared, next, ticks() - 1});
    if (last <= begins[i] || !is_whole(begins[i] + 1, last)) continue;
    REHEARSE_TRY(checkpoints.restore(begins[i], *world));
    stretches_.push_back({begins[i], begins[i] + 1, last, world->save()});
  }
  has_complete_states_ = true;
  return {};
}

Result<void> FlownMotion::find_estimated_stretches(const Scenario& scenario, const Extent& extent) {
  for (std::size_t id = 0; id < scenario.bodies[body_].model->joints.size(); ++id) {
    const Joint& joint = joint_of(*scenario.bodies[body_].model, id);
    const auto is_its = [&](const FlownSeries& one) {
      return one.index == static_cast<int>(id) && one.quantity == FlownSeries::Quantity::displacement;
    };
    if (is_movable(joint.type) && std::ranges::none_of(series_, is_its))
      return error_in(file_, fmt::format("it has no displacement of joint '{}'", joint.name));
  }
  std::vector<FlownStretch> all;
  for (std::int64_t first = extent.lead; first + extent.compared < ticks();) {
    const std::int64_t last = first + extent.compared;
    const bool is_used = is_whole(first - extent.lead, last);
    if (is_used) all.push_back({first - extent.lead, first, last, {}});
    first = is_used ? last + 1 : first + 1;
  }
  const std::size_t every = all.size() / most_stretches + 1;
  for (std::size_t i = 0; i < all.size(); i += every) stretches_.push_back(std::move(all[i]));
  return {};
}

Result<std::unique_ptr<const FlownMotion>> FlownMotion::read(const Scenario& scenario, const std::string& file,
                                                             const Extent& extent) {
  const auto trace = REHEARSE_TRY(Trace::load(file));
  if (const auto change = changed_time_step(scenario, trace))
    return error_in(file, fmt::format("its time step is {} s, and that of {} is {} s", change->expected, scenario.name,
                                      change->actual));
  auto motion = std::make_unique<FlownMotion>();
  motion->file_ = file;
  while (motion->body_ < scenario.bodies.size() && scenario.bodies[motion->body_].controllers.empty()) ++motion->body_;
  if (motion->body_ == scenario.bodies.size())
    return error_in(scenario.file, "no body of it has a controller: it can't be that of the recording");
  motion->read_numbers(scenario, trace);
  if (motion->series_.empty())
    return error_in(file, fmt::format("it has no joints of '{}'", scenario.bodies[motion->body_].name));
  REHEARSE_TRY(motion->read_commands(scenario, trace));
  motion->measure_noise();
  const std::string unknown = unknown_state(scenario, motion->body_);
  const std::string objection = REHEARSE_TRY(RecordedCheckpoints(trace, scenario).objection());
  if (!unknown.empty() && !objection.empty())
    return error_in(file, fmt::format("the state of the world isn't known: {}, and {}", unknown, objection));
  if (!unknown.empty())
    REHEARSE_TRY(motion->find_complete_stretches(scenario, trace, extent));
  else
    REHEARSE_TRY(motion->find_estimated_stretches(scenario, extent));
  if (motion->stretches_.empty())
    return error_in(file, fmt::format("it has no stretch of {} ticks in which nothing is missing",
                                      extent.lead + extent.compared + 1));
  return std::unique_ptr<const FlownMotion>(std::move(motion));
}

}  // namespace rehearse
