#include "log_clocks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/hashing.h"
#include "clock_estimate.h"
#include "core/ros2msg/message_format.h"
#include "message_reader.h"

namespace rehearse {
namespace {

/// Nanoseconds up to the year 2116; a later time is invalid.
constexpr std::uint64_t end_of_time = std::uint64_t{1} << 62;

struct HeaderOnly {
  static constexpr std::string_view type_name = "std_msgs/msg/Header";
  msg::Header header;
  REHEARSE_FIELDS(header)
};

/// A log time after which a stamp of 0 means that it isn't set [ns]: 11 days, longer than any log that begins at 0.
constexpr std::uint64_t first_wall_time = 1'000'000'000'000'000;

const char* suffix_of(LogInput::Content content) {
  switch (content) {
    case LogInput::Content::depth: return " (depth)";
    case LogInput::Content::camera_info: return " (info)";
    default: return "";
  }
}

}  // namespace

struct LogTimes::Stamps {
  explicit Stamps(const ros2msg::Schema& schema) : reader(schema) {}
  MessageReader<HeaderOnly> reader;
};

LogTimes::LogTimes(mcap::Reader& log, const std::vector<MappedSource>& sources) : log_(log) {
  bool any_log_time = false, any_offset = false;
  for (const MappedSource& mapped : sources) {
    Topic& topic = topics_[mapped.source->topic];
    topic.clock = mapped.source->clock;
    any_log_time |= topic.clock == LogClock::log_time;
    if (!mapped.source->clock_offset) continue;
    any_offset = true;
    LogClockReport& stated = topic.offsets.emplace_back();
    stated.offset = static_cast<std::int64_t>(std::llround(*mapped.source->clock_offset * 1e9));
    stated.is_stated = true;
  }
  for (const auto& [id, channel] : log.channels())
    for (const MappedSource& mapped : sources)
      if (mapped.source->is_on(channel.topic)) by_channel_[id] = &*topics_.find(mapped.source->topic);
  if (any_log_time || any_offset) estimate(log, sources);
}
LogTimes::~LogTimes() = default;

void LogTimes::estimate(mcap::Reader& log, const std::vector<MappedSource>& sources) {
  std::vector<MappedSource> stamped;
  for (const MappedSource& mapped : sources) {
    const Topic& topic = topics_.at(mapped.source->topic);
    if (topic.clock == LogClock::header_stamp && topic.offsets.empty()) stamped.push_back(mapped);
  }
  std::map<std::string, ClockEstimate> estimates;
  read_in_order(log, channels_of(log, stamped), [&](const mcap::Message& message) {
    const auto stamp = stamp_of(message);
    if (stamp && message.log_time < end_of_time)
      estimates[by_channel_.at(message.channel->id)->first].add(*stamp, static_cast<std::int64_t>(message.log_time));
    return true;
  });
  for (const auto& [topic, estimate] : estimates) topics_.at(topic).offsets = estimate.report();
}

std::optional<std::int64_t> LogTimes::stamp_of(const mcap::Message& message) {
  std::unique_ptr<Stamps>& stamps = stamps_[message.channel->id];
  if (!stamps) {
    const mcap::Schema* schema = log_.schema_of(*message.channel);
    auto parsed = ros2msg::schema_of(message.channel->message_encoding, *schema);
    if (!parsed) return std::nullopt;  // topics_of() has reported it
    stamps = std::make_unique<Stamps>(*parsed);
  }
  const HeaderOnly* read = stamps->reader.read(message.data);
  if (!read || read->header.stamp.sec < 0 || read->header.stamp.nanosec >= 1'000'000'000) return std::nullopt;
  const std::uint64_t stamp = read->header.stamp.to_ns();
  if (stamp == 0 && message.log_time >= first_wall_time) return std::nullopt;
  return static_cast<std::int64_t>(stamp);
}

Result<std::int64_t> LogTimes::of(const mcap::Message& message) {
  constexpr std::int64_t early = 2'000'000;  // [ns]: clocks are estimated better than this
  if (message.log_time >= end_of_time) return error("a log time beyond the year 2116");
  const auto logged = static_cast<std::int64_t>(message.log_time);
  const Topic& topic = by_channel_.at(message.channel->id)->second;
  if (topic.clock == LogClock::log_time) return logged;
  const auto stamp = stamp_of(message);
  if (!stamp) return error("no time in header.stamp");
  if (topic.offsets.empty()) {
    if (jumps_ahead(message, *stamp)) return error("a header.stamp that is ahead of those before and after it");
    return *stamp;
  }
  std::optional<std::int64_t> nearest;  // to the log time, by the clocks before and after a step
  for (const LogClockReport& clock : topic.offsets) {
    const std::int64_t time =
        *stamp + clock.offset + std::llround(clock.drift * static_cast<double>(*stamp - clock.reference));
    if (!nearest || std::abs(logged - time) < std::abs(logged - *nearest)) nearest = time;
  }
  if (!topic.offsets[0].is_stated && *nearest > logged + early)
    return error("a header.stamp that is later than the message was logged");
  return *nearest;
}

bool LogTimes::is_twin(const mcap::Message& message) {
  constexpr std::int64_t microseconds = 50'000;  // [ns]
  const auto logged = static_cast<std::int64_t>(message.log_time);
  std::deque<Recent::Seen>& seen = recent_[message.channel->topic].seen;
  const std::uint64_t hash = hash_bytes(message.data.data(), message.data.size());
  const bool is_known = std::ranges::any_of(seen, [&](const Recent::Seen& one) {
    if (one.hash != hash) return false;
    const auto stamp = logged - one.logged > microseconds ? stamp_of(message) : std::optional<std::int64_t>(1);
    return stamp && *stamp > 0;
  });
  seen.push_back({hash, logged});
  if (seen.size() > Recent::most) seen.pop_front();
  return is_known;
}

bool LogTimes::jumps_ahead(const mcap::Message& message, std::int64_t stamp) {
  constexpr std::int64_t most = 1'000'000'000;  // [ns]
  const auto logged = static_cast<std::int64_t>(message.log_time);
  Delays& delays = delays_[message.channel->id];
  if (logged < delays.logged) delays = {};  // the log is read again
  delays.logged = logged;
  const std::int64_t delay = logged - stamp;
  const std::optional<std::int64_t> last = std::exchange(delays.last, delay);
  const bool jumps = delays.accepted && delay < *delays.accepted - most && delay < *last - most;
  if (!jumps) delays.accepted = delay;
  return jumps;
}

bool LogTimes::are_stamps() const {
  return std::ranges::all_of(topics_, [](const auto& entry) {
    return entry.second.clock == LogClock::header_stamp && entry.second.offsets.empty();
  });
}

std::optional<LogClockReport> LogTimes::clock_of(const std::string& topic) const {
  const std::vector<LogClockReport>& offsets = topics_.at(topic).offsets;
  if (offsets.empty()) return std::nullopt;
  LogClockReport first = offsets[0];
  first.steps = std::ssize(offsets) - 1;
  return first;
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
    add(devices, fmt::format("{}{}", fmt::join(names, ", "), suffix_of(devices.input->content))).devices = &devices;
  }
  if (map.joystick) add(*map.joystick, "joystick").joystick = &*map.joystick;
  if (map.root) add(*map.root, "root").root = &*map.root;
  if (map.commands) add(*map.commands, "commands").commands = &*map.commands;
  if (map.state) add(*map.state, "state").state = &*map.state;
  const auto ticks_too = [&map](const MappedSource& mapped) { return mapped.source->topic == map.tick->topic; };
  if (map.tick && std::ranges::none_of(sources, ticks_too)) add(*map.tick, "ticks");
  return sources;
}

std::vector<std::uint16_t> channels_of(const mcap::Reader& log, const std::vector<MappedSource>& sources) {
  std::vector<std::uint16_t> channels;
  for (const auto& [id, channel] : log.channels()) {
    const auto maps_it = [topic = channel.topic](const MappedSource& mapped) { return mapped.source->is_on(topic); };
    if (std::ranges::any_of(sources, maps_it)) channels.push_back(id);
  }
  return channels;
}

Diagnostics read_in_order(mcap::Reader& log, const std::vector<std::uint16_t>& channels,
                          const std::function<bool(const mcap::Message&)>& callback) {
  if (channels.empty()) return {};  // without a channel the reader would deliver all
  const auto read = log.for_each_message_in_order(callback, channels);
  return read ? Diagnostics() : read.errors();
}

}  // namespace rehearse
