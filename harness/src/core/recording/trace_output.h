// TraceOutput: writes the channels and messages of a run into its trace. Used by Recorder and its parts.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "core/kinds/channel_name.h"
#include "fixed_message.h"

namespace rehearse {

/// The size of a recording.
struct RecordingSize {
  std::int64_t ticks = 0;
  int channels = 0;
  std::int64_t pictures = 0;  // of colour and of depth
  std::int64_t messages = 0;
};

struct TraceOutput {
  explicit TraceOutput(double seconds_a_tick) : time_step(seconds_a_tick) {}

  double time_step;                      // [s]
  std::unique_ptr<mcap::Writer> writer;  // null: channels are listed, and nothing is written
  RecordingSize size;
  std::map<std::string, std::uint16_t> by_topic;       // ids of channels
  std::map<std::string, mcap::StringMap> listed = {};  // metadata of channels by topic, if nothing is written
  DeviceMessage device_message = {};                   // its memory is reused

  /// Adds a channel for messages of type T, which is the type of the name's kind. Returns its id, which is never 0. Its
  /// metadata is the units of that kind, and `metadata`.
  template <class T>
  std::uint16_t channel(const ChannelName& name, mcap::StringMap metadata = {}) {
    REHEARSE_ASSERT(form_of(name.kind).type == T::type_name, "a channel has the messages of its kind");
    return channel(name, std::move(metadata));
  }

  /// A channel that was added before, as one of a copied recording, isn't added again.
  std::uint16_t channel(const ChannelName& name, mcap::StringMap metadata = {}) {
    const ChannelForm& form = form_of(name.kind);
    const std::string topic = name.topic();
    if (const auto known = by_topic.find(topic); known != by_topic.end()) return known->second;
    metadata.merge(unit_metadata(name.kind));
    if (!writer) {
      listed[topic] = std::move(metadata);
      return static_cast<std::uint16_t>(listed.size());
    }
    const std::uint16_t schema = writer->add_schema(form.type, "ros2msg", form.schema());
    ++size.channels;
    return by_topic[topic] = writer->add_channel(schema, topic, "cdr", std::move(metadata), chunk_group_of(name));
  }

  /// Writes a message of that tick.
  template <class T>
  Result<void> write(std::uint16_t to, std::int64_t tick, const T& message) {
    cdr_.reset();
    msg::encode(message, cdr_);
    return write_encoded(to, tick, cdr_.bytes());
  }

  Result<void> write(std::uint16_t to, std::int64_t tick, FixedMessage& message) {
    message.set_stamp(stamp(tick));
    return write_encoded(to, tick, message.bytes());
  }

  Result<void> write_encoded(std::uint16_t to, std::int64_t tick, mcap::Bytes message) {
    ++size.messages;
    begin(tick);
    return writer->write(to, now_, now_, message);
  }

  /// Writes a message that takes long to compose. `held`: the size by which it counts until then [bytes].
  Result<void> write_later(std::uint16_t to, std::int64_t tick, std::size_t held, std::vector<std::byte> raw,
                           mcap::Compose compose) {
    ++size.messages;
    begin(tick);
    return writer->write_later(to, now_, now_, held, std::move(raw), compose);
  }

  const msg::Time& stamp(std::int64_t tick) {
    begin(tick);
    return stamp_;
  }

 private:
  /// Most messages are of the same tick as the last one.
  void begin(std::int64_t tick) {
    if (tick == tick_) return;
    tick_ = tick;
    now_ = nanoseconds_of(tick, time_step);
    stamp_ = msg::Time::from_ns(now_);
  }

  std::int64_t tick_ = std::numeric_limits<std::int64_t>::min();  // of the last message
  std::uint64_t now_ = 0;                                         // its log time [ns]
  msg::Time stamp_;
  CdrWriter cdr_;
};

}  // namespace rehearse
