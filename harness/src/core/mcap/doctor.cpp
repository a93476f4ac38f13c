#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "doctor_impl.h"
#include "model/text.h"
#include "record_layout.h"

namespace rehearse::mcap {

void Findings::add(Severity severity, Place place, std::string message) {
  constexpr std::uint64_t limit = 1000;
  std::uint64_t& count = counts_[static_cast<std::size_t>(severity)];
  if (count++ < limit) list_.push_back({severity, place, std::move(message)});
}

Doctor::Doctor(const FileView& view, Bytes file, const DoctorOptions& options, Examination& into)
    : file_(file),
      pass_(view, file, true, options.progress),
      options_(options),
      into_(into),
      findings_(into.findings),
      resync_(file, options.max_chunk_size),
      opener_({.max_chunk_size = options.max_chunk_size}) {}

void Doctor::examine() {
  Record footer;
  const bool ends = pass_to_footer(footer);
  if (ends) examine_summary(footer);
  tell_channels();
  into_.chunks = chunks_.size();
  into_.messages = messages_;
  if (options_.content != nullptr) options_.content->end(file_.size(), findings_);
}

/// Examines the data section and the bytes after it. False if there is no Footer.
bool Doctor::pass_to_footer(Record& record) {
  while (true) {
    if (!pass_.next(record)) {
      leave_chunk();
      if (!skip_damage()) return false;
      continue;
    }
    if (record.opcode == op::footer && summary_begin_) return true;
    if (summary_begin_) continue;  // the summary is examined when its end is known
    if (record.opcode != op::data_end && record.opcode != op::footer) {
      examine_record(record);
      continue;
    }
    leave_chunk();
    if (!headed_) fail({magic.size(), {}}, "there is no Header");
    if (record.opcode == op::footer) {
      fail({record.offset, {}}, "there is no Data End before the Footer");
      summary_begin_ = record.offset;
      return true;
    }
    examine_data_end(record);
    summary_begin_ = pass_.offset();
  }
}

/// Skips bytes that are no record. False if no record follows.
bool Doctor::skip_damage() {
  const std::uint64_t begin = pass_.offset();
  const auto next = begin < file_.size() ? resync_.find(begin + 1) : std::nullopt;
  damaged_ = true;
  if (next) {
    fail({begin, {}}, fmt::format("the bytes there are no record; the next record begins at byte {}", *next));
    pass_.go_on_at(*next);
    return true;
  }
  const Bytes rest = file_.subspan(begin);
  if (rest.empty())
    fail({begin, {}}, "truncated: the file ends there, without Data End and Footer");
  else if (is_all_zero(rest))
    fail({begin, {}}, fmt::format("truncated: from there to the end at byte {} are zeros only", file_.size()));
  else
    fail({begin, {}},
         fmt::format("truncated: the record that begins there isn't whole, and no record follows up to the "
                     "end at byte {}",
                     file_.size()));
  return false;
}

void Doctor::examine_record(const Record& record) {
  const Place place{record.offset, {}};
  if (record.offset == magic.size() && record.opcode != op::header)
    fail(place, fmt::format("the first record is no Header, but a {}", name_of(record.opcode)));
  if (record.opcode != op::message_index) leave_chunk();
  if (!is_known(record.opcode)) {
    if (!is_private(record.opcode))
      add(Severity::note, place, fmt::format("a {}, which version 0 doesn't define", name_of(record.opcode)));
    return;
  }
  if (!check_fields(record, place)) return;
  switch (record.opcode) {
    case op::header: return examine_header(record);
    case op::schema: return examine_schema(record, place);
    case op::channel: return examine_channel(record, place);
    case op::message:
      if (loose_messages_++ == 0) loose_at_ = record.offset;
      resync_.expect_loose_messages();
      return examine_message(record, place);
    case op::chunk: return examine_chunk(record);
    case op::message_index: return examine_message_index(record);
    case op::attachment: return examine_attachment(record);
    case op::metadata: return examine_metadata(record);
    default: fail(place, fmt::format("a {} isn't allowed in the data section", name_of(record.opcode)));
  }
}

bool Doctor::check_fields(const Record& record, Place place) {
  const LayoutCheck check = check_layout(record.opcode, record.body);
  if (!check.whole) {
    fail(place, fmt::format("the {} is shorter than its fields state: it has {} bytes", name_of(record.opcode),
                            record.body.size()));
    damaged_ = true;
    return false;
  }
  for (const std::string& problem : check.problems)
    fail(place, fmt::format("the {}: {}", name_of(record.opcode), problem));
  const bool fixed = record.opcode == op::data_end || record.opcode == op::footer;
  if (check.extra > 0)
    add(fixed ? Severity::error : Severity::note, place,
        fmt::format("the {} has {} bytes more than its fields of version 0{}", name_of(record.opcode), check.extra,
                    fixed ? "; it can't be extended" : ""));
  return true;
}

void Doctor::examine_header(const Record& record) {
  const Place place{record.offset, {}};
  if (headed_) return fail(place, "a second Header");
  headed_ = true;
  ByteReader in(record.body);
  into_.profile = in.get_string();
  into_.library = in.get_string();
  if (into_.library.empty()) add(Severity::warning, place, "the Header doesn't name the library that wrote the file");
  if (into_.profile.empty()) add(Severity::note, place, "the Header names no profile");
}

void Doctor::examine_schema(const Record& record, Place place) {
  auto schema = parse_schema(record.body);
  REHEARSE_ASSERT(schema, "its fields are whole");
  if (schema->id == 0) return fail(place, fmt::format("the Schema {} has the id 0", in_quotes(schema->name)));
  const auto [known, added] = schemas_.try_emplace(schema->id, *schema, place.offset);
  if (!added) {
    if (known->second.first != *schema)
      fail(place, fmt::format("Schema {} differs from its definition at byte {}", schema->id, known->second.second));
    return;
  }
  if (schema->name.empty()) add(Severity::warning, place, fmt::format("Schema {} has no name", schema->id));
  if (schema->encoding.empty() && !schema->data.empty())
    fail(place, fmt::format("Schema {} {} has data but no encoding", schema->id, in_quotes(schema->name)));
  if (schema->encoding.empty() && schema->data.empty())
    add(Severity::note, place,
        fmt::format("Schema {} {} is a name without a definition", schema->id, in_quotes(schema->name)));
  else if (into_.profile == "ros2" && schema->encoding != "ros2msg" && schema->encoding != "ros2idl")
    add(Severity::warning, place,
        fmt::format("Schema {} {} has the encoding {}; the profile ros2 has ros2msg and ros2idl", schema->id,
                    in_quotes(schema->name), in_quotes(schema->encoding)));
  if (into_.profile == "ros1" && schema->encoding != "ros1msg")
    add(Severity::warning, place,
        fmt::format("Schema {} {} has the encoding {}; the profile ros1 has ros1msg", schema->id,
                    in_quotes(schema->name), in_quotes(schema->encoding)));
  if (options_.content != nullptr) options_.content->schema(*schema, place, findings_);
}

void Doctor::examine_channel(const Record& record, Place place) {
  auto channel = parse_channel(record.body);
  REHEARSE_ASSERT(channel, "its fields are whole");
  const std::uint16_t id = channel->id;
  if (const auto known = channels_.find(id); known != channels_.end()) {
    if (known->second.channel != *channel)
      fail(place, fmt::format("Channel {} differs from its definition at byte {}", id, known->second.offset));
    return;
  }
  if (channel->schema_id != 0 && !schemas_.contains(channel->schema_id))
    fail(place, fmt::format("Channel {} {} is of Schema {}, which isn't defined before it", id,
                            in_quotes(channel->topic), channel->schema_id));
  if (channel->topic.empty()) add(Severity::warning, place, fmt::format("Channel {} has no topic", id));
  examine_channel_profile(*channel, place);
  ExaminedChannel& examined = channels_[id];
  examined.channel = std::move(*channel);
  examined.offset = place.offset;
}

void Doctor::examine_channel_profile(const Channel& channel, Place place) {
  const auto warn = [&](std::string what) {
    add(Severity::warning, place,
        fmt::format("Channel {} {} {}", channel.id, in_quotes(channel.topic), std::move(what)));
  };
  if (into_.profile == "ros2") {
    if (channel.message_encoding != "cdr")
      warn(fmt::format("has messages of the encoding {}; the profile ros2 has cdr",
                       in_quotes(channel.message_encoding)));
    if (!channel.metadata.contains("offered_qos_profiles"))
      warn("has no offered_qos_profiles in its metadata, which the profile ros2 requires");
  } else if (into_.profile == "ros1" && channel.message_encoding != "ros1") {
    warn(
        fmt::format("has messages of the encoding {}; the profile ros1 has ros1", in_quotes(channel.message_encoding)));
  }
}

void Doctor::examine_attachment(const Record& record) {
  const auto parsed = parse_attachment(record.body);
  REHEARSE_ASSERT(parsed, "its fields are whole");
  Attachment attachment = parsed->attachment;
  if (parsed->crc != 0 && parsed->crc != crc32(parsed->covered))
    fail({record.offset, {}}, fmt::format("the CRC of the Attachment {} doesn't match", in_quotes(attachment.name)));
  if (attachment.name.empty()) add(Severity::warning, {record.offset, {}}, "the Attachment has no name");
  attachment.data = {};
  attachment.offset = record.offset;
  if (options_.content != nullptr) options_.content->attachment(attachment, findings_);
  attachments_.push_back({bytes_of(record).size(), std::move(attachment), parsed->attachment.data.size()});
}

void Doctor::examine_metadata(const Record& record) {
  auto metadata = parse_metadata(record.body);
  REHEARSE_ASSERT(metadata, "its fields are whole");
  metadata->offset = record.offset;
  if (options_.content != nullptr) options_.content->metadata(*metadata, findings_);
  ExaminedRecord& examined = metadata_.emplace_back();
  examined.length = bytes_of(record).size();
  examined.attachment.name = std::move(metadata->name);
  examined.attachment.offset = record.offset;
}

void Doctor::examine_message(const Record& record, Place place) {
  const auto head = parse_message_head(record.body);
  REHEARSE_ASSERT(head, "its fields are whole");
  ++messages_;
  first_time_ = std::min(first_time_, head->log_time);
  last_time_ = std::max(last_time_, head->log_time);
  const auto found = channels_.find(head->channel);
  if (found == channels_.end())
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
  const Location location{place.offset, place.inside.value_or(0), place.inside.has_value()};
  const Message message{
      &channel.channel, head->sequence, head->log_time, head->publish_time, record.body.subspan(message_head),
      location};
  const auto schema = schemas_.find(channel.channel.schema_id);
  options_.content->message(message, schema == schemas_.end() ? nullptr : &schema->second.first, place, findings_);
}

void Doctor::examine_data_end(const Record& record) {
  const Place place{record.offset, {}};
  if (!check_fields(record, place)) return;
  const auto crc = ByteReader(record.body).get<std::uint32_t>();
  if (crc != 0 && crc != pass_.crc())
    fail(place, "the CRC of the data section, which the Data End states, doesn't match");
}

/// Reports findings that are made once for a channel, independent of the number of its messages.
void Doctor::tell_channels() {
  for (const auto& [id, channel] : channels_) {
    const std::string name = fmt::format("Channel {} {}", id, in_quotes(channel.channel.topic));
    if (channel.back_in_time > 0)
      add(Severity::warning, channel.back_at,
          fmt::format("{}: the log time goes back from here on, in {} of {} messages, by up to {} ns", name,
                      channel.back_in_time, channel.messages, channel.back_by));
    if (channel.jumps > 0)
      add(Severity::note, channel.jump_at,
          fmt::format(
              "{}: the sequence numbers have {} {}, the first one here: messages are missing, or the numbers are "
              "no counts",
              name, channel.jumps, channel.jumps == 1 ? "gap" : "gaps"));
  }
}

namespace {

Result<Examination> examine_view(const FileView& view, Bytes bytes, const std::string& name,
                                 const DoctorOptions& options) {
  if (!begins_with_magic(bytes)) return error_in(name, describe_start(bytes));
  Examination examination;
  examination.size = view.converted() ? view.converted()->size : bytes.size();
  Doctor(view, bytes, options, examination).examine();
  return examination;
}

}  // namespace

Result<Examination> examine(const std::filesystem::path& file, const DoctorOptions& options) {
  const auto view = FileView::open(file);
  if (!view) return view.errors();
  return examine_view(*view, view->bytes(), view->name(), options);
}

Result<Examination> examine_bytes(Bytes bytes, const std::string& name, const DoctorOptions& options) {
  return examine_view(FileView(), bytes, name, options);
}

}  // namespace rehearse::mcap
