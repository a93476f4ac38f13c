#include "survey.h"

#include <fmt/format.h>
#include <rehearse/text.h>

#include <algorithm>

#include "frame.h"
#include "record_layout.h"

namespace rehearse::mcap {

namespace {

constexpr std::size_t listed_losses = 1000;
constexpr std::uint64_t progress_step = 16 << 20;  // [bytes]

std::uint64_t end_of(const Record& record) { return record.offset + record_head + record.body.size(); }

/// Definitions and attachments have names, or at least a length for an empty one.
bool is_nameless(const Record& record) {
  const std::size_t name_at = record.opcode == op::schema       ? 2
                              : record.opcode == op::channel    ? 4
                              : record.opcode == op::attachment ? 16
                              : record.opcode == op::metadata   ? 0
                                                                : record.body.size();
  if (name_at >= record.body.size()) return false;
  return ByteReader(record.body.subspan(name_at)).get<std::uint32_t>() == 0;
}

/// What is left over isn't fields that a later version may have appended, but fields that have lost their lengths.
bool is_overwritten(const Record& record, const LayoutCheck& layout) {
  return layout.extra > 0 && (is_nameless(record) || is_all_zero(record.body.last(layout.extra)));
}

}  // namespace

Survey::Survey(const FileView& file, const RecoverOptions& options, Recovery& recovery)
    : file_(file.bytes()),
      passed_(file, file_),
      options_(options),
      recovery_(recovery),
      resync_(file_, options.max_chunk_size) {
  recovery_.size = file_.size();
  read_summary();
  walk();
  if (private_records_ > 0)
    recovery_.remarks.push_back(fmt::format("{} private records aren't kept", private_records_));
}

/// If the file ends as it should, and the CRC of the summary matches: what it defines is right.
void Survey::read_summary() {
  if (file_.size() < footer_size + 2 * magic.size()) return;
  const std::uint64_t footer_at = file_.size() - magic.size() - footer_size;
  RecordWalker walker(file_, footer_at);
  Record record;
  if (!begins_with_magic(file_.last(magic.size())) || !walker.next(record) || record.opcode != op::footer) return;
  const auto footer = parse_footer(record.body);
  if (!footer || footer->summary_crc == 0 || footer->summary_start == 0 || footer->summary_start > footer_at) return;
  const Bytes covered = file_.subspan(footer->summary_start, footer_at + footer_covered - footer->summary_start);
  if (crc32(covered) != footer->summary_crc) return;
  RecordWalker summary(file_.first(footer_at), footer->summary_start);
  while (summary.next(record)) {
    if (record.opcode == op::schema) static_cast<void>(learn_schema(record));
    if (record.opcode == op::channel) static_cast<void>(learn_channel(record));
    if (record.opcode == op::statistics) statistics = parse_statistics(record.body);
  }
  summary_decides_ = true;
}

void Survey::walk() {
  std::uint64_t offset = 0;
  if (begins_with_magic(file_)) {
    offset = magic.size();
    crc_ = crc32(file_.first(offset));
  } else {
    offset = resync_.find(0).value_or(file_.size());
    lose(0, offset, "what stands there is no beginning of an MCAP file");
  }
  while (offset < file_.size()) {
    passed_.pass(offset);
    if (options_.progress && offset >= next_progress_) {
      options_.progress(offset / 2, file_.size());
      next_progress_ = offset + progress_step;
    }
    RecordWalker walker(file_, offset);
    Record record;
    if (walker.next(record)) {
      if (record.opcode == op::footer && parse_footer(record.body)) {
        const Bytes tail = file_.subspan(end_of(record));
        if (begins_with_magic(tail)) {
          if (tail.size() > magic.size())
            lose(end_of(record) + magic.size(), file_.size(), "what stands behind the file's end");
          return;
        }
      }
      if (pass_record(record)) {
        offset = end_of(record);
        continue;
      }
      if (resync_.is_plausible(end_of(record))) {
        offset = end_of(record);
        continue;
      }
      recovery_.lost.pop_back();  // its length isn't to be believed either: it may hide what is whole
      recovery_.lost_bytes -= end_of(record) - record.offset;
      if (!runs.empty() && !runs.back().trusted && runs.back().begin == record.offset) runs.pop_back();
    }
    const std::uint64_t next = resync_.find(offset + 1).value_or(file_.size());
    if (options_.trust_damaged && next == file_.size() && is_cut_chunk(offset)) save(offset, next, false);
    lose(offset, next, next == file_.size() ? "no record that is whole, up to the end" : "no record");
    offset = next;
    chunk_was_lost_ = false;
  }
  recovery_.remarks.push_back("the file had no end, and so no summary");
}

/// The file ends in the middle of a chunk that begins there.
bool Survey::is_cut_chunk(std::uint64_t offset) const {
  const Bytes left = file_.subspan(offset);
  if (left.size() <= record_head || left[0] != std::byte{op::chunk}) return false;
  const auto head = parse_cut_chunk(left.subspan(record_head));
  return head && head->start_time <= head->end_time && is_utf8(head->compression);
}

/// False if it isn't saved; then that is told.
bool Survey::pass_record(const Record& record) {
  if (!in_summary_ && record.opcode != op::data_end)
    crc_ = crc32(file_.subspan(record.offset, end_of(record) - record.offset), crc_);
  if (record.opcode == op::message_index && chunk_was_lost_) count_lost(record);
  if (record.opcode != op::message_index) chunk_was_lost_ = false;
  const Fault fault = judge(record);
  if (fault.empty()) {
    save(record.offset, end_of(record));
    return true;
  }
  if (record.opcode == op::chunk && options_.trust_damaged && parse_chunk(record.body))
    save(record.offset, end_of(record), false);
  chunk_was_lost_ = record.opcode == op::chunk;
  lose(record.offset, end_of(record), fault);
  return false;
}

Survey::Fault Survey::judge(const Record& record) {
  if (!is_known(record.opcode)) {
    if (!is_private(record.opcode)) return fmt::format("a {}", name_of(record.opcode));
    ++private_records_;
    return {};
  }
  const LayoutCheck layout = check_layout(record.opcode, record.body);
  if (!layout.whole) return fmt::format("a {} that is too short for what it says", name_of(record.opcode));
  if (is_overwritten(record, layout)) return fmt::format("a {} that is partly overwritten", name_of(record.opcode));
  switch (record.opcode) {
    case op::header: {
      if (!layout.problems.empty() || !profile.empty() || !library.empty()) return {};
      ByteReader in(record.body);
      profile = in.get_string();
      library = in.get_string();
      return {};
    }
    case op::schema: return learn_schema(record);
    case op::channel: return learn_channel(record);
    case op::message: resync_.expect_loose_messages(); return {};
    case op::chunk: return judge_chunk(record);
    case op::attachment: return judge_attachment(record);
    case op::data_end: finish_data(record); return {};
    default: return {};
  }
}

void Survey::finish_data(const Record& data_end) {
  const auto stated = ByteReader(data_end.body).get<std::uint32_t>();
  in_summary_ = true;
  if (stated != 0 && stated != crc_ && recovery_.lost.empty())
    recovery_.remarks.push_back(
        "the CRC of the data section doesn't match, and those of its parts do: something between them isn't what was "
        "written");
}

Survey::Fault Survey::learn_schema(const Record& record) {
  const auto schema = parse_schema(record.body);
  if (!schema) return "a Schema that is too short for what it says";
  if (schema->id == 0) return "a Schema with the id 0";
  const auto [known, added] = schemas.try_emplace(schema->id, *schema);
  if (known->second == *schema) return {};
  return fmt::format("a Schema {} that is defined otherwise {}", schema->id,
                     summary_decides_ ? "in the summary" : "before");
}

Survey::Fault Survey::learn_channel(const Record& record) {
  const auto channel = parse_channel(record.body);
  if (!channel) return "a Channel that is too short for what it says";
  const auto [known, added] = channels.try_emplace(channel->id, *channel);
  if (known->second == *channel) return {};
  return fmt::format("a Channel {} that is defined otherwise {}", channel->id,
                     summary_decides_ ? "in the summary" : "before");
}

Survey::Fault Survey::judge_attachment(const Record& record) const {
  const auto attachment = parse_attachment(record.body);
  if (!attachment) return "an Attachment that is too short for what it says";
  if (attachment->crc == 0 || attachment->crc == crc32(attachment->covered)) return {};
  return fmt::format("an Attachment, {}, whose CRC doesn't match", in_quotes(attachment->attachment.name));
}

Survey::Fault Survey::judge_chunk(const Record& record) {
  const auto head = parse_chunk(record.body);
  if (!head) return "a Chunk that is too short for what it says";
  if (head->uncompressed_size > options_.max_chunk_size)
    return fmt::format("a Chunk that says it holds {} bytes decompressed", head->uncompressed_size);
  const auto records = decompressor_.decompress(head->compression, head->records, head->uncompressed_size, buffer_);
  if (!records) return "a Chunk that can't be decompressed: " + records.errors().front().message;
  if (head->uncompressed_crc != 0 && head->uncompressed_crc != crc32(*records))
    return "a Chunk whose CRC doesn't match";
  RecordWalker inside(*records);
  Record inner;
  while (inside.next(inner)) {
    if (is_known(inner.opcode) && !check_layout(inner.opcode, inner.body).whole) break;
  }
  if (!inside.at_end() && head->uncompressed_crc == 0) return "a Chunk without a CRC whose records aren't whole";
  pass_chunk_records(*records, head->compression);
  return {};
}

void Survey::pass_chunk_records(Bytes records, std::string_view compression) {
  std::vector<bool> seen(0x10000);
  std::vector<std::uint16_t> in_chunk;
  RecordWalker inside(records);
  Record inner;
  while (inside.next(inner)) {
    if (inner.opcode == op::schema) static_cast<void>(learn_schema(inner));
    if (inner.opcode == op::channel) static_cast<void>(learn_channel(inner));
    const auto head = inner.opcode == op::message ? parse_message_head(inner.body) : std::nullopt;
    if (!head || seen[head->channel]) continue;
    seen[head->channel] = true;
    in_chunk.push_back(head->channel);
  }
  groups.add_chunk(compression, in_chunk);
}

/// Message indexes behind a lost chunk say what was in it.
void Survey::count_lost(const Record& message_index) {
  if (!check_layout(message_index.opcode, message_index.body).exact()) return;
  ByteReader in(message_index.body);
  const auto channel = in.get<std::uint16_t>();
  recovery_.channels[channel].lost += in.get<std::uint32_t>() / 16;
}

void Survey::save(std::uint64_t begin, std::uint64_t end, bool trusted) {
  if (in_summary_) return;
  if (trusted && !runs.empty() && runs.back().trusted && runs.back().end == begin)
    runs.back().end = end;
  else
    runs.push_back({begin, end, trusted});
}

void Survey::lose(std::uint64_t begin, std::uint64_t end, std::string what) {
  if (begin == end) return;
  recovery_.lost_bytes += end - begin;
  if (recovery_.lost.size() == listed_losses) recovery_.lost.pop_back();
  recovery_.lost.push_back({begin, end, std::move(what)});
}

}  // namespace rehearse::mcap
