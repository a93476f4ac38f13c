// Files that controllers open to read. These are inputs that a recording doesn't contain, so it contains their names
// and hashes.
//
// Replacements of the C library's functions that open files (file_tripwires.cpp) note the name in a fixed table. They
// use neither a lock nor the heap, because a call may be ended at any instruction. The content of the file is read
// after the call.
#pragma once

#include <string>
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

}  // namespace rehearse
