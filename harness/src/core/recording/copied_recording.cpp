#include "copied_recording.h"

#include <rehearse/messages.h>

#include <algorithm>

#include "core/kinds/channel_name.h"
#include "recorder_impl.h"

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

Result<void> CopiedRecording::copy(const mcap::Message& message, const mcap::Schema& schema, const std::string& topic) {
  const std::uint16_t to = topic_like(*message.channel, schema, topic, recorder_);
  ++recorder_.size.messages;
  if (topic == run_topics::tick) ++recorder_.size.ticks;
  count_pictures(message, schema);
  return recorder_.writer->write(to, message.log_time, message.publish_time, message.data);
}

void CopiedRecording::count_pictures(const mcap::Message& message, const mcap::Schema& schema) {
  if (schema.name == msg::CompressedImage::type_name) {
    CdrReader reader(message.data);
    msg::CompressedImage picture;
    if (msg::decode(reader, picture) && !picture.data.empty()) ++recorder_.size.pictures;
  } else if (schema.name == msg::Image::type_name) {
    ++recorder_.size.pictures;
  }
}

bool CopiedRecording::begins_like(const mcap::Reader& other) const {
  const TraceOutput& output = recorder_;
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

Result<void> CopiedRecording::copy_chunk(const mcap::StoredChunk& chunk, const mcap::Reader& other) {
  TraceOutput& output = recorder_;
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

Result<void> CopiedRecording::write_measured_joints(std::int64_t tick, int body,
                                                    const std::vector<JointReading>& joints) {
  BodyChannels& channels = recorder_.bodies[static_cast<std::size_t>(body)];
  REHEARSE_ASSERT(channels.measured_joints, "Recorder::measure_joints() was called before declare()");
  return recorder_.write_joints(tick, channels, *channels.measured_joints, joints);
}

Result<void> CopiedRecording::write_reading(std::int64_t tick, int body, int device, const DeviceReading& reading) {
  BodyChannels& channels = recorder_.bodies[static_cast<std::size_t>(body)];
  return channels.devices[static_cast<std::size_t>(device)].write(recorder_, tick, reading);
}

Result<void> CopiedRecording::write_joystick(std::int64_t tick, const JoystickReading& reading) {
  return recorder_.write_joystick(tick, reading);
}

}  // namespace rehearse
