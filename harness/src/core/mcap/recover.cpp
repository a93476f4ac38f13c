#include "recover.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/text.h"
#include "draft.h"
#include "file_view.h"
#include "record_layout.h"

namespace rehearse::mcap {

namespace {

/// Reports one half of the progress: the first (0) or the second (1).
Progress half_of(const Progress& progress, std::uint64_t half) {
  if (!progress) return {};
  return [progress, half](std::uint64_t done, std::uint64_t all) { progress(half * all / 2 + done / 2, all); };
}

/// The text with invalid UTF-8 replaced, as a valid file demands.
std::string as_utf8(std::string_view text) {
  if (is_utf8(text)) return std::string(text);
  constexpr std::string_view replacement = "\xEF\xBF\xBD";
  std::string valid;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    valid += length > 0 ? text.substr(0, length) : replacement;
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return valid;
}

StringMap as_utf8(const StringMap& map) {
  StringMap valid;
  for (const auto& [key, value] : map) valid[as_utf8(key)] = as_utf8(value);
  return valid;
}

/// Gets the saved records in file order; false: stop.
struct OnSaved {
  std::function<bool(const Message&)> message;
  std::function<bool(const Attachment&)> attachment;
  std::function<bool(const Metadata&)> metadata;
};

/// The second pass: delivers the records that the examination saved.
class SavedPass {
 public:
  SavedPass(const FileView& file, const Examination& source, const RecoverOptions& options, Recovery& recovery,
            const OnSaved& saved)
      : file_(file.bytes()),
        passed_(file, file_, half_of(options.progress, 1)),
        source_(source),
        recovery_(recovery),
        saved_(saved),
        opener_({.max_chunk_size = options.max_chunk_size}) {}

  void run() {
    Record record;
    for (const SavedSpan& span : source_.saved) {
      if (!span.trusted && !pass_damaged_chunk(span)) return;
      RecordWalker walker(file_.first(span.end), span.begin);
      while (span.trusted && walker.next(record))
        if (!pass(record)) return;
    }
    if (orphans_ > 0)
      recovery_.remarks.push_back(
          fmt::format("{} messages are of channels whose definitions are lost, and so can't be kept", orphans_));
  }

 private:
  /// False: stop.
  bool pass(const Record& record) {
    DamageLog none("");  // the examination has reported it
    passed_.pass(record.offset);
    switch (record.opcode) {
      case op::message: return deliver(record);
      case op::chunk: return deliver_records(opener_.open(record, buffer_).records, record.offset);
      case op::attachment: return saved_.attachment(*read_attachment(record, false, none));
      case op::metadata: return saved_.metadata(*read_metadata(record, none));
      default: return true;
    }
  }

  /// Passes the messages of a damaged chunk that seem whole.
  bool pass_damaged_chunk(const SavedSpan& span) {
    const auto head = parse_cut_chunk(file_.subspan(span.begin + record_head, span.end - span.begin - record_head));
    REHEARSE_ASSERT(head, "the examination parsed it");
    return deliver_records(opener_.open_front(*head, buffer_), span.begin);
  }

  bool deliver_records(Bytes records, std::uint64_t chunk) {
    RecordWalker inside(records);
    Record inner;
    inner.chunk = chunk;
    while (inside.next(inner)) {
      if (is_known(inner.opcode) && !check_layout(inner.opcode, inner.body).whole) break;
      if (inner.opcode == op::message && !deliver(inner)) return false;
    }
    return true;
  }

  bool deliver(const Record& record) {
    const auto head = parse_message_head(record.body);
    if (!head) return true;
    if (!source_.contents.channels.contains(head->channel)) {
      ++orphans_;
      ++recovery_.channels[head->channel].lost;
      return true;
    }
    DamageLog none("");
    return saved_.message(source_.contents.read_message(record, none));
  }

