#include "copy.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "codec.h"
#include "file_view.h"
#include "reader_impl.h"
#include "summary.h"

namespace rehearse::mcap {
namespace {

/// The place where a file is cut.
struct Cut {
  std::uint64_t kept_end = 0;  // end of the kept part of the data section [bytes]
  std::uint32_t left_out = 0;  // number of the omitted metadata records after it
  std::uint64_t data_end = 0;  // offset of DataEnd
  std::uint32_t data_crc = 0;  // CRC that DataEnd states; 0: none
  std::uint64_t summary_start = 0;
};

/// `bytes` must be a whole file.
Cut cut_before(Bytes bytes, std::string_view replaced) {
  Cut cut;
  RecordWalker walker(bytes, magic.size());
  Record record;
  cut.kept_end = walker.offset();
  while (walker.next(record) && record.opcode != op::data_end && record.opcode != op::footer) {
    const auto metadata = record.opcode == op::metadata ? parse_metadata(record.body) : std::nullopt;
    if (metadata && metadata->name.starts_with(replaced)) {
      ++cut.left_out;
    } else {
      cut.kept_end = walker.offset();
      cut.left_out = 0;
    }
  }
  cut.data_end = record.offset;
  cut.summary_start = record.opcode == op::data_end ? walker.offset() : record.offset;
  if (record.opcode == op::data_end) cut.data_crc = ByteReader(record.body).get<std::uint32_t>();
  return cut;
}

/// The records of a summary with one opcode.
struct Group {
  std::uint8_t opcode = 0;
  std::vector<std::byte> records;
};

std::vector<std::byte>& group_of(std::vector<Group>& groups, std::uint8_t opcode) {
  for (Group& group : groups)
    if (group.opcode == opcode) return group.records;
  groups.push_back({opcode, {}});
  return groups.back().records;
}

/// The source's groups, without the entries of the omitted records. `added`: number of the records that replace them.
std::vector<Group> summary_of(Bytes bytes, const Cut& cut, std::size_t added) {
  std::vector<Group> groups;
  RecordWalker walker(bytes, cut.summary_start);
  Record record;
  while (walker.next(record) && record.opcode != op::footer) {
    if (record.opcode == op::summary_offset) continue;
    if (record.opcode == op::metadata_index && ByteReader(record.body).get<std::uint64_t>() >= cut.kept_end) continue;
    ByteWriter out(group_of(groups, record.opcode));
    auto statistics = record.opcode == op::statistics ? parse_statistics(record.body) : std::nullopt;
    if (statistics) {
      statistics->metadata_count += static_cast<std::uint32_t>(added) - cut.left_out;
      put_statistics(out, *statistics);
    } else {
      out.put_bytes(bytes.subspan(record.offset, record_head + record.body.size()));
    }
  }
  return groups;
}

Result<void> write_file(const std::filesystem::path& file, std::initializer_list<Bytes> parts) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  for (const Bytes part : parts)
    stream.write(reinterpret_cast<const char*>(part.data()), static_cast<std::streamsize>(part.size()));
  stream.close();
  if (!stream) return error_in(file.string(), fmt::format("can't be written: {}", std::strerror(errno)));
  return {};
}

}  // namespace

Result<void> copy_with_metadata(const std::filesystem::path& source, const std::filesystem::path& target,
                                std::string_view replaced, const std::vector<Metadata>& added) {
  const auto view = REHEARSE_TRY(FileView::open(source));
  const Bytes bytes = view.bytes();
  const auto reader = REHEARSE_TRY(Reader::open_bytes(bytes, source.string()));
  if (!reader->damage().empty()) return reader->damage();
  const Cut cut = cut_before(bytes, replaced);
  if (cut.data_crc != 0 && cut.data_crc != crc32(bytes.first(cut.data_end)))
    return error_in(source.string(), "damaged: the CRC of the data section doesn't match");
  std::vector<Group> groups = summary_of(bytes, cut, added.size());
  if (groups.empty()) return error_in(source.string(), "it has no summary, so nothing can be added to it");

  std::vector<std::byte> records;
  ByteWriter out(records);
  for (const Metadata& metadata : added) {
    const std::size_t begin = records.size();
    put_metadata(out, metadata.name, metadata.values);
    ByteWriter index(group_of(groups, op::metadata_index));
    put_metadata_index(index, cut.kept_end + begin, records.size() - begin, metadata.name);
  }
  const Bytes kept = bytes.first(cut.kept_end);
  std::vector<std::byte> end;
  SummaryComposer summary(kept.size() + records.size(), crc32(records, crc32(kept)),
                          [&](Bytes more) { end.insert(end.end(), more.begin(), more.end()); });
  for (const Group& group : groups) summary.add_group(group.opcode, group.records);
  summary.finish();
  return write_file(target, {kept, records, end});
}

}  // namespace rehearse::mcap
