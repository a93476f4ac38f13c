// Merges several files into one, in the order of time.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rehearse::mcap {

struct MergeSource {
  std::filesystem::path file;
  std::string prefix;  // prefix of each of its topics, as "/left"
};

struct MergeOptions {
  /// Every source keeps separate channels. Otherwise channels with equal definitions become one.
  bool keep_apart = false;
  /// Called now and then with the number of written messages and the number of all messages, if the sources'
  /// statistics state it; null: never called.
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;
};

/// The result of merge().
struct Merged {
  std::uint64_t messages = 0;
  std::uint64_t channels = 0, attachments = 0, metadata = 0;
  std::uint64_t bytes = 0;
  std::vector<std::string>
      remarks;  // sentences: topics with different definitions, names that occur twice, private records
};

/// Writes `target`, under a temporary name until it is complete. It contains all messages by log time, then in the
/// order of the sources, then as in their files, with their bytes, numbers and both times; and the attachments and
/// metadata of all sources. Channels with equal topic, encoding, schema and metadata become one. Other channels with
/// equal topics stay separate, and are reported. The profile is that of all sources if they agree, else empty. A
/// metadata record `rehearse.merge` names the sources. Private records aren't kept, which a remark states. Chunks that
/// overlap in time are kept in memory. Fails, and writes nothing, if a source is damaged, or if `target` can't be
/// written.
Result<Merged> merge(const std::vector<MergeSource>& sources, const std::filesystem::path& target,
                     const MergeOptions& options = {});

}  // namespace rehearse::mcap
