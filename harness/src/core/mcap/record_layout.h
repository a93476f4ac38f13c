// The fields of each kind of record, as in the specification. Internal.
#pragma once

#include "records.h"

#include <string>
#include <string_view>
#include <vector>

namespace rehearse::mcap {

/// True for the kinds of version 0.
constexpr bool is_known(std::uint8_t opcode) { return op::header <= opcode && opcode <= op::data_end; }
/// True for the kinds that the specification reserves for private use.
constexpr bool is_private(std::uint8_t opcode) { return opcode >= 0x80; }

/// "Schema", "Message Index"; for an unknown kind "record of opcode 0x42".
std::string name_of(std::uint8_t opcode);

/// The result of comparing a body with the fields of its kind.
struct LayoutCheck {
  bool whole = false;     // every field is complete, and every length in it fits
  std::size_t extra = 0;  // number of bytes after the last field
  /// Problems of the fields, as "its topic is not UTF-8"; empty unless the body is whole.
  std::vector<std::string> problems;

  /// True if nothing is missing, wrong or left over.
  bool exact() const { return whole && extra == 0 && problems.empty(); }
};

/// Checks a body of a known kind: only lengths, texts and the keys of maps, not the meaning of numbers.
LayoutCheck check_layout(std::uint8_t opcode, Bytes body);

/// True if the bytes are whole records, and all records of known kinds pass.
template <class Passes>
bool has_layout(Bytes records, const Passes& passes) {
  RecordWalker walker(records);
  Record record;
  while (walker.next(record))
    if (is_known(record.opcode) && !passes(check_layout(record.opcode, record.body))) return false;
  return walker.at_end();
}

}  // namespace rehearse::mcap
