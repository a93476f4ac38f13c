// A part of a file: some topics, a span of time or of ticks; or all of it in another form.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "select.h"

namespace rehearse::mcap {

struct FilterOptions {
  Selection selection;
  std::vector<std::string> exclude;  // globs of topics that are left out, even if they were chosen
  bool attachments = true;           // keep them, all
  bool metadata = true;              // likewise
  /// For all channels; nullopt: as each was compressed.
  std::optional<Compression> compression;
  std::optional<int> level;               // of the compression; nullopt: the Writer's
  std::optional<std::size_t> chunk_size;  // [bytes]; nullopt: the Writer's
  /// Called now and then with the bytes passed and all; null: not.
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;

  /// Something is left out.
  bool cuts() const {
    return !selection.topics.empty() || !selection.takes_all_times() || !exclude.empty() || !attachments || !metadata;
  }
};

/// What was written.
struct Filtered {
  std::uint64_t messages = 0, left_out = 0;  // of the source
  std::uint64_t channels = 0, attachments = 0, metadata = 0;
  std::uint64_t first_time = 0, last_time = 0;  // log times [ns]; 0 without messages
  std::uint64_t bytes = 0;
};

/// Writes `target`, under another name until it is whole. Messages keep their bytes, their numbers, both times and
/// their order; chosen channels are kept even without messages. If something is left out, the metadata record
/// `rehearse.filter` says what the file was cut from, and how. Private records aren't kept. Fails, with nothing
/// written, if the source is damaged (recover() comes first then), if the selection has something that the file hasn't,
/// or if `target` can't be written.
Result<Filtered> filter(const std::filesystem::path& source, const std::filesystem::path& target,
                        const FilterOptions& options);

}  // namespace rehearse::mcap
