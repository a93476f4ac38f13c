// The remedy of an error about a file or folder that can't be written.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace rehearse {

/// The folder at which the disk with this file or folder is mounted.
std::filesystem::path disk_of(const std::filesystem::path& place);

/// "make the folder out writable, or name another file with -o", "make the folder out first, or ...", "make room on the
/// disk, or ...", whichever is the cause. `other`: how the user names another place, as "name another file with -o".
std::string write_hint(const std::filesystem::path& file, std::string_view other);

}  // namespace rehearse
