// Writes a part of a file: some topics, a span of time or of ticks; or all of it in a different form.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "select.h"
#include "state_rate.h"

namespace rehearse::mcap {

struct FilterOptions {
  Selection selection;
  std::vector<std::string> exclude;  // globs of topics that are left out, even if they were selected
  /// Globs of the attachments that are kept: all by default, none if it is empty.
  std::vector<std::string> attachments = {"*"};
  bool metadata = true;              // all metadata records are kept
  std::optional<StateRate> samples;  // of the state only the samples at a rate are kept, and a record states the rate
  /// Compression of all channels; nullopt: the compression of each channel in the source.
  std::optional<Compression> compression;
  std::optional<int> level;               // level of the compression; nullopt: the Writer's level
  std::optional<std::size_t> chunk_size;  // [bytes]; nullopt: the Writer's size
  /// Called now and then with the number of read bytes and the number of all bytes; null: never called.
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;

  /// True if something is left out.
  bool cuts() const {
    return !selection.topics.empty() || !selection.takes_all_times() || !exclude.empty() ||
           attachments != std::vector<std::string>{"*"} || !metadata;
  }
};

/// The result of filter().
struct Filtered {
  std::uint64_t messages = 0, left_out = 0;  // numbers of messages of the source
  std::uint64_t channels = 0, attachments = 0, metadata = 0;
  std::uint64_t first_time = 0, last_time = 0;  // log times [ns]; 0 without messages
  std::uint64_t bytes = 0;
  std::vector<std::string> remarks;  // sentences: private records of the source
};

/// Writes `target`, under a temporary name until it is complete. Messages keep their bytes, their numbers, both times
/// and their order; selected channels are kept even without messages. If something is left out, the metadata record
/// `rehearse.filter` states the source and the selection. Private records aren't kept, which a remark states. Fails,
/// and writes nothing, if the source is damaged (it must be recovered first), if the file lacks something in the
/// selection, or if `target` can't be written.
Result<Filtered> filter(const std::filesystem::path& source, const std::filesystem::path& target,
                        const FilterOptions& options);

}  // namespace rehearse::mcap
