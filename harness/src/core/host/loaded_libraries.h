// The programs and shared libraries in this process: the linker's build identifiers, and the hashes of their code.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace rehearse {

/// Bytes of a file.
struct FilePart {
  std::uint64_t offset = 0, size = 0;
};

struct LoadedLibrary {
  std::string file;      // path; empty: the program itself
  std::string build_id;  // bytes of the linker's build identifier, which differs for different code; empty: none
  std::vector<FilePart> parts = {};  // the parts of the file that are in memory, without notes and header
  std::uint64_t inode = 0;           // of the file that was loaded; 0: unknown
};

/// The libraries by the names of their files. The program is the entry with the empty name.
std::map<std::string, LoadedLibrary> loaded_libraries();

/// LoadedLibrary::build_id of each library, by the name of its file. Reads no file.
std::map<std::string, std::string> build_ids();

/// The names of the libraries with which the program began.
const std::set<std::string>& libraries_at_start();

/// The libraries that a loaded library needs, and with which the program didn't begin: by the names of their files the
/// build identifier in hexadecimal digits, or the hash of the file. `handle`: from dlopen().
std::map<std::string, std::string> linked_libraries(void* handle);

/// True if a loaded library, or one of linked_libraries(), refers to a function of the C or C++ library that starts a
/// thread. libraries_without_turns are left out.
bool can_start_threads(void* handle);

/// The library of that name ("libOSMesa.so.8") and all libraries that it needs; they are loaded if necessary. Fails if
/// a library can't be loaded.
Result<std::map<std::string, LoadedLibrary>> load_library(const std::string& name);

/// The hash of a library's code and data. Debug information and the build identifier don't count, so a new build of
/// equal code has the same hash. Fails if the file can't be read, or isn't the loaded file any more.
Result<std::string> code_hash_of(const LoadedLibrary& library);

}  // namespace rehearse
