// The fields of each kind of record, as the specification has them. Internal.
#pragma once

#include "records.h"

#include <string>
#include <string_view>
#include <vector>

namespace rehearse::mcap {

/// True for the kinds of version 0.
constexpr bool is_known(std::uint8_t opcode) { return op::header <= opcode && opcode <= op::data_end; }
/// True for those that the specification leaves to everybody.
constexpr bool is_private(std::uint8_t opcode) { return opcode >= 0x80; }

/// "Schema", "Message Index"; of an unknown one "record of opcode 0x42".
std::string name_of(std::uint8_t opcode);

/// How a body fits the fields of its kind.
struct LayoutCheck {
  bool whole = false;                 // every field is there, and every length in it fits
  std::size_t extra = 0;              // behind the last field [bytes]
  std::vector<std::string> problems;  // of what is there: "its topic is not UTF-8"; none unless it is whole

  /// Nothing is missing, wrong or left over.
  bool exact() const { return whole && extra == 0 && problems.empty(); }
};

/// Of a known kind. Looks at no number's meaning, only at lengths, texts and the keys of maps.
LayoutCheck check_layout(std::uint8_t opcode, Bytes body);

/// True if the bytes come to whole records, and all of known kinds pass.
template <class Passes>
bool has_layout(Bytes records, const Passes& passes) {
  RecordWalker walker(records);
  Record record;
  while (walker.next(record))
    if (is_known(record.opcode) && !passes(check_layout(record.opcode, record.body))) return false;
  return walker.at_end();
}

}  // namespace rehearse::mcap
