#include "log_commands.h"

#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/tolerance.h>

#include <cmath>

#include "message_reader.h"

namespace rehearse {
namespace {

/// Float64MultiArray and its kin.
struct NumberArray {
  static constexpr std::string_view type_name = "std_msgs/msg/Float64MultiArray";
  std::vector<double> data;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("data", self.data);
  }
};

}  // namespace

struct LogCommands::Readers {
  Readers(const LogMap& map, const Model& model, const ros2msg::Schema& schema)
      : states(schema), array(schema), names(map.commands->names, model) {}
  MessageReader<msg::JointState> states;
  MessageReader<NumberArray> array;
  JointNames names;
};

LogCommands::LogCommands(const LogMap& map, const Model& model, const ros2msg::Schema& schema)
    : map_(map), model_(model), readers_(std::make_unique<Readers>(map, model, schema)) {}
LogCommands::~LogCommands() = default;

bool LogCommands::take(std::int64_t time, mcap::Bytes payload) {
  Sample sample;
  sample.time = time;
  sample.joints.resize(model_.joints.size());
  const bool fits = map_.commands->is_array ? take_array(payload, sample) : take_states(payload, sample);
  if (fits) samples_.push_back(std::move(sample));
  return fits;
}

bool LogCommands::take_states(mcap::Bytes payload, Sample& sample) {
  const msg::JointState* state = readers_->states.read(payload);
  if (!state) return false;
  const std::vector<JointRename>& joints = readers_->names.find(state->name);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointRename& joint = joints[i];
    if (joint.joint < 0) continue;
    Commanded& commanded = sample.joints[joint.joint];
    if (i < state->position.size()) {
      commanded.q = state->position[i] * joint.scale;
      if (joint.offset != 0.0) *commanded.q += joint.offset;
    }
    if (i < state->velocity.size()) commanded.dq = state->velocity[i] * joint.scale;
    if (i < state->effort.size()) commanded.u = state->effort[i] / joint.scale;
  }
  return true;
}

bool LogCommands::take_array(mcap::Bytes payload, Sample& sample) {
  const NumberArray* array = readers_->array.read(payload);
  const CommandSource& source = *map_.commands;
  if (!array || array->data.size() != source.joints.size()) return false;
  for (std::size_t i = 0; i < array->data.size(); ++i) {
    if (!source.joints[i]) continue;
    Commanded& commanded = sample.joints[*source.joints[i]];
    switch (source.quantity) {
      case CommandSource::Quantity::position: commanded.q = array->data[i]; break;
      case CommandSource::Quantity::velocity: commanded.dq = array->data[i]; break;
      case CommandSource::Quantity::effort: commanded.u = array->data[i]; break;
    }
  }
  return true;
}

std::int64_t LogCommands::compare(std::int64_t from, std::int64_t until, const ControllerHost& host,
                                  const Scenario& scenario, const OnDifference& differs) {
  while (!samples_.empty() && samples_.front().time < from) samples_.pop_front();
  const Sample* latest = nullptr;
  for (const Sample& sample : samples_) {
    if (sample.time >= until) break;
    latest = &sample;
  }
  if (!latest) return 0;
  std::int64_t compared = 0;
  for (const HostedController& hosted : host.controllers()) {
    if (!hosted.tick.has_output) continue;
    for (const IoField& field : hosted.io->outputs().fields) {
      if (field.joint < 0) continue;
      const Commanded& commanded = latest->joints[field.joint];
      const std::optional<double>& expected = field.quantity == Quantity::q    ? commanded.q
                                              : field.quantity == Quantity::dq ? commanded.dq
                                                                               : commanded.u;
      if (field.quantity > Quantity::u || field.quantity == Quantity::ddq || !expected) continue;
      ++compared;
      const double actual = hosted.io->output_values()[field.offset];
      if (identical(*expected, actual)) continue;
      const Joint& joint = model_.links[field.link].joint;
      Divergence found;
      found.channel = ChannelName::of_controller(hosted.label, ChannelSide::output, ChannelKind::joints).topic();
      found.element = joint.name + "/" + name_of(field.quantity);
      put_numbers(found, *expected, actual, unit_of_joint(name_of(field.quantity), is_linear(joint.type)));
      const std::string series = series_name(found.channel, found.element);
      found.tolerance = tolerance_of(series, found.unit, scenario.tolerances).bound(std::abs(*expected));
      differs(std::move(found));
    }
  }
  return compared;
}

}  // namespace rehearse
