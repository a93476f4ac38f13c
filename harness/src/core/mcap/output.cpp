#include "output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/quiet_thread.h"

namespace rehearse::mcap {

Output::Output(std::unique_ptr<Sink> sink, std::string name, const WriterOptions& options)
    : sink_(std::move(sink)),
      crcs_(options.crcs),
      verified_(options.verified),
      name_(std::move(name)),
      queue_length_(std::max<std::size_t>(1, options.queue_length)),
      compressor_(options.zstd_level, options.lz4_level),
      chunk_indexes_(*sink_, options.index_size),
      thread_(start_quiet_thread([this] { run(); })) {}

Output::~Output() {
  stop();
  close_file();
}

void Output::push(Job job) {
  std::unique_lock lock(mutex_);
  from_thread_.wait(lock, [this] { return queue_.size() < queue_length_; });
  queue_.push_back(std::move(job));
  to_thread_.notify_one();
}

ChunkData Output::take_chunk() {
  const std::scoped_lock lock(mutex_);
  if (free_.empty()) return {};
  ChunkData chunk = std::move(free_.back());
  free_.pop_back();
  return chunk;
}

Result<void> Output::status() {
  if (!failed()) return {};
  const std::scoped_lock lock(mutex_);
  return error_;
}

Result<void> Output::drain() {
  std::unique_lock lock(mutex_);
  from_thread_.wait(lock, [this] { return queue_.empty() && !busy_; });
  lock.unlock();
  return status();
}

void Output::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    to_thread_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (queue_.empty()) return;
    Job job = std::move(queue_.front());
    queue_.pop_front();
    busy_ = true;
    lock.unlock();
    from_thread_.notify_all();
    process(job);
    lock.lock();
    if (auto* chunk = std::get_if<ChunkData>(&job)) {
      chunk->clear();
      free_.push_back(std::move(*chunk));
    }
    busy_ = false;
    from_thread_.notify_all();
  }
}

void Output::stop() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  to_thread_.notify_one();
  thread_.join();
}

void Output::process(Job& job) {
  if (failed()) return;
  if (const auto* raw = std::get_if<RawJob>(&job)) return process_raw(*raw);
  if (const auto* stored = std::get_if<StoredJob>(&job)) return process_stored(*stored);
  auto& chunk = std::get<ChunkData>(job);
  compose(chunk);
  process_chunk(chunk);
}

/// Inserts the data of deferred messages after the heads of their records.
void Output::compose(ChunkData& chunk) {
  if (chunk.put_off.empty()) return;
  composed_.clear();
  const auto copy = [&](std::size_t begin, std::size_t end) {
    const Bytes piece = Bytes(chunk.records).subspan(begin, end - begin);
    composed_.insert(composed_.end(), piece.begin(), piece.end());
  };
  std::size_t copied = 0;  // bytes of the records
  std::size_t moved = 0;   // entries of the index
  for (PutOff& message : chunk.put_off) {
    const std::size_t shift = composed_.size() - copied;  // number of bytes inserted before
    for (; moved <= message.entry; ++moved) chunk.index[moved].offset += shift;
    const std::size_t head = chunk.index[message.entry].offset;
    const std::size_t data_at = head - shift + record_head + message_head;
    copy(copied, data_at);
    copied = data_at;
    const std::vector<std::byte> data = message.compose(message.raw);
    message.raw = {};  // releases its memory
    const std::uint64_t length = message_head + data.size();
    std::memcpy(&composed_[head + 1], &length, sizeof length);
    composed_.insert(composed_.end(), data.begin(), data.end());
  }
  for (; moved < chunk.index.size(); ++moved) chunk.index[moved].offset += composed_.size() - copied;
  copy(copied, chunk.records.size());
  std::swap(chunk.records, composed_);
}

void Output::process_raw(const RawJob& job) {
  const std::uint64_t start = offset_;
  write_data(job.bytes);
  if (job.kind == RawJob::Kind::attachment) {
    ++counts_.attachment_count;
    ByteWriter out(attachment_indexes_);
    const Attachment& a = job.attachment;
    out.put_record(op::attachment_index, start, offset_ - start, a.log_time, a.create_time, job.data_size, a.name,
                   a.media_type);
  } else if (job.kind == RawJob::Kind::metadata) {
    ++counts_.metadata_count;
    ByteWriter out(metadata_indexes_);
    put_metadata_index(out, start, offset_ - start, job.metadata_name);
  }
}

void Output::process_chunk(const ChunkData& chunk) {
  const auto compressed = compressor_.compress(chunk.compression, chunk.records);
  if (!compressed) return fail(compressed.errors().front());
  const std::string_view compression = to_string(chunk.compression);

  scratch_.clear();
  ByteWriter out(scratch_);
  out.begin_record(op::chunk);
  out.put(chunk.start_time);
  out.put(chunk.end_time);
  out.put(static_cast<std::uint64_t>(chunk.records.size()));
  out.put(crcs_ ? crc32(chunk.records) : 0u);
  out.put(compression);
  out.put(static_cast<std::uint64_t>(compressed->size()));
  out.put_bytes(*compressed);
  out.end_record();
  const std::size_t size = out.size();
  std::vector<std::byte> places;
  ByteWriter out_places(places);
  put_message_indexes(chunk, out, out_places);
  add_index({0, chunk.start_time, chunk.end_time, std::string(compression), compressed->size(), chunk.records.size()},
            size, out.size() - size, places);
  write_data(scratch_);
}

