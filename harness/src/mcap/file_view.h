// A file's bytes, mapped. Internal.
#pragma once

#include <rehearse/mcap.h>

namespace rehearse::mcap {

class FileView {
 public:
  /// Maps a file for reading, as large as it is now: what is written behind that meanwhile isn't seen. What can't be
  /// mapped (a pipe, standard input by the name "-") is kept in a nameless temporary file first, to its end; of a
  /// pipe without a name for the life of the process, so that it can be opened again.
  /// Of a file that another program cuts while it is mapped, zeros are read where its bytes are gone (cut_files.h).
  static Result<FileView> open(const std::filesystem::path& file);
  FileView() = default;
  ~FileView();
  FileView(FileView&& other) noexcept;
  FileView& operator=(FileView&& other) noexcept;

  Bytes bytes() const { return bytes_; }
  /// Lets go of the memory that these bytes take here; they come back when they are looked at. Nothing for bytes that
  /// aren't of this file.
  void forget(Bytes part) const;
  const std::string& name() const { return name_; }  // of the file, as messages call it

 private:
  static Result<FileView> map(int descriptor, std::uint64_t size, const std::string& name);

  Bytes bytes_;
  std::string name_;
};

/// Lets go of what a pass from front to back has left behind, so that a large file takes no more memory than a small one.
class PassedBytes {
 public:
  /// Of the view's own bytes; of others nothing is let go.
  PassedBytes(const FileView& view, Bytes bytes) : view_(view), bytes_(bytes) {}
  /// All before that offset is passed.
  void pass(std::uint64_t offset) {
    constexpr std::uint64_t step = std::uint64_t{16} << 20;
    if (offset < forgotten_ + step) return;
    view_.forget(bytes_.subspan(forgotten_, offset - forgotten_));
    forgotten_ = offset;
  }

 private:
  const FileView& view_;
  Bytes bytes_;
  std::uint64_t forgotten_ = 0;
};

}  // namespace rehearse::mcap
