// Makes a log like that of a robot from a recording: with different names of topics, a wall clock, and messages that
// are late, out of order or missing.
#pragma once

#include <gtest/gtest.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace rehearse {

struct RobotLog {
  std::map<std::string, std::string> topics;       // the topics in the log: names in the recording, then in the log
  std::int64_t start = 1'763'640'000'123'456'789;  // of the recording, by the log's clock [ns]
  /// For a topic of the log at a time of the recording [ns]. Null `keep`: all messages; null `lateness`: no delay.
  std::function<bool(const std::string& topic, std::int64_t time)> keep;
  std::function<std::int64_t(const std::string& topic, std::int64_t time)> lateness;      // [ns]
  std::function<void(const std::string& topic, std::vector<std::byte>& payload)> change;  // null: as recorded
};

/// header.stamp is the time of the measurement in the recording; log times are later by `lateness`.
inline void write_log(const std::filesystem::path& recording, const std::filesystem::path& log, const RobotLog& robot) {
  const auto source = mcap::Reader::open(recording);
  ASSERT_TRUE(source.ok()) << to_string(source.errors());
  mcap::WriterOptions options;
  options.chunk_size = 16 * 1024;
  const auto writer = mcap::Writer::create(log, options);
  ASSERT_TRUE(writer.ok()) << to_string(writer.errors());
  std::map<std::uint16_t, std::uint16_t> channels;
  for (const auto& [id, channel] : (*source)->channels()) {
    const auto renamed = robot.topics.find(channel.topic);
    if (renamed == robot.topics.end()) continue;
    const mcap::Schema& schema = *(*source)->schema_of(channel);
    channels[id] = (*writer)->add_channel((*writer)->add_schema(schema.name, schema.encoding, schema.data),
                                          renamed->second, "cdr");
  }
  struct Message {
    std::uint16_t channel;
    std::uint64_t time;
    std::vector<std::byte> data;
  };
  std::vector<Message> messages;
  ASSERT_TRUE((*source)->for_each_message([&](const mcap::Message& message) {
    if (channels.count(message.channel->id) == 0) return true;
    const std::string& topic = robot.topics.at(message.channel->topic);
    const auto time = static_cast<std::int64_t>(message.log_time);
    if (robot.keep && !robot.keep(topic, time)) return true;
    Message& added = messages.emplace_back();
    added.channel = channels.at(message.channel->id);
    added.time = static_cast<std::uint64_t>(robot.start + time + (robot.lateness ? robot.lateness(topic, time) : 0));
    added.data.assign(message.data.begin(), message.data.end());
    if (robot.change) robot.change(topic, added.data);
    std::int32_t seconds;
    std::uint32_t nanoseconds;
    std::memcpy(&seconds, &added.data[4], 4);  // all messages begin with a header
    std::memcpy(&nanoseconds, &added.data[8], 4);
    const std::int64_t stamp = robot.start + seconds * std::int64_t{1'000'000'000} + nanoseconds;
    seconds = static_cast<std::int32_t>(stamp / 1'000'000'000);
    nanoseconds = static_cast<std::uint32_t>(stamp % 1'000'000'000);
    std::memcpy(&added.data[4], &seconds, 4);
    std::memcpy(&added.data[8], &nanoseconds, 4);
    return true;
  }));
  // like recorders with one thread per topic: the file is not sorted
  constexpr std::size_t block = 7;
  for (std::size_t i = 0; i + 2 * block <= messages.size(); i += 2 * block) {
    const auto begin = messages.begin() + static_cast<std::ptrdiff_t>(i);
    std::rotate(begin, begin + block, begin + 2 * block);
  }
  for (const Message& message : messages)
    ASSERT_TRUE((*writer)->write(message.channel, message.time, message.time, message.data));
  ASSERT_TRUE((*writer)->close());
}

}  // namespace rehearse
