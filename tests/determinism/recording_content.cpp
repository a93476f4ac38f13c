#include "recording_content.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>

namespace rehearse::matrix {
namespace {

namespace fs = std::filesystem;

/// Hash of a sequence of texts and numbers; each text is preceded by its length, so that texts can't be confused.
class Hash {
 public:
  Hash& add(const void* data, std::size_t size) {
    value_ = XXH3_64bits_withSeed(&size, sizeof size, value_);
    value_ = XXH3_64bits_withSeed(data, size, value_);
    return *this;
  }
  Hash& add(std::string_view text) { return add(text.data(), text.size()); }
  Hash& add(std::uint64_t number) { return add(&number, sizeof number); }
  Hash& add(const mcap::StringMap& map) {
    for (const auto& [key, value] : map) add(key).add(value);
    return *this;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0;
};

std::uint64_t definition_of(const mcap::Reader& reader, const mcap::Channel& channel) {
  Hash hash;
  hash.add(channel.message_encoding).add(channel.metadata);
  if (const mcap::Schema* schema = reader.schema_of(channel)) hash.add(schema->name).add(schema->data);
  return hash.value();
}

struct Place {
  std::uint64_t time = 0;
  std::string topic;
};

/// The first message that only one of them has, or that isn't the same.
std::optional<std::uint64_t> first_difference(const ChannelContent& expected, const ChannelContent& actual) {
  const auto [a, b] =
      std::mismatch(expected.messages.begin(), expected.messages.end(), actual.messages.begin(), actual.messages.end());
  const bool a_ended = a == expected.messages.end(), b_ended = b == actual.messages.end();
  if (a_ended && b_ended) return std::nullopt;
  if (a_ended || b_ended) return a_ended ? b->time : a->time;
  return std::min(a->time, b->time);
}

const ChannelContent* find(const std::vector<ChannelContent>& in, const std::string& topic) {
  const auto found = std::ranges::find_if(in, [&](const ChannelContent& channel) { return channel.topic == topic; });
  return found == in.end() ? nullptr : &*found;
}

bool has_costs(const mcap::Reader& reader, const mcap::Channel& channel) {
  const mcap::Schema* schema = reader.schema_of(channel);
  return schema && schema->name == msg::ControlCost::type_name;
}

}  // namespace

std::uint64_t RecordingContent::hash() const {
  Hash hash;
  for (const ChannelContent& channel : channels) {
    hash.add(channel.topic).add(channel.definition).add(channel.messages.size());
    for (const MessageContent& message : channel.messages) hash.add(message.time).add(message.hash);
  }
  for (const auto& [name, content] : attachments) hash.add(name).add(content);
  return hash.add(outcome).value();
}

Result<RecordingContent> content_of(const fs::path& recording, std::optional<std::uint64_t> before) {
  const auto reader = mcap::Reader::open(recording);
  if (!reader) return reader.errors();
  RecordingContent content;
  struct Target {
    std::vector<ChannelContent>& channels;
    std::size_t index;
  };
  std::map<std::uint16_t, Target> targets;
  for (const auto& [id, channel] : (*reader)->channels()) {
    auto& channels = has_costs(**reader, channel) ? content.costs : content.channels;
    targets.emplace(id, Target{channels, channels.size()});
    channels.push_back({channel.topic, definition_of(**reader, channel), {}});
  }
  const auto read = (*reader)->for_each_message([&](const mcap::Message& message) {
    if (before && message.log_time >= *before) return true;
    Hash hash;
    hash.add(message.sequence).add(message.publish_time).add(message.data.data(), message.data.size());
    const Target& target = targets.at(message.channel->id);
    target.channels[target.index].messages.push_back({message.log_time, hash.value()});
    return true;
  });
  if (!read) return read.errors();
  for (const mcap::Attachment& attachment : (*reader)->attachments())
    content.attachments[attachment.name] =
        Hash().add(attachment.media_type).add(attachment.data.data(), attachment.data.size()).value();
  for (const mcap::Metadata& metadata : (*reader)->metadata())
    if (metadata.name == "rehearse.outcome" && !before) content.outcome = Hash().add(metadata.values).value();
  return content;
}

std::string first_difference(const std::vector<ChannelContent>& expected, const std::vector<ChannelContent>& actual,
                             double time_step) {
  std::optional<Place> first;
  for (const ChannelContent& channel : expected) {
    const ChannelContent* other = find(actual, channel.topic);
    if (!other) return fmt::format("channel {} isn't there", channel.topic);
    if (other->definition != channel.definition) return fmt::format("channel {} is defined otherwise", channel.topic);
    const std::optional<std::uint64_t> time = first_difference(channel, *other);
    if (time && (!first || *time < first->time)) first = Place{*time, channel.topic};
  }
  for (const ChannelContent& channel : actual)
    if (!find(expected, channel.topic)) return fmt::format("channel {} is new", channel.topic);
  if (!first) return {};
  const double seconds = static_cast<double>(first->time) * 1e-9;
  return fmt::format("tick {} ({} s), {}", std::llround(seconds / time_step), seconds, first->topic);
}

std::string first_difference(const RecordingContent& expected, const RecordingContent& actual, double time_step) {
  if (std::string found = first_difference(expected.channels, actual.channels, time_step); !found.empty()) return found;
  for (const auto& [name, content] : expected.attachments) {
    const auto other = actual.attachments.find(name);
    if (other == actual.attachments.end()) return fmt::format("attachment {} isn't there", name);
    if (other->second != content) return fmt::format("attachment {} differs", name);
  }
  if (actual.attachments.size() != expected.attachments.size()) return "it has more attachments";
  if (actual.outcome != expected.outcome) return "the outcome (ticks, completeness, checkpoints)";
  return {};
}

Result<std::uint64_t> hash_of_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream && !stream.eof()) return error(fmt::format("can't read {}", file.string()));
  return Hash().add(bytes).value();
}

}  // namespace rehearse::matrix
