// Files that controllers open to read: inputs that no recording holds, so it holds what they were.
//
// The C library's functions that open files lead through ours (file_tripwires.cpp), which note the name in a fixed
// table, without a lock or the heap: a call may be ended at any instruction. What is in the file is looked at after it.
#pragma once

#include <string>
#include <vector>

namespace rehearse {

struct OpenedFile {
  std::string name;     // without its folders, which are the machine's
  std::string content;  // size and hash: "1234 bytes, 0123456789abcdef"; or missing_file
};

inline constexpr const char* missing_file = "missing";

/// A file that guarded code opened or wanted to open, to read. May be called anywhere.
void note_opened_file(const char* path) noexcept;

/// Those since the last call, in order. Neither devices nor what the kernel makes up.
std::vector<OpenedFile> take_files_opened();

}  // namespace rehearse
