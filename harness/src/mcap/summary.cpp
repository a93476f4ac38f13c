#include "summary.h"

#include "codec.h"

namespace rehearse::mcap {

SummaryComposer::SummaryComposer(std::uint64_t data_size, std::uint32_t data_crc, const FileForm& form, Write write)
    : form_(form), write_(std::move(write)), offset_(data_size) {
  std::vector<std::byte> data_end;
  ByteWriter out(data_end);
  out.begin_record(op::data_end);
  out.put(data_crc);
  out.end_record();
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
  ByteWriter offset(offsets_);
  offset.begin_record(op::summary_offset);
  offset.put(opcode);
  offset.put(begin);
  offset.put(offset_ - begin);
  offset.end_record();
}

void SummaryComposer::finish() {
  const bool empty = offset_ == start_;
  const std::uint64_t offsets_start = offset_;
  const bool has_offsets = form_.summary_offsets && !empty;
  if (has_offsets) put(offsets_);
  std::vector<std::byte> footer;
  ByteWriter out(footer);
  out.begin_record(op::footer);
  out.put(empty ? 0 : start_);
  out.put(has_offsets ? offsets_start : 0);
  out.put(std::uint32_t{0});
  out.end_record();
  const std::size_t crc_at = footer.size() - 4;
  if (form_.summary_crc) out.patch(crc_at, crc32(Bytes(footer).first(crc_at), crc_));
  out.put_bytes(magic);
  write_(footer);
}

void put_metadata_index(ByteWriter& out, std::uint64_t offset, std::uint64_t length, std::string_view name) {
  out.begin_record(op::metadata_index);
  out.put(offset);
  out.put(length);
  out.put_string(name);
  out.end_record();
}

}  // namespace rehearse::mcap
