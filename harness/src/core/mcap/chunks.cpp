#include "chunks.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/text.h"
#include "record_layout.h"
#include "record_pass.h"

namespace rehearse::mcap {

OpenedChunk ChunkOpener::open(const Record& chunk, RawBuffer& buffer) {
  OpenedChunk opened;
  opened.offset = chunk.offset;
  const auto head = parse_chunk(chunk.body);
  if (!head) return opened.fault = OpenedChunk::Fault::too_short, opened;
  opened.head = *head;
  if (head->uncompressed_size > options_.max_chunk_size) return opened.fault = OpenedChunk::Fault::too_large, opened;
  const auto records = decompressor_.decompress(head->compression, head->records, head->uncompressed_size, buffer);
  if (!records) {
    opened.fault = OpenedChunk::Fault::not_decompressed;
    opened.reason = records.errors().front().message;
  } else if (options_.check_crcs && head->uncompressed_crc != 0 && head->uncompressed_crc != crc32(*records)) {
    opened.fault = OpenedChunk::Fault::wrong_crc;
  } else {
    opened.records = *records;
  }
  return opened;
}

Bytes ChunkOpener::open_front(const ChunkHead& head, RawBuffer& buffer) {
  const auto size = std::min(head.uncompressed_size, options_.max_chunk_size);
  return decompressor_.decompress_front(head.compression, head.records, size, buffer);
}

std::string ChunkOpener::describe(const OpenedChunk& chunk) const {
  switch (chunk.fault) {
    case OpenedChunk::Fault::none: return {};
    case OpenedChunk::Fault::too_short:
      return fmt::format("damaged: the chunk at byte {} is shorter than its fields state", chunk.offset);
    case OpenedChunk::Fault::too_large:
      return fmt::format("damaged: the chunk at byte {} states {} bytes decompressed, more than the limit of {}",
                         chunk.offset, chunk.head.uncompressed_size, options_.max_chunk_size);
    case OpenedChunk::Fault::not_decompressed:
      return fmt::format("damaged: the chunk at byte {} can't be decompressed: {}", chunk.offset, chunk.reason);
    case OpenedChunk::Fault::wrong_crc:
      return fmt::format("damaged: the CRC of the chunk at byte {} doesn't match", chunk.offset);
  }
  REHEARSE_ASSERT(false, "the value is no Fault");
}

namespace {
Compression compression_of(std::string_view word) {
  if (word == to_string(Compression::none)) return Compression::none;
  return word == to_string(Compression::lz4) ? Compression::lz4 : Compression::zstd;
}
}  // namespace

std::uint16_t ChannelGroups::root_of(std::uint16_t channel) const {
  while (parent_.at(channel) != channel) channel = parent_.at(channel);
  return channel;
}

void ChannelGroups::add_chunk(std::string_view compression, std::span<const std::uint16_t> channels) {
  if (channels.empty()) return;
  for (const std::uint16_t channel : channels) {
    if (parent_.try_emplace(channel, channel).second) compression_[channel] = compression_of(compression);
  }
  const std::uint16_t first = root_of(channels.front());
  for (const std::uint16_t channel : channels) {
    const std::uint16_t other = root_of(channel);
    if (other == root_of(first)) continue;
    // the smaller channel id becomes the root
    parent_[std::max(other, root_of(first))] = std::min(other, root_of(first));
  }
}

void ChannelGroups::add_chunk(std::string_view compression) { otherwise_ = compression_of(compression); }

ChunkGroup ChannelGroups::of(std::uint16_t channel) const {
  if (!parent_.contains(channel)) return {0, otherwise_};
  const std::uint16_t root = root_of(channel);
  return {root + 1, compression_.at(root)};
}

std::string private_remark(const ChannelGroups& groups, const std::string& file) {
  if (groups.private_records == 0) return {};
  return fmt::format(
      "{} of {} {} kept: their meaning is known to their writer alone",
      groups.private_records == 1 ? "1 private record" : fmt::format("{} private records", groups.private_records),
      printable(file, 200), groups.private_records == 1 ? "isn't" : "aren't");
}

ChannelGroups groups_of(const FileView& view, Bytes file) {
  ChannelGroups groups;
  RecordPass pass(view, file, false, {}, magic.size());
  Record record;
  std::string_view compression;
  std::vector<std::uint16_t> channels;
  bool in_chunk = false;
  const auto add = [&] {
    if (in_chunk && channels.empty()) groups.add_chunk(compression);
    groups.add_chunk(compression, channels);
    channels.clear();
    in_chunk = false;
  };
  while (pass.next(record) && record.opcode != op::data_end && record.opcode != op::footer) {
    if (record.opcode == op::message_index) {
      channels.push_back(ByteReader(record.body).get<std::uint16_t>());
      continue;
    }
    add();
    if (is_private(record.opcode)) ++groups.private_records;
    if (record.opcode != op::chunk) continue;
    const auto head = parse_chunk(record.body);
    in_chunk = head && head->uncompressed_size > 0;
    if (in_chunk) compression = head->compression;
  }
  add();
  return groups;
}

}  // namespace rehearse::mcap
