// GrowingFile: a recording that a different process is writing. Internal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "base/file_descriptor.h"

namespace rehearse {

class GrowingFile {
 public:
  explicit GrowingFile(std::filesystem::path file) : file_(std::move(file)) {}

  /// Looks at the file. It counts from the moment at which a Writer has it open: an older file of this name doesn't.
  /// True if it has grown since the last call, or was finished.
  bool look();
  /// It was being written, and is no longer.
  bool is_finished() const { return finished_; }
  /// The file as it is open here, also if another one has taken its name; none: nobody has written it yet.
  std::optional<std::filesystem::path> opened() const;

 private:
  std::filesystem::path file_;
  FileDescriptor descriptor_;
  std::uint64_t inode_ = 0, size_ = 0;  // size [bytes]
  bool finished_ = false;
};

}  // namespace rehearse
