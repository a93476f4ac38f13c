#include "log_survey.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "compare/series_scale.h"
#include "log_feed.h"
#include "message_reader.h"

namespace rehearse {
namespace {

/// Messages of joints are decoded until this number of messages contained no new joint or quantity.
constexpr std::int64_t joint_messages = 1000;
/// Nanoseconds up to the year 2116; a later time is invalid.
constexpr std::uint64_t end_of_time = std::uint64_t{1} << 62;

struct HeaderOnly {
  static constexpr std::string_view type_name = "std_msgs/msg/Header";
  msg::Header header;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
  }
};

const char* suffix_of(DeviceSource::Kind kind) {
  switch (kind) {
    case DeviceSource::Kind::depth: return " (depth)";
    case DeviceSource::Kind::camera_info: return " (info)";
    default: return "";
  }
}

/// The joints and quantities in JointState messages.
class JointSurvey {
 public:
  JointSurvey(const JointSource& source, const Model& model, const ros2msg::Schema& schema)
      : source_(source), reader_(schema), names_(source.names, model) {}

  void look(mcap::Bytes payload, std::int64_t time, SourceSurvey& found) {
    if (idle_ >= joint_messages) return;
    ++idle_;
    const msg::JointState* state = reader_.read(payload);
    if (!state) return;
    const std::vector<JointRename>& joints = names_.find(state->name);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (joints[i].joint < 0) {
        found.strangers.insert(state->name[i]);
        continue;
      }
      const auto [known, is_new] = found.joints.emplace(joints[i].joint, GivenJoint());
      const GivenJoint before = known->second;
      GivenJoint& given = known->second;
      given.q |= state->position.size() == joints.size();
      given.dq |= state->velocity.size() == joints.size() || (source_.differentiate && given.q);
      given.u |= state->effort.size() == joints.size();
      if (!is_new && before.q == given.q && before.dq == given.dq && before.u == given.u) continue;
      found.complete = time;
      idle_ = 0;
    }
  }

 private:
  const JointSource& source_;
  MessageReader<msg::JointState> reader_;
  JointNames names_;
  std::int64_t idle_ = 0;  // number of messages since the last new joint or quantity
};

/// One source during the survey.
struct Surveyed {
  std::unique_ptr<JointSurvey> joints;
  std::unique_ptr<CommandReader> commands;
  mcap::Location furthest;
  bool any = false;
};

void add_tick(std::int64_t time, LogSurvey& found) {
  if (found.tick_messages.empty() || time > found.tick_messages.back()) found.tick_messages.push_back(time);
}

bool is_behind(const mcap::Location& a, const mcap::Location& b) {
  return a.record != b.record ? a.record > b.record : a.inside > b.inside;
}

}  // namespace

struct LogTimes::Stamps {
  explicit Stamps(const ros2msg::Schema& schema) : reader(schema) {}
  MessageReader<HeaderOnly> reader;
};

LogTimes::LogTimes(const mcap::Reader& log, LogClock clock) : log_(log), clock_(clock) {}
LogTimes::~LogTimes() = default;

