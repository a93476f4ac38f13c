// The destination of a Writer's bytes. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rehearse::mcap {

class Sink {
 public:
  virtual ~Sink() = default;
  /// Writes all of the bytes, or fails. The diagnostic names no file.
  virtual Result<void> write(Bytes bytes) = 0;
  /// No write may follow; a second call has no effect.
  virtual Result<void> close() = 0;
  /// Whether written bytes can be read again before close().
  virtual bool readable() const { return false; }
  /// Fills `target` with the written bytes from that offset on. Fails if there are fewer.
  virtual Result<void> read_back(std::uint64_t offset, std::span<std::byte> target);
  /// Compares the file with the written bytes. Fails if something else has written into it, cut, deleted or replaced
  /// it.
  virtual Result<void> verify() { return {}; }
  /// Descriptor of an open file; -1 if there is none.
  virtual int descriptor() const { return -1; }
};

/// A file, created or emptied. A file with one name that belongs to this user is replaced by a new file with the same
/// permissions. So readers keep the old contents. Links, pipes and devices are written into.
Result<std::unique_ptr<Sink>> open_file_sink(const std::filesystem::path& file);

std::unique_ptr<Sink> make_memory_sink(std::vector<std::byte>& out);

}  // namespace rehearse::mcap
