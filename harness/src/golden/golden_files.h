// Files of goldens on disk: read whole, replaced safely. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace rehearse {

Result<std::string> read_text(const std::filesystem::path& file);

/// XXH3 of the bytes.
Result<std::uint64_t> hash_of_file(const std::filesystem::path& file);

/// Writes new versions of two files and puts them in the places of the old ones. `write_trace` writes the first to the
/// path it is given, `make_digest` makes the text of the second of what stands there. Both are complete on disk, under
/// other names, before either name changes hands; if anything fails before that, neither file is touched and nothing is
/// left behind. What an earlier attempt left behind is overwritten.
Result<void> replace_together(const std::filesystem::path& trace,
                              const std::function<Result<void>(const std::filesystem::path&)>& write_trace,
                              const std::filesystem::path& digest,
                              const std::function<Result<std::string>(const std::filesystem::path&)>& make_digest);

/// The same of one file.
Result<void> replace_text(const std::filesystem::path& file, const std::string& text);

}  // namespace rehearse
