#include "hashing.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <fstream>
#include <map>
#include <mutex>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/digest.h"
#include "file_identity.h"

namespace rehearse {

std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed) { return digest_of(data, size, seed); }

struct RunningHash::State {
  XXH3_state_t xxh;
};

RunningHash::RunningHash(std::uint64_t seed) : state_(std::make_unique<State>()) {
  XXH3_64bits_reset_withSeed(&state_->xxh, seed);
}

RunningHash::~RunningHash() = default;
RunningHash::RunningHash(RunningHash&&) noexcept = default;

void RunningHash::add(const void* data, std::size_t size) { XXH3_64bits_update(&state_->xxh, data, size); }

std::uint64_t RunningHash::value() const { return XXH3_64bits_digest(&state_->xxh); }

namespace {

Result<std::uint64_t> hash_of_bytes_in(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  RunningHash hash;
  std::array<char, 1 << 17> block;
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0)
    hash.add(block.data(), static_cast<std::size_t>(stream.gcount()));
  if (!stream.eof()) return error(fmt::format("{} can't be read", file.string()));
  return hash.value();
}

}  // namespace

Result<std::uint64_t> hash_of_file(const std::filesystem::path& file) {
  struct Kept {
    FileIdentity identity;
    std::uint64_t hash = 0;
  };
  static std::mutex mutex;
  static auto& kept = *new std::map<std::filesystem::path, Kept>;
  const auto before = FileIdentity::of(file);
  if (before) {
    const std::lock_guard lock(mutex);
    if (const auto found = kept.find(file); found != kept.end() && found->second.identity == *before)
      return found->second.hash;
  }
  constexpr std::chrono::seconds settled{2};
  const bool can_be_kept = before && before->is_older_than(settled);
  const auto hash = hash_of_bytes_in(file);
  if (can_be_kept && hash && FileIdentity::of(file) == before) {
    const std::lock_guard lock(mutex);
    kept.insert_or_assign(file, Kept{*before, *hash});
  }
  return hash;
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string content_hash_of(const std::filesystem::path& file) {
  const auto hash = hash_of_file(file);
  return hash_text(hash ? *hash : hash_bytes(nullptr, 0));
}

}  // namespace rehearse