std::optional<std::int64_t> LogTimes::of(const mcap::Message& message) {
  if (message.log_time >= end_of_time) return std::nullopt;
  if (clock_ == LogClock::log_time) return static_cast<std::int64_t>(message.log_time);
  std::unique_ptr<Stamps>& stamps = stamps_[message.channel->id];
  if (!stamps) {
    const mcap::Schema* schema = log_.schema_of(*message.channel);
    auto parsed = ros2msg::Schema::parse(schema->name, schema->data);
    if (!parsed) return std::nullopt;  // topics_of() has reported it
    stamps = std::make_unique<Stamps>(*parsed);
  }
  const HeaderOnly* read = stamps->reader.read(message.data);
  if (!read || read->header.stamp.sec < 0 || read->header.stamp.nanosec >= 1'000'000'000) return std::nullopt;
  return static_cast<std::int64_t>(read->header.stamp.to_ns());
}

std::vector<MappedSource> sources_of(const LogMap& map, const Model& model) {
  std::vector<MappedSource> sources;
  const auto add = [&sources](const LogSource& source, std::string use) -> MappedSource& {
    MappedSource& added = sources.emplace_back();
    added.source = &source;
    added.use = std::move(use);
    return added;
  };
  for (const JointSource& joints : map.joints) add(joints, "joints").joints = &joints;
  for (const DeviceSource& devices : map.devices) {
    std::vector<std::string> names;
    for (const int device : devices.devices) names.push_back(model.devices[device].name);
    add(devices, fmt::format("{}{}", fmt::join(names, ", "), suffix_of(devices.kind))).devices = &devices;
  }
  if (map.joystick) add(*map.joystick, "joystick").joystick = &*map.joystick;
  if (map.root) add(*map.root, "root").root = &*map.root;
  if (map.commands) add(*map.commands, "commands").commands = &*map.commands;
  const auto ticks_too = [&map](const MappedSource& mapped) { return mapped.source->topic == map.tick->topic; };
  if (map.tick && std::none_of(sources.begin(), sources.end(), ticks_too)) add(*map.tick, "ticks");
  return sources;
}

std::vector<std::uint16_t> channels_of(const mcap::Reader& log, const std::vector<MappedSource>& sources) {
  std::vector<std::uint16_t> channels;
  for (const auto& [id, channel] : log.channels()) {
    const auto maps_it = [topic = channel.topic](const MappedSource& mapped) { return mapped.source->topic == topic; };
    if (std::any_of(sources.begin(), sources.end(), maps_it)) channels.push_back(id);
  }
  return channels;
}

Diagnostics read_in_order(mcap::Reader& log, const std::vector<std::uint16_t>& channels,
                          const std::function<bool(const mcap::Message&)>& callback) {
  if (channels.empty()) return {};  // without a channel the reader would deliver all
  const auto read = log.for_each_message_in_order(callback, channels);
  return read ? Diagnostics() : read.errors();
}

LogSurvey survey(mcap::Reader& log, const LogMap& map, const Model& model, const std::vector<MappedSource>& sources) {
  LogSurvey found;
  found.sources.resize(sources.size());
  std::vector<Surveyed> surveyed(sources.size());
  LogTimes times(log, map.clock);
  bool any_time = false;
  const bool has_relative = std::any_of(map.tolerances.begin(), map.tolerances.end(), is_relative);
  const auto look = [&](const mcap::Message& message) {
    const auto time = times.of(message);
    if (time && map.tick && message.channel->topic == map.tick->topic) add_tick(*time, found);
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (sources[i].source->topic != message.channel->topic) continue;
      SourceSurvey& source = found.sources[i];
      Surveyed& state = surveyed[i];
      ++source.messages;
      if (state.any && is_behind(state.furthest, message.location)) ++source.out_of_order;
      if (!state.any || is_behind(message.location, state.furthest)) state.furthest = message.location;
      state.any = true;
      if (!time) {
        ++source.without_time;
        continue;
      }
      if (source.first && *time < source.last) continue;  // an earlier time than before: it isn't used
      if (source.first) source.intervals.add(*time - source.last);
      if (!source.first) source.first = source.complete = *time;
      source.last = *time;
      if (sources[i].commands && !found.tick_messages.empty() && *time >= found.tick_messages.back())
        found.latencies.add(*time - found.tick_messages.back());
      const std::int64_t late = static_cast<std::int64_t>(message.log_time) - *time;
      found.latest = std::exchange(any_time, true) ? std::max(found.latest, late) : late;
      const bool is_scale = sources[i].commands && has_relative;
      if (!sources[i].joints && !is_scale) continue;
      if (!state.joints && !state.commands) {
        const mcap::Schema* schema = log.schema_of(*message.channel);
        const auto parsed = ros2msg::Schema::parse(schema->name, schema->data);
        if (parsed && is_scale) state.commands = std::make_unique<CommandReader>(map, model, *parsed);
        if (parsed && !is_scale) state.joints = std::make_unique<JointSurvey>(*sources[i].joints, model, *parsed);
      }
      if (state.joints) state.joints->look(message.data, *time, source);
      if (state.commands)
        if (const auto joints = state.commands->read(message.data)) keep_largest(found.largest_commands, *joints);
    }
    return true;
  };
  found.damage = read_in_order(log, channels_of(log, sources), look);
  return found;
}

}  // namespace rehearse
