// The files that may be overwritten. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string_view>

namespace rehearse {

inline constexpr std::string_view mcap_magic = "\x89MCAP0\r\n";
inline constexpr std::string_view png_magic = "\x89PNG\r\n\x1a\n";

/// Succeeds if the file may be overwritten: it doesn't exist, is empty, or begins with `magic`, so it is of the same
/// kind. This protects, for example, a scenario from being replaced by a picture by mistake. `kind`: "trace".
Result<void> check_replaceable(const std::filesystem::path& file, std::string_view magic, std::string_view kind);

}  // namespace rehearse
