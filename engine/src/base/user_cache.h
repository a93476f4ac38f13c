// The folder of the user's caches, which all projects share.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace rehearse {

/// REHEARSE_CACHE, else `rehearse` in XDG_CACHE_HOME, else `.cache/rehearse` in HOME. Empty: REHEARSE_CACHE is `off`,
/// or none of them is stated.
std::filesystem::path user_cache();

/// The content of a file of the cache; none: it isn't there. A folder in its place is named in a warning on stderr,
/// once in a process, and stays.
std::optional<std::string> read_from_cache(const std::filesystem::path& file);

/// Writes a file of the cache, and makes its folder. Other processes find the whole file or the one from before. A file
/// that can't be written isn't kept.
void keep_in_cache(const std::filesystem::path& file, std::string_view bytes);

}  // namespace rehearse
