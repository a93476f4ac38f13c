// Opening what a user names: a file, a pipe, standard input. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
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

}  // namespace rehearse::mcap
