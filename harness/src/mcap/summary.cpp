#include "summary.h"

#include "codec.h"

namespace rehearse::mcap {

SummaryComposer::SummaryComposer(std::uint64_t data_size, std::uint32_t data_crc, const FileForm& form)
    : data_size_(data_size), form_(form) {
  ByteWriter out(bytes_);
  out.begin_record(op::data_end);
  out.put(data_crc);
  out.end_record();
  summary_at_ = bytes_.size();
}

void SummaryComposer::add_group(std::uint8_t opcode, Bytes records) {
  if (records.empty()) return;
  ByteWriter offset(offsets_);
  offset.begin_record(op::summary_offset);
  offset.put(opcode);
  offset.put(data_size_ + bytes_.size());
  offset.put(static_cast<std::uint64_t>(records.size()));
  offset.end_record();
  ByteWriter(bytes_).put_bytes(records);
}

Bytes SummaryComposer::finish() {
  ByteWriter out(bytes_);
  const bool empty = bytes_.size() == summary_at_;
  const std::uint64_t offsets_start = data_size_ + bytes_.size();
  const bool has_offsets = form_.summary_offsets && !empty;
  if (has_offsets) out.put_bytes(offsets_);
  out.begin_record(op::footer);
  out.put(empty ? 0 : data_size_ + summary_at_);
  out.put(has_offsets ? offsets_start : 0);
  out.put(std::uint32_t{0});
  out.end_record();
  const std::size_t crc_at = bytes_.size() - 4;
  if (form_.summary_crc) out.patch(crc_at, crc32(Bytes(bytes_).subspan(summary_at_, crc_at - summary_at_)));
  out.put_bytes(magic);
  return bytes_;
}

void put_metadata_index(ByteWriter& out, std::uint64_t offset, std::uint64_t length, std::string_view name) {
  out.begin_record(op::metadata_index);
  out.put(offset);
  out.put(length);
  out.put_string(name);
  out.end_record();
}

}  // namespace rehearse::mcap
