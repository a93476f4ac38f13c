// Which files may be written over. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string_view>

namespace rehearse {

inline constexpr std::string_view mcap_magic = "\x89MCAP0\r\n";
inline constexpr std::string_view png_magic = "\x89PNG\r\n\x1a\n";

/// That a file of ours may be written there: it doesn't exist, is empty, or is one of its kind, that is, begins with
/// `magic`. So that a slip of the hand replaces no scenario by a picture. `kind`: "trace".
Result<void> check_replaceable(const std::filesystem::path& file, std::string_view magic, std::string_view kind);

}  // namespace rehearse
