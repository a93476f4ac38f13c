// The library of a controller as a commit or the working folder has it, built in a separate folder.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>

namespace rehearse::tool {

/// True if git knows the word as a commit of the repository in the working folder.
bool is_commit(const std::string& word);

/// Checks out the commit into `folder`, builds its CMake project with -O0, and returns the built file of the same name
/// as `library`. The user's repository and build folder stay unchanged. Fails with the last lines of git or CMake.
Result<std::filesystem::path> build_of_commit(const std::string& commit, const std::filesystem::path& library,
                                              const std::filesystem::path& folder);

/// The same of the present sources in the working folder.
Result<std::filesystem::path> build_of_sources(const std::filesystem::path& library,
                                               const std::filesystem::path& folder);

}  // namespace rehearse::tool
