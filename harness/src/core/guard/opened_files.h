// Files that controllers open to read. These are inputs that a recording doesn't contain, so it contains their names
// and hashes.
//
// Replacements of the C library's functions that open files (process_tripwires.cpp) note the name in a fixed table.
// They use neither a lock nor the heap, because a call may be ended at any instruction. The content of the file is read
// after the call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

struct OpenedFile {
  std::string name;     // without its folders, which differ between machines
  std::string path;     // as it was opened
  std::string content;  // size and hash: "1234 bytes, 0123456789abcdef"; or missing_file
};

inline constexpr const char* missing_file = "missing";

/// Notes a file that guarded code opened or tried to open, to read. May be called anywhere.
void note_opened_file(const char* path) noexcept;

/// The files since the last call, in order; without devices and files that the kernel generates.
std::vector<OpenedFile> take_files_opened();

// Copies of files that controllers read by the API: those below shareDirPath(), and motions (.seq) elsewhere. A
// recording contains them, so that a replay finds them.

/// Names of the attachments: inputs/share/motion/walk.seq, inputs/walk.seq.
inline constexpr std::string_view input_copies_prefix = "inputs/";
/// Larger files are recorded by their digest only.
inline constexpr std::uintmax_t max_input_copy = std::uintmax_t{1} << 20;  // 1 MiB

/// Adds the content of the file by the name of its attachment, if it is one of those, and isn't too large.
void copy_input(const OpenedFile& file, std::map<std::string, std::string>& copies);

}  // namespace rehearse
