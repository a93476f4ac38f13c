// A program in a process of its own, in the surroundings that a row of the matrix asks for.
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
  bool bare = false;                  // none of this process's variables, but what sanitizers are told
  std::map<std::string, std::optional<std::string>> variables;  // set, or, without a value, taken away
  std::filesystem::path folder;                                 // it works in; empty: in this process's
};

/// True if a program of that name is found in PATH.
bool is_installed(const std::string& program);

/// Runs a command to its end; fails unless its exit status is 0. What it says goes to the file `log` and, if it fails,
/// its end into the error.
Result<void> run(const std::vector<std::string>& command, const Surroundings& surroundings,
                 const std::filesystem::path& log);

}  // namespace rehearse::matrix
