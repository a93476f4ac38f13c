#include "record_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace rehearse::mcap {

RecordPass::RecordPass(const FileView& view, Bytes file, bool counts, Progress progress, std::uint64_t begin)
    : file_(file), memory_(view, file, std::move(progress)), counts_(counts) {
  go_on_at(begin);
}

bool RecordPass::next(Record& record) {
  pass(last_);
  memory_.pass(offset_);
  if (!RecordWalker(file_, offset_).next(record)) return false;
  last_ = bytes_of(record);
  return true;
}

void RecordPass::go_on_at(std::uint64_t offset) { pass(file_.subspan(offset_, offset - offset_)); }

void RecordPass::pass(Bytes bytes) {
  if (counts_) crc_ = crc32(bytes, crc_);
  offset_ += bytes.size();
  last_ = {};
}

void RecordPass::begin_section(bool counts) {
  pass(last_);
  counts_ = counts;
  crc_ = 0;
}

Bytes RecordPass::look_at_tail() {
  pass(last_);
  return file_.subspan(offset_, std::min<std::uint64_t>(magic.size() + 1, file_.size() - offset_));
}

CutPlace RecordPass::look_at_cut() const {
  const Bytes rest = file_.subspan(offset_);
  const bool ends_well = rest.size() >= magic.size() && begins_with_magic(rest.last(magic.size()));
  return {offset_, file_.size(), ends_well, !ends_well && is_all_zero(rest)};
}

Frame read_frame(RecordPass& pass, bool check_crcs, Contents& contents, DamageLog& damage,
                 const std::function<bool(const Record&)>& take) {
  Frame frame;
  std::optional<std::uint64_t> summary;  // offset of the summary
  Contents said;                         // contents of the summary; used, with its damage, if its CRC matches
  DamageLog said_damage(damage.file());
  bool says_channels = false;
  bool started = false;
  Record record;
  while (true) {
    if (!pass.next(record)) {
      if (!summary) frame.data_end = pass.offset();
      damage.add(describe_cut(pass.look_at_cut()));
      return frame;
    }
    if (!std::exchange(started, true) && record.opcode != op::header)
      damage.add("damaged: the first record isn't a Header");
    if (record.opcode == op::footer) break;
    if (summary) {
      says_channels = says_channels || record.opcode == op::channel;
      if (record.opcode == op::statistics) said.statistics = parse_statistics(record.body);
      said.learn(record, said_damage);
    } else if (record.opcode == op::data_end) {
      frame.data_end = record.offset;
      frame.data_crc = read_data_end(record, damage);
      if (pass.counts() && frame.data_crc && *frame.data_crc != pass.crc())
        damage.add("damaged: the CRC of the data section doesn't match");
      said = contents;
      summary = pass.offset();
      pass.begin_section(check_crcs);
    } else if (!take(record)) {
      return frame;
    }
  }
  if (!summary) frame.data_end = record.offset;
  const std::uint64_t start = summary.value_or(record.offset);
  if (const auto footer = read_footer(record, start, damage)) {
    const std::uint32_t crc = crc32(bytes_of(record).first(footer_covered), summary ? pass.crc() : 0);
    if (check_crcs && footer->summary_crc != 0 && footer->summary_crc != crc) {
      damage.add(fmt::format("damaged: the CRC of the summary at byte {} doesn't match", start));
    } else {
      damage.add(said_damage);
      contents.add(std::move(said));
      frame.summary_has_channels = says_channels;
    }
  }
  const Bytes tail = pass.look_at_tail();
  check_tail(tail, pass.offset(), damage);
  return frame;
}

bool Delivery::deliver(const Record& from) {
  const auto head = parse_message_head(from.body);
  if (head && !channels.has(head->channel)) return true;
  const Message read = contents.read_message(from, damage);
  return read.channel == nullptr || message(read);
}

bool Delivery::deliver_chunk(const Record& chunk) {
  const OpenedChunk opened = opener.open(chunk, buffer);
  if (!opened.ok()) {
    if (opened.fault != OpenedChunk::Fault::too_short) damage.add(opener.describe(opened));
    return true;
  }
  RecordWalker inside(opened.records);
  Record inner;
  inner.chunk = chunk.offset;
  while (inside.next(inner)) {
    if (inner.opcode != op::message) {
      contents.learn(inner, damage);
    } else if (!deliver(inner)) {
      return false;
    }
  }
  if (!inside.at_end())
    damage.add(fmt::format("damaged: the records of the chunk at byte {} aren't whole", chunk.offset));
  return true;
}

}  // namespace rehearse::mcap
