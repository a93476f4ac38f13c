// Runs a program in a separate process, in the environment that a row of the matrix requires.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::matrix {

struct Surroundings {
  std::vector<std::string> launcher;  // comes before the program: setarch -R, qemu-x86_64 -cpu Nehalem
  bool bare = false;                  // without this process's variables, except options of sanitizers
  std::map<std::string, std::optional<std::string>> variables;  // variables to set or, without a value, to remove
  std::filesystem::path folder;                                 // working folder; empty: that of this process
};

/// True if a program of that name is found in PATH.
bool is_installed(const std::string& program);

/// Runs a command to its end; fails unless its exit status is 0. Its output goes to the file `log`; if the command
/// fails, the error contains the end of the output.
Result<void> run(const std::vector<std::string>& command, const Surroundings& surroundings,
                 const std::filesystem::path& log);

}  // namespace rehearse::matrix
