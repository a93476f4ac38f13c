#include "recorded_commands.h"
#include "core/recording/initial_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/clock.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

/// The numbers of a row, in the order of the message's fields. None if one of them isn't finite.
std::vector<double> finite_row(const TraceChannel& channel, std::size_t row) {
  std::vector<double> numbers;
  for (std::size_t column = 0; column < channel.columns.size(); ++column) {
    numbers.push_back(channel.number(row, column));
    if (!std::isfinite(numbers.back())) return {};
  }
  return numbers;
}

Eigen::Vector3d vector(const std::vector<double>& numbers, std::size_t at) {
  return {numbers[at], numbers[at + 1], numbers[at + 2]};
}

/// True if a device's state, in the form of the API's writeState, is on.
bool is_on(const Device& device, const std::vector<double>& state) {
  const bool says_so = std::holds_alternative<Camera>(device.kind) ||
                       std::holds_alternative<RangeSensor>(device.kind) || is_actuator(device);
  return !says_so || state[0] != 0.0;
}

}  // namespace

std::optional<RecordedCommands::Kind> RecordedCommands::link_kind(ChannelKind kind) {
  switch (kind) {
    case ChannelKind::wrench: return Kind::wrench;
    case ChannelKind::pose: return Kind::place;
    case ChannelKind::twist: return Kind::twist;
    default: return std::nullopt;
  }
}

Result<RecordedCommands> RecordedCommands::find(const Scenario& scenario, const Trace& trace) {
  RecordedCommands commands(scenario, trace);
  if (const auto origin = RunFacts::of(trace).branch) commands.acted_until_ = origin->acted_until.value_or(0);
  Diagnostics findings;
  std::set<std::string_view> taken;
  const auto add = [&](const ScenarioController& controller, std::size_t body, bool delay) {
    const std::string label = scenario.bodies[body].name + "/" + controller.name;
    for (std::size_t i = 0; i < trace.channels().size(); ++i) {
      const TraceChannel& channel = trace.channels()[i];
      const ChannelName name = ChannelName::parse(channel.topic);
      if (!name.is_of(label, ChannelSide::output) && !name.is_of(label, ChannelSide::acted)) continue;
      if (!taken.insert(channel.topic).second) continue;
      const auto added = commands.add(name, static_cast<int>(body), controller, delay, i);
      findings.insert(findings.end(), added.errors().begin(), added.errors().end());
    }
  };
  for (std::size_t body = 0; body < scenario.bodies.size(); ++body) {
    for (const ScenarioController& controller : scenario.bodies[body].controllers) {
      add(controller, body, controller.delay);
      for (const ScenarioController& child : controller.children) add(child, body, controller.delay);
    }
  }
  for (const TraceChannel& channel : trace.channels())
    if (ChannelName::parse(channel.topic).side == ChannelSide::output && taken.count(channel.topic) == 0)
      findings.push_back(error(fmt::format("the recording has commands on {}, but {} has no such controller",
                                           channel.topic, scenario.name)));
  for (Diagnostic& finding : findings) finding.file = trace.file();
  if (!findings.empty()) return findings;
  commands.begin();
  return commands;
}

/// The channels that are read, by their indices in the trace.
std::vector<std::size_t> RecordedCommands::channels_read() const {
  std::set<std::size_t> read;
  for (const Source& source : sources_) {
    read.insert(source.channel);
    if (source.delays) read.insert(*source.delays);
  }
  return {read.begin(), read.end()};
}

/// Reads the first window, which contains the commands of initialize().
void RecordedCommands::begin() {
  const std::vector<std::size_t> channels = channels_read();
  if (channels.empty() || !is_without_messages(trace_)) return;
  windows_ = std::make_unique<TraceWindows>(trace_, channels);
  windows_->move(0, window_end_);
}

/// True if the rows of the table set every number that the source ever sets. A device's settings come once.
bool RecordedCommands::replaces_all(const Source& source, const TraceChannel& table) const {
  const auto any_row = [&](const auto& sets) {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const double time = static_cast<double>(table.times[row]) * 1e-9;
      if (!source.controller->loses(time, scenario_.time_step) && sets(row)) return true;
    }
    return false;
  };
  switch (source.kind) {
    case Kind::device: return false;
    case Kind::wrench: return true;  // acts in one step only
    case Kind::place:
    case Kind::twist: return any_row([&](std::size_t row) { return !finite_row(table, row).empty(); });
    case Kind::joints: break;
  }
  return std::ranges::all_of(source.cells, [&](const JointCell& cell) {
    return any_row([&](std::size_t row) { return std::isfinite(table.number(row, cell.column)); });
  });
}

