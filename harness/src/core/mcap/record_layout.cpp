#include "record_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>

#include "base/text.h"

namespace rehearse::mcap {
namespace {

enum class Kind {
  number,      // `width` bytes
  text,        // text after a length of four bytes
  bytes,       // bytes after a length of four bytes
  long_bytes,  // bytes after a length of eight bytes
  text_map,    // map of texts, after a length of four bytes
  array,       // array of elements of `width` bytes, after a length of four bytes
  rest,        // all remaining bytes
};

struct Field {
  Kind kind = Kind::number;
  std::size_t width = 0;  // [bytes]
  const char* name = "";
};

constexpr Field u8{Kind::number, 1}, u16{Kind::number, 2}, u32{Kind::number, 4}, u64{Kind::number, 8};

constexpr Field header[] = {{Kind::text, 0, "profile"}, {Kind::text, 0, "library"}};
constexpr Field footer[] = {u64, u64, u32};
constexpr Field schema[] = {u16, {Kind::text, 0, "name"}, {Kind::text, 0, "encoding"}, {Kind::bytes, 0, "data"}};
constexpr Field channel[] = {
    u16, u16, {Kind::text, 0, "topic"}, {Kind::text, 0, "message encoding"}, {Kind::text_map, 0, "metadata"}};
constexpr Field message[] = {u16, u32, u64, u64, {Kind::rest, 0, "data"}};
constexpr Field chunk[] = {u64, u64, u64, u32, {Kind::text, 0, "compression"}, {Kind::long_bytes, 0, "records"}};
constexpr Field message_index[] = {u16, {Kind::array, index_entry_size, "records"}};
constexpr Field chunk_index[] = {
    u64, u64, u64, u64, {Kind::array, 10, "message index offsets"}, u64, {Kind::text, 0, "compression"}, u64, u64};
constexpr Field attachment[] = {
    u64, u64, {Kind::text, 0, "name"}, {Kind::text, 0, "media type"}, {Kind::long_bytes, 0, "data"}, u32};
constexpr Field attachment_index[] = {u64, u64, u64, u64, u64, {Kind::text, 0, "name"}, {Kind::text, 0, "media type"}};
constexpr Field statistics[] = {u64, u16, u32, u32, u32, u32, u64, u64, {Kind::array, 10, "channel message counts"}};
constexpr Field metadata[] = {{Kind::text, 0, "name"}, {Kind::text_map, 0, "metadata"}};
constexpr Field metadata_index[] = {u64, u64, {Kind::text, 0, "name"}};
constexpr Field summary_offset[] = {u8, u64, u64};
constexpr Field data_end[] = {u32};

struct Type {
  const char* name;
  std::span<const Field> fields;
};

constexpr Type types[] = {
    {"Header", header},
    {"Footer", footer},
    {"Schema", schema},
    {"Channel", channel},
    {"Message", message},
    {"Chunk", chunk},
    {"Message Index", message_index},
    {"Chunk Index", chunk_index},
    {"Attachment", attachment},
    {"Attachment Index", attachment_index},
    {"Statistics", statistics},
    {"Metadata", metadata},
    {"Metadata Index", metadata_index},
    {"Summary Offset", summary_offset},
    {"Data End", data_end},
};

void check_text(std::string_view text, std::string_view what, std::vector<std::string>& problems) {
  if (!is_utf8(text)) problems.push_back(fmt::format("its {} {} is not UTF-8", what, in_quotes(text)));
}

/// False if an entry doesn't fit into the map.
bool check_map(Bytes map, const Field& field, std::vector<std::string>& problems) {
  ByteReader in(map);
  std::vector<std::string_view> keys;
  while (in.left() > 0) {
    const std::string_view key = as_text(in.get_bytes(in.get<std::uint32_t>()));
    const std::string_view value = as_text(in.get_bytes(in.get<std::uint32_t>()));
    if (!in.ok()) return false;
    check_text(key, std::string(field.name) + " key", problems);
    check_text(value, fmt::format("{} of the key {}", field.name, in_quotes(key)), problems);
    keys.push_back(key);
  }
  std::ranges::sort(keys);
  const auto twice = std::ranges::adjacent_find(keys);
  if (twice != keys.end())
    problems.push_back(fmt::format("its {} has the key {} more than once", field.name, in_quotes(*twice)));
  return true;
}

/// False if the field is incomplete.
bool check_field(ByteReader& in, const Field& field, std::vector<std::string>& problems) {
  switch (field.kind) {
    case Kind::number: in.get_bytes(field.width); break;
    case Kind::text: check_text(as_text(in.get_bytes(in.get<std::uint32_t>())), field.name, problems); break;
    case Kind::bytes: in.get_bytes(in.get<std::uint32_t>()); break;
    case Kind::long_bytes: in.get_bytes(in.get<std::uint64_t>()); break;
    case Kind::text_map: return check_map(in.get_bytes(in.get<std::uint32_t>()), field, problems) && in.ok();
    case Kind::array: return in.get_bytes(in.get<std::uint32_t>()).size() % field.width == 0 && in.ok();
    case Kind::rest: in.get_bytes(in.left()); break;
  }
  return in.ok();
}

}  // namespace

std::string name_of(std::uint8_t opcode) {
  return is_known(opcode) ? types[opcode - 1].name : fmt::format("record of opcode {:#04x}", opcode);
}

LayoutCheck check_layout(std::uint8_t opcode, Bytes body) {
  REHEARSE_ASSERT(is_known(opcode), "only these have a layout");
  LayoutCheck check;
  ByteReader in(body);
  for (const Field& field : types[opcode - 1].fields) {
    if (check_field(in, field, check.problems)) continue;
    check.problems.clear();
    return check;
  }
  check.whole = true;
  check.extra = in.left();
  return check;
}

}  // namespace rehearse::mcap
