#include "output.h"

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "summary.h"

namespace rehearse::mcap {

namespace {

/// Starts a thread that no signal is delivered to: alarms and interrupts belong to the program's own threads.
template <class Function>
std::thread start_quiet_thread(Function function) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(function));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

/// Device and inode; of what isn't open none.
std::pair<std::uint64_t, std::uint64_t> identity_of(int file) {
  struct stat status {};
  if (::fstat(file, &status) != 0) return {};
  return {status.st_dev, status.st_ino};
}

}  // namespace

Output::Output(int file, std::string name, const WriterOptions& options)
    : file_(file),
      device_(identity_of(file).first),
      inode_(identity_of(file).second),
      name_(std::move(name)),
      queue_length_(std::max<std::size_t>(1, options.queue_length)),
      compressor_(options.zstd_level),
      thread_(start_quiet_thread([this] { run(); })) {}

/// The program around us may have closed our descriptor, and its number may stand for another file by now.
bool Output::is_our_file() const {
  const auto [device, inode] = identity_of(file_);
  return device == device_ && inode == inode_;
}

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
  auto& chunk = std::get<ChunkData>(job);
  compose(chunk);
  process_chunk(chunk);
}

/// Puts the data of what was put off behind the heads of their records.
void Output::compose(ChunkData& chunk) {
  if (chunk.put_off.empty()) return;
  composed_.clear();
  auto next = chunk.put_off.begin();
  for (std::size_t i = 0; i < chunk.index.size(); ++i) {
    const std::size_t begin = chunk.index[i].offset;
    const std::size_t end = i + 1 < chunk.index.size() ? chunk.index[i + 1].offset : chunk.records.size();
    chunk.index[i].offset = composed_.size();
    const Bytes record = Bytes(chunk.records).subspan(begin, end - begin);
    composed_.insert(composed_.end(), record.begin(), record.end());
    if (next == chunk.put_off.end() || next->entry != i) continue;
    const std::vector<std::byte> data = next->compose();
    next->compose = nullptr;  // what it held goes
    ++next;
    const std::uint64_t length = message_head + data.size();
    std::memcpy(&composed_[chunk.index[i].offset + 1], &length, sizeof length);
    composed_.insert(composed_.end(), data.begin(), data.end());
  }
  std::swap(chunk.records, composed_);
}

void Output::process_raw(const RawJob& job) {
  const std::uint64_t start = offset_;
  write_data(job.bytes);
  if (job.kind == RawJob::Kind::attachment) {
    ++counts_.attachment_count;
    ByteWriter out(attachment_indexes_);
    out.begin_record(op::attachment_index);
    out.put(start);
    out.put(offset_ - start);
    out.put(job.attachment.log_time);
    out.put(job.attachment.create_time);
    out.put(job.data_size);
    out.put_string(job.attachment.name);
    out.put_string(job.attachment.media_type);
    out.end_record();
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
  out.put(crc32(chunk.records));
  out.put_string(compression);
  out.put(static_cast<std::uint64_t>(compressed->size()));
  out.put_bytes(*compressed);
  out.end_record();
  const std::uint64_t chunk_length = out.size();
  std::vector<std::byte> offsets;
  ByteWriter offset_map(offsets);
  put_message_indexes(chunk, out, offset_, offset_map);

  ++counts_.chunk_count;
  ByteWriter summary(chunk_indexes_);
  summary.begin_record(op::chunk_index);
  summary.put(chunk.start_time);
  summary.put(chunk.end_time);
  summary.put(offset_);
  summary.put(chunk_length);
  summary.put(static_cast<std::uint32_t>(offsets.size()));
  summary.put_bytes(offsets);
  summary.put(static_cast<std::uint64_t>(out.size() - chunk_length));
  summary.put_string(compression);
  summary.put(static_cast<std::uint64_t>(compressed->size()));
  summary.put(static_cast<std::uint64_t>(chunk.records.size()));
  summary.end_record();

  write_data(scratch_);
}

/// One MessageIndex record per channel, by ascending channel; `offsets` gets channel and file offset of each.
void Output::put_message_indexes(const ChunkData& chunk, ByteWriter& out, std::uint64_t record_start,
                                 ByteWriter& offsets) const {
  std::vector<IndexEntry> entries = chunk.index;
  std::stable_sort(entries.begin(), entries.end(),
                   [](const IndexEntry& a, const IndexEntry& b) { return a.channel < b.channel; });
  for (auto first = entries.begin(); first != entries.end();) {
    const auto last = std::find_if(first, entries.end(), [&](const auto& e) { return e.channel != first->channel; });
    offsets.put(first->channel);
    offsets.put(record_start + out.size());
    out.begin_record(op::message_index);
    out.put(first->channel);
    out.put(static_cast<std::uint32_t>((last - first) * 16));
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

  SummaryComposer summary(offset_, data_crc_);
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
  summary.add_group(op::chunk_index, chunk_indexes_);
  summary.add_group(op::attachment_index, attachment_indexes_);
  summary.add_group(op::metadata_index, metadata_indexes_);
  write_file(summary.finish());
  close_file();
  return status();
}

void Output::write_data(Bytes bytes) {
  data_crc_ = crc32(bytes, data_crc_);
  write_file(bytes);
}

void Output::write_file(Bytes bytes) {
  if (!bytes.empty() && !failed() && !is_our_file())
    return fail(
        error("the trace can't be written any further: something in this process has closed its file descriptor",
              "what was written before is whole; does a controller close what it hasn't opened?"));
  while (!bytes.empty() && !failed()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return fail(error(fmt::format("can't write the trace: {}", std::strerror(errno))));
    offset_ += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void Output::fail(Diagnostic diagnostic) {
  diagnostic.file = name_;
  const std::scoped_lock lock(mutex_);
  if (error_.empty()) error_ = {std::move(diagnostic)};
  failed_.store(true, std::memory_order_release);
}

void Output::close_file() {
  if (file_ < 0) return;
  const int result = is_our_file() ? ::close(file_) : 0;
  file_ = -1;
  if (result != 0 && !failed()) fail(error(fmt::format("can't finish writing the trace: {}", std::strerror(errno))));
}

}  // namespace rehearse::mcap
