// Files of goldens on disk: read completely, replaced safely. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace rehearse {

Result<std::string> read_text(const std::filesystem::path& file);

/// The file beside a run's trace with the verdict of its check.
std::filesystem::path verdict_file_of(const std::filesystem::path& trace);

/// Removes a run: its trace, its verdict, its pictures of differences and its report. Files that can't be removed stay.
void remove_run(const std::filesystem::path& trace);

/// Writes new versions of two files and replaces the old ones. `write_trace` writes the first to the given path;
/// `make_digest` makes the text of the second from the written trace. Both are complete on disk, under temporary names,
/// before either is renamed. If anything fails before that, neither file is changed and no temporary file is left.
/// Temporary files of an earlier attempt are overwritten.
Result<void> replace_together(const std::filesystem::path& trace,
                              const std::function<Result<void>(const std::filesystem::path&)>& write_trace,
                              const std::filesystem::path& digest,
                              const std::function<Result<std::string>(const std::filesystem::path&)>& make_digest);

/// Replaces one text file in the same way.
Result<void> replace_text(const std::filesystem::path& file, const std::string& text);

}  // namespace rehearse
