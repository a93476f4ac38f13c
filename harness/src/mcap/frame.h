// What holds a file together: its magic bytes, DataEnd and Footer; and what is said if one of them isn't right. The
// same for a mapped file and for a stream. Internal.
#pragma once

#include "damage_log.h"
#include "records.h"

namespace rehearse::mcap {

bool begins_with_magic(Bytes bytes);

/// Why a file that begins so isn't read.
std::string describe_start(Bytes start);

/// Where the records end before DataEnd and Footer came.
struct CutPlace {
  std::uint64_t record = 0;      // offset of what is no whole record
  std::uint64_t size = 0;        // of the file
  bool ends_with_magic = false;  // the file does
  bool zeros_only = false;       // from `record` on
};
std::string describe_cut(const CutPlace& cut);

bool is_all_zero(Bytes bytes);

/// The CRC that a DataEnd states, if it states one.
std::optional<std::uint32_t> read_data_end(const Record& record, DamageLog& damage);

/// The Footer, if it says that the summary begins at `summary_start`, where it does.
std::optional<Footer> read_footer(const Record& record, std::uint64_t summary_start, DamageLog& damage);

/// Before the Footer's CRC, which covers all of the summary up to there [bytes of the record].
inline constexpr std::size_t footer_covered = record_head + 16;

/// Looks at what follows the Footer: `tail` begins at byte `offset`, and one byte more than the magic's is enough.
void check_tail(Bytes tail, std::uint64_t offset, DamageLog& damage);

}  // namespace rehearse::mcap
