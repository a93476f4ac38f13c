#include "definitions.h"
#include "output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <utility>

namespace rehearse::mcap {

namespace {
/// Later than any log time.
constexpr std::uint64_t no_time = std::numeric_limits<std::uint64_t>::max();
}  // namespace

/// The only implementation of Writer.
class FileWriter final : public Writer {
 public:
  FileWriter(std::unique_ptr<Sink> sink, std::string name, const WriterOptions& options)
      : options_(options), output_(std::move(sink), std::move(name), options) {
    RawJob job;
    ByteWriter out(job.bytes);
    out.put_bytes(magic);
    put_header(out, options.profile, options.library.value_or("rehearse " REHEARSE_VERSION));
    output_.push(std::move(job));
  }

  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data) override;
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding,
                            StringMap metadata, ChunkGroup group) override;
  Result<void> write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, Bytes data,
                     std::optional<std::uint32_t> sequence) override;
  Result<void> write_later(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, std::size_t held,
                           std::vector<std::byte> raw, Compose compose) override;
  Result<void> copy_chunk(const StoredChunk& stored) override;
  Result<void> add_attachment(std::string_view name, std::string_view media_type, Bytes data, std::uint64_t log_time,
                              std::uint64_t create_time) override;
  Result<void> add_metadata(std::string_view name, const StringMap& values) override;
  Result<void> flush() override;
  Result<void> close() override;
  int descriptor() const override { return output_.descriptor(); }
  std::uint64_t deadline() const override { return next_deadline_; }
  bool is_changed_by_others() const override { return output_.is_changed_by_others(); }

 private:
  struct Group {
    ChunkGroup key;
    ChunkData open;
  };
  struct ChannelState {
    std::size_t group = 0;
    std::uint64_t count = 0;  // number of messages
  };

  static std::size_t index_of(std::uint16_t channel) { return Definitions::index_of(channel); }
  std::size_t find_or_add_group(ChunkGroup key);
  /// The log time at which the chunk must be finished by age.
  std::uint64_t deadline_of(const ChunkData& chunk) const {
    return chunk.first_time + std::min(options_.chunk_span, no_time - chunk.first_time);
  }
  Group& begin_message(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, std::size_t size,
                       std::optional<std::uint32_t> numbered = {});
  Result<void> end_message(Group& group);
  void finish_chunk(Group& group);
  void finish_old_chunks(std::uint64_t now);

  const WriterOptions options_;
  Definitions definitions_;
  std::vector<ChannelState> states_;  // parallel to the channels
  std::vector<Group> groups_;
  std::uint64_t next_deadline_ = no_time;       // log time at which the first chunk must be finished
  std::uint64_t unwritten_deadline_ = no_time;  // the same time for chunks in the queue
  std::uint64_t message_count_ = 0;
  std::uint64_t start_time_ = no_time;
  std::uint64_t end_time_ = 0;
  std::optional<Result<void>> closed_;
  Output output_;
};

std::uint16_t FileWriter::add_schema(std::string_view name, std::string_view encoding, std::string_view data) {
  bool added = false;
  const std::uint16_t id = definitions_.add_schema(name, encoding, data, added);
  if (id == 0)
    output_.fail(error(
        fmt::format("the schema {} is one too many: a file contains at most {}", name, Definitions::most_schemas)));
  if (added) {
    RawJob job;
    ByteWriter out(job.bytes);
    put_schema(out, definitions_.schema(id));
    output_.push(std::move(job));
  }
  return id;
}

