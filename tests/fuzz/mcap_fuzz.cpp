// For any bytes, the readers of traces deliver messages or report errors, and never crash, hang or take more memory
// than the bytes justify. All ways of reading deliver the same, and so does a copy by Rehearse's Writer. Schemas and
// payloads in the file are passed to the ros2msg and CDR readers.
#include <rehearse/mcap.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "../harness/mcap/file_forms.h"
#include "core/ros2msg/ros2msg.h"
#include "scratch.h"

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
  static_cast<void>(reader.for_each_message_in_order([&](const mcap::Message& message) {
    static_cast<void>(sum(message.data));
    return ++ordered < 100'000;
  }));
  if (last && !reader.message_at(*last)) std::abort();  // a message that a pass delivered can be read again
  for (const auto& attachment : reader.attachments()) static_cast<void>(sum(attachment.data));
  static_cast<void>(reader.can_copy_chunks());
  for (const mcap::Chunk& chunk : reader.chunks()) {
    const auto stored = reader.stored_chunk(chunk);
    if (!stored) continue;
    static_cast<void>(sum(stored->bytes));
    for (const auto& index : stored->indexes)
      if (index.offset >= stored->bytes.size() || index.count > stored->bytes.size()) std::abort();
  }
  decode_all(reader);
}

void expect(bool true_of_all_bytes) {
  if (!true_of_all_bytes) std::abort();
}

/// A message; with its place in the file if places are compared, too.
struct Seen {
  std::uint64_t record = 0, inside = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0, data = 0;
  std::string topic;
  bool operator==(const Seen&) const = default;
};

Seen see(const mcap::Message& message, bool with_place) {
  return {with_place ? message.location.record : 0,
          with_place ? message.location.inside : 0,
          message.sequence,
          message.log_time,
          message.publish_time,
          sum(message.data) * 31 + message.data.size(),
          message.channel->topic};
}

/// The first messages in file order, and whether anything was wrong.
struct Pass {
  std::vector<Seen> messages;
  bool whole = false;
};

Pass pass_over(mcap::Reader& reader, bool with_place) {
  constexpr std::size_t most = 20'000;
  Pass pass;
  const Result<void> end = reader.for_each_message([&](const mcap::Message& message) {
    pass.messages.push_back(see(message, with_place));
    return pass.messages.size() < most;
  });
  pass.whole = end.ok() && pass.messages.size() < most;
  return pass;
}

constexpr std::uint64_t small_chunks = 1 << 20;

Pass read_file(mcap::Bytes bytes, mcap::Opening opening) {
  const auto reader = mcap::Reader::open_bytes(bytes, "fuzz.mcap", {true, opening, small_chunks});
  return reader ? pass_over(**reader, true) : Pass{};
}

/// For a valid file: a copy by Rehearse's Writer, brought into a form that the bytes determine.
void rewrite(mcap::Bytes bytes) {
  const auto reader = mcap::Reader::open_bytes(bytes, "fuzz.mcap", {true, mcap::Opening::walk, small_chunks});
  const std::uint64_t choice = sum(bytes);
  mcap::WriterOptions options;
  options.chunk_size = 1 + choice % 5000;
  options.compression = static_cast<mcap::Compression>(choice % 3);
  const Scratch file("_copy.mcap");
  const auto writer = std::move(*mcap::Writer::create(file.path, options));
  std::map<std::uint16_t, std::uint16_t> schemas, channels;
  for (const auto& [id, schema] : (*reader)->schemas())
    schemas[id] = writer->add_schema(schema.name, schema.encoding, schema.data);
  for (const auto& [id, channel] : (*reader)->channels())
    channels[id] =
        writer->add_channel(schemas[channel.schema_id], channel.topic, channel.message_encoding, channel.metadata);
  const auto copied = (*reader)->for_each_message([&](const mcap::Message& message) {
    return writer
        ->write(channels[message.channel->id], message.log_time, message.publish_time, message.data, message.sequence)
        .ok();
  });
  expect(copied.ok() && writer->close().ok());
  test::FileForm form;
  form.chunks = choice % 3 != 0;
  form.definitions_in_chunks = choice % 2 == 0;
  form.summary = choice % 5 != 0;
  form.repeated_channels = choice % 7 != 0;
  const std::vector<std::byte> copy = test::in_form(file.read(), form);
  const auto again = mcap::Reader::open_bytes(copy, "copy.mcap");
  expect(again.ok());
  const Pass before = pass_over(**reader, false), after = pass_over(**again, false);
  expect(after.whole && after.messages == before.messages);
  const auto indexed = mcap::Reader::open_bytes(copy, "copy.mcap", {.opening = mcap::Opening::by_summary});
  const bool all_repeated = form.repeated_channels || (*reader)->channels().empty();
  expect((*indexed)->opened_by_summary() == (form.summary && all_repeated));
}

void compare_ways(mcap::Bytes bytes) {
  const Pass file = read_file(bytes, mcap::Opening::walk);
  const Pass summary = read_file(bytes, mcap::Opening::by_summary);
  expect(summary.whole == file.whole && (!file.whole || summary.messages == file.messages));
  if (file.whole) rewrite(bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const mcap::Bytes bytes(reinterpret_cast<const std::byte*>(data), size);
  read_all(bytes, true);
  compare_ways(bytes);
  read_all(bytes, false);  // goes deeper: mutations seldom get a CRC right
  return 0;
}
