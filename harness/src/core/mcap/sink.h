// The destination of a Writer's bytes. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

namespace rehearse::mcap {

/// The error of write() that code of another one in the process can cause.
inline constexpr std::string_view closed_by_others =
    "the trace can't be written any further: something in this process has closed its file descriptor";

/// A file, created or emptied. A file with one name that belongs to this user is replaced by a new file with the same
/// permissions. So readers keep the old contents. Links, pipes and devices are written into.
class Sink {
 public:
  static Result<std::unique_ptr<Sink>> open(const std::filesystem::path& file);
  ~Sink() { static_cast<void>(close()); }
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;

  /// Writes all of the bytes, or fails. The diagnostic names no file.
  Result<void> write(Bytes bytes);
  /// No write may follow; a second call has no effect.
  Result<void> close();
  /// Whether written bytes can be read again before close(): an ordinary file.
  bool readable() const { return readable_; }
  /// Fills `target` with the written bytes from that offset on. Fails if there are fewer.
  Result<void> read_back(std::uint64_t offset, std::span<std::byte> target);
  /// Compares the file with the written bytes. Fails if something else has written into it, cut, deleted or replaced
  /// it.
  Result<void> verify();
  /// Descriptor of the open file; -1 after close().
  int descriptor() const { return file_; }

 private:
  Sink(int file, std::filesystem::path place);
  /// False if the program has closed this descriptor, and its number belongs to a different file.
  bool is_our_file() const;

  int file_;
  const std::filesystem::path place_;
  const bool readable_;
  std::pair<std::uint64_t, std::uint64_t> identity_;
  std::uint64_t size_ = 0;  // of the written bytes
  std::uint32_t crc_ = 0;
};

}  // namespace rehearse::mcap
