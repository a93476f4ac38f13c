// The hashes of the code in this process, kept between processes. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <map>
#include <string>

#include "core/host/loaded_libraries.h"

namespace rehearse {

/// code_hash_of() each library, by its name. They are kept in `code` of the user's cache: reading all code takes a
/// third of the time of a proved check. A kept hash counts while nobody has changed the file since the machine was
/// started: its device, inode, size, times and build identifier are the same. Files that changed less than two seconds
/// ago, or have no build identifier, are read each time.
Result<std::map<std::string, std::string>> code_hashes_of(const std::map<std::string, LoadedLibrary>& libraries);

}  // namespace rehearse
