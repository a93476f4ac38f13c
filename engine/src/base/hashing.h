// hash_bytes: the hash function of all hashes of a run (XXH3, 64 bits). Equal bytes have equal hashes on every machine.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace rehearse {

std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed = 0);

/// The hash of bytes that are added in parts: equal to the hash of all of them together.
class RunningHash {
 public:
  explicit RunningHash(std::uint64_t seed = 0);
  ~RunningHash();
  RunningHash(RunningHash&&) noexcept;
  void add(const void* data, std::size_t size);
  std::uint64_t value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// hash_bytes() of a file. Fails if it can't be read. A file is read once in a process, until its FileIdentity is
/// another; one that was changed just now is read each time.
Result<std::uint64_t> hash_of_file(const std::filesystem::path& file);

/// 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

/// The hash of a library's file in the provenance: hash_text() of its bytes; of no bytes if it can't be read.
std::string content_hash_of(const std::filesystem::path& file);

}  // namespace rehearse