std::uint16_t FileWriter::add_channel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding,
                                      StringMap metadata, ChunkGroup group) {
  REHEARSE_ASSERT(schema <= definitions_.schemas().size(), "a channel's schema is added before it");
  if (!definitions_.has_room_for_a_channel()) {
    output_.fail(error(
        fmt::format("the channel {} is one too many: a file contains at most {}", topic, Definitions::most_channels)));
    return definitions_.channels().back().id;
  }
  if (options_.profile == "ros2") metadata.try_emplace("offered_qos_profiles");
  const std::uint16_t id = definitions_.add_channel(schema, topic, message_encoding, std::move(metadata));
  RawJob job;
  ByteWriter out(job.bytes);
  put_channel(out, definitions_.channel(id));
  output_.push(std::move(job));
  states_.push_back({find_or_add_group(group)});
  return id;
}

std::size_t FileWriter::find_or_add_group(ChunkGroup key) {
  if (options_.compression) key.compression = *options_.compression;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    if (groups_[i].key.id == key.id && groups_[i].key.compression == key.compression) return i;
  }
  groups_.push_back({key, {}});
  return groups_.size() - 1;
}

/// Appends the head of a message's record, for `size` bytes of data, to the open chunk of its channel's group.
FileWriter::Group& FileWriter::begin_message(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
                                             std::size_t size, std::optional<std::uint32_t> numbered) {
  REHEARSE_ASSERT(definitions_.has_channel(channel), "a message's channel is added before it");
  REHEARSE_ASSERT(!closed_, "nothing is written to a closed trace");
  if (log_time >= next_deadline_) finish_old_chunks(log_time);
  ChannelState& state = states_[index_of(channel)];
  Group& group = groups_[state.group];
  ChunkData& chunk = group.open;
  if (chunk.empty()) {
    chunk.records.reserve(options_.chunk_size + options_.chunk_size / 8);
    chunk.compression = group.key.compression;
    chunk.first_time = chunk.start_time = chunk.end_time = log_time;
    next_deadline_ = std::min(next_deadline_, deadline_of(chunk));
  }
  chunk.start_time = std::min(chunk.start_time, log_time);
  chunk.end_time = std::max(chunk.end_time, log_time);
  chunk.index.push_back({log_time, chunk.records.size(), channel});

  std::array<std::byte, record_head + message_head> head;
  const std::uint64_t length = message_head + size;
  const auto counted = static_cast<std::uint32_t>(state.count++);
  const std::uint32_t sequence = numbered.value_or(counted);
  head[0] = std::byte{op::message};
  std::memcpy(&head[1], &length, 8);
  std::memcpy(&head[9], &channel, 2);
  std::memcpy(&head[11], &sequence, 4);
  std::memcpy(&head[15], &log_time, 8);
  std::memcpy(&head[23], &publish_time, 8);
  chunk.records.insert(chunk.records.end(), head.begin(), head.end());

  ++message_count_;
  start_time_ = std::min(start_time_, log_time);
  end_time_ = std::max(end_time_, log_time);
  return group;
}

Result<void> FileWriter::write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, Bytes data,
                               std::optional<std::uint32_t> sequence) {
  Group& group = begin_message(channel, log_time, publish_time, data.size(), sequence);
  group.open.records.insert(group.open.records.end(), data.begin(), data.end());
  return end_message(group);
}

Result<void> FileWriter::write_later(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
                                     std::size_t held, std::vector<std::byte> raw, Compose compose) {
  Group& group = begin_message(channel, log_time, publish_time, 0);
  group.open.put_off.push_back({group.open.index.size() - 1, std::move(raw), compose});
  group.open.held += held;
  return end_message(group);
}

Result<void> FileWriter::end_message(Group& group) {
  if (group.open.size() >= options_.chunk_size) finish_chunk(group);
  if (output_.failed()) [[unlikely]]
    return output_.status();
  return {};
}

void FileWriter::finish_chunk(Group& group) {
  unwritten_deadline_ = std::min(unwritten_deadline_, deadline_of(group.open));
  next_deadline_ = std::min(next_deadline_, unwritten_deadline_);
  ChunkData next = output_.take_chunk();
  output_.push(std::exchange(group.open, std::move(next)));
}

