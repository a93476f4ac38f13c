// The shared libraries in this process, and the linker's build identifiers of their code.
#pragma once

#include <rehearse/diagnostic.h>

#include <map>
#include <string>

namespace rehearse {

struct LoadedLibrary {
  std::string file;      // path; empty: the program itself
  std::string build_id;  // bytes of the linker's build identifier, which differs for different code; empty: none
};

/// The libraries by the names of their files. The program is the entry with the empty name.
std::map<std::string, LoadedLibrary> loaded_libraries();

/// The library of that name ("libOSMesa.so.8") and all libraries that it needs; they are loaded if necessary. Fails if
/// a library can't be loaded.
Result<std::map<std::string, LoadedLibrary>> load_library(const std::string& name);

}  // namespace rehearse
