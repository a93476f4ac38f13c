// Composes the bytes of MCAP records, in forms that the Writer never produces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <rehearse/mcap.h>

namespace rehearse::test {

using Buffer = std::vector<std::byte>;

inline mcap::Bytes bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

/// Composes records by hand.
class Composer {
 public:
  template <class T>
  Composer& put(T value) {
    const auto* place = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), place, place + sizeof(T));
    return *this;
  }
  Composer& text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    return raw(bytes_of(text));
  }
  Composer& raw(mcap::Bytes more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return *this;
  }
  Composer& magic() { return raw(bytes_of(std::string_view("\x89MCAP0\r\n", 8))); }
  Composer& record(std::uint8_t opcode, const Composer& body) {
    put(opcode).put(static_cast<std::uint64_t>(body.bytes.size()));
    return raw(body.bytes);
  }

  Composer& header() { return record(0x01, Composer().text("").text("by hand")); }
  Composer& channel(std::uint16_t id, std::string_view topic) {
    return record(0x04, Composer().put(id).put(std::uint16_t{0}).text(topic).text("text").put(std::uint32_t{0}));
  }
  Composer& message(std::uint16_t channel, std::uint64_t log_time, std::string_view data) {
    return record(0x05, Composer().put(channel).put(std::uint32_t{0}).put(log_time).put(log_time).raw(bytes_of(data)));
  }
  Composer& chunk(std::uint64_t start, std::uint64_t end, const Composer& records, std::string_view compression = "",
                  std::optional<std::uint64_t> said_size = {}, std::uint32_t crc = 0) {
    return record(0x06, Composer()
                            .put(start)
                            .put(end)
                            .put(said_size.value_or(records.bytes.size()))
                            .put(crc)
                            .text(compression)
                            .put(static_cast<std::uint64_t>(records.bytes.size()))
                            .raw(records.bytes));
  }
  /// DataEnd without CRC, Footer without summary, magic.
  Composer& end() {
    record(0x0f, Composer().put(std::uint32_t{0}));
    return footer();
  }
  Composer& footer() {
    record(0x02, Composer().put(std::uint64_t{0}).put(std::uint64_t{0}).put(std::uint32_t{0}));
    return magic();
  }

  Buffer bytes;
};

}  // namespace rehearse::test
