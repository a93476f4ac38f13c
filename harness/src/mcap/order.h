// Messages by log time, out of chunks that overlap. Internal.
#pragma once

#include "reader_impl.h"

#include <memory>
#include <utility>
#include <vector>

namespace rehearse::mcap {

/// A message that waits for its turn.
struct Waiting {
  std::uint64_t log_time = 0;
  std::uint64_t offset = 0;  // of its record, in the file or in the decompressed chunk
};

/// A run of messages sorted by time: a decompressed chunk, or all messages that are in no chunk.
struct Run {
  std::optional<std::uint64_t> chunk;
  Bytes compressed;  // the chunk's record, where the file is mapped
  RawBuffer buffer;
  Bytes records;
  std::vector<Waiting> order;
  std::size_t next = 0;

  bool done() const { return next == order.size(); }
  std::uint64_t time() const { return order[next].log_time; }
  std::uint64_t file_offset() const { return chunk.value_or(order[next].offset); }
};

/// The messages of a file, one after the other, by (log time, position in the file). Chunks are opened when the time
/// comes to their first message and let go after their last.
class MessageOrder {
 public:
  /// All three outlive it.
  MessageOrder(Reader::Impl& reader, const ChannelSet& channels, DamageLog& damage);

  /// The next message's record; false when there is none left, or no memory for them.
  bool next(Record& record);
  /// Done with that message.
  void advance();

 private:
  static bool later(const std::unique_ptr<Run>& a, const std::unique_ptr<Run>& b) {
    return std::pair(a->time(), a->file_offset()) > std::pair(b->time(), b->file_offset());
  }
  void collect_loose();
  void open_next_chunk();
  void collect(Run& run, RecordWalker& walker, const Chunk* place);
  void add(std::unique_ptr<Run> run);
  void let_go(std::unique_ptr<Run> run);

  Reader::Impl& reader_;
  const ChannelSet& channels_;
  DamageLog& damage_;
  PassedBytes passed_;         // what stands between chunks, too
  std::vector<Chunk> chunks_;  // by start time, then place
  std::size_t next_chunk_ = 0;
  std::vector<std::unique_ptr<Run>> heap_;   // the earliest on top
  std::vector<std::unique_ptr<Run>> spare_;  // for their memory
  std::uint64_t held_ = 0;                   // bytes of open chunks
};

}  // namespace rehearse::mcap
