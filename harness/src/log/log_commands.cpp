#include "log_commands.h"

#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "joint_messages.h"
#include "number_messages.h"

namespace rehearse {
struct CommandReader::Readers {
  Readers(const LogMap& map, const Model& model, const ros2msg::Schema& schema)
      : states(schema, JointRole::commanded), array(schema), names(map.commands->names, model) {}
  JointMessages states;
  NumberMessages array;
  JointNames names;
};

CommandReader::CommandReader(const LogMap& map, const Model& model, const ros2msg::Schema& schema)
    : source_(*map.commands), joints_(model.joints.size()), readers_(std::make_unique<Readers>(map, model, schema)) {}
CommandReader::~CommandReader() = default;

Result<CommandedJoints> CommandReader::read(mcap::Bytes payload) {
  CommandedJoints joints(joints_);
  const Result<void> done = source_.is_array ? read_array(payload, joints) : read_states(payload, joints);
  if (!done) return done.errors();
  return joints;
}

Result<void> CommandReader::read_states(mcap::Bytes payload, CommandedJoints& joints) {
  const auto read = readers_->states.read(payload);
  if (!read) return read.errors();
  const msg::JointState* state = *read;
  const std::vector<JointRename>& named = readers_->names.find(state->name);
  for (std::size_t i = 0; i < named.size(); ++i) {
    const JointRename& joint = named[i];
    if (joint.joint < 0) continue;
    CommandedJoint& commanded = joints[joint.joint];
    if (i < state->position.size()) {
      commanded.q = state->position[i] * joint.scale;
      if (joint.offset != 0.0) *commanded.q += joint.offset;
    }
    if (i < state->velocity.size()) commanded.dq = state->velocity[i] * joint.scale;
    if (i < state->effort.size()) commanded.u = state->effort[i] / joint.scale;
  }
  return {};
}

Result<void> CommandReader::read_array(mcap::Bytes payload, CommandedJoints& joints) {
  const std::vector<double>* numbers = readers_->array.read(payload);
  if (!numbers) return misfit(payload);
  if (numbers->size() != source_.joints.size())
    return error(fmt::format("{} numbers, where the map has {} joints", numbers->size(), source_.joints.size()),
                 "expected joints: a joint, or ~, for each number");
  for (std::size_t i = 0; i < numbers->size(); ++i) {
    if (!source_.joints[i]) continue;
    CommandedJoint& commanded = joints[*source_.joints[i]];
    switch (source_.quantity) {
      case CommandSource::Quantity::position: commanded.q = (*numbers)[i]; break;
      case CommandSource::Quantity::velocity: commanded.dq = (*numbers)[i]; break;
      case CommandSource::Quantity::effort: commanded.u = (*numbers)[i]; break;
    }
  }
  return {};
}

std::optional<double> CommandedJoint::*commanded_part(const IoField& field) {
  if (field.joint < 0) return nullptr;
  switch (field.quantity) {
    case Quantity::q: return &CommandedJoint::q;
    case Quantity::dq: return &CommandedJoint::dq;
    case Quantity::u: return &CommandedJoint::u;
    default: return nullptr;
  }
}

void keep_largest(CommandedJoints& largest, const CommandedJoints& joints) {
  largest.resize(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i)
    for (const auto part : {&CommandedJoint::q, &CommandedJoint::dq, &CommandedJoint::u})
      if (const std::optional<double>& number = joints[i].*part; number && std::isfinite(*number))
        largest[i].*part = std::max((largest[i].*part).value_or(0.0), std::abs(*number));
}

Result<void> LogCommands::take(std::int64_t time, mcap::Bytes payload) {
  auto joints = reader_.read(payload);
  if (!joints) return joints.errors();
  samples_.push_back({time, *std::move(joints)});
  return {};
}

bool LogCommands::covers(std::int64_t tick) const {
  return ticks_.time(tick + shift_) <= facts_.last && ticks_.time(tick + shift_ + 1) > facts_.first;
}

const CommandedJoints* LogCommands::of_tick(std::int64_t tick) {
  const std::int64_t from = ticks_.time(tick + shift_);
  std::int64_t until = ticks_.time(tick + shift_ + 1);
  if (!ticks_.is_nominal())
    until = std::min<std::int64_t>(until, from + facts_.latency + std::llround(ticks_.time_step() / 2 * 1e9));
  while (!samples_.empty() && samples_.front().time < from) samples_.pop_front();
  const CommandedJoints* found = nullptr;
  for (const Sample& sample : samples_) {
    if (sample.time >= until) break;
    if (!found || ticks_.is_nominal()) found = &sample.joints;
  }
  return found;
}

Divergence LogCommands::place_of(const HostedController& hosted, const IoField& field, double largest,
                                 const Scenario& scenario) const {
  const Joint& joint = model_.links[field.link].joint;
  Divergence place;
  place.channel = ChannelName::of_controller(hosted.label, ChannelSide::output, ChannelKind::joints).topic();
  place.element = joint.name + "/" + name_of(field.quantity);
  place.unit = unit_of_joint(name_of(field.quantity), is_linear(joint.type));
  const std::string series = series_name(place.channel, place.element);
  place.tolerance = tolerance_of(series, place.unit, scenario.tolerances).bound(largest);
  return place;
}

std::vector<CommandPair> LogCommands::compare(const CommandedJoints& logged, const ControllerHost& host,
                                              const Scenario& scenario, const OnDifference& differs) {
  std::vector<CommandPair> pairs;
  for (const HostedController& hosted : host.controllers()) {
    if (!hosted.tick.has_output) continue;
    for (const IoField& field : hosted.io->outputs().fields) {
      const auto part = commanded_part(field);
      if (!part) continue;
      const std::optional<double>& expected = logged[field.joint].*part;
      const double actual = hosted.io->output_values()[field.offset];
      const double largest = facts_.largest.empty() ? 0.0 : (facts_.largest[field.joint].*part).value_or(0.0);
      if (tolerances_.size() == pairs.size())
        tolerances_.push_back(place_of(hosted, field, largest, scenario).tolerance);
      pairs.push_back({expected, actual, tolerances_[pairs.size()]});
      if (!expected || identical(*expected, actual)) continue;
      Divergence found = place_of(hosted, field, largest, scenario);
      put_numbers(found, *expected, actual, found.unit);
      differs(std::move(found));
    }
  }
  return pairs;
}

}  // namespace rehearse
