#include "recover.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "doctor.h"
#include "draft.h"
#include "file_view.h"
#include "model/text.h"
#include "record_layout.h"
#include "survey.h"

namespace rehearse::mcap {

namespace {

/// Reports the second half of the progress.
Progress second_half(const Progress& progress) {
  if (!progress) return {};
  return [progress](std::uint64_t done, std::uint64_t all) { progress(all / 2 + done / 2, all); };
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

/// The second pass: delivers the records that the first one saved.
class SavedPass {
 public:
  SavedPass(const FileView& file, const Survey& survey, const RecoverOptions& options, Recovery& recovery,
            const OnSaved& saved)
      : file_(file.bytes()),
        passed_(file, file_, second_half(options.progress)),
        survey_(survey),
        recovery_(recovery),
        saved_(saved),
        opener_({.max_chunk_size = options.max_chunk_size}) {}

  void run() {
    Record record;
    for (const SavedRun& run : survey_.runs) {
      if (!run.trusted && !pass_damaged_chunk(run)) return;
      RecordWalker walker(file_.first(run.end), run.begin);
      while (run.trusted && walker.next(record))
        if (!pass(record)) return;
    }
    if (orphans_ > 0)
      recovery_.remarks.push_back(
          fmt::format("{} messages are of channels whose definitions are lost, and so can't be kept", orphans_));
  }

 private:
  /// False: stop.
  bool pass(const Record& record) {
    DamageLog none("");  // the first pass has reported it
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
  bool pass_damaged_chunk(const SavedRun& run) {
    const auto head = parse_cut_chunk(file_.subspan(run.begin + record_head, run.end - run.begin - record_head));
    REHEARSE_ASSERT(head, "the first pass parsed it");
    return deliver_records(opener_.open_front(*head, buffer_), run.begin);
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
    if (!survey_.contents.channels.contains(head->channel)) {
      ++orphans_;
      ++recovery_.channels[head->channel].lost;
      return true;
    }
    DamageLog none("");
    return saved_.message(survey_.contents.read_message(record, none));
  }

  const Bytes file_;
  PassedBytes passed_;
  const Survey& survey_;
  Recovery& recovery_;
  const OnSaved& saved_;
  ChunkOpener opener_;
  RawBuffer buffer_;
  std::uint64_t orphans_ = 0;
};

/// The format forbids data without an encoding, because its meaning would be unknown.
bool is_damaged(const Schema& schema) { return schema.encoding.empty() && !schema.data.empty(); }

/// Defines the channels in the new file. Returns their ids in the new file by those in the source.
std::vector<std::uint16_t> define(Writer& writer, const Survey& survey, Recovery& recovery) {
  std::vector<std::uint16_t> ids(0x10000);
  for (const auto& [id, channel] : survey.contents.channels) {
    std::uint16_t schema = 0;
    if (channel.schema_id != 0) {
      const auto known = survey.contents.schemas.find(channel.schema_id);
      const bool lost = known == survey.contents.schemas.end();
      if (lost || is_damaged(known->second))
        recovery.remarks.push_back(fmt::format("the schema of {} is {}: its messages are kept without one",
                                               in_quotes(channel.topic), lost ? "lost" : "damaged"));
      else
        schema = writer.add_schema(as_utf8(known->second.name), as_utf8(known->second.encoding), known->second.data);
    }
    const std::string topic = as_utf8(channel.topic);
    ids[id] = writer.add_channel(schema, topic, as_utf8(channel.message_encoding), as_utf8(channel.metadata),
                                 survey.groups.of(id));
    recovery.channels[id].topic = topic;
    if (topic != channel.topic) recovery.remarks.push_back(fmt::format("the topic {} was not UTF-8", in_quotes(topic)));
  }
  return ids;
}

/// Computes the losses from the remaining statistics.
void count_losses(const Survey& survey, Recovery& recovery) {
  if (survey.contents.statistics) {
    recovery.loss_is_known = true;
    recovery.source_last_time = survey.contents.statistics->message_end_time;
    recovery.lost_messages = survey.contents.statistics->message_count -
                             std::min(survey.contents.statistics->message_count, recovery.messages);
    for (const auto& [id, count] : survey.contents.statistics->channel_message_counts) {
      RecoveredChannel& channel = recovery.channels[id];
      channel.lost = count - std::min(count, channel.saved);
    }
    return;
  }
  for (const auto& [id, channel] : recovery.channels) recovery.lost_messages += channel.lost;
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

/// Writes all records that the survey saved.
Result<void> write_saved(const FileView& file, const std::filesystem::path& source, const Draft& draft,
                         const Survey& survey, const RecoverOptions& options, Recovery& recovery) {
  WriterOptions form;
  form.profile = as_utf8(survey.contents.profile);
  auto writer = draft.open_writer(form);
  if (!writer) return writer.errors();
  const std::vector<std::uint16_t> ids = define(**writer, survey, recovery);
  Result<void> written;
  recovery.first_time = std::numeric_limits<std::uint64_t>::max();
  OnSaved saved;
  saved.message = [&](const Message& message) {
    ++recovery.messages;
    ++recovery.channels[message.channel->id].saved;
    recovery.first_time = std::min(recovery.first_time, message.log_time);
    recovery.last_time = std::max(recovery.last_time, message.log_time);
    written = (*writer)->write(ids[message.channel->id], message.log_time, message.publish_time, message.data,
                               message.sequence);
    return written.ok();
  };
  saved.attachment = [&](const Attachment& attachment) {
    ++recovery.attachments;
    written = (*writer)->add_attachment(as_utf8(attachment.name), as_utf8(attachment.media_type), attachment.data,
                                        attachment.log_time, attachment.create_time);
    return written.ok();
  };
  saved.metadata = [&](const Metadata& metadata) {
    ++recovery.metadata;
    written = (*writer)->add_metadata(as_utf8(metadata.name), as_utf8(metadata.values));
    return written.ok();
  };
  SavedPass(file, survey, options, recovery, saved).run();
  if (!written) return written;
  if (recovery.messages == 0) recovery.first_time = 0;
  if (recovery.messages + recovery.attachments + recovery.metadata == 0)
    return error_in(source.string(),
                    "nothing can be saved: it has no message, no attachment and no metadata that is whole");
  count_losses(survey, recovery);
  if (!recovery.is_whole()) {
    if (auto noted = (*writer)->add_metadata("rehearse.recover", note_of(source, options, recovery)); !noted)
      return noted;
  }
  return (*writer)->close();
}

/// Checks that the written file is whole.
Result<void> examine_written(const std::filesystem::path& written, const std::filesystem::path& target,
                             const Recovery& recovery) {
  const auto examination = examine(written);
  if (!examination) return examination.errors();
  for (const Finding& finding : examination->findings.list())
    if (finding.severity == Severity::error)
      return error_in(target.string(), fmt::format("the saved file isn't valid, so it isn't kept: at byte {}: {}",
                                                   finding.place.offset, finding.message));
  if (examination->messages != recovery.messages)
    return error_in(target.string(), fmt::format("{} messages were saved, but {} are in the file, so it isn't kept",
                                                 recovery.messages, examination->messages));
  return {};
}

}  // namespace

Result<Recovery> recover(const std::filesystem::path& source, const std::filesystem::path& target,
                         const RecoverOptions& options) {
  const auto view = FileView::open(source);
  if (!view) return view.errors();
  auto draft = Draft::begin(target, std::span(&source, 1));
  if (!draft) return draft.errors();
  Recovery recovery;
  if (view->converted())
    for (const Diagnostic& damage : view->converted()->damage) recovery.remarks.push_back(damage.message);
  const Survey survey(*view, options, recovery);
  if (survey.runs.empty())
    return error_in(source.string(), "nothing can be saved: it has no MCAP record that is whole");
  if (auto done = write_saved(*view, source, *draft, survey, options, recovery); !done) return done.errors();
  if (auto whole = examine_written(draft->file(), target, recovery); !whole) return whole.errors();
  if (auto done = draft->finish(); !done) return done.errors();
  return recovery;
}

}  // namespace rehearse::mcap
