#include "replayed_twice.h"

#include <rehearse/replay.h>

#include <algorithm>
#include <vector>

#include "trace/hashing.h"

namespace rehearse {
namespace {

/// A hash of the outputs of each tick.
Result<std::vector<std::uint64_t>> replayed_outputs(const std::filesystem::path& recording, const HostOptions& host) {
  std::vector<std::uint64_t> hashes;
  ReplayOptions options;
  static_cast<HostOptions&>(options) = host;
  options.on_outputs = [&hashes](std::int64_t, const std::vector<std::uint64_t>& row) {
    hashes.push_back(hash_bytes(row.data(), row.size() * sizeof(row[0])));
  };
  if (auto replayed = replay(recording, options); !replayed) return replayed.errors();
  return hashes;
}

}  // namespace

Result<std::optional<std::int64_t>> first_unrepeated_tick(const std::filesystem::path& recording,
                                                          const HostOptions& host) {
  const auto once = replayed_outputs(recording, host), again = replayed_outputs(recording, host);
  if (!once) return once.errors();
  if (!again) return again.errors();
  if (*once == *again) return std::optional<std::int64_t>();
  return std::optional(std::ranges::mismatch(*once, *again).in1 - once->begin());
}

}  // namespace rehearse