Result<void> FileWriter::copy_chunk(const StoredChunk& stored) {
  REHEARSE_ASSERT(!closed_, "nothing is copied to a closed trace");
  const Chunk& chunk = stored.chunk;
  if (chunk.end_time >= next_deadline_) finish_old_chunks(chunk.end_time);
  for (const StoredChunk::Index& index : stored.indexes) {
    REHEARSE_ASSERT(definitions_.has_channel(index.channel), "a copied chunk's channels are added before it");
    states_[index_of(index.channel)].count += index.count;
    message_count_ += index.count;
    if (index.count == 0) continue;
    start_time_ = std::min(start_time_, chunk.start_time);
    end_time_ = std::max(end_time_, chunk.end_time);
  }
  output_.push(StoredJob{{stored.bytes.begin(), stored.bytes.end()}, chunk, stored.indexes});
  return output_.status();
}

/// Finishes the chunks whose first message is chunk_span or more before `now`, in the order of their groups. Waits
/// until all such chunks are written, so that a kill loses no more than that span.
void FileWriter::finish_old_chunks(std::uint64_t now) {
  next_deadline_ = no_time;
  for (Group& group : groups_) {
    if (group.open.empty()) continue;
    const std::uint64_t deadline = deadline_of(group.open);
    if (deadline <= now) {
      finish_chunk(group);
    } else {
      next_deadline_ = std::min(next_deadline_, deadline);
    }
  }
  if (unwritten_deadline_ <= now) {
    static_cast<void>(output_.drain());  // the next call of status() reports a failure
    unwritten_deadline_ = no_time;
  }
  next_deadline_ = std::min(next_deadline_, unwritten_deadline_);
}

Result<void> FileWriter::add_attachment(std::string_view name, std::string_view media_type, Bytes data,
                                        std::uint64_t log_time, std::uint64_t create_time) {
  REHEARSE_ASSERT(!closed_, "nothing is attached to a closed trace");
  RawJob job;
  job.kind = RawJob::Kind::attachment;
  job.attachment = {log_time, create_time, std::string(name), std::string(media_type), data, 0};
  ByteWriter out(job.bytes);
  put_attachment(out, job.attachment);
  job.data_size = data.size();
  job.attachment.data = {};
  output_.push(std::move(job));
  return output_.status();
}

Result<void> FileWriter::add_metadata(std::string_view name, const StringMap& values) {
  REHEARSE_ASSERT(!closed_, "nothing is added to a closed trace");
  RawJob job;
  job.kind = RawJob::Kind::metadata;
  job.metadata_name = name;
  ByteWriter out(job.bytes);
  put_metadata(out, name, values);
  output_.push(std::move(job));
  return output_.status();
}

Result<void> FileWriter::flush() {
  finish_old_chunks(no_time);
  return output_.drain();
}

Result<void> FileWriter::close() {
  if (closed_) return *closed_;
  finish_old_chunks(no_time);
  Statistics statistics;
  statistics.message_count = message_count_;
  statistics.schema_count = static_cast<std::uint16_t>(definitions_.schemas().size());
  statistics.channel_count = static_cast<std::uint32_t>(definitions_.channels().size());
  statistics.message_start_time = message_count_ == 0 ? 0 : start_time_;
  statistics.message_end_time = end_time_;
  for (const Channel& channel : definitions_.channels()) {
    const std::uint64_t count = states_[index_of(channel.id)].count;
    if (count > 0) statistics.channel_message_counts[channel.id] = count;
  }
  closed_ = output_.finish(definitions_.schemas(), definitions_.channels(), statistics);
  return *closed_;
}

Result<std::unique_ptr<Writer>> Writer::create(const std::filesystem::path& file, WriterOptions options) {
  auto sink = REHEARSE_TRY(Sink::open(file));
  return std::unique_ptr<Writer>(std::make_unique<FileWriter>(std::move(sink), file.string(), options));
}

}  // namespace rehearse::mcap