  const Bytes file_;
  PassedBytes passed_;
  const Examination& source_;
  Recovery& recovery_;
  const OnSaved& saved_;
  ChunkOpener opener_;
  RawBuffer buffer_;
  std::uint64_t orphans_ = 0;
};

/// The format forbids data without an encoding, because its meaning would be unknown.
bool is_damaged(const Schema& schema) { return schema.encoding.empty() && !schema.data.empty(); }

/// Defines the channels in the new file. Returns their ids in the new file by those in the source.
std::vector<std::uint16_t> define(Writer& writer, const Examination& from, Recovery& recovery) {
  std::vector<std::uint16_t> ids(0x10000);
  for (const auto& [id, channel] : from.contents.channels) {
    std::uint16_t schema = 0;
    if (channel.schema_id != 0) {
      const auto known = from.contents.schemas.find(channel.schema_id);
      const bool lost = known == from.contents.schemas.end();
      if (lost || is_damaged(known->second))
        recovery.remarks.push_back(fmt::format("the schema of {} is {}: its messages are kept without one",
                                               in_quotes(channel.topic), lost ? "lost" : "damaged"));
      else
        schema = writer.add_schema(as_utf8(known->second.name), as_utf8(known->second.encoding), known->second.data);
    }
    const std::string topic = as_utf8(channel.topic);
    ids[id] = writer.add_channel(schema, topic, as_utf8(channel.message_encoding), as_utf8(channel.metadata),
                                 from.groups.of(id));
    recovery.channels[id].topic = topic;
    if (topic != channel.topic) recovery.remarks.push_back(fmt::format("the topic {} was not UTF-8", in_quotes(topic)));
  }
  return ids;
}

/// Computes the losses from the remaining statistics, and adds those of the conversion.
void count_losses(const FileView& file, const Examination& from, Recovery& recovery) {
  if (from.contents.statistics) {
    recovery.loss_is_known = true;
    recovery.source_last_time = from.contents.statistics->message_end_time;
    recovery.lost_messages =
        from.contents.statistics->message_count - std::min(from.contents.statistics->message_count, recovery.messages);
    for (const auto& [id, count] : from.contents.statistics->channel_message_counts) {
      RecoveredChannel& channel = recovery.channels[id];
      channel.lost = count - std::min(count, channel.saved);
    }
  } else {
    for (const auto& [id, channel] : recovery.channels) recovery.lost_messages += channel.lost;
  }
  if (file.converted() == nullptr) return;
  recovery.loss_is_known = recovery.loss_is_known && file.converted()->lost_messages;
  recovery.lost_messages += file.converted()->lost_messages.value_or(0);
}

/// The metadata of the new file about its recovery.
StringMap note_of(const std::filesystem::path& source, const RecoverOptions& options, const Recovery& recovery) {
  constexpr std::size_t listed = 20;
  std::string spans;
  for (std::size_t i = 0; i < std::min(listed, recovery.lost.size()); ++i)
    spans += fmt::format("{}{}-{}: {}", i == 0 ? "" : "; ", recovery.lost[i].begin, recovery.lost[i].end,
                         recovery.lost[i].what);
  if (recovery.lost.size() > listed) spans += fmt::format("; and {} more", recovery.lost.size() - listed);
  StringMap note{{"source", printable(source.filename().string(), 200)},
                 {"source_bytes", std::to_string(recovery.size)},
                 {"lost_bytes", std::to_string(recovery.lost_bytes)},
                 {"lost", spans}};
  if (recovery.loss_is_known) note["lost_messages"] = std::to_string(recovery.lost_messages);
  if (options.trust_damaged) note["trust_damaged"] = "true";
  return note;
}

/// The losses, and the errors that the new file won't have.
Recovery begin_recovery(const FileView& file, const Examination& from) {
  constexpr std::size_t listed = 20;
  Recovery recovery;
  recovery.size = from.size;
  recovery.lost_bytes = from.lost_bytes;
  recovery.lost = from.lost;
  for (const auto& [channel, count] : from.lost_messages) recovery.channels[channel].lost = count;
  if (file.converted())
    for (const Diagnostic& damage : file.converted()->damage) recovery.remarks.push_back(damage.message);
  if (from.private_records > 0)
    recovery.remarks.push_back(fmt::format("{} private records aren't kept", from.private_records));
  std::size_t mended = 0;
  for (const Finding& finding : from.findings.list()) {
    const bool is_loss =
        std::ranges::any_of(from.lost, [&](const LostBytes& lost) { return lost.begin == finding.place.offset; });
    if (finding.severity != Severity::error || is_loss) continue;
    if (mended++ < listed)
      recovery.remarks.push_back(fmt::format("byte {}: {}", finding.place.offset, finding.message));
  }
  if (mended > listed) recovery.remarks.push_back(fmt::format("and {} more errors", mended - listed));
  return recovery;
}

/// Writes all records that the examination saved.
Result<void> write_saved(const FileView& file, const std::filesystem::path& source, const Draft& draft,
                         const Examination& from, const RecoverOptions& options, Recovery& recovery) {
  WriterOptions form;
  form.profile = as_utf8(from.contents.profile);
  auto writer = REHEARSE_TRY(draft.open_writer(form));
  const std::vector<std::uint16_t> ids = define(*writer, from, recovery);
  Result<void> written;
  recovery.first_time = std::numeric_limits<std::uint64_t>::max();
  OnSaved saved;
  saved.message = [&](const Message& message) {
    ++recovery.messages;
    ++recovery.channels[message.channel->id].saved;
    recovery.first_time = std::min(recovery.first_time, message.log_time);
    recovery.last_time = std::max(recovery.last_time, message.log_time);
    written =
        writer->write(ids[message.channel->id], message.log_time, message.publish_time, message.data, message.sequence);
    return written.ok();
  };
  saved.attachment = [&](const Attachment& attachment) {
    ++recovery.attachments;
    written = writer->add_attachment(as_utf8(attachment.name), as_utf8(attachment.media_type), attachment.data,
                                     attachment.log_time, attachment.create_time);
    return written.ok();
  };
  saved.metadata = [&](const Metadata& metadata) {
    ++recovery.metadata;
    written = writer->add_metadata(as_utf8(metadata.name), as_utf8(metadata.values));
    return written.ok();
  };
  SavedPass(file, from, options, recovery, saved).run();
  if (!written) return written;
  if (recovery.messages == 0) recovery.first_time = 0;
  if (recovery.messages + recovery.attachments + recovery.metadata == 0)
    return error_in(source.string(),
                    "nothing can be saved: it has no message, no attachment and no metadata that is whole");
  count_losses(file, from, recovery);
  if (!recovery.is_whole()) {
    REHEARSE_TRY(writer->add_metadata("rehearse.recover", note_of(source, options, recovery)));
  }
  return writer->close();
}

/// Checks that the written file is whole.
Result<void> examine_written(const std::filesystem::path& written, const std::filesystem::path& target,
                             const Recovery& recovery) {
  const auto examination = REHEARSE_TRY(examine(written));
  for (const Finding& finding : examination.findings.list())
    if (finding.severity == Severity::error)
      return error_in(target.string(), fmt::format("the saved file isn't valid, so it isn't kept: at byte {}: {}",
                                                   finding.place.offset, finding.message));
  if (examination.messages != recovery.messages)
    return error_in(target.string(), fmt::format("{} messages were saved, but {} are in the file, so it isn't kept",
                                                 recovery.messages, examination.messages));
  return {};
}

}  // namespace

Result<Recovery> recover(const std::filesystem::path& source, const std::filesystem::path& target,
                         const RecoverOptions& options) {
  const auto view = REHEARSE_TRY(FileView::open(source));
  auto draft = REHEARSE_TRY(Draft::begin(target, std::span(&source, 1)));
  ExamineOptions examining;
  examining.max_chunk_size = options.max_chunk_size;
  examining.trust_damaged = options.trust_damaged;
  examining.progress = half_of(options.progress, 0);
  const Examination from = examine_view(view, view.bytes(), examining);
  if (from.saved.empty()) return error_in(source.string(), "nothing can be saved: it has no MCAP record that is whole");
  Recovery recovery = begin_recovery(view, from);
  REHEARSE_TRY(write_saved(view, source, draft, from, options, recovery));
  REHEARSE_TRY(examine_written(draft.file(), target, recovery));
  REHEARSE_TRY(draft.finish());
  return recovery;
}

}  // namespace rehearse::mcap
