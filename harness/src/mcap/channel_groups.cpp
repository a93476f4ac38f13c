#include "channel_groups.h"

#include <algorithm>
#include <vector>

#include "records.h"

namespace rehearse::mcap {

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
    // the channel that is met earlier has the say
    parent_[std::max(other, root_of(first))] = std::min(other, root_of(first));
  }
}

void ChannelGroups::add_chunk(std::string_view compression) { otherwise_ = compression_of(compression); }

ChunkGroup ChannelGroups::of(std::uint16_t channel) const {
  if (!parent_.contains(channel)) return {0, otherwise_};
  const std::uint16_t root = root_of(channel);
  return {root + 1, compression_.at(root)};
}

ChannelGroups groups_of(Bytes file) {
  ChannelGroups groups;
  RecordWalker walker(file, magic.size());
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
  while (walker.next(record) && record.opcode != op::data_end && record.opcode != op::footer) {
    if (record.opcode == op::message_index) {
      channels.push_back(ByteReader(record.body).get<std::uint16_t>());
      continue;
    }
    add();
    if (record.opcode != op::chunk) continue;
    const auto head = parse_chunk(record.body);
    in_chunk = head && head->uncompressed_size > 0;
    if (in_chunk) compression = head->compression;
  }
  add();
  return groups;
}

}  // namespace rehearse::mcap
