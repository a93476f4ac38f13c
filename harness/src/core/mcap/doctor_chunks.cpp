#include <fmt/format.h>

#include <algorithm>

#include "doctor_impl.h"
#include "model/text.h"
#include "record_layout.h"

namespace rehearse::mcap {

namespace {

bool by_offset(const IndexEntry& a, const IndexEntry& b) { return a.offset < b.offset; }

/// The entries of one channel.
std::span<const IndexEntry> entries_of(const std::vector<IndexEntry>& all, std::uint16_t channel) {
  const auto [first, last] =
      std::equal_range(all.begin(), all.end(), IndexEntry{0, 0, channel},
                       [](const IndexEntry& a, const IndexEntry& b) { return a.channel < b.channel; });
  return {first, last};
}

}  // namespace

void Doctor::examine_chunk(const Record& record) {
  using Fault = OpenedChunk::Fault;
  const Place place{record.offset, {}};
  const OpenedChunk opened = opener_.open(record, buffer_);
  REHEARSE_ASSERT(opened.fault != Fault::too_short, "its fields are whole");
  const ChunkHead& head = opened.head;
  ExaminedChunk& chunk = chunks_.emplace_back();
  chunk.index.chunk = {record.offset,       head.start_time,       head.end_time, std::string(head.compression),
                       head.records.size(), head.uncompressed_size};
  chunk.index.length = bytes_of(record).size();
  at_chunk_ = true;
  chunk_is_open_ = opened.ok();
  chunk_entries_.clear();
  damaged_ = damaged_ || !opened.ok();
  if (head.start_time > head.end_time)
    fail(place,
         fmt::format("the Chunk states an end before its start: from {} ns to {} ns", head.start_time, head.end_time));
  if (opened.fault == Fault::too_large)
    fail(place, fmt::format("the Chunk states {} bytes decompressed, more than the limit of {}", head.uncompressed_size,
                            options_.max_chunk_size));
  if (opened.fault == Fault::not_decompressed)
    fail(place, fmt::format("the Chunk can't be decompressed: {}", opened.reason));
  if (opened.fault == Fault::wrong_crc) fail(place, "the CRC of the Chunk doesn't match");
  if (opened.ok()) examine_chunk_records(opened.records, chunk.index.chunk);
}

void Doctor::examine_chunk_records(Bytes records, const Chunk& chunk) {
  RecordWalker walker(records);
  Record record;
  while (walker.next(record)) {
    const Place place{chunk.offset, record.offset};
    if (!is_known(record.opcode)) {
      if (!is_private(record.opcode))
        add(Severity::note, place, fmt::format("a {}, which version 0 doesn't define", name_of(record.opcode)));
      continue;
    }
    if (record.opcode != op::schema && record.opcode != op::channel && record.opcode != op::message) {
      fail(place, fmt::format("a {} isn't allowed in a Chunk", name_of(record.opcode)));
      continue;
    }
    if (!check_fields(record, place)) continue;
    if (record.opcode == op::schema) examine_schema(record, place);
    if (record.opcode == op::channel) examine_channel(record, place);
    if (record.opcode != op::message) continue;
    const auto head = parse_message_head(record.body);
    chunk_entries_.push_back({head->log_time, record.offset, head->channel});
    examine_message(record, place);
  }
  if (!walker.at_end()) {
    fail({chunk.offset, walker.offset()}, "the records of the Chunk aren't whole from there on");
    damaged_ = true;
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
  std::stable_sort(chunk_entries_.begin(), chunk_entries_.end(),
                   [](const IndexEntry& a, const IndexEntry& b) { return a.channel < b.channel; });
}

void Doctor::examine_message_index(const Record& record) {
  const Place place{record.offset, {}};
  if (!at_chunk_) return fail(place, "a Message Index that doesn't follow a Chunk");
  ExaminedChunk& chunk = chunks_.back();
  ByteReader in(record.body);
  const auto channel = in.get<std::uint16_t>();
  const Bytes entries = in.get_bytes(in.get<std::uint32_t>());
  const bool twice = std::any_of(chunk.indexes.begin(), chunk.indexes.end(),
                                 [&](const auto& known) { return known.first == channel; });
  if (twice)
    fail(place, fmt::format("a second Message Index of channel {} for the Chunk at byte {}", channel, chunk.offset()));
  chunk.indexes.push_back({channel, record.offset});
  chunk.index.indexes_length += bytes_of(record).size();
  if (chunk_is_open_) compare_index(record, channel, entries);
}

/// Compares the entries with the channel's messages in the chunk.
void Doctor::compare_index(const Record& record, std::uint16_t channel, Bytes entries) {
  const Place place{record.offset, {}};
  const std::string name =
      fmt::format("the Message Index of channel {} for the Chunk at byte {}", channel, chunks_.back().offset());
  const auto there = entries_of(chunk_entries_, channel);
  if (there.empty() && entries.empty()) {
    if (!channels_.contains(channel)) return fail(place, fmt::format("{}: the channel isn't defined", name));
    return add(Severity::note, place, fmt::format("{} is empty, and therefore unnecessary", name));
  }
  std::vector<IndexEntry> stated;
  for (ByteReader in(entries); in.left() > 0;) {
    const auto time = in.get<std::uint64_t>();
    stated.push_back({time, in.get<std::uint64_t>(), channel});
  }
  std::stable_sort(stated.begin(), stated.end(), by_offset);
  auto next = there.begin();
  for (const IndexEntry& entry : stated) {
    while (next != there.end() && next->offset < entry.offset) {
      fail(place, fmt::format("{} lacks the message at byte {} of the Chunk", name, next->offset));
      ++next;
    }
    if (next == there.end() || next->offset != entry.offset) {
      fail(place, fmt::format("{} lists byte {} of the Chunk twice, or no message of that channel is there", name,
                              entry.offset));
      continue;
    }
    if (next->log_time != entry.log_time)
      fail(place,
           fmt::format("{}: the message at byte {} of the Chunk has the stated time {} ns and the actual time {} ns",
                       name, entry.offset, entry.log_time, next->log_time));
    ++next;
  }
  for (; next != there.end(); ++next)
    fail(place, fmt::format("{} lacks the message at byte {} of the Chunk", name, next->offset));
}

/// Called after the last message index of the chunk: checks that each channel has a message index.
void Doctor::leave_chunk() {
  if (!std::exchange(at_chunk_, false) || !chunk_is_open_) return;
  const ExaminedChunk& chunk = chunks_.back();
  if (chunk.indexes.empty()) return;  // a file without an index
  for (std::size_t i = 0; i < chunk_entries_.size(); ++i) {
    const std::uint16_t channel = chunk_entries_[i].channel;
    if (i > 0 && chunk_entries_[i - 1].channel == channel) continue;
    const bool indexed = std::any_of(chunk.indexes.begin(), chunk.indexes.end(),
                                     [&](const auto& known) { return known.first == channel; });
    if (!indexed)
      fail({chunk.offset(), {}},
           fmt::format("the Chunk has messages of channel {}, but no Message Index for it", channel));
  }
}

}  // namespace rehearse::mcap
