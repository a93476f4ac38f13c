// Opens files, pipes and standard input by name; maps the bytes of a file. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <functional>
#include <memory>
#include <utility>

#include "base/file_descriptor.h"
#include "container.h"

namespace rehearse::mcap {

/// An open descriptor for reading.
class Input {
 public:
  /// "-" is standard input. A directory, a device and a socket's file are refused.
  static Result<Input> open(const std::filesystem::path& file);

  const std::string& name() const { return name_; }  // its name in messages
  int descriptor() const { return descriptor_; }

  /// Size of a file that can be mapped from its beginning [bytes]; 0 for all others: pipes, sockets, empty files and
  /// files without real size.
  std::uint64_t mappable_size() const { return size_; }

  /// The number of a pipe that has no name in a folder: its data can't be read again. nullopt for all others.
  const std::optional<std::uint64_t>& only_once() const { return only_once_; }

  /// Fills the front of `target`; waits at most for the first byte. Returns the number of bytes; 0 is the end.
  Result<std::size_t> read(std::span<std::byte> target);

 private:
  Input(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {}
  Result<void> look();
  Diagnostic unreadable(std::string_view why, std::string hint = {}) const;

  FileDescriptor descriptor_;
  std::string name_;
  std::uint64_t size_ = 0;
  std::optional<std::uint64_t> only_once_;
};

class FileView {
 public:
  /// Maps a file for reading, in its present size: data that is appended later isn't seen. Every verb opens logs here:
  /// one that isn't an MCAP file is converted first, if the program has a reader of its container (container.h). Input
  /// that can't be mapped (a pipe, standard input by the name "-") is first stored to its end in a nameless temporary
  /// file. For a pipe without a name this file is kept for the life of the process, so that it can be opened again. If
  /// a different program truncates a mapped file, the missing bytes are read as zeros.
  static Result<FileView> open(const std::filesystem::path& file);

  Bytes bytes() const { return bytes_; }
  /// Releases the memory of these bytes; they are loaded again when they are read. No effect on bytes of other files.
  void forget(Bytes part) const;
  const std::string& name() const { return name_; }  // name of the file in messages

  /// The log that was converted to these bytes; null: the bytes are the file's own.
  const Converted* converted() const { return converted_.get(); }

 private:
  static Result<FileView> open_folder(const std::filesystem::path& folder);
  static Result<FileView> map_converted(const ConvertedPtr& converted, const std::string& name);
  static Result<FileView> map(int descriptor, std::uint64_t size, const std::string& name);

  Bytes bytes_;
  std::string name_;
  ConvertedPtr converted_;
  std::shared_ptr<void> mapping_;  // its deleter unmaps the bytes
};

/// True if bytes of a mapped file were read that a different program had truncated. Such a read raises SIGBUS, which
/// would end the process. At most 256 open files are watched.
bool was_cut(Bytes mapped);

/// Called now and then with the number of passed bytes and the number of all bytes; null: never called.
using Progress = std::function<void(std::uint64_t done, std::uint64_t all)>;

/// Reports the progress of a pass from front to back, and releases the memory of passed bytes. So a large file takes no
/// more memory than a small one.
class PassedBytes {
 public:
  /// For the view's own bytes; the memory of other bytes isn't released.
  PassedBytes(const FileView& view, Bytes bytes, Progress progress = {})
      : view_(view), bytes_(bytes), progress_(std::move(progress)) {}
  ~PassedBytes() {
    if (bytes_.size() >= step) let_go(passed_);
  }
  PassedBytes(const PassedBytes&) = delete;
  PassedBytes& operator=(const PassedBytes&) = delete;

  /// Reports that all bytes before that offset are passed.
  void pass(std::uint64_t offset) {
    passed_ = offset;
    if (progress_ && offset >= next_progress_) {
      progress_(offset, bytes_.size());
      next_progress_ = offset + step;
    }
    if (offset >= forgotten_ + step) let_go(offset);
  }
  /// True if the memory of the byte at that offset will be released when the pass is beyond it.
  bool releases(std::uint64_t offset) const { return offset >= forgotten_; }

 private:
  static constexpr std::uint64_t step = std::uint64_t{2} << 20;  // [bytes]; a smaller file may stay in memory

  void let_go(std::uint64_t end) {
    if (end > forgotten_) view_.forget(bytes_.subspan(forgotten_, end - forgotten_));
    forgotten_ = end;
  }

  const FileView& view_;
  Bytes bytes_;
  Progress progress_;
  std::uint64_t passed_ = 0;
  std::uint64_t forgotten_ = 0;
  std::uint64_t next_progress_ = 0;
};

}  // namespace rehearse::mcap
