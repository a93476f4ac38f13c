#include "resync.h"

#include <algorithm>

#include "record_layout.h"

namespace rehearse::mcap {

namespace {
constexpr int records_in_a_row = 3;

bool ends_here(Bytes file, std::uint64_t offset) {
  return file.size() - offset == magic.size() && std::equal(magic.begin(), magic.end(), file.end() - magic.size());
}
}  // namespace

Resync::Resync(Bytes file, std::uint64_t max_chunk_size)
    : file_(file),
      max_chunk_size_(max_chunk_size),
      budget_(8 * file.size() + (std::uint64_t{64} << 20)),
      opener_({.max_chunk_size = max_chunk_size}) {}

/// The record at that offset, if its length fits into the file.
std::optional<Record> Resync::head_at(std::uint64_t offset) const {
  RecordWalker walker(file_, offset);
  Record record;
  if (!walker.next(record)) return std::nullopt;
  return record;
}

bool Resync::is_plausible(std::uint64_t offset) {
  if (offset == file_.size() || ends_here(file_, offset)) return true;
  const auto record = head_at(offset);
  if (!record) return false;
  if (!is_known(record->opcode)) return is_private(record->opcode) && leads_on(offset, records_in_a_row);
  return check_layout(record->opcode, record->body).whole;
}

/// True if `records` records in a row have fields of exactly their lengths, or the file ends before that.
bool Resync::leads_on(std::uint64_t offset, int records) {
  std::uint64_t cost = 0;
  for (; records > 0; --records) {
    if (ends_here(file_, offset)) return true;
    const auto record = head_at(offset);
    if (!record) break;
    if (record->opcode != op::message) cost += record->body.size();
    if (cost > budget_) break;
    if (is_known(record->opcode) ? !check_layout(record->opcode, record->body).exact() : !is_private(record->opcode))
      break;
    offset += record_head + record->body.size();
  }
  if (records > 0) budget_ -= std::min(budget_, cost);
  return records == 0;
}

bool Resync::is_believed_chunk(const Record& chunk) {
  const auto head = parse_chunk(chunk.body);
  if (!head || head->uncompressed_size > max_chunk_size_ || head->start_time > head->end_time) return false;
  if (head->compression != "" && head->compression != "zstd" && head->compression != "lz4") return false;
  const std::uint64_t cost = head->records.size() + head->uncompressed_size;
  if (cost > budget_) return false;
  const OpenedChunk opened = opener_.open(chunk, buffer_);
  if (opened.ok() && head->uncompressed_crc != 0) return true;
  budget_ -= cost;
  return opened.ok() && !opened.records.empty() &&
         has_layout(opened.records, [](const LayoutCheck& check) { return check.exact(); });
}

bool Resync::is_believed_attachment(Bytes body) {
  const auto attachment = parse_attachment(body);
  if (!attachment || attachment->crc == 0 || body.size() > budget_) return false;
  if (crc32(attachment->covered) == attachment->crc) return true;
  budget_ -= body.size();
  return false;
}

bool Resync::is_believed(std::uint64_t offset) {
  const auto record = head_at(offset);
  if (!record || !is_known(record->opcode)) return false;
  if (record->opcode == op::chunk) return is_believed_chunk(*record);
  if (record->opcode == op::attachment && is_believed_attachment(record->body)) return true;
  if (record->opcode == op::message && !loose_messages_) return false;
  return leads_on(offset, records_in_a_row);
}

std::optional<std::uint64_t> Resync::find(std::uint64_t begin) {
  for (std::uint64_t offset = begin; offset + record_head <= file_.size(); ++offset) {
    // most bytes are excluded by their value and the high bytes of the length after them
    if (!is_known(std::to_integer<std::uint8_t>(file_[offset])) || file_[offset + 8] != std::byte{0}) continue;
    if (is_believed(offset)) return offset;
  }
  return std::nullopt;
}

}  // namespace rehearse::mcap
