#include "copied_recording.h"

#include <rehearse/messages.h>

#include <algorithm>

#include "core/kinds/channel_name.h"

namespace rehearse {
namespace {

/// The id of a topic, which is added like the other recording's channel if it is missing.
std::uint16_t topic_like(const mcap::Channel& channel, const mcap::Schema& schema, const std::string& topic,
                         TraceOutput& output) {
  if (const auto known = output.by_topic.find(topic); known != output.by_topic.end()) return known->second;
  const std::uint16_t schema_id = output.writer->add_schema(schema.name, schema.encoding, schema.data);
  ++output.size.channels;
  return output.by_topic[topic] =
             output.writer->add_channel(schema_id, topic, channel.message_encoding, channel.metadata);
}

}  // namespace

Result<void> copy_message(const mcap::Message& message, const mcap::Schema& schema, const std::string& topic,
                          TraceOutput& output) {
  const std::uint16_t to = topic_like(*message.channel, schema, topic, output);
  ++output.size.messages;
  if (topic == run_topics::tick) ++output.size.ticks;
  count_pictures(message, schema, output.size);
  return output.writer->write(to, message.log_time, message.publish_time, message.data);
}

void count_pictures(const mcap::Message& message, const mcap::Schema& schema, RecordingSize& size) {
  if (schema.name == msg::CompressedImage::type_name) {
    CdrReader reader(message.data);
    msg::CompressedImage picture;
    if (msg::decode(reader, picture) && !picture.data.empty()) ++size.pictures;
  } else if (schema.name == msg::Image::type_name) {
    ++size.pictures;
  }
}

bool begins_like(const TraceOutput& output, const mcap::Reader& other) {
  if (other.channels().size() < output.by_topic.size()) return false;
  std::uint16_t next = 1;
  for (const auto& [id, channel] : other.channels()) {
    const mcap::Schema* schema = other.schema_of(channel);
    if (id != next++ || !schema) return false;
    const auto known = output.by_topic.find(channel.topic);
    if (known == output.by_topic.end()) {
      if (id <= output.by_topic.size()) return false;
    } else if (known->second != id || schema->data != form_of(ChannelName::parse(channel.topic).kind).schema()) {
      return false;
    }
  }
  return true;
}

Result<void> copy_chunk(const mcap::StoredChunk& chunk, const mcap::Reader& other, TraceOutput& output) {
  std::uint16_t last = 0;
  const std::uint16_t tick_channel = output.by_topic.at(run_topics::tick);
  for (const mcap::StoredChunk::Index& index : chunk.indexes) {
    last = std::max(last, index.channel);
    output.size.messages += static_cast<std::int64_t>(index.count);
    if (index.channel == tick_channel) output.size.ticks += static_cast<std::int64_t>(index.count);
  }
  for (const auto& [id, channel] : other.channels()) {
    if (id > last) break;
    const std::uint16_t here = topic_like(channel, *other.schema_of(channel), channel.topic, output);
    REHEARSE_ASSERT(here == id, "the channels of both recordings have the same ids");
  }
  return output.writer->copy_chunk(chunk);
}

}  // namespace rehearse
