#include "summary.h"

#include <array>

#include "codec.h"

namespace rehearse::mcap {

SummaryComposer::SummaryComposer(std::uint64_t data_size, std::uint32_t data_crc, Write write)
    : write_(std::move(write)), offset_(data_size) {
  std::vector<std::byte> data_end;
  ByteWriter(data_end).put_record(op::data_end, data_crc);
  put(data_end);
  start_ = offset_;
  crc_ = 0;
}

void SummaryComposer::put(Bytes bytes) {
  crc_ = crc32(bytes, crc_);
  offset_ += bytes.size();
  write_(bytes);
}

void SummaryComposer::add_group(std::uint8_t opcode, Bytes records) {
  add_group(opcode, [&](const Write& write) { write(records); });
}

void SummaryComposer::add_group(std::uint8_t opcode, const std::function<void(const Write&)>& put_all) {
  const std::uint64_t begin = offset_;
  put_all([this](Bytes records) { put(records); });
  if (offset_ == begin) return;
  ByteWriter(offsets_).put_record(op::summary_offset, opcode, begin, offset_ - begin);
}

void SummaryComposer::finish() {
  const bool empty = offset_ == start_;
  const std::uint64_t offsets_start = offset_;
  put(offsets_);
  std::vector<std::byte> footer;
  ByteWriter out(footer);
  out.put_record(op::footer, empty ? 0 : start_, empty ? 0 : offsets_start, std::uint32_t{0});
  const std::size_t crc_at = footer.size() - 4;
  out.patch(crc_at, crc32(Bytes(footer).first(crc_at), crc_));
  out.put_bytes(magic);
  write_(footer);
}

namespace {

/// Reads back the chunks of a file of this Writer, and the message indexes after each.
class ReadBack {
 public:
  ReadBack(Sink& file, std::uint64_t data_size, const std::function<void(Bytes)>& out)
      : file_(file), data_size_(data_size), out_(out) {}

  Result<void> run();

 private:
  static constexpr std::size_t piece = 1 << 16;

  bool begin_chunk(const Record& chunk, std::uint64_t length);
  void end_chunk();
  void hand_out();

  Sink& file_;
  std::uint64_t data_size_;
  const std::function<void(Bytes)>& out_;
  std::optional<ChunkIndex> chunk_;
  std::vector<std::byte> places_;  // places of its message indexes
  std::vector<std::byte> records_;
};

Result<void> ReadBack::run() {
  const Diagnostic changed = error("can't finish the trace: another program has changed it meanwhile");
  // The front of a record with all necessary fields: a chunk's head with the longest name of a compression.
  std::array<std::byte, record_head + 8 + 8 + 8 + 4 + (4 + 4) + 8> start;
  for (std::uint64_t offset = magic.size(); offset < data_size_;) {
    const std::uint64_t wanted = std::min<std::uint64_t>(start.size(), data_size_ - offset);
    REHEARSE_TRY(file_.read_back(offset, std::span(start).first(wanted)));
    ByteReader in(Bytes(start).first(wanted));
    const auto opcode = in.get<std::uint8_t>();
    const auto length = in.get<std::uint64_t>();
    if (!in.ok() || length > data_size_ - offset - record_head) return changed;
    if (opcode == op::chunk) {
      end_chunk();
      if (!begin_chunk({opcode, in.rest(), offset, {}}, record_head + length)) return changed;
    } else if (opcode == op::message_index && chunk_) {
      ByteWriter places(places_);
      places.put(in.get<std::uint16_t>());
      places.put(offset);
      chunk_->indexes_length += record_head + length;
    }
    offset += record_head + length;
  }
  end_chunk();
  hand_out();
  return {};
}

/// `chunk` has the front of its body only.
bool ReadBack::begin_chunk(const Record& chunk, std::uint64_t length) {
  std::uint64_t stored_size = 0;
  const auto head = parse_chunk_front(chunk.body, stored_size);
  if (!head) return false;
  chunk_ = ChunkIndex{{chunk.offset, head->start_time, head->end_time, std::string(head->compression), stored_size,
                       head->uncompressed_size},
                      length,
                      0,
                      {}};
  places_.clear();
  return true;
}

void ReadBack::end_chunk() {
  if (!chunk_) return;
  ByteWriter out(records_);
  chunk_->places = places_;
  put_chunk_index(out, *chunk_);
  chunk_.reset();
  if (records_.size() >= piece) hand_out();
}

void ReadBack::hand_out() {
  out_(records_);
  records_.clear();
}

}  // namespace

void ChunkIndexes::add(const ChunkIndex& index) {
  if (forgotten_) return;
  ByteWriter out(records_);
  put_chunk_index(out, index);
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
