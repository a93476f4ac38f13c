#include "examiner.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/text.h"

namespace rehearse::mcap {

namespace {

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

/// True if the encodings and the metadata are those that the profile demands.
bool fits_profile(const std::string& profile, const Channel& channel, const Schema* schema) {
  const std::string_view encoding = schema == nullptr ? "" : std::string_view(schema->encoding);
  if (profile == "ros1") return channel.message_encoding == "ros1" && (schema == nullptr || encoding == "ros1msg");
  if (profile != "ros2") return true;
  return channel.message_encoding == "cdr" && channel.metadata.contains("offered_qos_profiles") &&
         (encoding.empty() || encoding == "ros2msg" || encoding == "ros2idl");
}

}  // namespace

void Findings::add(Severity severity, Place place, std::string message) {
  constexpr std::uint64_t limit = 1000;
  std::uint64_t& count = counts_[static_cast<std::size_t>(severity)];
  if (count++ < limit) list_.push_back({severity, place, std::move(message)});
}

Examiner::Examiner(const FileView& view, Bytes file, const ExamineOptions& options, Examination& into)
    : file_(file),
      pass_(view, file, true, options.progress, 0),
      options_(options),
      into_(into),
      findings_(into.findings),
      contents_(into.contents),
      resync_(file, options.max_chunk_size),
      opener_({.max_chunk_size = options.max_chunk_size}) {}

void Examiner::examine() {
  read_definitions_of_summary();
  if (const auto footer = walk()) {
    examine_summary(*footer);
    examine_end(*footer);
  }
  tell_channels();
  tell_deviations();
  into_.chunks = chunks_.size();
  into_.messages = messages_;
  if (options_.content != nullptr) options_.content->end(file_.size(), findings_);
}

/// Adds a definition to those known so far. False: they have a different one.
template <class Known, class Parsed>
bool Examiner::learn(Known& known, const Parsed& parsed, ExaminedDefinition& at, std::uint64_t offset) {
  const auto [definition, added] = known.try_emplace(parsed.id, parsed);
  if (added) at.offset = offset;
  return definition->second == parsed;
}

/// Reads the definitions of the summary, if the file has a regular end and the CRC of the summary matches.
void Examiner::read_definitions_of_summary() {
  std::uint64_t footer_at = 0;
  const auto footer = find_footer(file_, footer_at);
  if (!footer || footer->summary_crc == 0 || footer->summary_start == 0 || footer->summary_start > footer_at) return;
  const Bytes covered = file_.subspan(footer->summary_start, footer_at + footer_covered - footer->summary_start);
  if (crc32(covered) != footer->summary_crc) return;
  RecordWalker summary(file_.first(footer_at), footer->summary_start);
  Record record;
  while (summary.next(record)) {
    if (record.opcode == op::statistics) contents_.statistics = parse_statistics(record.body);
    learn(record);
  }
}

/// Learns a definition of the summary, unless the data section has a different one.
void Examiner::learn(const Record& record) {
  const auto schema = record.opcode == op::schema ? parse_schema(record.body) : std::nullopt;
  if (schema && schema->id != 0) learn(contents_.schemas, *schema, schemas_[schema->id], record.offset);
  const auto channel = record.opcode == op::channel ? parse_channel(record.body) : std::nullopt;
  if (channel) learn(contents_.channels, *channel, channels_[channel->id], record.offset);
}

/// Passes over the file. Returns the Footer, if nothing but the magic bytes should follow it.
std::optional<Record> Examiner::walk() {
  if (begins_with_magic(file_)) {
    pass_.go_on_at(magic.size());
  } else {
    const std::uint64_t first = resync_.find(0).value_or(file_.size());
    lose(0, first, {"the bytes there aren't the beginning of an MCAP file"});
    pass_.go_on_at(first);
  }
  std::optional<Record> footer;
  Record record;
  while (pass_.offset() < file_.size()) {
    const std::uint64_t begin = pass_.offset();
    if (pass_.next(record)) {
      const std::uint64_t end = end_of(record);
      footer.reset();
      if (record.opcode == op::footer && parse_footer(record.body)) {
        footer = record;
        if (begins_with_magic(file_.subspan(end))) return footer;
        if (summary_begin_) continue;
      }
      const Verdict lost = examine_record(record);
      if (!lost) {
        save(begin, end);
        continue;
      }
      if (resync_.is_plausible(end)) {  // else its length may be wrong, too, and cover undamaged records
        if (options_.trust_damaged && record.opcode == op::chunk && parse_chunk(record.body)) save(begin, end, false);
        lose(begin, end, *lost, is_known(record.opcode));
        continue;
      }
    }
    leave_chunk();
    if (const auto next = resync_.find(begin + 1)) {
      footer.reset();
      lose(begin, *next, {fmt::format("the bytes there are no record; the next record begins at byte {}", *next)});
      pass_.go_on_at(*next);
      continue;
    }
    if (footer) return footer;
    tell_cut(begin);
    return std::nullopt;
  }
  leave_chunk();
  if (!footer) fail({file_.size(), {}}, "truncated: the file ends there, without Data End and Footer");
  return footer;
}

/// Loses the bytes up to the end of the file, which are no records.
void Examiner::tell_cut(std::uint64_t begin) {
  if (options_.trust_damaged && is_cut_chunk(begin)) save(begin, file_.size(), false);
  const bool zeros = is_all_zero(file_.subspan(begin));
  lose(begin, file_.size(),
       {zeros ? fmt::format("truncated: from there to the end at byte {} are zeros only", file_.size())
              : fmt::format("truncated: the record that begins there isn't whole, and no record follows up to the "
                            "end at byte {}",
                            file_.size())});
}

/// True if the file ends inside of a chunk that begins there.
bool Examiner::is_cut_chunk(std::uint64_t offset) const {
  const Bytes left = file_.subspan(offset);
  if (left.size() <= record_head || left[0] != std::byte{op::chunk}) return false;
  const auto head = parse_cut_chunk(left.subspan(record_head));
  return head && head->start_time <= head->end_time && is_utf8(head->compression);
}

/// Examines the bytes after the Footer.
void Examiner::examine_end(const Record& footer) {
  const std::uint64_t end = end_of(footer);
  const Bytes tail = file_.subspan(end);
  if (!begins_with_magic(tail)) return fail({end, {}}, "the magic bytes at the end of the file are missing");
  lose(end + magic.size(), file_.size(),
       {fmt::format("{} bytes after the end of the file", tail.size() - magic.size())});
}

Examiner::Verdict Examiner::examine_record(const Record& record) {
  const Place place{record.offset, {}};
  if (!std::exchange(begun_, true) && record.opcode != op::header)
    fail(place, fmt::format("the first record is no Header, but a {}", name_of(record.opcode)));
  if (record.opcode != op::message_index) leave_chunk();
  if (is_private(record.opcode)) {
    if (!summary_begin_) ++into_.private_records;
    return {};
  }
  if (!is_known(record.opcode))
    return Fault{fmt::format("a {}, which version 0 doesn't define", name_of(record.opcode))};
  const LayoutCheck layout = check_layout(record.opcode, record.body);
  if (!layout.whole)
    return Fault{fmt::format("the {} is shorter than its fields state: it has {} bytes", name_of(record.opcode),
                             record.body.size())};
  if (is_overwritten(record, layout)) return Fault{fmt::format("the {} is partly overwritten", name_of(record.opcode))};
  tell_fields(record, place, layout);
  if (summary_begin_) return learn(record), Verdict();  // the summary is examined when its end is known
  switch (record.opcode) {
    case op::header: return examine_header(record), Verdict();
    case op::schema: return examine_schema(record, place);
    case op::channel: return examine_channel(record, place);
    case op::message:
      if (loose_messages_++ == 0) loose_at_ = record.offset;
      resync_.expect_loose_messages();
      return examine_message(record, place), Verdict();
    case op::chunk: return examine_chunk(record);
    case op::message_index: return examine_message_index(record), Verdict();
    case op::attachment: return examine_attachment(record);
    case op::metadata: return examine_metadata(record), Verdict();
    case op::data_end: return examine_data_end(record), Verdict();
    default: fail(place, fmt::format("a {} isn't allowed in the data section", name_of(record.opcode))); return {};
  }
}

void Examiner::tell_fields(const Record& record, Place place, const LayoutCheck& layout) {
  for (const std::string& problem : layout.problems)
    fail(place, fmt::format("the {}: {}", name_of(record.opcode), problem));
  if (layout.extra == 0) return;
  const std::string what =
      fmt::format("the {} has {} bytes more than its fields of version 0", name_of(record.opcode), layout.extra);
  if (record.opcode == op::data_end || record.opcode == op::footer)
    fail(place, what + "; it can't be extended");
  else
    deviate(place, what);
}

void Examiner::examine_header(const Record& record) {
  const Place place{record.offset, {}};
  if (std::exchange(headed_, true)) return fail(place, "a second Header");
  ByteReader in(record.body);
  contents_.profile = in.get_string();
  contents_.library = in.get_string();
  if (contents_.library.empty()) deviate(place, "the Header doesn't name the library that wrote the file");
}

Examiner::Verdict Examiner::examine_schema(const Record& record, Place place) {
  const auto schema = parse_schema(record.body);
  REHEARSE_ASSERT(schema, "its fields are whole");
  if (schema->id == 0) return Fault{fmt::format("the Schema {} has the id 0", in_quotes(schema->name))};
  ExaminedDefinition& known = schemas_[schema->id];
  const bool is_first = !std::exchange(known.in_data, true);
  if (!learn(contents_.schemas, *schema, known, place.offset))
    return Fault{fmt::format("Schema {} differs from its definition at byte {}", schema->id, known.offset)};
  if (!is_first) return {};
  if (schema->name.empty()) deviate(place, fmt::format("Schema {} has no name", schema->id));
  if (schema->encoding.empty() && !schema->data.empty())
    fail(place, fmt::format("Schema {} {} has data but no encoding", schema->id, in_quotes(schema->name)));
  if (options_.content != nullptr) options_.content->schema(*schema, place, findings_);
  return {};
}

Examiner::Verdict Examiner::examine_channel(const Record& record, Place place) {
  const auto channel = parse_channel(record.body);
  REHEARSE_ASSERT(channel, "its fields are whole");
  ExaminedChannel& known = channels_[channel->id];
  const bool is_first = !std::exchange(known.in_data, true);
  if (!learn(contents_.channels, *channel, known, place.offset))
    return Fault{fmt::format("Channel {} differs from its definition at byte {}", channel->id, known.offset)};
  if (!is_first) return {};
  const auto schema = schemas_.find(channel->schema_id);
  if (channel->schema_id != 0 && (schema == schemas_.end() || !schema->second.in_data))
    fail(place, fmt::format("Channel {} {} is of Schema {}, which isn't defined before it", channel->id,
                            in_quotes(channel->topic), channel->schema_id));
  if (channel->topic.empty()) deviate(place, fmt::format("Channel {} has no topic", channel->id));
  if (!fits_profile(contents_.profile, *channel, contents_.schema_of(*channel)))
    deviate(place, fmt::format("Channel {} {} hasn't the encodings or the metadata of the profile {}", channel->id,
                               in_quotes(channel->topic), contents_.profile));
  return {};
}

Examiner::Verdict Examiner::examine_attachment(const Record& record) {
  const auto parsed = parse_attachment(record.body);
  REHEARSE_ASSERT(parsed, "its fields are whole");
  Attachment attachment = parsed->attachment;
  attachment.data = {};
  attachment.offset = record.offset;
  attachments_.push_back({bytes_of(record).size(), attachment, parsed->attachment.data.size()});
  if (parsed->crc != 0 && parsed->crc != crc32(parsed->covered))
    return Fault{fmt::format("the CRC of the Attachment {} doesn't match", in_quotes(attachment.name))};
  if (attachment.name.empty()) deviate({record.offset, {}}, "the Attachment has no name");
  if (options_.content != nullptr) options_.content->attachment(attachment, findings_);
  return {};
}

void Examiner::examine_metadata(const Record& record) {
  auto metadata = parse_metadata(record.body);
  REHEARSE_ASSERT(metadata, "its fields are whole");
  metadata->offset = record.offset;
  if (options_.content != nullptr) options_.content->metadata(*metadata, findings_);
  ExaminedRecord& examined = metadata_.emplace_back();
  examined.length = bytes_of(record).size();
  examined.attachment.name = std::move(metadata->name);
  examined.attachment.offset = record.offset;
}

void Examiner::examine_message(const Record& record, Place place) {
  const auto head = parse_message_head(record.body);
  REHEARSE_ASSERT(head, "its fields are whole");
  ++messages_;
  first_time_ = std::min(first_time_, head->log_time);
  last_time_ = std::max(last_time_, head->log_time);
  const auto found = channels_.find(head->channel);
  if (found == channels_.end() || !found->second.in_data)
    return fail(place, fmt::format("a Message of channel {}, which isn't defined before it", head->channel));
  ExaminedChannel& channel = found->second;
  if (channel.messages > 0) {
    if (head->log_time < channel.last_time) {
      if (channel.back_in_time++ == 0) channel.back_at = place;
      channel.back_by = std::max(channel.back_by, channel.last_time - head->log_time);
    }
    const std::uint32_t step = head->sequence - channel.last_sequence;
    if (step > 1 && channel.jumps++ == 0) channel.jump_at = place;
  }
  ++channel.messages;
  channel.in_chunks = channel.in_chunks || place.inside.has_value();
  channel.last_time = head->log_time;
  channel.last_sequence = head->sequence;
  if (options_.content == nullptr) return;
  const Channel& definition = contents_.channels.at(head->channel);
  const Location location{place.offset, place.inside.value_or(0), place.inside.has_value()};
  const Message message{
      &definition, head->sequence, head->log_time, head->publish_time, record.body.subspan(message_head), location};
  options_.content->message(message, contents_.schema_of(definition), place, findings_);
}

void Examiner::examine_data_end(const Record& record) {
  summary_begin_ = end_of(record);
  const auto crc = ByteReader(record.body).get<std::uint32_t>();
  if (crc != 0 && crc != pass_.crc())
    fail({record.offset, {}}, "the CRC of the data section, which the Data End states, doesn't match");
}

/// Reports findings that are made once for a channel, independent of the number of its messages.
void Examiner::tell_channels() {
  for (const auto& [id, channel] : channels_) {
    const std::string name = fmt::format("Channel {} {}", id, in_quotes(contents_.channels.at(id).topic));
    if (channel.back_in_time > 0)
      findings_.add(Severity::warning, channel.back_at,
                    fmt::format("{}: the log time goes back from here on, in {} of {} messages, by up to {} ns", name,
                                channel.back_in_time, channel.messages, channel.back_by));
    if (channel.jumps > 0)
      findings_.add(
          Severity::note, channel.jump_at,
          fmt::format(
              "{}: the sequence numbers have {} {}, the first one here: messages are missing, or the numbers are "
              "no counts",
              name, channel.jumps, channel.jumps == 1 ? "gap" : "gaps"));
  }
}

void Examiner::deviate(Place place, std::string what) {
  constexpr std::size_t listed = 10;
  if (deviation_count_++ == 0) deviation_at_ = place;
  if (deviations_.size() < listed) deviations_.push_back(std::move(what));
}

void Examiner::tell_deviations() {
  if (deviations_.empty()) return;
  std::string all;
  for (const std::string& what : deviations_) all += (all.empty() ? "" : "; ") + what;
  if (deviation_count_ > deviations_.size()) all += fmt::format("; and {} more", deviation_count_ - deviations_.size());
  findings_.add(Severity::note, deviation_at_, "deviations from the specification that harm no reader: " + all);
}

void Examiner::save(std::uint64_t begin, std::uint64_t end, bool trusted) {
  if (summary_begin_) return;
  std::vector<SavedSpan>& saved = into_.saved;
  if (trusted && !saved.empty() && saved.back().trusted && saved.back().end == begin)
    saved.back().end = end;
  else
    saved.push_back({begin, end, trusted});
}

void Examiner::lose(std::uint64_t begin, std::uint64_t end, Fault fault, bool is_error) {
  constexpr std::size_t listed = 1000;
  if (begin == end) return;
  const Place place{begin, fault.inside};
  if (is_error) {
    damaged_ = true;
    fail(place, fault.message);
  } else {
    deviate(place, fault.message);
  }
  into_.lost_bytes += end - begin;
  if (into_.lost.size() < listed) into_.lost.push_back({begin, end, std::move(fault.message)});
}

Examination examine_view(const FileView& view, Bytes bytes, const ExamineOptions& options) {
  Examination examination;
  examination.size = view.converted() ? view.converted()->size : bytes.size();
  Examiner(view, bytes, options, examination).examine();
  return examination;
}

Result<Examination> examine(const std::filesystem::path& file, const ExamineOptions& options) {
  const auto view = REHEARSE_TRY(FileView::open(file));
  if (!begins_with_magic(view.bytes())) return not_mcap(view.name(), view.bytes());
  return examine_view(view, view.bytes(), options);
}

}  // namespace rehearse::mcap
