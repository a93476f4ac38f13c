// A complete, indexed MCAP file of many gigabytes that takes little space on the disk: its messages' contents are a
// hole in a sparse file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace rehearse::test {

/// The file has 30 channels; each chunk has a small message of all but the last channel, and a large one of that.
class LargeFile {
 public:
  LargeFile(std::filesystem::path file, std::uint64_t size) : path_(std::move(file)), out_(path_, std::ios::binary) {
    constexpr std::string_view magic("\x89MCAP0\r\n", 8);
    raw(magic);
    record(0x01, text("") + text("a large file"));
    std::string definitions;
    for (std::uint16_t id = 1; id <= channels; ++id) {
      const std::string body = number(id) + number<std::uint16_t>(0) + text("/series/" + two_digits(id)) +
                               text("text") + number<std::uint32_t>(0);
      definitions += head(0x04, body.size()) + body;
    }
    raw(definitions);
    while (at_ < size) chunk();
    record(0x0f, number<std::uint32_t>(0));
    const std::uint64_t summary = at_;
    raw(definitions);
    statistics();
    raw(indexes_);
    record(0x02, number(summary) + number<std::uint64_t>(0) + number<std::uint32_t>(0));
    raw(magic);
  }
  ~LargeFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  LargeFile(const LargeFile&) = delete;
  LargeFile& operator=(const LargeFile&) = delete;

  std::uint64_t size() const { return at_; }
  std::uint64_t messages() const { return chunks_ * channels; }
  bool ok() {
    out_.flush();
    return out_.good();
  }

 private:
  static constexpr std::uint16_t channels = 30;
  static constexpr std::uint64_t hole = 768 * 1024;

  template <class T>
  static std::string number(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
  }
  static std::string two_digits(int value) { return std::to_string(value / 10) + std::to_string(value % 10); }
  static std::string text(std::string_view value) {
    return number(static_cast<std::uint32_t>(value.size())) + std::string(value);
  }
  static std::string head(std::uint8_t opcode, std::uint64_t length) { return number(opcode) + number(length); }
  void raw(std::string_view bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    at_ += bytes.size();
  }
  void record(std::uint8_t opcode, std::string_view body) { raw(head(opcode, body.size()) + std::string(body)); }

  static std::string message(std::uint16_t channel, std::uint64_t time, std::uint64_t size) {
    return head(0x05, 22 + size) + number(channel) + number<std::uint32_t>(0) + number(time) + number(time);
  }

  void chunk() {
    const std::uint64_t time = 1'700'000'000'000'000'000 + chunks_ * 1'000'000'000;
    std::string small;
    std::string places;  // offsets for the index
    for (std::uint16_t id = 1; id < channels; ++id) small += message(id, time, 4) + "tiny";
    const std::uint64_t large = small.size();
    small += message(channels, time, hole);
    const std::uint64_t size = small.size() + hole;
    const std::uint64_t begin = at_;
    raw(head(0x06, 40 + size) + number(time) + number(time) + number(size) + number<std::uint32_t>(0) + text("") +
        number(size) + small);
    out_.seekp(static_cast<std::streamoff>(hole), std::ios::cur);
    at_ += hole;
    const std::uint64_t length = at_ - begin;
    std::string message_indexes;
    for (std::uint16_t id = 1; id <= channels; ++id) {
      places += number(id) + number(at_ + message_indexes.size());
      message_indexes += head(0x07, 22) + number(id) + number<std::uint32_t>(16) + number(time) +
                         number(id == channels ? large : (id - 1u) * (large / (channels - 1)));
    }
    raw(message_indexes);
    const std::string body = number(time) + number(time) + number(begin) + number(length) +
                             number(static_cast<std::uint32_t>(places.size())) + places +
                             number(static_cast<std::uint64_t>(message_indexes.size())) + text("") + number(size) +
                             number(size);
    indexes_ += head(0x08, body.size()) + body;
    ++chunks_;
  }

  void statistics() {
    std::string counts;
    for (std::uint16_t id = 1; id <= channels; ++id) counts += number(id) + number(chunks_);
    const std::uint64_t first = 1'700'000'000'000'000'000;
    record(0x0b, number(messages()) + number<std::uint16_t>(0) + number<std::uint32_t>(channels) +
                     number<std::uint32_t>(0) + number<std::uint32_t>(0) + number(static_cast<std::uint32_t>(chunks_)) +
                     number(first) + number(first + (chunks_ - 1) * 1'000'000'000) + text(counts));
  }

  std::filesystem::path path_;
  std::ofstream out_;
  std::uint64_t at_ = 0;
  std::uint64_t chunks_ = 0;
  std::string indexes_;
};

}  // namespace rehearse::test
