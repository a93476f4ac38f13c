// Whatever the bytes: the reader of traces delivers messages or says what is wrong, and never crashes, hangs or takes
// memory that the bytes don't warrant. Schemas and payloads found inside go on to the ros2msg and CDR readers.
#include <rehearse/mcap.h>
#include <rehearse/ros2msg.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>

using namespace rehearse;

namespace {

/// Touches every byte, so that a span that points anywhere else is noticed.
std::uint64_t sum(mcap::Bytes bytes) {
  std::uint64_t total = 0;
  for (const std::byte byte : bytes) total += std::to_integer<std::uint64_t>(byte);
  return total;
}

void decode_all(mcap::Reader& reader) {
  std::map<std::uint16_t, ros2msg::Decoder> decoders;
  for (const auto& [id, schema] : reader.schemas()) {
    if (auto parsed = ros2msg::Schema::parse(schema.name, schema.data)) decoders.emplace(id, std::move(*parsed));
  }
  std::uint64_t budget = 100'000;  // values: one input takes milliseconds, not minutes
  static_cast<void>(reader.for_each_message([&](const mcap::Message& message) {
    const auto decoder = decoders.find(message.channel->schema_id);
    if (decoder == decoders.end()) return true;
    decoder->second.decode(message.data, [&](const ros2msg::Value& value) {
      static_cast<void>(sum(value.blob));
      if (budget > 0) --budget;
    });
    return budget > 0;
  }));
}

void read_all(mcap::Bytes bytes, bool check_crcs) {
  mcap::ReaderOptions options;
  options.check_crcs = check_crcs;
  options.max_chunk_size = 1 << 20;
  const auto opened = mcap::Reader::open_bytes(bytes, "fuzz.mcap", options);
  if (!opened) return;
  mcap::Reader& reader = **opened;
  std::uint64_t messages = 0;
  std::optional<mcap::Location> last;
  static_cast<void>(reader.for_each_message([&](const mcap::Message& message) {
    static_cast<void>(sum(message.data));
    last = message.location;
    return ++messages < 100'000;
  }));
  std::uint64_t ordered = 0;
  std::uint64_t time = 0;
  static_cast<void>(reader.for_each_message_in_order([&](const mcap::Message& message) {
    static_cast<void>(sum(message.data));
    time = message.log_time;
    return ++ordered < 100'000;
  }));
  if (last && !reader.message_at(*last)) std::abort();  // what a pass delivered can be had again
  static_cast<void>(reader.for_each_record([&](const mcap::Record& record) { return sum(record.body) < ~time; }));
  for (const auto& attachment : reader.attachments()) static_cast<void>(sum(attachment.data));
  decode_all(reader);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const mcap::Bytes bytes(reinterpret_cast<const std::byte*>(data), size);
  read_all(bytes, true);
  read_all(bytes, false);  // goes deeper: mutations seldom get a CRC right
  return 0;
}
