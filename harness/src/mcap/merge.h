// Several files in one, in the order of time.
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
  std::string prefix;  // put before each of its topics, as "/left"
};

struct MergeOptions {
  /// Every source keeps channels of its own. Else channels that are defined alike become one.
  bool keep_apart = false;
  /// Called now and then with the messages written and all, where the sources' statistics tell how many; null: not.
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;
};

/// What was written.
struct Merged {
  std::uint64_t messages = 0;
  std::uint64_t channels = 0, attachments = 0, metadata = 0;
  std::uint64_t bytes = 0;
  std::vector<std::string> remarks;  // sentences: topics that are defined otherwise, names that come twice
};

/// Writes `target`, under another name until it is whole: all messages by log time, then in the order of the sources,
/// then as in their files, with their bytes, numbers and both times; attachments and metadata of all. Channels with the
/// same topic, encoding, schema and metadata become one; others of one topic stay apart, and are told of. The profile
/// is what all sources have, else empty. A metadata record `rehearse.merge` names the sources. Private records aren't
/// kept. Holds the chunks that overlap in time. Fails, with nothing written, if a source is damaged, or if `target`
/// can't be written.
Result<Merged> merge(const std::vector<MergeSource>& sources, const std::filesystem::path& target,
                     const MergeOptions& options = {});

}  // namespace rehearse::mcap
