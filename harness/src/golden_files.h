// Files of goldens on disk: read whole, replaced safely. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace rehearse {

Result<std::string> read_text(const std::filesystem::path& file);

/// XXH3 of the bytes.
Result<std::uint64_t> hash_of_file(const std::filesystem::path& file);

/// Puts a copy of `source` at `trace` and `text` at `digest`. Both are complete on disk, under other names, before
/// either name changes hands; if anything fails before that, neither file is touched and nothing is left behind.
Result<void> replace_together(const std::filesystem::path& source, const std::filesystem::path& trace,
                              const std::string& text, const std::filesystem::path& digest);

}  // namespace rehearse
