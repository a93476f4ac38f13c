// The folder of the user's caches, which all projects share.
#pragma once

#include <cstdint>
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

/// The most that a folder of the cache has, as `hulls` [bytes].
constexpr std::uintmax_t cache_bound = 256 << 20;

/// Writes a file of the cache, and makes its folder. Other processes find the whole file or the one from before. A file
/// that can't be written isn't kept, and neither is one above the bound [bytes]. Of the other files in its folder those
/// go that were read longest ago, to within a day, until all have the bound.
void keep_in_cache(const std::filesystem::path& file, std::string_view bytes, std::uintmax_t bound);
inline void keep_in_cache(const std::filesystem::path& file, std::string_view bytes) {
  keep_in_cache(file, bytes, cache_bound);
}

}  // namespace rehearse
