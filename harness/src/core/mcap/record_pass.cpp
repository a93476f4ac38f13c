#include "record_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace rehearse::mcap {

namespace {
constexpr std::size_t smallest_window = std::size_t{1} << 17;  // [bytes]; twice the size of a pipe
}

bool RecordPass::next(Record& record) {
  pass(last_);
  if (!find(record)) return false;
  last_ = bytes_of(record);
  return true;
}

void RecordPass::pass(Bytes bytes) {
  if (counts_) crc_ = crc32(bytes, crc_);
  offset_ += bytes.size();
  last_ = {};
  move_on(bytes.size());
}

void RecordPass::begin_section(bool counts) {
  pass(last_);
  counts_ = counts;
  crc_ = 0;
}

Bytes RecordPass::look_at_tail() {
  pass(last_);
  return look(magic.size() + 1);
}

MappedPass::MappedPass(const FileView& view, Bytes file, bool counts, Progress progress, std::uint64_t begin)
    : RecordPass(0, counts), file_(file), memory_(view, file, std::move(progress)) {
  go_on_at(begin);
}

void MappedPass::go_on_at(std::uint64_t offset) { pass(file_.subspan(passed(), offset - passed())); }

bool MappedPass::find(Record& record) {
  memory_.pass(passed());
  return RecordWalker(file_, passed()).next(record);
}

Bytes MappedPass::look(std::uint64_t count) {
  return file_.subspan(passed(), std::min<std::uint64_t>(count, file_.size() - passed()));
}

CutPlace MappedPass::look_at_cut() {
  const Bytes rest = file_.subspan(passed());
  const bool ends_well = rest.size() >= magic.size() && begins_with_magic(rest.last(magic.size()));
  return {passed(), file_.size(), ends_well, !ends_well && is_all_zero(rest)};
}

StreamPass::StreamPass(ReadBytes source, std::uint64_t most_held, bool counts, DamageLog& damage)
    : RecordPass(0, counts), source_(std::move(source)), most_held_(most_held), damage_(damage) {}

Bytes StreamPass::begin() {
  const Bytes start = look(magic.size());
  pass(start);
  return start;
}

/// Reads until `count` bytes are buffered. The memory grows with the received bytes, never with `count` alone.
Bytes StreamPass::look(std::uint64_t count) {
  while (end_ - begin_ < count && !ended_) {
    if (end_ == buffer_.capacity()) make_room();
    auto came = source_({buffer_.data() + end_, buffer_.capacity() - end_});
    if (!came) failure_ = came.errors();
    ended_ = !came || *came == 0;
    if (!ended_) end_ += *came;
  }
  return {buffer_.data() + begin_, std::min<std::uint64_t>(count, end_ - begin_)};
}

void StreamPass::move_on(std::uint64_t count) {
  begin_ += count;
  if (begin_ == end_) begin_ = end_ = 0;
}

/// Moves the buffered bytes to the front if that frees half of the buffer; otherwise doubles the buffer.
void StreamPass::make_room() {
  const std::size_t held = end_ - begin_;
  if (buffer_.capacity() > 0 && held <= buffer_.capacity() / 2) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, held);
  } else {
    RawBuffer larger;
    larger.reserve(std::max(smallest_window, 2 * buffer_.capacity()));
    if (held > 0) std::memcpy(larger.data(), buffer_.data() + begin_, held);
    std::swap(buffer_, larger);
  }
  begin_ = 0;
  end_ = held;
}

bool StreamPass::find(Record& record) {
  constexpr std::uint64_t chunk_frame = 4096;  // more than the size of a chunk's fields except its records
  while (true) {
    const Bytes head = look(record_head);
    if (head.size() < record_head) return false;
    ByteReader in(head);
    const auto opcode = in.get<std::uint8_t>();
    const auto length = in.get<std::uint64_t>();
    if (opcode == 0) return false;
    if (length <= most_held_ + chunk_frame) {
      const Bytes whole = look(record_head + length);
      if (whole.size() < record_head + length) return false;
      record = {opcode, whole.subspan(record_head), passed(), {}};
      return true;
    }
    if (!leave_out(length)) return false;
  }
}

/// Skips a record that is too large for the buffer. False: the record is incomplete.
bool StreamPass::leave_out(std::uint64_t length) {
  const std::uint64_t offset = passed();
  cut_record_ = offset;
  std::uint64_t left = record_head;
  left += std::min(length, ~left);
  while (left > 0) {
    const Bytes piece = look(1).empty() ? Bytes() : look(std::min<std::uint64_t>(left, end_ - begin_));
    if (piece.empty()) return false;
    remember(piece);
    left -= piece.size();
    pass(piece);
  }
  cut_record_.reset();
  damage_.add(fmt::format("the record at byte {} was left out: it has {} bytes, more than the limit of {} for a stream",
                          offset, length, most_held_));
  return true;
}

void StreamPass::remember(Bytes piece) {
  piece = piece.last(std::min(piece.size(), magic.size()));
  last_bytes_.insert(last_bytes_.end(), piece.begin(), piece.end());
  if (last_bytes_.size() > magic.size()) last_bytes_.erase(last_bytes_.begin(), last_bytes_.end() - magic.size());
}

/// Reads the remaining bytes.
CutPlace StreamPass::look_at_cut() {
  CutPlace cut;
  cut.record = cut_record_.value_or(passed());
  cut.zeros_only = !cut_record_;
  if (!cut_record_) last_bytes_.clear();
  while (!look(1).empty()) {
    const Bytes piece = look(end_ - begin_);
    cut.zeros_only = cut.zeros_only && is_all_zero(piece);
    remember(piece);
    pass(piece);
  }
  cut.size = passed();
  cut.ends_with_magic = begins_with_magic(last_bytes_);
  return cut;
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
