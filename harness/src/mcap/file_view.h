// Opening what a user names: a file, a pipe, standard input; and a file's bytes, mapped. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <functional>
#include <utility>

namespace rehearse::mcap {

/// An open descriptor that bytes can be read of.
class Input {
 public:
  /// "-" is standard input. A directory, a device and a socket's file are refused.
  static Result<Input> open(const std::filesystem::path& file);
  ~Input();
  Input(Input&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)),
        name_(std::move(other.name_)),
        size_(other.size_),
        only_once_(other.only_once_) {}
  Input& operator=(Input&&) = delete;

  const std::string& name() const { return name_; }  // as messages call it
  int descriptor() const { return descriptor_; }

  /// [bytes] of a file that can be mapped from its beginning; 0 for all else: pipes, sockets, empty and made-up files.
  std::uint64_t mappable_size() const { return size_; }

  /// The number of a pipe that has no name in a folder: what it gave can't be had again. nullopt for all else.
  const std::optional<std::uint64_t>& only_once() const { return only_once_; }

  /// Fills the front of `target`, waiting for the first byte at most, and says how much came; 0 is the end.
  Result<std::size_t> read(std::span<std::byte> target);

 private:
  Input(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {}
  Result<void> look();
  Diagnostic unreadable(std::string_view why, std::string hint = {}) const;

  int descriptor_;
  std::string name_;
  std::uint64_t size_ = 0;
  std::optional<std::uint64_t> only_once_;
};

class FileView {
 public:
  /// Maps a file for reading, as large as it is now: what is written behind that meanwhile isn't seen. What can't be
  /// mapped (a pipe, standard input by the name "-") is kept in a nameless temporary file first, to its end; of a
  /// pipe without a name for the life of the process, so that it can be opened again.
  /// Of a file that another program cuts while it is mapped, zeros are read where its bytes are gone.
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

/// Whether bytes of a mapped file were read that another program had cut off: reading these raises SIGBUS, which would
/// end the process. Of more than 256 files at a time the others aren't watched.
bool was_cut(Bytes mapped);

/// Called now and then with the bytes passed and all; null: not.
using Progress = std::function<void(std::uint64_t done, std::uint64_t all)>;

/// Tells the progress of a pass from front to back, and lets go of what it has left behind, so that a large file takes
/// no more memory than a small one.
class PassedBytes {
 public:
  /// Of the view's own bytes; of others nothing is let go.
  PassedBytes(const FileView& view, Bytes bytes, Progress progress = {})
      : view_(view), bytes_(bytes), progress_(std::move(progress)) {}
  ~PassedBytes() { let_go(passed_); }
  PassedBytes(const PassedBytes&) = delete;
  PassedBytes& operator=(const PassedBytes&) = delete;

  /// All before that offset is passed.
  void pass(std::uint64_t offset) {
    constexpr std::uint64_t step = std::uint64_t{16} << 20;
    passed_ = offset;
    if (progress_ && offset >= next_progress_) {
      progress_(offset, bytes_.size());
      next_progress_ = offset + step;
    }
    if (offset >= forgotten_ + step) let_go(offset);
  }

 private:
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
