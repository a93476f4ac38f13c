#include "forced_run.h"

#include <fmt/format.h>
#include <rehearse/world.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/clock.h"
#include "core/compare/scenario_changes.h"
#include "core/guard/float_mode.h"
#include "core/kinds/channel_name.h"
#include "core/trace/trace_windows.h"
#include "noise_estimate.h"
#include "plant.h"
#include "recorded_commands.h"

namespace rehearse {
namespace {

constexpr double span_of_sums = 0.05;         // [s]
constexpr double sure = 6.0;                  // standard deviations of noise that are a difference
constexpr double rounded_velocity = 1e-9;     // of a velocity [rad/s] or [m/s]
constexpr std::size_t most_samples = 20'000;  // of a joint's third differences

/// The columns of the joints' displacements and velocities, by joint id.
struct StateColumns {
  std::size_t channel = 0;
  std::vector<std::size_t> q, dq;
};

/// Why the state of an actuator isn't known; empty: it has none.
std::string memory_of(const Actuator& actuator) {
  if (actuator.delay > 0.0 || actuator.jitter > 0.0) return "delay";
  if (actuator.bandwidth > 0.0) return "bandwidth";
  if (actuator.has_loop() && actuator.period > 0.0) return "period";
  if (actuator.backlash > 0.0) return "backlash";
  if (actuator.continuous_effort) return "heat";
  return {};
}

/// What of the world's state no flight has; empty: it has all.
std::string unknown_state(const Scenario& scenario, std::size_t flown) {
  for (std::size_t i = 0; i < scenario.bodies.size(); ++i) {
    const ScenarioBody& body = scenario.bodies[i];
    if (i == flown && !body.fixed)
      return fmt::format("the base of '{}' isn't fixed, and the flight has neither its pose nor its twist", body.name);
    if (i != flown && !body.fixed)
      return fmt::format("'{}' can move, and the flight doesn't have its state", body.name);
    for (std::size_t id = 0; id < body.actuators.size(); ++id)
      if (const std::string memory = body.actuators[id] ? memory_of(*body.actuators[id]) : ""; !memory.empty())
        return fmt::format("the actuator of '{}' has a state ({}), which the flight doesn't have",
                           body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint.name, memory);
  }
  return {};
}

/// The columns of the state; fails, with the joint, if one is missing.
Result<StateColumns> columns_of(const ScenarioBody& body, const Trace& flight) {
  const TraceChannel* const channel = flight.find_channel(ChannelName::of_body(body.name, ChannelKind::joints).topic());
  if (!channel) return error(fmt::format("the flight has no joints of '{}'", body.name));
  StateColumns found{static_cast<std::size_t>(channel - flight.channels().data()), {}, {}};
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  found.q.assign(body.model->joints.size(), none);
  found.dq = found.q;
  for (std::size_t column = 0; column < channel->columns.size(); ++column)
    for (std::size_t id = 0; id < found.q.size(); ++id) {
      const std::string& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint.name;
      if (channel->columns[column].element == joint + "/q") found.q[id] = column;
      if (channel->columns[column].element == joint + "/dq") found.dq[id] = column;
    }
  for (std::size_t id = 0; id < found.q.size(); ++id) {
    const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
    if (is_movable(joint.type) && (found.q[id] == none || found.dq[id] == none))
      return error(fmt::format("the flight has no displacement and velocity of joint '{}'", joint.name));
  }
  return found;
}

/// The sum of a joint's differences over the last ticks.
class Sum {
 public:
  explicit Sum(std::size_t span) : last_(span, 0.0) {}
  double add(double difference) {
    sum_ += difference - std::exchange(last_[at_], difference);
    at_ = (at_ + 1) % last_.size();
    if (at_ == 0) {  // errors of rounding don't remain
      sum_ = 0.0;
      for (const double one : last_) sum_ += one;
    }
    return sum_;
  }
  void clear() {
    std::ranges::fill(last_, 0.0);
    sum_ = 0.0;
  }

 private:
  std::vector<double> last_;
  std::size_t at_ = 0;
  double sum_ = 0.0;
};

class ForcedRun {
 public:
  ForcedRun(const Scenario& scenario, const Trace& flight, std::size_t body, StateColumns columns)
      : scenario_(scenario), flight_(flight), body_(body), columns_(std::move(columns)) {}

  Result<ForcedReport> compare(RecordedCommands commands,
                               const std::function<void(std::int64_t, std::int64_t)>& progress);

 private:
  struct Moved {
    int id;
    std::size_t q, dq;  // columns
    NoiseEstimate noise;
    Sum sum;
  };
  /// Calls `take(tick, table, row)` for each tick with all numbers of the state.
  template <class Take>
  void for_each_state(Take take) const;
  std::int64_t tick_at(std::uint64_t time) const {
    return std::llround(static_cast<double>(time) * 1e-9 / scenario_.time_step);
  }
  Result<void> step_from(const TraceChannel& table, std::size_t row, const Command& command);

