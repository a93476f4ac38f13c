#include "frame.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse::mcap {

bool begins_with_magic(Bytes bytes) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

std::string describe_start(Bytes start) {
  constexpr std::size_t version_at = 5;
  if (start.empty()) return "not an MCAP file: it is empty";
  const std::size_t seen = std::min(start.size(), magic.size());
  if (start.size() < magic.size() && std::equal(start.begin(), start.end(), magic.begin())) {
    return fmt::format("truncated at byte {}: not even the magic bytes of MCAP are whole", seen);
  }
  if (seen == magic.size() && std::equal(magic.begin(), magic.begin() + version_at, start.begin())) {
    return "an MCAP file of a version that this reader doesn't know, or damaged in its first eight bytes";
  }
  return "not an MCAP file: it doesn't begin with the magic bytes \\x89MCAP0\\r\\n";
}

std::string describe_cut(const CutPlace& cut) {
  if (cut.ends_with_magic) {
    return fmt::format("damaged at byte {}: what begins there is no record that fits into the file", cut.record);
  }
  if (cut.record < cut.size && cut.zeros_only) {
    return fmt::format("truncated at byte {}: from there on the file holds zeros only", cut.record);
  }
  return fmt::format("truncated at byte {}: the record that begins at byte {} isn't whole", cut.size, cut.record);
}

bool is_all_zero(Bytes bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

std::optional<std::uint32_t> read_data_end(const Record& record, DamageLog& damage) {
  ByteReader in(record.body);
  const auto crc = in.get<std::uint32_t>();
  if (!in.ok() || in.left() != 0) {
    damage.add(fmt::format("damaged: the DataEnd record at byte {} hasn't its length of 4", record.offset));
    return std::nullopt;
  }
  return crc == 0 ? std::nullopt : std::optional(crc);
}

std::optional<Footer> read_footer(const Record& record, std::uint64_t summary_start, DamageLog& damage) {
  const auto footer = parse_footer(record.body);
  const bool no_summary = summary_start == record.offset;
  const std::uint64_t expected = no_summary ? 0 : summary_start;
  if (!footer) {
    damage.add(fmt::format("damaged: the Footer at byte {} hasn't its length of 20", record.offset));
    return std::nullopt;
  }
  if (footer->summary_start != expected && !(no_summary && footer->summary_start == record.offset)) {
    damage.add(fmt::format("damaged: the Footer at byte {} says that the summary begins at byte {}, it does at byte {}",
                           record.offset, footer->summary_start, expected));
    return std::nullopt;
  }
  return footer;
}

void check_tail(Bytes tail, std::uint64_t offset, DamageLog& damage) {
  if (tail.size() < magic.size()) {
    damage.add(fmt::format("truncated at byte {}: the magic bytes at the end aren't whole", offset + tail.size()));
  } else if (tail.size() > magic.size() || !begins_with_magic(tail)) {
    damage.add(fmt::format("damaged at byte {}: the file doesn't end with its magic bytes there", offset));
  }
}

}  // namespace rehearse::mcap
