#include "log_commands.h"

#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "message_reader.h"

namespace rehearse {
namespace {

/// Float64MultiArray and similar messages.
struct NumberArray {
  static constexpr std::string_view type_name = "std_msgs/msg/Float64MultiArray";
  std::vector<double> data;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("data", self.data);
  }
};

}  // namespace

struct CommandReader::Readers {
  Readers(const LogMap& map, const Model& model, const ros2msg::Schema& schema)
      : states(schema), array(schema), names(map.commands->names, model) {}
  MessageReader<msg::JointState> states;
  MessageReader<NumberArray> array;
  JointNames names;
};

CommandReader::CommandReader(const LogMap& map, const Model& model, const ros2msg::Schema& schema)
    : source_(*map.commands), joints_(model.joints.size()), readers_(std::make_unique<Readers>(map, model, schema)) {}
CommandReader::~CommandReader() = default;

std::optional<CommandedJoints> CommandReader::read(mcap::Bytes payload) {
  CommandedJoints joints(joints_);
  const bool fits = source_.is_array ? read_array(payload, joints) : read_states(payload, joints);
  return fits ? std::optional(std::move(joints)) : std::nullopt;
}

bool CommandReader::read_states(mcap::Bytes payload, CommandedJoints& joints) {
  const msg::JointState* state = readers_->states.read(payload);
  if (!state) return false;
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
  return true;
}

bool CommandReader::read_array(mcap::Bytes payload, CommandedJoints& joints) {
  const NumberArray* array = readers_->array.read(payload);
  if (!array || array->data.size() != source_.joints.size()) return false;
  for (std::size_t i = 0; i < array->data.size(); ++i) {
    if (!source_.joints[i]) continue;
    CommandedJoint& commanded = joints[*source_.joints[i]];
    switch (source_.quantity) {
      case CommandSource::Quantity::position: commanded.q = array->data[i]; break;
      case CommandSource::Quantity::velocity: commanded.dq = array->data[i]; break;
      case CommandSource::Quantity::effort: commanded.u = array->data[i]; break;
    }
  }
  return true;
}

void keep_largest(CommandedJoints& largest, const CommandedJoints& joints) {
  largest.resize(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i)
    for (const auto part : {&CommandedJoint::q, &CommandedJoint::dq, &CommandedJoint::u})
      if (const std::optional<double>& number = joints[i].*part; number && std::isfinite(*number))
        largest[i].*part = std::max((largest[i].*part).value_or(0.0), std::abs(*number));
}

bool LogCommands::take(std::int64_t time, mcap::Bytes payload) {
  auto joints = reader_.read(payload);
  if (joints) samples_.push_back({time, *std::move(joints)});
  return joints.has_value();
}

bool LogCommands::covers(std::int64_t tick) const {
  return ticks_.time(tick + shift_) <= facts_.last && ticks_.time(tick + shift_ + 1) > facts_.first;
}

const CommandedJoints* LogCommands::of_tick(std::int64_t tick) {
  const std::int64_t from = ticks_.time(tick + shift_);
  std::int64_t until = ticks_.time(tick + shift_ + 1);
  if (!ticks_.is_grid())
    until = std::min<std::int64_t>(until, from + facts_.latency + std::llround(ticks_.time_step() / 2 * 1e9));
  while (!samples_.empty() && samples_.front().time < from) samples_.pop_front();
  const CommandedJoints* found = nullptr;
  for (const Sample& sample : samples_) {
    if (sample.time >= until) break;
    if (!found || ticks_.is_grid()) found = &sample.joints;
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
      if (field.joint < 0 || field.quantity > Quantity::u || field.quantity == Quantity::ddq) continue;
      const auto part = field.quantity == Quantity::q    ? &CommandedJoint::q
                        : field.quantity == Quantity::dq ? &CommandedJoint::dq
                                                         : &CommandedJoint::u;
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
