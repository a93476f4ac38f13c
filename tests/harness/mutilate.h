// Copies of recordings in which messages are missing or replaced: faults of the simulation loop itself, which no
// controller and no model can cause.
#pragma once

#include <rehearse/mcap.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::testing {

/// The replacement of a message: its bytes, different bytes, or nothing.
using Mutilation = std::function<std::optional<std::vector<std::byte>>(const mcap::Message&)>;

inline std::optional<std::vector<std::byte>> untouched(const mcap::Message& message) {
  return std::vector<std::byte>(message.data.begin(), message.data.end());
}

/// Replaces the file by a copy in which `change` is applied to every message, `outcome` to the outcome, `facts` to the
/// provenance, and `of_channels` to the metadata of every channel.
inline Result<void> mutilate(const std::filesystem::path& file, const Mutilation& change,
                             const mcap::StringMap& outcome = {}, const mcap::StringMap& facts = {},
                             const mcap::StringMap& of_channels = {}) {
  const std::filesystem::path whole = file.string() + ".whole";
  std::filesystem::rename(file, whole);
  auto reader = mcap::Reader::open(whole);
  if (!reader) return reader.errors();
  auto opened = mcap::Writer::create(file);
  if (!opened) return opened.errors();
  mcap::Writer& writer = **opened;
  for (const mcap::Attachment& attachment : (*reader)->attachments())
    if (auto done = writer.add_attachment(attachment.name, attachment.media_type, attachment.data); !done) return done;
  for (mcap::Metadata metadata : (*reader)->metadata()) {
    if (metadata.name == "rehearse.outcome")
      for (const auto& [fact, value] : outcome) metadata.values[fact] = value;
    if (metadata.name == "rehearse")
      for (const auto& [fact, value] : facts) metadata.values[fact] = value;
    if (auto done = writer.add_metadata(metadata.name, metadata.values); !done) return done;
  }
  std::vector<std::uint16_t> ids;
  for (const auto& [id, channel] : (*reader)->channels()) {
    const mcap::Schema& schema = (*reader)->schemas().at(channel.schema_id);
    const std::string_view text(reinterpret_cast<const char*>(schema.data.data()), schema.data.size());
    ids.resize(std::max<std::size_t>(ids.size(), id + 1));
    mcap::StringMap metadata = channel.metadata;
    metadata.insert(of_channels.begin(), of_channels.end());
    ids[id] = writer.add_channel(writer.add_schema(schema.name, schema.encoding, text), channel.topic,
                                 channel.message_encoding, metadata);
  }
  Result<void> written;
  const auto read = (*reader)->for_each_message([&](const mcap::Message& message) {
    if (const auto bytes = change(message))
      written = writer.write(ids[message.channel->id], message.log_time, message.publish_time, *bytes);
    return written.ok();
  });
  if (!read) return read;
  if (!written) return written;
  std::filesystem::remove(whole);
  return writer.close();
}

}  // namespace rehearse::testing
