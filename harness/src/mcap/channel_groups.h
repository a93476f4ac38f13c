// Which channels share chunks in a file, so that a copy keeps pictures apart from numbers as the file did. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <map>
#include <span>
#include <string_view>

namespace rehearse::mcap {

class ChannelGroups {
 public:
  /// A chunk with messages of these channels.
  void add_chunk(std::string_view compression, std::span<const std::uint16_t> channels);
  /// A chunk with messages of nobody knows which channels: how those are compressed that no other chunk is added for.
  void add_chunk(std::string_view compression);
  ChunkGroup of(std::uint16_t channel) const;

 private:
  std::uint16_t root_of(std::uint16_t channel) const;
  std::map<std::uint16_t, std::uint16_t> parent_;     // of each channel; a root's is itself
  std::map<std::uint16_t, Compression> compression_;  // by root
  Compression otherwise_ = Compression::zstd;
};

/// Of a file, from its message indexes; nothing is decompressed. A chunk without an index tells only how it is
/// compressed: that goes for all channels without one.
ChannelGroups groups_of(Bytes file);

}  // namespace rehearse::mcap
