// Opens a file by its summary, if that is complete and consistent. Reads nothing else but the header, the first and the
// last chunk, and the records that the summary points to.
#include "reader_impl.h"

#include <algorithm>

namespace rehearse::mcap {

namespace {

/// The contents of a summary.
struct Summary {
  Contents contents;
  std::vector<ChunkIndex> chunks;
  std::vector<RecordPlace> attachments;
  std::vector<RecordPlace> metadata;
  std::uint64_t statistics = 0;  // number of Statistics records
  bool whole = true;
};

void take_in_summary(const Record& record, Summary& summary, DamageLog& damage) {
  const auto keep = [&](auto&& parsed, auto& list) {
    if (parsed) list.push_back(std::move(*parsed));
    summary.whole = summary.whole && parsed;
  };
  switch (record.opcode) {
    case op::chunk_index: return keep(parse_chunk_index(record.body), summary.chunks);
    case op::attachment_index: return keep(parse_record_place(record.body), summary.attachments);
    case op::metadata_index: return keep(parse_record_place(record.body), summary.metadata);
    case op::statistics:
      summary.contents.statistics = parse_statistics(record.body);
      ++summary.statistics;
      return;
    default: summary.contents.learn(record, damage);
  }
}

/// True if the counts are equal to the numbers of indexed records, and no channel is missing.
bool counts_fit(const Summary& summary) {
  if (summary.statistics != 1 || !summary.contents.statistics) return false;
  const Statistics& said = *summary.contents.statistics;
  const auto& channels = summary.contents.channels;
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : said.channel_message_counts) {
    if (!channels.contains(channel)) return false;
    messages += count;
  }
  return summary.contents.has_all_schemas() && messages == said.message_count &&
         channels.size() == said.channel_count && summary.contents.schemas.size() == said.schema_count &&
         summary.chunks.size() == said.chunk_count && summary.attachments.size() == said.attachment_count &&
         summary.metadata.size() == said.metadata_count;
}

/// True if a record of that opcode and length begins at `offset` in the data section.
bool is_record(Bytes data, std::uint64_t offset, std::uint64_t length, std::uint8_t opcode) {
  if (offset < magic.size() || offset > data.size()) return false;
  Record record;
  return RecordWalker(data, offset).next(record) && record.opcode == opcode &&
         record_head + record.body.size() == length;
}

/// True if the stated places of the chunks don't overlap, and the first and the last chunk exist.
bool chunks_fit(std::vector<ChunkIndex>& chunks, Bytes data) {
  const auto earlier = [](const ChunkIndex& a, const ChunkIndex& b) { return a.chunk.offset < b.chunk.offset; };
  std::ranges::stable_sort(chunks, earlier);
  std::uint64_t end = magic.size();
  for (const ChunkIndex& index : chunks) {
    if (index.chunk.offset < end || index.chunk.offset > data.size()) return false;
    const std::uint64_t room = data.size() - index.chunk.offset;
    if (index.length > room || index.indexes_length > room - index.length || index.chunk.stored_size > index.length)
      return false;
    end = index.chunk.offset + index.length + index.indexes_length;
  }
  const auto stands = [&](const ChunkIndex& index) {
    return is_record(data, index.chunk.offset, index.length, op::chunk);
  };
  return chunks.empty() || (stands(chunks.front()) && stands(chunks.back()));
}

}  // namespace

/// Offset of the summary, if Footer, DataEnd and the last bytes of the file are right.
std::optional<std::uint64_t> Reader::Impl::find_summary() const {
  constexpr std::size_t data_end_size = record_head + 4;
  std::uint64_t footer_at = 0;
  const auto footer = find_footer(bytes_, footer_at);
  if (!footer || footer->summary_start < magic.size() + data_end_size || footer->summary_start >= footer_at)
    return std::nullopt;
  if (!is_record(bytes_, footer->summary_start - data_end_size, data_end_size, op::data_end)) return std::nullopt;
  if (!options_.check_crcs || footer->summary_crc == 0) return footer->summary_start;
  std::uint32_t crc = 0;
  constexpr std::size_t step = std::size_t{1} << 20;
  for (Bytes left = bytes_.subspan(footer->summary_start, footer_at + footer_covered - footer->summary_start);
       !left.empty();) {
    const Bytes piece = left.first(std::min(step, left.size()));
    crc = crc32(piece, crc);
    file_.forget(piece);
    left = left.subspan(piece.size());
  }
  return crc == footer->summary_crc ? std::optional(footer->summary_start) : std::nullopt;
}

/// False: a walk is necessary, and nothing was read from the summary.
bool Reader::Impl::open_by_summary() {
  const auto start = find_summary();
  if (!start) return false;
  DamageLog damage(name_);
  Summary summary;
  const Bytes data = bytes_.first(*start);
  Record record;
  if (!RecordWalker(data, magic.size()).next(record) || record.opcode != op::header) return false;
  summary.contents.learn_header(record, damage);

  RecordWalker walker(bytes_.first(bytes_.size() - footer_size - magic.size()), *start);
  std::uint64_t forgotten = *start;
  while (walker.next(record)) {
    take_in_summary(record, summary, damage);
    constexpr std::uint64_t step = std::uint64_t{1} << 20;
    if (walker.offset() - forgotten < step) continue;
    file_.forget(bytes_.subspan(forgotten, walker.offset() - forgotten));
    forgotten = walker.offset();
  }
  if (!walker.at_end() || !summary.whole || !counts_fit(summary) || !chunks_fit(summary.chunks, data)) return false;

  std::vector<Attachment> attachments;
  for (const RecordPlace& place : summary.attachments) {
    if (!is_record(data, place.offset, place.length, op::attachment)) return false;
    RecordWalker(data, place.offset).next(record);
    // The CRC isn't checked, because this would read the whole attachment.
    if (auto attachment = read_attachment(record, false, damage)) attachments.push_back(std::move(*attachment));
  }
  std::vector<Metadata> metadata;
  for (const RecordPlace& place : summary.metadata) {
    if (!is_record(data, place.offset, place.length, op::metadata)) return false;
    RecordWalker(data, place.offset).next(record);
    if (auto values = read_metadata(record, damage)) metadata.push_back(std::move(*values));
  }
  if (!damage.list().empty()) return false;

  contents_ = std::move(summary.contents);
  attachments_ = std::move(attachments);
  metadata_ = std::move(metadata);
  for (ChunkIndex& index : summary.chunks) chunks_.push_back(std::move(index.chunk));
  return true;
}

}  // namespace rehearse::mcap