void Output::process_stored(const StoredJob& job) {
  std::vector<std::byte> places;
  ByteWriter out(places);
  for (const StoredChunk::Index& index : job.indexes) {
    out.put(index.channel);
    out.put(offset_ + index.offset);
  }
  const std::uint64_t size = job.indexes.empty() ? job.bytes.size() : job.indexes.front().offset;
  add_index(job.chunk, size, job.bytes.size() - size, places);
  write_data(job.bytes);
}

/// Adds the index of a chunk that is written next. `size`: of its record; `places`: of its message indexes, which have
/// `indexes_size` bytes.
void Output::add_index(const Chunk& chunk, std::uint64_t size, std::uint64_t indexes_size, Bytes places) {
  ChunkIndex index{chunk, size, indexes_size, places};
  index.chunk.offset = offset_;
  ++counts_.chunk_count;
  chunk_indexes_.add(index);
}

/// Writes one MessageIndex record per channel, by ascending channel; `places` gets channel and file offset of each.
void Output::put_message_indexes(const ChunkData& chunk, ByteWriter& out, ByteWriter& places) const {
  std::vector<IndexEntry> entries = chunk.index;
  std::ranges::stable_sort(entries, [](const IndexEntry& a, const IndexEntry& b) { return a.channel < b.channel; });
  for (auto first = entries.begin(); first != entries.end();) {
    const auto last =
        std::ranges::find_if(first, entries.end(), [&](const auto& e) { return e.channel != first->channel; });
    places.put(first->channel);
    places.put(static_cast<std::uint64_t>(offset_ + out.size()));
    out.begin_record(op::message_index);
    out.put(first->channel);
    out.put(static_cast<std::uint32_t>((last - first) * index_entry_size));
    for (; first != last; ++first) {
      out.put(first->log_time);
      out.put(first->offset);
    }
    out.end_record();
  }
}

Result<void> Output::finish(const std::vector<Schema>& schemas, const std::vector<Channel>& channels,
                            Statistics statistics) {
  stop();
  if (failed()) {
    close_file();
    return status();
  }
  statistics.attachment_count = counts_.attachment_count;
  statistics.metadata_count = counts_.metadata_count;
  statistics.chunk_count = counts_.chunk_count;

  const std::uint64_t data_size = offset_;
  SummaryComposer summary(data_size, data_crc_, [this](Bytes bytes) { write_file(bytes); });
  const auto add_group = [&](std::uint8_t opcode, auto&& put_records) {
    std::vector<std::byte> records;
    ByteWriter out(records);
    put_records(out);
    summary.add_group(opcode, records);
  };
  add_group(op::schema, [&](ByteWriter& out) {
    for (const auto& schema : schemas) put_schema(out, schema);
  });
  add_group(op::channel, [&](ByteWriter& out) {
    for (const auto& channel : channels) put_channel(out, channel);
  });
  add_group(op::statistics, [&](ByteWriter& out) { put_statistics(out, statistics); });
  summary.add_group(op::chunk_index, [&](const SummaryComposer::Write& write) {
    if (const auto all = chunk_indexes_.write(*sink_, data_size, write); !all) fail(all.errors().front());
  });
  add_group(op::attachment_index, [&](ByteWriter& out) { out.put_bytes(attachment_indexes_); });
  add_group(op::metadata_index, [&](ByteWriter& out) { out.put_bytes(metadata_indexes_); });
  summary.finish();
  verify();
  close_file();
  return status();
}

/// Compares the file with the written bytes, if that is wished.
void Output::verify() {
  if (!verified_ || failed()) return;
  if (const auto verdict = sink_->verify(); !verdict) {
    changed_by_others_ = true;
    fail(verdict.errors().front());
  }
}

void Output::write_data(Bytes bytes) {
  if (crcs_) data_crc_ = crc32(bytes, data_crc_);
  write_file(bytes);
}

void Output::write_file(Bytes bytes) {
  if (failed()) return;
  if (const auto written = sink_->write(bytes); !written) return fail(written.errors().front());
  offset_ += bytes.size();
}

void Output::fail(Diagnostic diagnostic) {
  diagnostic.file = name_;
  const std::scoped_lock lock(mutex_);
  if (error_.empty()) error_ = {std::move(diagnostic)};
  failed_.store(true, std::memory_order_release);
}

void Output::close_file() {
  const auto closed = sink_->close();
  if (!closed && !failed()) fail(closed.errors().front());
}

}  // namespace rehearse::mcap
