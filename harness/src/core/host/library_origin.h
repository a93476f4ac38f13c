// The origin of a shared library, from its file: its sources by its line information, and the libraries that it links.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

struct LibraryOrigin {
  std::vector<std::string> sources;   // of the line information; relative ones are in the compiler's working folder
  std::vector<std::string> needed;    // names of the libraries that it links: libgait.so
  std::vector<std::string> searched;  // folders in which the dynamic linker searches them; $ORIGIN is not replaced
};

/// A child process reads the file: the memory of this one, which runs controllers, stays as it is. Empty if the file
/// can't be read, or libdw isn't installed.
LibraryOrigin origin_of(const std::filesystem::path& library);

/// The files of the libraries that `library` links, where they are in a folder of its own search. Others, such as the
/// system's, are left out.
std::vector<std::filesystem::path> files_of_linked(const LibraryOrigin& origin, const std::filesystem::path& library);

}  // namespace rehearse
