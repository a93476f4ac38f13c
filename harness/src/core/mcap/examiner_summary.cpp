#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "examiner.h"

namespace rehearse::mcap {

namespace {

/// The element of `sorted` that begins at that byte; null: there is none.
template <class T>
const T* find_at(const std::vector<T>& sorted, std::uint64_t offset) {
  const auto found = std::lower_bound(sorted.begin(), sorted.end(), offset,
                                      [](const T& element, std::uint64_t value) { return element.offset() < value; });
  return found != sorted.end() && found->offset() == offset ? &*found : nullptr;
}

/// Collects the differences between an index and the actual values.
class Comparison {
 public:
  explicit Comparison(std::string what) : what_(std::move(what)) {}

  template <class T>
  void compare(std::string_view field, const T& stated, const T& there) {
    if (stated != there)
      text_ += fmt::format("{} {} {} in place of {}", text_.empty() ? "" : ";", field, stated, there);
  }
  void compare_text(std::string_view field, std::string_view stated, std::string_view there) {
    if (stated != there) compare<std::string>(field, in_quotes(stated), in_quotes(there));
  }
  /// The differences as a sentence; empty if there are none.
  std::string sentence() const { return text_.empty() ? "" : what_ + " states:" + text_; }

 private:
  std::string what_;
  std::string text_;
};

}  // namespace

/// Examines the records between the end of the data section and the Footer, and the Footer.
void Examiner::examine_summary(const Record& footer) {
  if (!summary_begin_) {
    fail({footer.offset, {}}, "there is no Data End before the Footer");
    summary_begin_ = footer.offset;
  }
  indexed_chunks_.assign(chunks_.size(), false);
  indexed_attachments_.assign(attachments_.size(), false);
  indexed_metadata_.assign(metadata_.size(), false);
  RecordWalker walker(file_.first(footer.offset), *summary_begin_);
  Record record;
  while (walker.next(record)) {
    examine_grouping(record);
    if (is_known(record.opcode) && check_layout(record.opcode, record.body).whole) examine_summary_record(record);
  }
  tell_missing_parts();
  examine_footer(footer, *parse_footer(footer.body));
}

void Examiner::examine_footer(const Record& record, const Footer& footer) {
  const std::uint64_t begin = *summary_begin_;
  const Place place{record.offset, {}};
  const bool empty = begin == record.offset;
  if (footer.summary_start != begin && !(empty && footer.summary_start == 0))
    fail(place, fmt::format("the Footer states a summary at byte {}, but it begins at byte {}", footer.summary_start,
                            empty ? 0 : begin));
  std::uint64_t offsets_begin = 0;
  for (const auto& [opcode, span] : groups_)
    if (opcode == op::summary_offset && offsets_begin == 0) offsets_begin = span.first;
  if (footer.summary_offset_start != offsets_begin &&
      !(offsets_begin == 0 && footer.summary_offset_start == record.offset))
    fail(place, fmt::format("the Footer states summary offsets at byte {}, but they begin at byte {}",
                            footer.summary_offset_start, offsets_begin));
  const Bytes covered = file_.subspan(begin, record.offset + footer_covered - begin);
  if (footer.summary_crc != 0 && footer.summary_crc != crc32(covered))
    fail(place, "the CRC of the summary, which the Footer states, doesn't match");
}

void Examiner::examine_summary_record(const Record& record) {
  switch (record.opcode) {
    case op::schema:
    case op::channel: return examine_repeated(record);
    case op::chunk_index: return examine_chunk_index(record);
    case op::attachment_index: return examine_record_index(record, attachments_, true);
    case op::metadata_index: return examine_record_index(record, metadata_, false);
    case op::statistics: return examine_statistics(record);
    case op::summary_offset: return examine_summary_offset(record);
    default: fail({record.offset, {}}, fmt::format("a {} isn't allowed in the summary", name_of(record.opcode)));
  }
}

/// Finds the groups of equal records, to which the summary offsets point.
void Examiner::examine_grouping(const Record& record) {
  const std::uint64_t end = end_of(record);
  if (!groups_.empty() && groups_.back().first == record.opcode) {
    groups_.back().second.second = end;
    return;
  }
  const bool again = std::ranges::any_of(groups_, [&](const auto& group) { return group.first == record.opcode; });
  if (again || (!groups_.empty() && groups_.back().first == op::summary_offset))
    deviate({record.offset, {}},
            fmt::format("the summary isn't grouped: a {} after records of other kinds", name_of(record.opcode)));
  groups_.push_back({record.opcode, {record.offset, end}});
}

/// Examines a Schema or Channel of the summary. The pass has already learned it, if it was unknown.
void Examiner::examine_repeated(const Record& record) {
  const auto compare = [&](std::string_view kind, const auto& known, const auto& places, const auto& repeated) {
    const auto learned = known.find(repeated.id);
    if (learned == known.end()) return;  // the pass has lost it
    const ExaminedDefinition& at = places.at(repeated.id);
    if (learned->second != repeated)
      fail({record.offset, {}},
           fmt::format("{} {} differs from its definition at byte {}", kind, repeated.id, at.offset));
    else if (!at.in_data && !damaged_)
      deviate({record.offset, {}},
              fmt::format("the summary has {} {}, but the data section doesn't", kind, repeated.id));
  };
  if (record.opcode == op::channel) {
    const auto channel = parse_channel(record.body);
    REHEARSE_ASSERT(channel, "its fields are whole");
    repeated_channels_.insert(channel->id);
    compare("Channel", contents_.channels, channels_, *channel);
  } else {
    const auto schema = parse_schema(record.body);
    REHEARSE_ASSERT(schema, "its fields are whole");
    repeated_schemas_.insert(schema->id);
    compare("Schema", contents_.schemas, schemas_, *schema);
  }
}

void Examiner::examine_chunk_index(const Record& record) {
  const Place place{record.offset, {}};
  const auto stated = parse_chunk_index(record.body);
  REHEARSE_ASSERT(stated, "its fields are whole");
  const std::uint64_t offset = stated->chunk.offset;
  const ExaminedChunk* chunk = find_at(chunks_, offset);
  if (chunk == nullptr) return fail(place, fmt::format("a Chunk Index of byte {}, where no Chunk begins", offset));
  const auto index = static_cast<std::size_t>(chunk - chunks_.data());
  if (indexed_chunks_[index]) fail(place, fmt::format("a second Chunk Index of the Chunk at byte {}", offset));
  indexed_chunks_[index] = true;
  const ChunkIndex& there = chunk->index;
  Comparison comparison(fmt::format("the Chunk Index of the Chunk at byte {}", offset));
  comparison.compare("start time", stated->chunk.start_time, there.chunk.start_time);
  comparison.compare("end time", stated->chunk.end_time, there.chunk.end_time);
  comparison.compare("length", stated->length, there.length);
  comparison.compare_text("compression", stated->chunk.compression, there.chunk.compression);
  comparison.compare("compressed size", stated->chunk.stored_size, there.chunk.stored_size);
  comparison.compare("uncompressed size", stated->chunk.size, there.chunk.size);
  comparison.compare("length of the message indexes", stated->indexes_length, there.indexes_length);
  if (std::string said = comparison.sentence(); !said.empty()) fail(place, std::move(said));
  std::vector<std::pair<std::uint16_t, std::uint64_t>> places;
  for (ByteReader in(stated->places); in.left() > 0;) {
    const auto channel = in.get<std::uint16_t>();
    places.push_back({channel, in.get<std::uint64_t>()});
  }
  auto indexes = chunk->indexes;
  std::ranges::sort(places);
  std::ranges::sort(indexes);
  if (places != indexes && !places.empty())
    fail(place, fmt::format("the Chunk Index of the Chunk at byte {} doesn't have the places of its {} message indexes",
                            offset, indexes.size()));
}

/// Examines an Attachment Index, or a Metadata Index.
void Examiner::examine_record_index(const Record& record, const std::vector<ExaminedRecord>& all, bool attachments) {
  const Place place{record.offset, {}};
  const std::string kind = attachments ? "Attachment" : "Metadata";
  ByteReader in(record.body);
  const auto offset = in.get<std::uint64_t>();
  const auto length = in.get<std::uint64_t>();
  const ExaminedRecord* there = find_at(all, offset);
  if (there == nullptr) return fail(place, fmt::format("an index of byte {}, where no {} record begins", offset, kind));
  std::vector<bool>& indexed = attachments ? indexed_attachments_ : indexed_metadata_;
  const auto index = static_cast<std::size_t>(there - all.data());
  if (indexed[index]) fail(place, fmt::format("a second {} Index of byte {}", kind, offset));
  indexed[index] = true;
  Comparison comparison(fmt::format("the {} Index of byte {}", kind, offset));
  comparison.compare("length", length, there->length);
  if (attachments) {
    comparison.compare("log time", in.get<std::uint64_t>(), there->attachment.log_time);
    comparison.compare("create time", in.get<std::uint64_t>(), there->attachment.create_time);
    comparison.compare("data size", in.get<std::uint64_t>(), there->data_size);
  }
  comparison.compare_text("name", in.get_string(), there->attachment.name);
  if (attachments) comparison.compare_text("media type", in.get_string(), there->attachment.media_type);
  if (std::string said = comparison.sentence(); !said.empty()) fail(place, std::move(said));
}

void Examiner::examine_statistics(const Record& record) {
  const Place place{record.offset, {}};
  const auto stated = parse_statistics(record.body);
  REHEARSE_ASSERT(stated, "its fields are whole");
  if (damaged_) return;  // not all records could be counted
  const auto in_data = [](const auto& definitions) {
    return static_cast<std::uint64_t>(
        std::ranges::count_if(definitions, [](const auto& entry) { return entry.second.in_data; }));
  };
  Comparison comparison("the record of statistics");
  comparison.compare<std::uint64_t>("messages", stated->message_count, messages_);
  comparison.compare<std::uint64_t>("schemas", stated->schema_count, in_data(schemas_));
  comparison.compare<std::uint64_t>("channels", stated->channel_count, in_data(channels_));
  comparison.compare<std::uint64_t>("attachments", stated->attachment_count, attachments_.size());
  comparison.compare<std::uint64_t>("metadata", stated->metadata_count, metadata_.size());
  comparison.compare<std::uint64_t>("chunks", stated->chunk_count, chunks_.size());
  comparison.compare<std::uint64_t>("first log time", stated->message_start_time, messages_ == 0 ? 0 : first_time_);
  comparison.compare<std::uint64_t>("last log time", stated->message_end_time, last_time_);
  if (!stated->channel_message_counts.empty()) {
    for (const auto& [id, count] : stated->channel_message_counts) {
      const auto channel = channels_.find(id);
      comparison.compare<std::uint64_t>(fmt::format("messages of channel {}", id), count,
                                        channel == channels_.end() ? 0 : channel->second.messages);
    }
    for (const auto& [id, channel] : channels_)
      if (channel.messages > 0 && !stated->channel_message_counts.contains(id))
        comparison.compare<std::uint64_t>(fmt::format("messages of channel {}", id), 0, channel.messages);
  }
  if (std::string said = comparison.sentence(); !said.empty()) fail(place, std::move(said));
}

void Examiner::examine_summary_offset(const Record& record) {
  const Place place{record.offset, {}};
  ByteReader in(record.body);
  const auto opcode = in.get<std::uint8_t>();
  const auto begin = in.get<std::uint64_t>();
  const auto length = in.get<std::uint64_t>();
  const auto group = std::ranges::find_if(groups_, [&](const auto& candidate) { return candidate.first == opcode; });
  if (group == groups_.end() || opcode == op::summary_offset)
    return fail(place, fmt::format("a Summary Offset of a group of {} records, which the summary doesn't have",
                                   name_of(opcode)));
  const auto [there, end] = group->second;
  if (begin != there || length != end - there)
    fail(place,
         fmt::format("the Summary Offset of the group of {} records states {} bytes at byte {}; they are {} bytes at "
                     "byte {}",
                     name_of(opcode), length, begin, end - there, there));
}

/// Checks that indexes exist for all records or for none, and that indexed messages can be read with the summary alone.
void Examiner::tell_missing_parts() {
  const std::uint64_t begin = *summary_begin_;
  const auto lacking = [&](const std::vector<bool>& indexed, std::string_view kind, const auto& all) {
    const auto missing = static_cast<std::size_t>(std::ranges::count(indexed, false));
    if (missing == 0 || missing == indexed.size()) return;
    const auto first = static_cast<std::size_t>(std::ranges::find(indexed, false) - indexed.begin());
    fail({begin, {}}, fmt::format("the summary has no {} Index for {} of {} records, the first of them at byte {}",
                                  kind, missing, indexed.size(), all[first].offset()));
  };
  lacking(indexed_chunks_, "Chunk", chunks_);
  lacking(indexed_attachments_, "Attachment", attachments_);
  lacking(indexed_metadata_, "Metadata", metadata_);
  const bool has_index = std::ranges::find(indexed_chunks_, true) != indexed_chunks_.end();
  if (!has_index) return;
  if (loose_messages_ > 0)
    findings_.add(Severity::warning, {loose_at_, {}},
                  fmt::format("{} messages are outside of Chunks, from here on, although the file has a Chunk Index: "
                              "readers that use the index don't find them",
                              loose_messages_));
  for (const auto& [id, channel] : channels_) {
    if (!channel.in_chunks) continue;
    const Channel& definition = contents_.channels.at(id);
    if (!repeated_channels_.contains(id))
      fail({begin, {}},
           fmt::format("the summary has a Chunk Index, but not Channel {} {}, which has messages in chunks", id,
                       in_quotes(definition.topic)));
    if (contents_.schema_of(definition) != nullptr && !repeated_schemas_.contains(definition.schema_id))
      fail({begin, {}}, fmt::format("the summary has a Chunk Index, but not Schema {} of Channel {} {}",
                                    definition.schema_id, id, in_quotes(definition.topic)));
  }
}

}  // namespace rehearse::mcap
