// A file's bytes, mapped. Internal.
#pragma once

#include <rehearse/mcap.h>

namespace rehearse::mcap {

class FileView {
 public:
  /// Maps a regular file for reading. A file that shrinks while it is mapped is beyond help.
  static Result<FileView> open(const std::filesystem::path& file);
  FileView() = default;
  ~FileView();
  FileView(FileView&& other) noexcept;
  FileView& operator=(FileView&& other) noexcept;

  Bytes bytes() const { return bytes_; }

 private:
  explicit FileView(Bytes bytes) : bytes_(bytes) {}
  Bytes bytes_;
};

}  // namespace rehearse::mcap
