// The shared libraries in this process, and the linker's build identifiers of their code.
#pragma once

#include <map>
#include <string>

namespace rehearse {

struct LoadedLibrary {
  std::string file;      // path; empty: the program itself
  std::string build_id;  // bytes of the linker's build identifier, which differs for different code; empty: none
};

/// The libraries by the names of their files. The program is the entry with the empty name.
std::map<std::string, LoadedLibrary> loaded_libraries();

}  // namespace rehearse