  const Scenario& scenario_;
  const Trace& flight_;
  std::size_t body_;
  StateColumns columns_;
  std::vector<Moved> joints_;
  std::vector<double> predicted_;  // velocities after a step, by number in joints_
};

template <class Take>
void ForcedRun::for_each_state(Take take) const {
  for_each_window(flight_, {columns_.channel}, [&](const Trace& window) {
    const TraceChannel& table = window.channels()[columns_.channel];
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const bool is_whole = std::ranges::all_of(joints_, [&](const Moved& joint) {
        return std::isfinite(table.number(row, joint.q)) && std::isfinite(table.number(row, joint.dq));
      });
      if (is_whole && !take(tick_at(table.times[row]), table, row)) return false;
    }
    return true;
  });
}

/// Makes the step of a world that has the robot's state.
Result<void> ForcedRun::step_from(const TraceChannel& table, std::size_t row, const Command& command) {
  std::vector<WorldBody> bodies = world_bodies(scenario_);
  WorldBody& flown = bodies[body_];
  flown.joint_velocities.resize(flown.joints.size(), 0.0);
  for (const Moved& joint : joints_) {
    flown.joints[static_cast<std::size_t>(joint.id)] = table.number(row, joint.q);
    flown.joint_velocities[static_cast<std::size_t>(joint.id)] = table.number(row, joint.dq);
  }
  const auto world = REHEARSE_TRY(World::create(scenario_, std::move(bodies)));
  world->actuate(command);
  predicted_.clear();
  if (!world->step()) return {};  // it has exploded: this step isn't compared
  for (const Moved& joint : joints_)
    predicted_.push_back(world->sense().bodies[body_].joints[static_cast<std::size_t>(joint.id)].dq);
  return {};
}

Result<ForcedReport> ForcedRun::compare(RecordedCommands commands,
                                        const std::function<void(std::int64_t, std::int64_t)>& progress) {
  const auto span = static_cast<std::size_t>(std::max(2.0, std::round(span_of_sums / scenario_.time_step)));
  ForcedReport report;
  report.span = static_cast<double>(span) * scenario_.time_step;
  const Model& model = *scenario_.bodies[body_].model;
  for (std::size_t id = 0; id < columns_.q.size(); ++id) {
    const Joint& joint = model.links[static_cast<std::size_t>(model.joints[id])].joint;
    if (!is_movable(joint.type)) continue;
    joints_.push_back({static_cast<int>(id), columns_.q[id], columns_.dq[id], {}, Sum(span)});
    report.joints.push_back({joint.name, joint.type == JointType::prismatic});
  }
  if (joints_.empty()) return error(fmt::format("'{}' has no joint that moves", scenario_.bodies[body_].name));

  std::int64_t last = -2, all = 0;
  for_each_state([&](std::int64_t tick, const TraceChannel& table, std::size_t row) {
    all = tick;
    for (Moved& joint : joints_) {
      if (joint.noise.samples() >= most_samples) continue;
      if (tick != last + 1) joint.noise.interrupt();
      joint.noise.add(table.number(row, joint.dq));
    }
    last = tick;
    return true;
  });
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    report.joints[i].noise = joints_[i].noise.value();
    report.joints[i].floor = (sure * std::sqrt(2.0) * report.joints[i].noise + rounded_velocity) / report.span;
  }

  Command command = commands.initial();
  std::int64_t put = 0;  // the commands of the ticks before it have been put
  last = -2;
  Result<void> stepped;
  for_each_state([&](std::int64_t tick, const TraceChannel& table, std::size_t row) {
    const bool follows = tick == last + 1 && predicted_.size() == joints_.size();
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      if (!follows) {
        joints_[i].sum.clear();
        continue;
      }
      ForcedJoint& found = report.joints[i];
      const double missing = joints_[i].sum.add(table.number(row, joints_[i].dq) - predicted_[i]) / report.span;
      if (std::abs(missing) > std::abs(found.missing)) {
        found.missing = missing;
        found.worst = last;
      }
      if (!found.from && std::abs(missing) > found.floor) found.from = last;
    }
    report.steps += follows ? 1 : 0;
    for (; put <= tick; ++put) {
      if (put > 0) commands.put(put - 1, Timing::next_step, command);
      commands.put(put, Timing::same_step, command);
    }
    stepped = step_from(table, row, command);
    use_up_wrenches(command);
    last = tick;
    if (progress && tick % 100 == 0) progress(tick, all);
    return static_cast<bool>(stepped);
  });
  if (!stepped) return stepped.errors();
  return report;
}

}  // namespace

const ForcedJoint* ForcedReport::first() const {
  const ForcedJoint* found = nullptr;
  for (const ForcedJoint& joint : joints)
    if (joint.from && (!found || *joint.from < *found->from)) found = &joint;
  return found;
}

Result<ForcedReport> compare_with_flight(const Scenario& scenario, const Trace& flight,
                                         const std::function<void(std::int64_t done, std::int64_t all)>& progress) {
  const StandardFloatMode float_mode;
  if (const auto change = changed_time_step(scenario, flight))
    return error_in(flight.file(), fmt::format("its time step is {} s, and that of {} is {} s", change->expected,
                                               scenario.name, change->actual));
  std::size_t body = 0;
  while (body < scenario.bodies.size() && scenario.bodies[body].controllers.empty()) ++body;
  if (body == scenario.bodies.size())
    return error_in(scenario.file, "no body of it has a controller: it can't be that of the flight");
  ForcedReport report;
  report.undecided = unknown_state(scenario, body);
  if (!report.undecided.empty()) return report;
  auto columns = columns_of(scenario.bodies[body], flight);
  if (!columns) {
    report.undecided = columns.errors()[0].message;
    return report;
  }
  auto commands = REHEARSE_TRY(RecordedCommands::find(scenario, flight));
  return ForcedRun(scenario, flight, body, *std::move(columns)).compare(std::move(commands), progress);
}

}  // namespace rehearse
