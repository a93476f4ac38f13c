#include "chunk_indexes.h"

#include <algorithm>

namespace rehearse::mcap {
namespace {

void put_chunk_index(ByteWriter& out, const ChunkIndexEntry& entry) {
  constexpr std::size_t channel_and_offset = 2 + 8;
  out.begin_record(op::chunk_index);
  out.put(entry.start_time);
  out.put(entry.end_time);
  out.put(entry.offset);
  out.put(entry.length);
  out.put(static_cast<std::uint32_t>(entry.message_indexes.size() * channel_and_offset));
  for (const auto& [channel, offset] : entry.message_indexes) {
    out.put(channel);
    out.put(offset);
  }
  out.put(entry.message_index_length);
  out.put_string(entry.compression);
  out.put(entry.compressed_size);
  out.put(entry.uncompressed_size);
  out.end_record();
}

/// Goes over the chunks of a file that we wrote ourselves, and over the message indexes behind each.
class ReadBack {
 public:
  ReadBack(Sink& file, std::uint64_t data_size, const std::function<void(Bytes)>& out)
      : file_(file), data_size_(data_size), out_(out) {}

  Result<void> run();

 private:
  static constexpr std::size_t piece = 1 << 16;

  bool begin_chunk(std::uint64_t offset, std::uint64_t length, Bytes body);
  void end_chunk();
  void hand_out();

  Sink& file_;
  std::uint64_t data_size_;
  const std::function<void(Bytes)>& out_;
  std::optional<ChunkIndexEntry> chunk_;
  std::vector<std::byte> records_;
};

Result<void> ReadBack::run() {
  const Diagnostic changed = error("can't finish the trace: somebody else has changed it meanwhile");
  // As much of a record as says all that is asked: a chunk's head with the longest name of a compression.
  std::array<std::byte, record_head + 8 + 8 + 8 + 4 + (4 + 4) + 8> start;
  for (std::uint64_t offset = magic.size(); offset < data_size_;) {
    const std::uint64_t wanted = std::min<std::uint64_t>(start.size(), data_size_ - offset);
    const auto read = file_.read_back(offset, std::span(start).first(wanted));
    if (!read) return read.errors();
    ByteReader in(Bytes(start).first(wanted));
    const auto opcode = in.get<std::uint8_t>();
    const auto length = in.get<std::uint64_t>();
    if (!in.ok() || length > data_size_ - offset - record_head) return changed;
    if (opcode == op::chunk) {
      end_chunk();
      if (!begin_chunk(offset, record_head + length, in.rest())) return changed;
    } else if (opcode == op::message_index && chunk_) {
      chunk_->message_indexes.emplace_back(in.get<std::uint16_t>(), offset);
      chunk_->message_index_length += record_head + length;
    }
    offset += record_head + length;
  }
  end_chunk();
  hand_out();
  return {};
}

bool ReadBack::begin_chunk(std::uint64_t offset, std::uint64_t length, Bytes body) {
  ByteReader in(body);
  ChunkIndexEntry& chunk = chunk_.emplace();
  chunk.offset = offset;
  chunk.length = length;
  chunk.start_time = in.get<std::uint64_t>();
  chunk.end_time = in.get<std::uint64_t>();
  chunk.uncompressed_size = in.get<std::uint64_t>();
  in.get<std::uint32_t>();
  chunk.compression = in.get_string();
  chunk.compressed_size = in.get<std::uint64_t>();
  return in.ok();
}

void ReadBack::end_chunk() {
  if (!chunk_) return;
  ByteWriter out(records_);
  put_chunk_index(out, *chunk_);
  chunk_.reset();
  if (records_.size() >= piece) hand_out();
}

void ReadBack::hand_out() {
  out_(records_);
  records_.clear();
}

}  // namespace

void ChunkIndexes::add(const ChunkIndexEntry& entry) {
  if (forgotten_) return;
  ByteWriter out(records_);
  put_chunk_index(out, entry);
  if (!can_forget_ || records_.size() <= most_) return;
  forgotten_ = true;
  records_ = {};
}

Result<void> ChunkIndexes::write(Sink& file, std::uint64_t data_size, const std::function<void(Bytes)>& out) {
  if (forgotten_) return ReadBack(file, data_size, out).run();
  out(records_);
  return {};
}

}  // namespace rehearse::mcap
