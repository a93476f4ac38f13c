#include "survey.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/text.h"
#include "record_layout.h"

namespace rehearse::mcap {

namespace {

constexpr std::size_t listed_losses = 1000;

/// Reports the first half of the progress.
Progress first_half(const Progress& progress) {
  if (!progress) return {};
  return [progress](std::uint64_t done, std::uint64_t all) { progress(done / 2, all); };
}

/// True if a definition or attachment has no name. Intact ones have a name, or at least a length for an empty one.
bool is_nameless(const Record& record) {
  const std::size_t name_at = record.opcode == op::schema       ? 2
                              : record.opcode == op::channel    ? 4
                              : record.opcode == op::attachment ? 16
                              : record.opcode == op::metadata   ? 0
                                                                : record.body.size();
  if (name_at >= record.body.size()) return false;
  return ByteReader(record.body.subspan(name_at)).get<std::uint32_t>() == 0;
}

/// True if the remaining bytes aren't fields of a later version, but fields whose lengths were overwritten.
bool is_overwritten(const Record& record, const LayoutCheck& layout) {
  return layout.extra > 0 && (is_nameless(record) || is_all_zero(record.body.last(layout.extra)));
}

}  // namespace

Survey::Survey(const FileView& file, const RecoverOptions& options, Recovery& recovery)
    : file_(file.bytes()),
      pass_(file, file_, true, first_half(options.progress), 0),
      options_(options),
      recovery_(recovery),
      resync_(file_, options.max_chunk_size),
      opener_({.max_chunk_size = options.max_chunk_size}) {
  recovery_.size = file_.size();
  read_summary();
  walk();
  if (private_records_ > 0)
    recovery_.remarks.push_back(fmt::format("{} private records aren't kept", private_records_));
}

/// Reads the definitions of the summary, if the file has a regular end and the CRC of the summary matches.
void Survey::read_summary() {
  std::uint64_t footer_at = 0;
  const auto footer = find_footer(file_, footer_at);
  if (!footer || footer->summary_crc == 0 || footer->summary_start == 0 || footer->summary_start > footer_at) return;
  const Bytes covered = file_.subspan(footer->summary_start, footer_at + footer_covered - footer->summary_start);
  if (crc32(covered) != footer->summary_crc) return;
  RecordWalker summary(file_.first(footer_at), footer->summary_start);
  Record record;
  while (summary.next(record)) {
    static_cast<void>(learn(record));
    if (record.opcode == op::statistics) contents.statistics = parse_statistics(record.body);
  }
  summary_decides_ = true;
}

void Survey::walk() {
  if (begins_with_magic(file_)) {
    pass_.go_on_at(magic.size());
  } else {
    const std::uint64_t first = resync_.find(0).value_or(file_.size());
    lose(0, first, "the bytes there aren't the beginning of an MCAP file");
    pass_.go_on_at(first);
  }
  Record record;
  while (pass_.offset() < file_.size()) {
    const std::uint64_t offset = pass_.offset();
    if (pass_.next(record)) {
      if (ends_file(record)) return;
      if (pass_record(record) || resync_.is_plausible(end_of(record))) continue;
      recovery_.lost.pop_back();  // its length may be wrong, too, and cover undamaged records
      recovery_.lost_bytes -= bytes_of(record).size();
      if (!runs.empty() && !runs.back().trusted && runs.back().begin == record.offset) runs.pop_back();
    }
    const std::uint64_t next = resync_.find(offset + 1).value_or(file_.size());
    if (options_.trust_damaged && next == file_.size() && is_cut_chunk(offset)) save(offset, next, false);
    lose(offset, next, next == file_.size() ? "no record that is whole, up to the end" : "no record");
    pass_.go_on_at(next);
    chunk_was_lost_ = false;
  }
  recovery_.remarks.push_back("the file had no end, and so no summary");
}

/// True for the Footer, followed by the magic bytes.
bool Survey::ends_file(const Record& record) {
  if (record.opcode != op::footer || !parse_footer(record.body)) return false;
  const std::uint64_t end = end_of(record);
  if (!begins_with_magic(file_.subspan(end))) return false;
  lose(end + magic.size(), file_.size(), "the bytes after the file's end");
  return true;
}

/// True if the file ends inside of a chunk that begins there.
bool Survey::is_cut_chunk(std::uint64_t offset) const {
  const Bytes left = file_.subspan(offset);
  if (left.size() <= record_head || left[0] != std::byte{op::chunk}) return false;
  const auto head = parse_cut_chunk(left.subspan(record_head));
  return head && head->start_time <= head->end_time && is_utf8(head->compression);
}

/// False if it isn't saved; then it was reported.
bool Survey::pass_record(const Record& record) {
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
  if (!layout.whole) return fmt::format("a {} that is shorter than its fields state", name_of(record.opcode));
  if (is_overwritten(record, layout)) return fmt::format("a {} that is partly overwritten", name_of(record.opcode));
  switch (record.opcode) {
    case op::header: {
      if (!layout.problems.empty() || !contents.profile.empty() || !contents.library.empty()) return {};
      ByteReader in(record.body);
      contents.profile = in.get_string();
      contents.library = in.get_string();
      return {};
    }
    case op::schema:
    case op::channel: return learn(record);
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
  if (stated != 0 && stated != pass_.crc() && recovery_.lost.empty())
    recovery_.remarks.push_back(
        "the CRC of the data section doesn't match, and the CRCs of its parts do: the bytes between them have "
        "changed");
}

/// Reads a Schema or Channel; ignores any other record.
Survey::Fault Survey::learn(const Record& record) {
  if (record.opcode != op::schema && record.opcode != op::channel) return {};
  const auto keep = [this, kind = name_of(record.opcode)](auto& known, const auto& parsed) -> Fault {
    if (!parsed) return fmt::format("a {} that is shorter than its fields state", kind);
    const auto [place, added] = known.try_emplace(parsed->id, *parsed);
    if (place->second == *parsed) return {};
    return fmt::format("a {} {} that is defined differently {}", kind, parsed->id,
                       summary_decides_ ? "in the summary" : "before");
  };
  if (record.opcode == op::channel) return keep(contents.channels, parse_channel(record.body));
  const auto schema = parse_schema(record.body);
  if (schema && schema->id == 0) return "a Schema with the id 0";
  return keep(contents.schemas, schema);
}

Survey::Fault Survey::judge_attachment(const Record& record) const {
  const auto attachment = parse_attachment(record.body);
  if (!attachment) return "an Attachment that is shorter than its fields state";
  if (attachment->crc == 0 || attachment->crc == crc32(attachment->covered)) return {};
  return fmt::format("an Attachment, {}, whose CRC doesn't match", in_quotes(attachment->attachment.name));
}

Survey::Fault Survey::judge_chunk(const Record& record) {
  const OpenedChunk chunk = opener_.open(record, buffer_);
  switch (chunk.fault) {
    case OpenedChunk::Fault::none: break;
    case OpenedChunk::Fault::too_short: return "a Chunk that is shorter than its fields state";
    case OpenedChunk::Fault::too_large:
      return fmt::format("a Chunk that states {} bytes decompressed", chunk.head.uncompressed_size);
    case OpenedChunk::Fault::not_decompressed: return "a Chunk that can't be decompressed: " + chunk.reason;
    case OpenedChunk::Fault::wrong_crc: return "a Chunk whose CRC doesn't match";
  }
  if (chunk.head.uncompressed_crc == 0 &&
      !has_layout(chunk.records, [](const LayoutCheck& check) { return check.whole; }))
    return "a Chunk without a CRC whose records aren't whole";
  pass_chunk_records(chunk.records, chunk.head.compression);
  return {};
}

void Survey::pass_chunk_records(Bytes records, std::string_view compression) {
  std::vector<bool> seen(0x10000);
  std::vector<std::uint16_t> in_chunk;
  RecordWalker inside(records);
  Record inner;
  while (inside.next(inner)) {
    static_cast<void>(learn(inner));
    const auto head = inner.opcode == op::message ? parse_message_head(inner.body) : std::nullopt;
    if (!head || seen[head->channel]) continue;
    seen[head->channel] = true;
    in_chunk.push_back(head->channel);
  }
  groups.add_chunk(compression, in_chunk);
}

/// Counts the lost messages: message indexes after a lost chunk list them.
void Survey::count_lost(const Record& message_index) {
  if (!check_layout(message_index.opcode, message_index.body).exact()) return;
  ByteReader in(message_index.body);
  const auto channel = in.get<std::uint16_t>();
  recovery_.channels[channel].lost += in.get<std::uint32_t>() / index_entry_size;
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