std::int64_t RecordedCommands::pass_over(std::int64_t tick) {
  const std::int64_t first = tick - std::llround(1.0 / scenario_.time_step);  // a second before
  if (!windows_ || first <= 0) return 0;
  for (const Source& source : sources_)
    if (!is_used(source, first) || !is_used(source, tick)) return 0;
  const std::vector<std::size_t> channels = channels_read();
  const std::uint64_t begin = nanoseconds_of(first, scenario_.time_step);
  const std::uint64_t end = nanoseconds_of(tick - 1, scenario_.time_step);
  // a channel whose first message came in initialize() has earlier messages, of others their number doesn't matter
  auto late = std::make_unique<TraceWindows>(trace_, channels,
                                             WindowsStart{begin, std::vector<std::uint64_t>(channels.size(), 1)});
  late->move(begin, end);
  for (const Source& source : sources_)
    if (!replaces_all(source, late->window().channels()[source.channel])) return 0;
  windows_ = std::move(late);
  window_end_ = end;
  return first;
}

const TraceChannel& RecordedCommands::table(std::size_t channel) const {
  return (windows_ ? windows_->window() : trace_).channels()[channel];
}

/// The columns of the channel; those without any number are empty.
std::vector<TraceColumn> RecordedCommands::columns_with_numbers(std::size_t channel) const {
  std::vector<TraceColumn> found;
  for_each_window(trace_, {channel}, [&](const Trace& window) {
    const TraceChannel& table = window.channels()[channel];
    found.resize(std::max(found.size(), table.columns.size()));
    bool all = !found.empty();
    for (std::size_t column = 0; column < table.columns.size(); ++column) {
      for (std::size_t row = 0; row < table.rows() && found[column].element.empty(); ++row)
        if (!std::isnan(table.number(row, column))) found[column] = table.columns[column];
      all = all && !found[column].element.empty();
    }
    return !all;
  });
  return found;
}

Result<void> RecordedCommands::add(const ChannelName& name, int body, const ScenarioController& controller, bool delay,
                                   std::size_t at) {
  const TraceChannel& channel = trace_.channels()[at];
  const ScenarioBody& commanded = scenario_.bodies[body];
  Source source;
  source.channel = at;
  source.is_acted = name.side == ChannelSide::acted;
  source.body = body;
  source.controller = &controller;
  const auto stated = channel.metadata.find("delay");
  source.delayed = stated == channel.metadata.end() ? delay : stated->second != "false";
  const ChannelName delays = ChannelName::of_controller(name.label(), name.side, ChannelKind::delay);
  if (const TraceChannel* found = trace_.find_channel(delays.topic()))
    source.delays = static_cast<std::size_t>(found - trace_.channels().data());
  source.before_the_run = channel.metadata.count("since") > 0;
  const auto unknown = [&](const char* what) {
    return error(fmt::format("the recorded '{}' commands {} '{}', which '{}' lacks", name.controller, what, name.owner,
                             commanded.name));
  };
  if (name.kind == ChannelKind::joints) {
    REHEARSE_TRY(add_joints(source));
  } else if (name.kind == ChannelKind::device_state) {
    source.kind = Kind::device;
    source.target = commanded.model->find_device(name.owner);
    if (source.target < 0) return unknown("device");
  } else if (const auto kind = link_kind(name.kind)) {
    source.kind = *kind;
    source.target = commanded.model->find_link(name.owner);
    if (source.target < 0) return unknown("link");
  } else {
    return {};  // quantities that move nothing
  }
  sources_.push_back(std::move(source));
  return {};
}

Result<void> RecordedCommands::add_joints(Source& source) {
  const Model& model = *scenario_.bodies[source.body].model;
  const std::vector<TraceColumn> columns = columns_with_numbers(source.channel);
  Diagnostics findings;
  for (std::size_t column = 0; column < columns.size(); ++column) {
    const std::string& element = columns[column].element;
    const std::size_t slash = element.rfind('/');
    if (slash == std::string::npos) continue;
    JointCell cell;
    cell.column = column;
    const std::string quantity = element.substr(slash + 1), joint = element.substr(0, slash);
    const int link = model.find_joint(joint);
    if (link < 0 || model.links[link].joint.id < 0) {
      findings.push_back(error(fmt::format("the recording commands joint '{}', which '{}' lacks", joint,
                                           scenario_.bodies[source.body].name)));
      continue;
    }
    cell.joint = model.links[link].joint.id;
    cell.number = quantity == "q" ? &JointCommand::q : quantity == "dq" ? &JointCommand::dq : &JointCommand::u;
    cell.drive = quantity == "q" ? drive_displacement : quantity == "dq" ? drive_velocity : drive_effort;
    source.cells.push_back(cell);
  }
  if (!findings.empty()) return findings;
  return {};
}

