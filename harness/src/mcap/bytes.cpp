#include "bytes.h"

namespace rehearse::mcap {

void ByteWriter::put_string(std::string_view text) {
  put(static_cast<std::uint32_t>(text.size()));
  put_bytes(as_bytes(text));
}

void ByteWriter::put_map(const std::map<std::string, std::string>& map) {
  const std::size_t length_at = size();
  put(std::uint32_t{0});
  for (const auto& [key, value] : map) {
    put_string(key);
    put_string(value);
  }
  patch(length_at, static_cast<std::uint32_t>(size() - length_at - 4));
}

void ByteWriter::begin_record(std::uint8_t opcode) {
  record_ = size();
  put(opcode);
  put(std::uint64_t{0});
}

void ByteWriter::end_record() { patch(record_ + 1, static_cast<std::uint64_t>(size() - record_ - 9)); }

std::span<const std::byte> ByteReader::get_bytes(std::uint64_t count) {
  if (count > bytes_.size()) {
    ok_ = false;
    bytes_ = {};
    return {};
  }
  const auto taken = bytes_.first(count);
  bytes_ = bytes_.subspan(count);
  return taken;
}

std::string ByteReader::get_string() { return std::string(as_text(get_bytes(get<std::uint32_t>()))); }

std::map<std::string, std::string> ByteReader::get_map() {
  ByteReader entries(get_bytes(get<std::uint32_t>()));
  std::map<std::string, std::string> map;
  while (entries.left() > 0) {
    std::string key = entries.get_string();
    std::string value = entries.get_string();
    if (!entries.ok()) break;
    map.insert_or_assign(std::move(key), std::move(value));
  }
  ok_ = ok_ && entries.ok();
  return map;
}

}  // namespace rehearse::mcap
