#include "child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

namespace rehearse::matrix {
namespace {

namespace fs = std::filesystem;

std::string_view name_in(std::string_view variable) { return variable.substr(0, variable.find('=')); }

/// True for options of sanitizers, which a sanitized build needs because they contain its suppressions.
bool is_for_a_sanitizer(std::string_view name) { return name.ends_with("SAN_OPTIONS"); }

std::vector<std::string> environment_of(const Surroundings& surroundings) {
  std::vector<std::string> all;
  for (char** variable = environ; *variable; ++variable) {
    const std::string_view name = name_in(*variable);
    const bool changed = surroundings.variables.count(std::string(name)) != 0;
    if (!changed && (!surroundings.bare || is_for_a_sanitizer(name))) all.emplace_back(*variable);
  }
  for (const auto& [name, value] : surroundings.variables)
    if (value) all.push_back(name + "=" + *value);
  return all;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::string end_of(const fs::path& log) {
  constexpr std::size_t enough = 2000;
  std::ifstream stream(log);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return text.size() <= enough ? text : "..." + text.substr(text.size() - enough);
}

}  // namespace

bool is_installed(const std::string& program) {
  const char* path = std::getenv("PATH");
  for (std::string_view rest = path ? path : ""; !rest.empty();) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
  }
  return false;
}

Result<void> run(const std::vector<std::string>& command, const Surroundings& surroundings, const fs::path& log) {
  std::vector<std::string> words = surroundings.launcher;
  words.insert(words.end(), command.begin(), command.end());
  std::vector<std::string> environment = environment_of(surroundings);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  if (!surroundings.folder.empty()) posix_spawn_file_actions_addchdir_np(&actions, surroundings.folder.c_str());
  pid_t child = 0;
  const int failed = posix_spawnp(&child, words[0].c_str(), &actions, nullptr, pointers_to(words).data(),
                                  pointers_to(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return error(fmt::format("{} can't be started: {}", words[0], std::strerror(failed)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return error(fmt::format("{} was lost: {}", words[0], std::strerror(errno)));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  const std::string how = WIFEXITED(status) ? fmt::format("ended with status {}", WEXITSTATUS(status))
                                            : fmt::format("was ended by signal {}", WTERMSIG(status));
  return error(fmt::format("{} {}: {}", fmt::join(words, " "), how, end_of(log)));
}

}  // namespace rehearse::matrix
