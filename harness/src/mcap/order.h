// Orders messages of overlapping chunks by log time. Internal.
#pragma once

#include "quiet_thread.h"
#include "reader_impl.h"

#include <array>
#include <memory>
#include <utility>
#include <vector>

namespace rehearse::mcap {

/// A message that is not delivered yet.
struct Waiting {
  std::uint64_t log_time = 0;
  std::uint64_t offset = 0;  // offset of its record, in the file or in the decompressed chunk
};

/// A sequence of messages sorted by time: a decompressed chunk, or all messages outside of chunks.
struct Run {
  std::optional<std::uint64_t> chunk;
  Bytes mapped;  // the chunk's record, if the chunk isn't compressed and its records are read from the mapped file
  RawBuffer buffer;
  Bytes records;
  std::vector<Waiting> order;
  std::size_t next = 0;

  bool done() const { return next == order.size(); }
  std::uint64_t time() const { return order[next].log_time; }
  std::uint64_t file_offset() const { return chunk.value_or(order[next].offset); }
  /// Loads the message after the next one into the cache of this processor: the worker wrote it on another processor.
  void prefetch() const;
};

/// A chunk that a thread opens while the messages before it are delivered.
struct ChunkAhead {
  Chunk place;
  std::unique_ptr<Run> run;
  Bytes body;  // body of the chunk's record; empty: the record is missing
  OpenedChunk opened;
  std::vector<Record> definitions;  // all records of the chunk except messages
  bool in_span = true;              // its messages are in the span of time that the chunk states
  bool is_whole = true;             // its last record is complete
};

/// The messages of a file, one after the other, by (log time, position in the file). A chunk is opened at the time of
/// its first message and released after its last.
class MessageOrder {
 public:
  /// The three objects must outlive this. Messages before `from` [ns] are left out.
  MessageOrder(Reader::Impl& reader, const ChannelSet& channels, DamageLog& damage, std::uint64_t from = 0);
  MessageOrder(const MessageOrder&) = delete;
  MessageOrder& operator=(const MessageOrder&) = delete;

  /// The record of the next message; false if there is none left, or not enough memory.
  bool next(Record& record);
  /// Checks the CRC of the data section; if it doesn't match, finds the damage in chunks of other channels too.
  void check_data_crc();
  /// Removes the message that next() returned.
  void advance();

 private:
  static bool later(const std::unique_ptr<Run>& a, const std::unique_ptr<Run>& b) {
    return std::pair(a->time(), a->file_offset()) > std::pair(b->time(), b->file_offset());
  }
  void collect_loose();
  void choose_ahead();
  void read_ahead();
  void open_ahead();
  void open_next_chunk();
  void collect(ChunkAhead& chunk, std::uint64_t begin = 0) const;
  void add(std::unique_ptr<Run> run);
  void let_go(std::unique_ptr<Run> run);

  Reader::Impl& reader_;
  const ChannelSet& channels_;
  const std::uint64_t from_;  // [ns]
  DamageLog& damage_;
  PassedBytes passed_;         // includes the bytes between chunks
  std::vector<Chunk> chunks_;  // chunks with messages to deliver, by start time, then offset
  std::vector<Chunk> others_;  // chunks without messages to deliver
  std::size_t next_chunk_ = 0;
  std::size_t next_ahead_ = 0;               // index of the next chunk to open ahead
  bool has_advanced_ = false;                // a message after the first is requested
  std::vector<std::unique_ptr<Run>> heap_;   // the earliest on top
  std::vector<std::unique_ptr<Run>> spare_;  // kept for their memory
  std::uint64_t held_ = 0;                   // bytes of open chunks
  const bool counts_;                        // the CRC of the data section is computed
  // used by the worker while calls are pending
  ChunkOpener opener_;
  std::array<ChunkAhead, 2> ahead_;  // chunk i of chunks_ is at i % 2
  std::size_t next_open_ = 0;        // index in chunks_ of the next chunk to open
  DataCrc data_crc_;
  QuietWorker worker_;
};

}  // namespace rehearse::mcap
