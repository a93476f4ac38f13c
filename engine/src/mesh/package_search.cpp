#include "package_search.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bytes = std::size_t{1} << 20;  // of a package.xml

/// True if a search may start at this directory: below the home directory, or at least two levels below the root.
bool may_search(const fs::path& directory) {
  const auto levels = std::distance(directory.begin(), directory.end()) - 1;  // without the root
  if (levels < 2) return false;
  const char* variable = std::getenv("HOME");
  const fs::path home = variable == nullptr ? fs::path() : fs::path(variable).lexically_normal();
  if (home.empty()) return true;
  const fs::path from_directory = home.lexically_relative(directory);
  return from_directory.empty() || *from_directory.begin() == "..";  // the home directory isn't inside `directory`
}

/// The content of <name> in a package.xml.
std::optional<std::string> package_name(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(most_bytes, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return std::nullopt;
  const auto* package = document.FirstChildElement("package");
  const auto* name = package == nullptr ? nullptr : package->FirstChildElement("name");
  if (name == nullptr || name->GetText() == nullptr) return std::nullopt;
  const std::string words = name->GetText();
  const std::size_t start = words.find_first_not_of(" \t\r\n");
  if (start == std::string::npos) return std::nullopt;
  return words.substr(start, words.find_last_not_of(" \t\r\n") + 1 - start);
}

std::vector<fs::path> found_by(const std::multimap<std::string, fs::path>& all, const std::string& name) {
  std::vector<fs::path> found;
  const auto [first, last] = all.equal_range(name);
  std::transform(first, last, std::back_inserter(found), [](const auto& entry) { return entry.second; });
  return found;
}

}  // namespace

void PackageSearch::look_into(const fs::path& root) {
  std::error_code ignored;
  const fs::path start = fs::absolute(root, ignored).lexically_normal();
  if (!may_search(start)) return;
  std::vector<fs::path> level{start};
  for (int depth = 0; depth <= most_levels && !level.empty(); ++depth) {
    std::vector<fs::path> next;
    for (const fs::path& directory : level) {
      if (gave_up()) return;
      if (!seen_.insert(directory).second) continue;
      for (fs::path& inner : enter(directory)) next.push_back(std::move(inner));
    }
    level = std::move(next);
  }
}

/// Registers one directory, and returns its subdirectories.
std::vector<fs::path> PackageSearch::enter(const fs::path& directory) {
  std::vector<fs::path> inner;
  bool is_package = false;
  std::error_code problem;
  fs::directory_iterator entry(directory, problem);
  for (; !problem && entry != fs::directory_iterator(); entry.increment(problem)) {
    // the order of entries, and so a partial result, depends on the file system
    if (++entries_ > most_entries) return {};
    std::error_code ignored;
    const std::string name = entry->path().filename().string();
    if (name == "package.xml") is_package = entry->is_regular_file(ignored);
    if (!name.starts_with('.') && !entry->is_symlink(ignored) && entry->is_directory(ignored)) {
      inner.push_back(entry->path());
    }
  }
  if (is_package) {
    if (const auto name = package_name(directory / "package.xml")) packages_.emplace(*name, directory);
  }
  std::ranges::sort(inner);
  for (const fs::path& found : inner) directories_.emplace(found.filename().string(), found);
  return inner;
}

std::vector<fs::path> PackageSearch::packages(const std::string& name) const { return found_by(packages_, name); }

std::vector<fs::path> PackageSearch::directories(const std::string& name) const { return found_by(directories_, name); }

}  // namespace rehearse
