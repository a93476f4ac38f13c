// Where a Writer's bytes go. Internal.
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
  /// All of the bytes, or why not. The diagnostic names no file.
  virtual Result<void> write(Bytes bytes) = 0;
  /// Nothing is written after it; a second call does nothing.
  virtual Result<void> close() = 0;
  /// Whether what was written can be had again before close().
  virtual bool readable() const { return false; }
  /// Fills `target` with what was written from that offset on. Fails if there isn't so much.
  virtual Result<void> read_back(std::uint64_t offset, std::span<std::byte> target);
  /// Of an open file; -1 if there is none.
  virtual int descriptor() const { return -1; }
};

/// A file, created or emptied. One that is only ours is replaced by a new one with the same permissions: who has the
/// old one open keeps it as it was. Through links, and into pipes and devices, is written as they are.
Result<std::unique_ptr<Sink>> open_file_sink(const std::filesystem::path& file);

std::unique_ptr<Sink> make_memory_sink(std::vector<std::byte>& out);

}  // namespace rehearse::mcap
