// An MCAP file as other programs write it: several encodings, an invalid schema, messages out of order, wall-clock
// times.
#pragma once

#include <gtest/gtest.h>
#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

namespace rehearse::test {

inline constexpr std::uint64_t wall_clock = 1'700'000'000'123'456'789;  // [ns]

inline mcap::Bytes bytes_of(std::string_view text) { return std::as_bytes(std::span(text.data(), text.size())); }

/// The messages of one topic of a file.
class TopicWriter {
 public:
  TopicWriter(mcap::Writer& writer, std::string_view topic, std::string_view encoding, std::uint16_t schema = 0,
              mcap::StringMap metadata = {}, mcap::ChunkGroup group = mcap::numbers)
      : writer_(writer), channel_(writer.add_channel(schema, topic, encoding, std::move(metadata), group)) {}

  void raw(std::uint64_t time, mcap::Bytes data) { ASSERT_TRUE(writer_.write(channel_, time, time + 1, data)); }
  template <class Message>
  void put(std::uint64_t time, const Message& message) {
    CdrWriter cdr;
    msg::encode(message, cdr);
    raw(time, cdr.bytes());
  }

 private:
  mcap::Writer& writer_;
  std::uint16_t channel_;
};

template <class Message>
std::uint16_t add_schema(mcap::Writer& writer) {
  return writer.add_schema(Message::type_name, "ros2msg", msg::schema_text<Message>());
}

/// /joints at 0, 1 and 2 ms, /json, /proto and /strange (a schema that can't be parsed) and /short (a payload that ends
/// early) between them; /json's message is in the file before those of /joints that are earlier.
inline void write_mixed_file(const std::filesystem::path& file) {
  auto writer = std::move(*mcap::Writer::create(file));
  TopicWriter json(*writer, "/json", "json", writer->add_schema("Thing", "jsonschema", "{}"));
  TopicWriter joints(*writer, "/joints", "cdr", add_schema<msg::JointState>(*writer), {{"unit:q", "rad"}});
  TopicWriter proto(*writer, "/proto", "protobuf", writer->add_schema("foo.Bar", "protobuf", "\x01\x02"));
  TopicWriter strange(*writer, "/strange", "cdr", writer->add_schema("a/msg/B", "ros2msg", "Unknown x\n"));
  TopicWriter cut(*writer, "/short", "cdr", add_schema<msg::JointState>(*writer));
  TopicWriter bare(*writer, "/bare", "");
  json.raw(wall_clock + 1'500'000, bytes_of("{ \"a\" : [1, 2.50, \"x y\"],\n \"n\": 12345678901234567890 }"));
  json.raw(wall_clock + 1'600'000, bytes_of("{not json"));
  for (std::uint64_t i = 0; i < 3; ++i) {
    const double q = i == 2 ? std::numeric_limits<double>::quiet_NaN() : 0.1 * static_cast<double>(i);
    joints.put(wall_clock + i * 1'000'000, msg::JointState{{{1, 2}, "base"}, {"KNEE", "ANKLE"}, {q, -0.0}, {}, {}});
  }
  proto.raw(wall_clock + 1'100'000, bytes_of("\xff\xfe"));
  strange.raw(wall_clock + 1'200'000, bytes_of(std::string_view("\0\1\0\0\7", 5)));
  cut.raw(wall_clock + 1'300'000, bytes_of(std::string_view("\0\1\0\0\7\0\0\0", 8)));
  bare.raw(wall_clock + 1'400'000, bytes_of(""));
  ASSERT_TRUE(writer->close());
}

}  // namespace rehearse::test
