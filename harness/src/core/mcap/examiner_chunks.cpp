#include <fmt/format.h>

#include <algorithm>

#include "examiner.h"

namespace rehearse::mcap {

namespace {

bool by_offset(const IndexEntry& a, const IndexEntry& b) { return a.offset < b.offset; }
bool by_channel(const IndexEntry& a, const IndexEntry& b) { return a.channel < b.channel; }

/// The place from which on the records of a chunk aren't whole; nullopt: all of them are.
std::optional<std::uint64_t> find_broken(Bytes records) {
  RecordWalker walker(records);
  Record record;
  while (walker.next(record))
    if (is_known(record.opcode) && !check_layout(record.opcode, record.body).whole) return record.offset;
  return walker.at_end() ? std::nullopt : std::optional(walker.offset());
}

}  // namespace

Examiner::Verdict Examiner::examine_chunk(const Record& record) {
  const OpenedChunk opened = opener_.open(record, buffer_);
  const ChunkHead& head = opened.head;
  ExaminedChunk& chunk = chunks_.emplace_back();
  chunk.index.chunk = {record.offset,       head.start_time,       head.end_time, std::string(head.compression),
                       head.records.size(), head.uncompressed_size};
  chunk.index.length = bytes_of(record).size();
  at_chunk_ = true;
  chunk_is_open_ = false;
  switch (opened.fault) {
    case OpenedChunk::Fault::none: break;
    case OpenedChunk::Fault::too_short: REHEARSE_ASSERT(false, "its fields are whole");
    case OpenedChunk::Fault::too_large:
      return Fault{fmt::format("the Chunk states {} bytes decompressed, more than the limit of {}",
                               head.uncompressed_size, options_.max_chunk_size)};
    case OpenedChunk::Fault::not_decompressed:
      return Fault{fmt::format("the Chunk can't be decompressed: {}", opened.reason)};
    case OpenedChunk::Fault::wrong_crc: return Fault{"the CRC of the Chunk doesn't match"};
  }
  const auto broken = find_broken(opened.records);
  const std::string why = "the records of the Chunk aren't whole from there on";
  if (broken && head.uncompressed_crc == 0) return Fault{why, broken};
  chunk_is_open_ = true;
  examine_chunk_records(opened.records.first(broken.value_or(opened.records.size())), chunk.index.chunk);
  if (broken) {
    damaged_ = true;
    fail({record.offset, broken}, why);
  }
  return {};
}

void Examiner::examine_chunk_records(Bytes records, const Chunk& chunk) {
  chunk_entries_.clear();
  RecordWalker walker(records);
  Record record;
  while (walker.next(record)) {
    const Place place{chunk.offset, record.offset};
    if (is_private(record.opcode)) continue;
    if (!is_known(record.opcode)) {
      deviate(place, fmt::format("a {}, which version 0 doesn't define", name_of(record.opcode)));
      continue;
    }
    if (record.opcode != op::message) tell_fields(record, place, check_layout(record.opcode, record.body));
    Verdict lost;
    if (record.opcode == op::schema) {
      lost = examine_schema(record, place);
    } else if (record.opcode == op::channel) {
      lost = examine_channel(record, place);
    } else if (record.opcode == op::message) {
      const auto head = parse_message_head(record.body);
      chunk_entries_.push_back({head->log_time, record.offset, head->channel});
      examine_message(record, place);
    } else {
      lost = Fault{fmt::format("a {} isn't allowed in a Chunk", name_of(record.opcode))};
    }
    if (lost) fail(place, std::move(lost->message));
  }
  std::uint64_t first = chunk_entries_.empty() ? 0 : ~std::uint64_t{0};
  std::uint64_t last = 0;
  for (const IndexEntry& entry : chunk_entries_) {
    first = std::min(first, entry.log_time);
    last = std::max(last, entry.log_time);
  }
  if (chunk.start_time != first || chunk.end_time != last)
    fail({chunk.offset, {}},
         fmt::format("the Chunk states messages from {} ns to {} ns, but they are from {} ns to {} ns",
                     chunk.start_time, chunk.end_time, first, last));
  std::ranges::stable_sort(chunk_entries_, by_channel);
  std::vector<std::uint16_t> channels;
  for (const IndexEntry& entry : chunk_entries_)
    if (channels.empty() || channels.back() != entry.channel) channels.push_back(entry.channel);
  into_.groups.add_chunk(chunk.compression, channels);
}

void Examiner::examine_message_index(const Record& record) {
  const Place place{record.offset, {}};
  if (!at_chunk_) return fail(place, "a Message Index that doesn't follow a Chunk");
  ExaminedChunk& chunk = chunks_.back();
  ByteReader in(record.body);
  const auto channel = in.get<std::uint16_t>();
  const Bytes entries = in.get_bytes(in.get<std::uint32_t>());
  const bool twice = std::ranges::any_of(chunk.indexes, [&](const auto& known) { return known.first == channel; });
  if (twice)
    fail(place, fmt::format("a second Message Index of channel {} for the Chunk at byte {}", channel, chunk.offset()));
  chunk.indexes.push_back({channel, record.offset});
  chunk.index.indexes_length += bytes_of(record).size();
  if (chunk_is_open_)
    compare_index(record, channel, entries);
  else
    into_.lost_messages[channel] += entries.size() / index_entry_size;
}

/// Compares the entries with the channel's messages in the chunk.
void Examiner::compare_index(const Record& record, std::uint16_t channel, Bytes entries) {
  const auto tell = [&](std::string what) {
    fail({record.offset, {}}, fmt::format("the Message Index of channel {} for the Chunk at byte {} {}", channel,
                                          chunks_.back().offset(), std::move(what)));
  };
  const auto found =
      std::equal_range(chunk_entries_.begin(), chunk_entries_.end(), IndexEntry{0, 0, channel}, by_channel);
  const auto last = found.second;  // a lambda below can't capture a structured binding with clang 14
  std::vector<IndexEntry> stated;
  for (ByteReader in(entries); in.left() > 0;) {
    const auto time = in.get<std::uint64_t>();
    stated.push_back({time, in.get<std::uint64_t>(), channel});
  }
  std::ranges::stable_sort(stated, by_offset);
  auto next = found.first;
  const auto tell_missing = [&](std::uint64_t before) {
    for (; next != last && next->offset < before; ++next)
      tell(fmt::format("lacks the message at byte {} of the Chunk", next->offset));
  };
  for (const IndexEntry& entry : stated) {
    tell_missing(entry.offset);
    if (next == last || next->offset != entry.offset) {
      tell(fmt::format("lists byte {} of the Chunk twice, or no message of that channel is there", entry.offset));
      continue;
    }
    if (next->log_time != entry.log_time)
      tell(
          fmt::format("is wrong: the message at byte {} of the Chunk has the stated time {} ns and the actual time "
                      "{} ns",
                      entry.offset, entry.log_time, next->log_time));
    ++next;
  }
  tell_missing(~std::uint64_t{0});
}

/// Called after the last message index of the chunk: checks that each channel has a message index.
void Examiner::leave_chunk() {
  if (!std::exchange(at_chunk_, false) || !chunk_is_open_) return;
  const ExaminedChunk& chunk = chunks_.back();
  if (chunk.indexes.empty()) return;  // a file without an index
  for (std::size_t i = 0; i < chunk_entries_.size(); ++i) {
    const std::uint16_t channel = chunk_entries_[i].channel;
    if (i > 0 && chunk_entries_[i - 1].channel == channel) continue;
    const bool indexed = std::ranges::any_of(chunk.indexes, [&](const auto& known) { return known.first == channel; });
    if (!indexed)
      fail({chunk.offset(), {}},
           fmt::format("the Chunk has messages of channel {}, but no Message Index for it", channel));
  }
}

}  // namespace rehearse::mcap
