#include "log_commands.h"

#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "base/glob.h"
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
  REHEARSE_TRY(source_.is_array ? read_array(payload, joints) : read_states(payload, joints));
  return joints;
}

Result<void> CommandReader::read_states(mcap::Bytes payload, CommandedJoints& joints) {
  const auto read = REHEARSE_TRY(readers_->states.read(payload));
  const JointArrays* state = read;
  const std::vector<JointRename>& named = readers_->names.find(state->names());
  for (std::size_t i = 0; i < named.size(); ++i) {
    const JointRename& joint = named[i];
    if (joint.joint < 0) continue;
    CommandedJoint& commanded = joints[joint.joint];
    if (i < state->position().size()) {
      commanded.q = state->position()[i] * joint.scale;
      if (joint.offset != 0.0) *commanded.q += joint.offset;
    }
    if (i < state->velocity().size()) commanded.dq = state->velocity()[i] * joint.scale;
    if (i < state->effort().size()) commanded.u = state->effort()[i] / joint.scale;
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
  auto joints = REHEARSE_TRY(reader_.read(payload));
  samples_.push_back({time, std::move(joints)});
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
    if (zeros_are_foreign_ && are_zero(sample.joints)) continue;
    if (!found || takes_last_ || ticks_.is_nominal()) found = &sample.joints;
  }
  return found;
}

std::vector<LogCommands::Commanded> LogCommands::commanded_by(const HostedController& hosted) const {
  std::vector<Commanded> numbers;
  if (!hosted.io) return numbers;
  const std::string topic = ChannelName::of_controller(hosted.label, ChannelSide::output, ChannelKind::joints).topic();
  for (const IoField& field : hosted.io->outputs().fields) {
    const auto part = commanded_part(field);
    if (!part) continue;
    const Joint& joint = model_.links[field.link].joint;
    numbers.push_back({field, part, topic, joint.name + "/" + name_of(field.quantity),
                       std::string(unit_of_joint(name_of(field.quantity), is_linear(joint.type)))});
  }
  return numbers;
}

/// The rule of a number: that of the map, with the default where it states no absolute tolerance.
ToleranceRule LogCommands::rule_of(const Commanded& number) const {
  const std::string series = series_name(number.topic, number.element);
  const auto stated = std::ranges::find_if(map_rules_.rbegin(), map_rules_.rend(),
                                           [&](const ToleranceRule& rule) { return matches(rule.channel, series); });
  ToleranceRule rule = stated == map_rules_.rend() ? ToleranceRule() : *stated;
  rule.channel = series;
  if (!rule.atol) rule.atol = facts_.ranges.tolerance(number.field.joint, number.part, number.unit);
  return rule;
}

std::vector<ToleranceRule> LogCommands::tolerances(const ControllerHost& host) const {
  std::vector<ToleranceRule> rules;
  for (const HostedController& hosted : host.controllers())
    for (const Commanded& number : commanded_by(hosted))
      if (facts_.ranges.has(number.field.joint, number.part)) rules.push_back(rule_of(number));
  return rules;
}

std::vector<std::string> LogCommands::steps(const ControllerHost& host) const {
  std::vector<std::string> found;
  for (const HostedController& hosted : host.controllers())
    for (const Commanded& number : commanded_by(hosted)) {
      const double step = facts_.ranges.step(number.field.joint, number.part);
      const double tolerance = rule_of(number).atol.value_or(0.0);
      if (step > 0.0 && tolerance > 0.4999 * step && tolerance < 0.5001 * step)
        found.push_back(fmt::format("{}: {:.6g} {}", number.element, step, number.unit));
    }
  return found;
}

std::unique_ptr<RowJudge> LogCommands::make_judge(const ControllerHost& host, double time_step,
                                                  RowJudge::OnDifference differs) {
  SeriesScales scales;
  rules_.clear();
  columns_.clear();
  std::vector<TraceChannel> channels;  // by controller
  for (const HostedController& hosted : host.controllers()) {
    TraceChannel& channel = channels.emplace_back();
    channel.topic = ChannelName::of_controller(hosted.label, ChannelSide::output, ChannelKind::joints).topic();
    channel.type = msg::JointState::type_name;
    for (const Commanded& number : commanded_by(hosted)) {
      const int joint = number.field.joint;
      channel.metadata["unit:" + number.element] = number.unit;
      channel.columns.push_back({number.element, {}, CellKind::floating});
      columns_.push_back({number.element, number.unit, facts_.ranges.range(joint, number.part)});
      rules_.push_back(rule_of(number));
      if (!facts_.largest.empty())
        scales[{channel.topic, number.element}] = (facts_.largest[joint].*number.part).value_or(0.0);
    }
  }
  auto judge = std::make_unique<RowJudge>(&rules_, std::move(scales), time_step, std::move(differs));
  for (const TraceChannel& channel : channels) judge->set_columns(judge->add_channel(channel), channel.columns);
  return judge;
}

namespace {

/// The log's numbers for the commands of a controller; NaN where the log has none.
std::vector<std::uint64_t> row_of(const HostedController& hosted, const CommandedJoints& logged) {
  std::vector<std::uint64_t> row;
  for (const IoField& field : hosted.io->outputs().fields)
    if (const auto part = commanded_part(field))
      row.push_back(
          std::bit_cast<std::uint64_t>((logged[field.joint].*part).value_or(std::numeric_limits<double>::quiet_NaN())));
  return row;
}

}  // namespace

std::vector<CommandPair> LogCommands::compare(std::int64_t tick, const CommandedJoints& logged,
                                              const ControllerHost& host, RowJudge& judge) const {
  std::vector<CommandPair> pairs;
  std::vector<std::uint64_t> actual_row;
  for (std::size_t i = 0; i < host.controllers().size(); ++i) {
    const HostedController& hosted = host.controllers()[i];
    if (!hosted.tick.has_output) continue;
    const std::vector<std::uint64_t> expected_row = row_of(hosted, logged);
    actual_row.clear();
    for (const IoField& field : hosted.io->outputs().fields) {
      const auto part = commanded_part(field);
      if (!part) continue;
      const std::size_t column = actual_row.size();
      const std::optional<double>& expected = logged[field.joint].*part;
      const double whole = hosted.io->output_values()[field.offset];
      const auto limit = limits_.find(field.joint);
      const double actual = limit == limits_.end() ? whole : std::clamp(whole, -limit->second, limit->second);
      pairs.push_back({expected, actual, judge.tolerance(i, column), whole});
      // a number that isn't in the log isn't compared
      actual_row.push_back(expected ? std::bit_cast<std::uint64_t>(actual) : expected_row[column]);
    }
    judge.add(i, tick, expected_row, actual_row);
  }
  return pairs;
}

void LogCommands::pass_over(std::int64_t tick, const CommandedJoints& logged, const ControllerHost& host,
                            RowJudge& judge) {
  for (std::size_t i = 0; i < host.controllers().size(); ++i) {
    const HostedController& hosted = host.controllers()[i];
    if (hosted.tick.has_output && judge.needs_equal_rows(i)) judge.add_golden(i, tick, row_of(hosted, logged));
  }
}

}  // namespace rehearse
