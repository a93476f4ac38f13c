#include "frame.h"
#include "reader_impl.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse::mcap {

Result<void> Reader::Impl::open() {
  if (!begins_with_magic(bytes_)) return damaged(describe_start(bytes_));
  if (options_.opening == Opening::walk || !open_by_summary()) walk_if_not_yet();
  return {};
}

void Reader::Impl::walk_if_not_yet() {
  if (walked_) return;
  walked_ = true;
  attachments_.clear();
  metadata_.clear();
  chunks_.clear();
  chunk_channels_.clear();
  scan();
}

void Reader::Impl::scan() {
  RecordWalker walker(bytes_, magic.size());
  Record record;
  PassedBytes passed(file_, bytes_);
  bool first = true;
  while (true) {
    data_end_ = walker.offset();
    passed.pass(data_end_);
    if (!walker.next(record)) {
      report_cut(walker);
      break;
    }
    if (first && record.opcode != op::header) damage_.add("damaged: the first record isn't a Header");
    first = false;
    if (record.opcode == op::data_end || record.opcode == op::footer) {
      scan_end(walker, record);
      break;
    }
    scan_data_record(record);
  }
  if (!knows_all_definitions()) learn_from_chunks();
}

void Reader::Impl::report_cut(const RecordWalker& walker) {
  const Bytes rest = bytes_.subspan(walker.offset());
  const bool ends_well = rest.size() >= magic.size() && begins_with_magic(rest.last(magic.size()));
  damage_.add(describe_cut({walker.offset(), bytes_.size(), ends_well, !ends_well && is_all_zero(rest)}));
}

void Reader::Impl::scan_data_record(const Record& record) {
  switch (record.opcode) {
    case op::header: contents_.learn_header(record, damage_); break;
    case op::schema:
    case op::channel: contents_.learn(record, damage_); break;
    case op::message: loose_messages_ = true; break;
    case op::chunk: scan_chunk_head(record); break;
    case op::message_index: scan_message_index(record); break;
    case op::attachment:
      if (auto attachment = read_attachment(record, options_.check_crcs, damage_))
        attachments_.push_back(std::move(*attachment));
      break;
    case op::metadata:
      if (auto metadata = read_metadata(record, damage_)) metadata_.push_back(std::move(*metadata));
      break;
    default: break;  // records that later versions of the format may bring
  }
}

void Reader::Impl::scan_chunk_head(const Record& record) {
  if (const auto head = parse_chunk(record.body)) {
    chunks_.push_back({record.offset, head->start_time, head->end_time, std::string(head->compression),
                       head->records.size(), head->uncompressed_size});
    chunk_channels_.push_back(ChunkChannels::not_said);
  } else {
    damage_.add(fmt::format("damaged: the chunk at byte {} is too short for what it says", record.offset));
  }
}

/// `record` is the DataEnd, or the Footer of a file that leaves DataEnd out.
void Reader::Impl::scan_end(RecordWalker& walker, const Record& record) {
  Record footer = record;
  std::uint64_t summary_start = record.offset;
  if (record.opcode == op::data_end) {
    data_crc_ = read_data_end(record, damage_);
    summary_start = walker.offset();
    footer.opcode = 0;
    while (footer.opcode != op::footer) {
      if (!walker.next(footer)) return report_cut(walker);
    }
  }
  scan_summary_up_to(footer, summary_start);
  check_tail(bytes_.subspan(walker.offset()), walker.offset(), damage_);
}

void Reader::Impl::scan_summary_up_to(const Record& record, std::uint64_t start) {
  const auto footer = read_footer(record, start, damage_);
  if (!footer) return;
  const Bytes covered = bytes_.subspan(start, record.offset + footer_covered - start);
  if (options_.check_crcs && footer->summary_crc != 0 && footer->summary_crc != crc32(covered)) {
    damage_.add(fmt::format("damaged: the CRC of the summary at byte {} doesn't match", start));
    return;
  }
  RecordWalker walker(bytes_.first(record.offset), start);
  Record said;
  while (walker.next(said)) {
    if (said.opcode == op::channel) summary_has_channels_ = true;
    if (said.opcode == op::statistics) contents_.statistics = parse_statistics(said.body);
    contents_.learn(said, damage_);
  }
}

/// Whether the summary repeats what may stand in chunks only.
bool Reader::Impl::knows_all_definitions() const {
  const auto is_known = [&](const auto& entry) {
    return entry.second.schema_id == 0 || contents_.schema_of(entry.second) != nullptr;
  };
  const auto& said = contents_.statistics;
  const bool all_counted =
      !said || (contents_.channels.size() >= said->channel_count && contents_.schemas.size() >= said->schema_count);
  return summary_has_channels_ && all_counted &&
         std::all_of(contents_.channels.begin(), contents_.channels.end(), is_known);
}

/// Files without a summary may tell their channels only inside of their chunks. A chunk whose messages are all of known
/// channels, as its index says, need not be opened for that.
void Reader::Impl::learn_from_chunks() {
  PassedBytes passed(file_, bytes_);
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < chunks_.size(); ++i) {
    passed.pass(chunks_[i].offset);
    if (chunk_channels_[i] == ChunkChannels::known) {
      others.push_back(i);
    } else {
      learn_from_chunk(chunks_[i]);
    }
  }
  const auto is_known = [this](std::uint16_t channel) { return contents_.channels.contains(channel); };
  if (std::all_of(unknown_channels_.begin(), unknown_channels_.end(), is_known)) return;
  for (const std::size_t i : others) learn_from_chunk(chunks_[i]);
}

void Reader::Impl::learn_from_chunk(const Chunk& place) {
  DamageLog ignored(name_);  // a pass over the messages says it
  RecordWalker at(bytes_, place.offset);
  Record record;
  if (!at.next(record)) return;
  const auto head = parse_chunk(record.body);
  if (!head) return;
  const auto records = chunk_opener_.open(*head, place.offset, pass_buffer_);
  if (!records) return;
  RecordWalker inside(*records);
  while (inside.next(record)) contents_.learn(record, ignored);
}

/// Of the chunk before it.
void Reader::Impl::scan_message_index(const Record& record) {
  ByteReader in(record.body);
  const auto channel = in.get<std::uint16_t>();
  if (chunk_channels_.empty() || !in.ok()) return;
  ChunkChannels& before = chunk_channels_.back();
  const auto known = contents_.channels.find(channel);
  if (known == contents_.channels.end()) {
    before = ChunkChannels::unknown;
    unknown_channels_.insert(channel);
  } else if (known->second.schema_id != 0 && contents_.schema_of(known->second) == nullptr) {
    before = ChunkChannels::unknown;
  } else if (before == ChunkChannels::not_said) {
    before = ChunkChannels::known;
  }
}

}  // namespace rehearse::mcap
