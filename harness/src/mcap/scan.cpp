#include "reader_impl.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse::mcap {

namespace {

bool begins_with_magic(Bytes bytes) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

/// Why a file without the magic bytes isn't read.
std::string describe_start(Bytes bytes) {
  constexpr std::size_t version_at = 5;
  if (bytes.empty()) return "not an MCAP file: it is empty";
  const std::size_t seen = std::min(bytes.size(), magic.size());
  if (bytes.size() < magic.size() && std::equal(bytes.begin(), bytes.end(), magic.begin())) {
    return fmt::format("truncated at byte {}: not even the magic bytes of MCAP are whole", seen);
  }
  if (seen == magic.size() && std::equal(magic.begin(), magic.begin() + version_at, bytes.begin())) {
    return "an MCAP file of a version that this reader doesn't know, or damaged in its first eight bytes";
  }
  return "not an MCAP file: it doesn't begin with the magic bytes \\x89MCAP0\\r\\n";
}

bool is_all_zero(Bytes bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

}  // namespace

bool RecordWalker::next(Record& record) {
  const Bytes left = range_.subspan(offset_);
  if (left.size() < record_head) return false;
  ByteReader in(left);
  const auto opcode = in.get<std::uint8_t>();
  const auto length = in.get<std::uint64_t>();
  if (opcode == 0 || length > in.left()) return false;
  record.opcode = opcode;
  record.body = in.get_bytes(length);
  record.offset = offset_;
  offset_ += record_head + length;
  return true;
}

void DamageLog::add(std::string message) {
  if (list_.size() > limit) return;
  if (list_.size() == limit) message = "and more damage after that";
  list_.push_back(error(std::move(message)));
  list_.back().file = file_;
}

Result<void> Reader::Impl::scan() {
  if (!begins_with_magic(bytes_)) return damaged(describe_start(bytes_));
  RecordWalker walker(bytes_, magic.size());
  Record record;
  bool first = true;
  while (true) {
    data_end_ = walker.offset();
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
  if (!summary_has_channels_) learn_from_chunks();
  return {};
}

void Reader::Impl::report_cut(const RecordWalker& walker) {
  const Bytes rest = bytes_.subspan(walker.offset());
  const bool ends_well = rest.size() >= magic.size() && begins_with_magic(rest.last(magic.size()));
  if (ends_well) {
    damage_.add(
        fmt::format("damaged at byte {}: what begins there is no record that fits into the file", walker.offset()));
  } else if (!rest.empty() && is_all_zero(rest)) {
    damage_.add(fmt::format("truncated at byte {}: from there on the file holds zeros only", walker.offset()));
  } else {
    damage_.add(fmt::format("truncated at byte {}: the record that begins at byte {} isn't whole", bytes_.size(),
                            walker.offset()));
  }
}

void Reader::Impl::scan_data_record(const Record& record) {
  switch (record.opcode) {
    case op::header: {
      ByteReader in(record.body);
      profile_ = in.get_string();
      library_ = in.get_string();
      if (!in.ok()) damage_.add(fmt::format("damaged: the Header at byte {} is too short", record.offset));
      break;
    }
    case op::schema:
    case op::channel: learn(record, damage_); break;
    case op::message: loose_messages_ = true; break;
    case op::chunk: scan_chunk_head(record); break;
    case op::attachment: scan_attachment(record); break;
    case op::metadata:
      if (auto metadata = parse_metadata(record.body)) {
        metadata->offset = record.offset;
        metadata_.push_back(std::move(*metadata));
      } else {
        damage_.add(fmt::format("damaged: the Metadata at byte {} is too short for what it says", record.offset));
      }
      break;
    default: break;  // indexes, and records that later versions of the format may bring
  }
}

void Reader::Impl::scan_chunk_head(const Record& record) {
  if (const auto head = parse_chunk(record.body)) {
    chunks_.push_back({record.offset, head->start_time, head->end_time});
  } else {
    damage_.add(fmt::format("damaged: the chunk at byte {} is too short for what it says", record.offset));
  }
}

void Reader::Impl::scan_attachment(const Record& record) {
  auto parsed = parse_attachment(record.body);
  if (!parsed) {
    damage_.add(fmt::format("damaged: the attachment at byte {} is too short for what it says", record.offset));
    return;
  }
  if (options_.check_crcs && parsed->crc != 0 && parsed->crc != crc32(parsed->covered)) {
    damage_.add(fmt::format("damaged: the CRC of the attachment \"{}\" at byte {} doesn't match",
                            parsed->attachment.name, record.offset));
    return;
  }
  parsed->attachment.offset = record.offset;
  attachments_.push_back(std::move(parsed->attachment));
}

/// `record` is the DataEnd, or the Footer of a file that leaves DataEnd out.
void Reader::Impl::scan_end(RecordWalker& walker, const Record& record) {
  Record footer = record;
  if (record.opcode == op::data_end) {
    ByteReader in(record.body);
    const auto crc = in.get<std::uint32_t>();
    if (!in.ok() || in.left() != 0) {
      damage_.add(fmt::format("damaged: the DataEnd record at byte {} hasn't its length of 4", record.offset));
    } else if (crc != 0) {
      data_crc_ = crc;
    }
    footer.opcode = 0;
    while (footer.opcode != op::footer) {
      if (!walker.next(footer)) return report_cut(walker);
    }
  }
  const std::uint64_t summary_start =
      record.opcode == op::data_end ? record.offset + record_head + record.body.size() : record.offset;
  scan_footer(footer, summary_start);
  const Bytes tail = bytes_.subspan(walker.offset());
  if (tail.size() < magic.size()) {
    damage_.add(fmt::format("truncated at byte {}: the magic bytes at the end aren't whole", bytes_.size()));
  } else if (tail.size() > magic.size() || !begins_with_magic(tail)) {
    damage_.add(fmt::format("damaged at byte {}: the file doesn't end with its magic bytes there", walker.offset()));
  }
}

void Reader::Impl::scan_footer(const Record& record, std::uint64_t summary_start) {
  const auto footer = parse_footer(record.body);
  const std::uint64_t expected_start = summary_start == record.offset ? 0 : summary_start;
  if (!footer) {
    damage_.add(fmt::format("damaged: the Footer at byte {} hasn't its length of 20", record.offset));
  } else if (footer->summary_start != expected_start &&
             !(expected_start == 0 && footer->summary_start == record.offset)) {
    damage_.add(
        fmt::format("damaged: the Footer at byte {} says that the summary begins at byte {}, it does at byte {}",
                    record.offset, footer->summary_start, expected_start));
  } else {
    const std::uint64_t crc_at = record.offset + record_head + 16;
    const Bytes covered = bytes_.subspan(summary_start, crc_at - summary_start);
    if (options_.check_crcs && footer->summary_crc != 0 && footer->summary_crc != crc32(covered)) {
      damage_.add(fmt::format("damaged: the CRC of the summary at byte {} doesn't match", summary_start));
      return;
    }
    scan_summary(bytes_.first(record.offset), summary_start);
  }
}

void Reader::Impl::scan_summary(Bytes until_footer, std::uint64_t start) {
  RecordWalker walker(until_footer, start);
  Record record;
  while (walker.next(record)) {
    if (record.opcode == op::channel) summary_has_channels_ = true;
    if (record.opcode == op::statistics) statistics_ = parse_statistics(record.body);
    learn(record, damage_);
  }
}

/// Files without a summary tell their channels only inside of their chunks.
void Reader::Impl::learn_from_chunks() {
  DamageLog ignored(name_);  // a pass over the messages says it
  for (const ChunkPlace& place : chunks_) {
    RecordWalker at(bytes_, place.offset);
    Record record;
    if (!at.next(record)) continue;
    const auto head = parse_chunk(record.body);
    if (!head) continue;
    const auto records = open_chunk(*head, place.offset, pass_buffer_);
    if (!records) continue;
    RecordWalker inside(*records);
    while (inside.next(record)) {
      if (record.opcode == op::schema || record.opcode == op::channel) learn(record, ignored);
    }
  }
}

void Reader::Impl::learn(const Record& record, DamageLog& damage) {
  const auto contradiction = [&](std::string_view what, std::uint16_t id) {
    damage.add(fmt::format("damaged: {} {} is defined a second time at byte {}, differently", what, id, record.offset));
  };
  const auto too_short = [&](std::string_view what) {
    damage.add(fmt::format("damaged: the {} at byte {} is too short for what it says", what, record.offset));
  };
  if (record.opcode == op::schema) {
    auto schema = parse_schema(record.body);
    if (!schema) return too_short("schema");
    if (schema->id == 0) return;  // the format says: ignore
    const auto [place, added] = schemas_.try_emplace(schema->id, *schema);
    if (!added && place->second != *schema) contradiction("schema", schema->id);
  } else if (record.opcode == op::channel) {
    auto channel = parse_channel(record.body);
    if (!channel) return too_short("channel");
    const auto [place, added] = channels_.try_emplace(channel->id, *channel);
    if (!added && place->second != *channel) contradiction("channel", channel->id);
  }
}

}  // namespace rehearse::mcap
