#include "golden_conflicts.h"

#include <fmt/format.h>
#include <rehearse/golden.h>

#include <filesystem>
#include <map>

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

fs::path normal_path(const fs::path& file) {
  std::error_code ignored;
  return fs::absolute(file, ignored).lexically_normal();
}

/// A golden that several scenarios name.
struct Conflict {
  std::string golden;
  std::string owners;
};

using Conflicts = std::map<fs::path, Conflict>;  // by scenario file

/// The conflicts of a repository.
Conflicts find_conflicts(const fs::path& goldens) {
  Conflicts conflicts;
  for (const auto& [golden, owners] : find_golden_owners(goldens, {goldens / ".."}))
    if (owners.scenarios.size() > 1)
      for (const std::string& file : owners.scenarios) conflicts[normal_path(file)] = {golden, owners.conflict()};
  return conflicts;
}

/// The conflicts of the repository that has the goldens of a file's folder. `searched`: by repository; each is searched
/// once. None: there is no such folder, or it is outside (REHEARSE_GOLDEN_DIR).
const Conflicts* conflicts_around(const std::string& file, std::map<fs::path, Conflicts>& searched) {
  const auto goldens = find_golden_folder(file);
  if (!goldens) return nullptr;  // check_golden tells
  const fs::path repository = normal_path(*goldens / "..");
  const fs::path inside = normal_path(file).lexically_relative(repository);
  if (inside.empty() || *inside.begin() == "..") return nullptr;
  const auto [found, is_new] = searched.try_emplace(repository);
  if (is_new) found->second = find_conflicts(*goldens);
  return &found->second;
}

}  // namespace

Result<void> check_owners(const std::vector<std::string>& files) {
  std::map<fs::path, Conflicts> searched;
  std::map<fs::path, const Conflicts*> of_folder;
  for (const std::string& file : files) {
    if (file.ends_with(".mcap")) continue;
    const auto [conflicts, is_new] = of_folder.try_emplace(fs::path(file).parent_path());
    if (is_new) conflicts->second = conflicts_around(file, searched);
    if (!conflicts->second || conflicts->second->empty()) continue;
    const auto found = conflicts->second->find(normal_path(file));
    if (found == conflicts->second->end()) continue;
    return error_in(
        file,
        fmt::format("the golden '{}' isn't this scenario's alone: {}", found->second.golden, found->second.owners),
        "give each a golden of its own");
  }
  return {};
}

}  // namespace rehearse::tool
