// Copies of files that controllers read by the API: those below shareDirPath(), and motions (.seq) elsewhere. A
// recording contains them, so that a replay finds them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "opened_files.h"

namespace rehearse {

/// Names of the attachments: inputs/share/motion/walk.seq, inputs/walk.seq.
inline constexpr std::string_view input_copies_prefix = "inputs/";
/// Larger files are recorded by their digest only.
inline constexpr std::uintmax_t max_input_copy = std::uintmax_t{1} << 20;  // 1 MiB

/// Adds the content of the file by the name of its attachment, if it is one of those, and isn't too large.
void copy_input(const OpenedFile& file, std::map<std::string, std::string>& copies);

}  // namespace rehearse