Command RecordedCommands::initial() const {
  Command command;
  for (const ScenarioBody& body : scenario_.bodies) {
    BodyCommand& at_rest = command.bodies.emplace_back();
    for (const double q : body.joints) at_rest.joints.push_back({drive_none, q, 0.0, 0.0});
    at_rest.external.resize(body.model->links.size());
    at_rest.devices.resize(body.model->devices.size());
  }
  set_drives(0, command);
  if (const mcap::StringMap* written = trace_.find_metadata(records::initial_commands))
    take_initial_commands(*written, scenario_, command);
  for (const Source& source : sources_)
    if (source.before_the_run && is_used(source, 0)) put_row(source, 0, command);
  return command;
}

/// True for the commands that moved the world: in a branch, different commands before its begin and after it.
bool RecordedCommands::is_used(const Source& source, std::int64_t tick) const {
  return source.is_acted == (tick < acted_until_);
}

/// True if the commands of the tick at `now` [ns] act one tick late.
bool RecordedCommands::is_delayed(const Source& source, std::uint64_t now) const {
  if (!source.delays) return source.delayed;
  const std::vector<std::uint64_t>& times = table(*source.delays).times;
  return source.delayed != std::ranges::binary_search(times, now);
}

void RecordedCommands::set_drives(std::int64_t tick, Command& command) const {
  for (BodyCommand& body : command.bodies)
    for (JointCommand& joint : body.joints) joint.drive = drive_none;
  for (const Source& source : sources_) {
    if (!is_used(source, tick)) continue;
    std::vector<JointCommand>& joints = command.bodies[source.body].joints;
    // The last controller determines the drive.
    for (const JointCell& cell : source.cells) joints[cell.joint].drive = drive_none;
    for (const JointCell& cell : source.cells) joints[cell.joint].drive |= cell.drive;
  }
}

void RecordedCommands::put(std::int64_t tick, Timing timing, Command& command) {
  constexpr std::uint64_t span = 1'000'000'000;  // length of a window [ns]
  const std::uint64_t now = nanoseconds_of(tick, scenario_.time_step);
  if (windows_ && now > window_end_) windows_->move(now, window_end_ = now + span);
  if (tick == acted_until_ && tick > 0 && timing == Timing::same_step) set_drives(tick, command);
  for (Source& source : sources_) {
    if (!is_used(source, tick)) continue;
    if (is_delayed(source, now) != (timing == Timing::next_step)) continue;
    const bool is_lost = source.controller->loses(time_of(tick, scenario_.time_step), scenario_.time_step);
    const std::size_t earlier = table(source.channel).earlier;
    const std::vector<std::uint64_t>& times = table(source.channel).times;
    std::size_t row = std::max(source.next, earlier) - earlier;
    while (row < times.size() && times[row] < now) ++row;
    for (; row < times.size() && times[row] == now; ++row)
      if (!is_lost && (earlier + row > 0 || !source.before_the_run)) put_row(source, row, command);
    source.next = earlier + row;
  }
}

void RecordedCommands::put_row(const Source& source, std::size_t row, Command& command) const {
  const TraceChannel& channel = table(source.channel);
  BodyCommand& body = command.bodies[source.body];
  if (source.kind == Kind::joints) {
    for (const JointCell& cell : source.cells) {
      const double number = channel.number(row, cell.column);
      if (std::isfinite(number)) body.joints[cell.joint].*cell.number = number;
    }
    return;
  }
  const std::vector<double> numbers = finite_row(channel, row);
  if (numbers.empty()) return;
  if (source.kind == Kind::device) {
    body.devices[source.target] = {true, is_on(scenario_.bodies[source.body].model->devices[source.target], numbers),
                                   numbers};
  } else if (source.kind == Kind::place && numbers.size() == 7) {
    body.given[source.target].place = LinkPlace{vector(numbers, 0), {numbers[6], numbers[3], numbers[4], numbers[5]}};
  } else if (source.kind == Kind::twist && numbers.size() == 6) {
    body.given[source.target].twist = LinkTwist{vector(numbers, 0), vector(numbers, 3)};
  } else if (source.kind == Kind::wrench && numbers.size() == 6) {
    body.external[source.target].force += vector(numbers, 0);
    body.external[source.target].torque += vector(numbers, 3);
  }
}

}  // namespace rehearse
