// The thread of a Writer: composes, compresses, checksums and writes finished chunks and other records. Internal.
#pragma once

#include <rehearse/mcap.h>

#include "codec.h"
#include "records.h"
#include "sink.h"
#include "summary.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <variant>

namespace rehearse::mcap {

/// A deferred message of a chunk: its record has no data so far.
struct PutOff {
  std::size_t entry = 0;  // its entry in the chunk's index
  std::vector<std::byte> raw;
  Compose compose = nullptr;
};

/// A chunk while it is filled, and until it is written.
struct ChunkData {
  std::vector<std::byte> records;
  std::vector<IndexEntry> index;
  std::vector<PutOff> put_off;  // in the order of their entries
  std::size_t held = 0;         // memory of the deferred messages [bytes]
  /// Log time of the first message in file order: determines when the chunk is finished by age.
  std::uint64_t first_time = 0;
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  Compression compression = Compression::none;

  bool empty() const { return index.empty(); }
  std::size_t size() const { return records.size() + held; }
  void clear() {
    records.clear();
    index.clear();
    put_off.clear();
    held = 0;
  }
};

/// A composed record outside of chunks, and its data for the summary.
struct RawJob {
  enum class Kind { plain, attachment, metadata };
  Kind kind = Kind::plain;
  std::vector<std::byte> bytes;
  Attachment attachment;        // kind attachment; without its data
  std::uint64_t data_size = 0;  // kind attachment: size of its data [bytes]
  std::string metadata_name;    // kind metadata
};

/// A chunk of another file.
struct StoredJob {
  std::vector<std::byte> bytes;  // StoredChunk::bytes
  Chunk chunk;
  std::vector<StoredChunk::Index> indexes;
};

using Job = std::variant<RawJob, ChunkData, StoredJob>;

class Output {
 public:
  /// Starts the thread. `name` is the file's name in messages.
  Output(std::unique_ptr<Sink> sink, std::string name, const WriterOptions& options);
  /// Writes the queued jobs and closes the file.
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  /// Adds a job to the queue; waits while the queue is full. After a failure jobs are dropped.
  void push(Job job);
  /// An empty chunk that reuses the memory of a written one.
  ChunkData take_chunk();

  /// Descriptor of the open file.
  int descriptor() const { return sink_->descriptor(); }
  /// True if finish() found that something else has changed the file.
  bool is_changed_by_others() const { return changed_by_others_; }
  bool failed() const { return failed_.load(std::memory_order_acquire); }
  /// Success, or the failure.
  Result<void> status();
  /// Reports a failure; nothing is written from now on.
  void fail(Diagnostic diagnostic);
  /// Waits until all queued jobs are written.
  Result<void> drain();
  /// Ends the thread, writes the end of the data section, the summary and the footer, and closes the file. `statistics`
  /// doesn't need the counts of attachments, metadata and chunks.
  Result<void> finish(const std::vector<Schema>& schemas, const std::vector<Channel>& channels, Statistics statistics);

 private:
  void run();
  void stop();
  void process(Job& job);
  void process_raw(const RawJob& job);
  void process_stored(const StoredJob& job);
  void compose(ChunkData& chunk);
  void process_chunk(const ChunkData& chunk);
  void add_index(const Chunk& chunk, std::uint64_t size, std::uint64_t indexes_size, Bytes places);
  void put_message_indexes(const ChunkData& chunk, ByteWriter& out, ByteWriter& places) const;
  void write_data(Bytes bytes);  // bytes of the data section: included in its CRC
  void write_file(Bytes bytes);
  void verify();
  void close_file();

  std::unique_ptr<Sink> sink_;
  const bool crcs_;
  const bool verified_;
  bool changed_by_others_ = false;
  const std::string name_;
  const std::size_t queue_length_;
  Compressor compressor_;

  std::mutex mutex_;
  std::condition_variable to_thread_;
  std::condition_variable from_thread_;
  std::deque<Job> queue_;  // guarded by mutex_, like all members down to error_
  std::vector<ChunkData> free_;
  bool busy_ = false;
  bool stopping_ = false;
  Diagnostics error_;
  std::atomic<bool> failed_{false};

  // Used by the thread while it runs, then by finish().
  std::uint64_t offset_ = 0;
  std::uint32_t data_crc_ = 0;
  Statistics counts_;
  ChunkIndexes chunk_indexes_;
  std::vector<std::byte> attachment_indexes_;  // whole records of the summary, like the next member
  std::vector<std::byte> metadata_indexes_;
  std::vector<std::byte> scratch_;
  std::vector<std::byte> composed_;

  std::thread thread_;  // last member: it starts after all others are initialised
};

}  // namespace rehearse::mcap
