// MessageFinder: the messages of a file by channel and time, forwards and backwards, without a pass over it.
//
// Only the needed chunks are opened, and a few of them are kept. The channels of a chunk are read from the message
// indexes after it at the first visit. So the memory doesn't grow with the length of the file, except for a few bytes
// per chunk. Messages outside of chunks aren't found.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/mcap/chunks.h"

namespace rehearse {

class MessageFinder {
 public:
  /// A chunk's messages, sorted by channel, then time, then offset.
  struct Content {
    struct Entry {
      std::uint16_t channel = 0;
      std::uint64_t time = 0;    // log time [ns]
      std::uint64_t offset = 0;  // of the data in `records`
      std::uint64_t size = 0;    // [bytes]
    };
    mcap::RawBuffer buffer;
    mcap::Bytes records;
    std::vector<Entry> entries;
  };
  /// A message, and the owner of its bytes.
  struct Found {
    std::uint64_t time = 0;  // log time [ns]
    mcap::Bytes data;
    std::shared_ptr<const Content> keep;
  };

  /// Fails as Reader::open.
  static Result<std::unique_ptr<MessageFinder>> open(const std::filesystem::path& file);

  mcap::Reader& reader() { return *reader_; }
  /// Chunks that couldn't be opened; the list grows during searches.
  const Diagnostics& damage() const { return damage_; }

  /// All messages of the channel at that time, in their order in the file.
  std::vector<Found> at(std::uint16_t channel, std::uint64_t time);
  /// The latest message from `earliest` to `time`, both included; of several at one time the last in the file.
  std::optional<Found> latest(std::uint16_t channel, std::uint64_t time, std::uint64_t earliest = 0);
  /// The earliest message from `time` on.
  std::optional<Found> next(std::uint16_t channel, std::uint64_t time);

 private:
  explicit MessageFinder(std::unique_ptr<mcap::Reader> reader) : reader_(std::move(reader)) {}

  struct Place {
    mcap::Chunk chunk;
    std::uint64_t latest_end = 0;         // of this chunk and of all before it [ns]
    bool learned = false;                 // `channels` were read
    bool has_index = false;               // there are message indexes; else any channel may be in it
    std::vector<std::uint16_t> channels;  // sorted
  };
  struct Cached {
    std::size_t place = 0;
    std::uint64_t used = 0;
    std::shared_ptr<const Content> content;
  };

  void let_go(std::uint64_t begin, std::uint64_t end) const;
  bool may_have(Place& place, std::uint16_t channel);
  std::shared_ptr<const Content> content(std::size_t place);
  std::shared_ptr<const Content> open_chunk(const Place& place);
  std::size_t begin_after(std::uint64_t time) const;

  std::unique_ptr<mcap::Reader> reader_;
  std::vector<Place> places_;  // by start time
  std::vector<Cached> cache_;
  std::uint64_t uses_ = 0;
  Diagnostics damage_;
};

}  // namespace rehearse
