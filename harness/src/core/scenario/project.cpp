#include "core/scenario/project.h"

#include <algorithm>
#include <string>

#include "scenario_values.h"
#include "yaml/yaml_tree.h"

namespace rehearse {

namespace fs = std::filesystem;

namespace {

/// The nearest folder, from this one upwards, of which `is_found` holds.
template <class Predicate>
std::optional<fs::path> nearest(fs::path folder, const Predicate& is_found) {
  for (;; folder = folder.parent_path()) {
    if (is_found(folder)) return folder;
    if (folder == folder.parent_path()) return std::nullopt;
  }
}

/// The *.yaml below a folder of the project or of its fixtures, by path.
std::vector<fs::path> yaml_files(const fs::path& project, const std::string& name) {
  std::vector<fs::path> files;
  for (const std::string& folder : {name, "fixtures/" + name}) {
    std::error_code missing;
    for (fs::recursive_directory_iterator entry(project / folder, missing), end; !missing && entry != end;
         entry.increment(missing))
      if (entry->path().extension() == ".yaml") files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

/// Presets of CMake build in folders as `out/build/release`, each with a cache of its own.
void add_builds_below(const fs::path& folder, int depth, std::vector<fs::path>& builds) {
  constexpr int deepest = 2;
  std::error_code missing;
  for (fs::directory_iterator entry(folder, missing), end; !missing && entry != end; entry.increment(missing)) {
    std::error_code ignored;
    const std::string name = entry->path().filename().string();
    if (!entry->is_directory(ignored)) continue;
    const bool has_cache = fs::is_regular_file(entry->path() / "CMakeCache.txt", ignored);
    if (has_cache || (depth == 0 && name.starts_with("build"))) builds.push_back(entry->path());
    const bool is_parent = !has_cache && (depth > 0 || name == "out" || name.starts_with("build"));
    if (is_parent && depth < deepest) add_builds_below(entry->path(), depth + 1, builds);
  }
}

}  // namespace

std::optional<fs::path> find_project(const fs::path& inside) {
  constexpr const char* build_files[] = {"CMakeLists.txt", "pyproject.toml", "pytest.ini"};
  std::error_code ignored;
  const fs::path begin = fs::absolute(inside.empty() ? "./" : inside, ignored);  // absolute() has no result for ""
  const fs::path folder = begin.lexically_normal().parent_path();
  const auto has_goldens = [&](const fs::path& above) { return fs::is_directory(above / "golden", ignored); };
  const auto is_built = [&](const fs::path& above) {
    return std::ranges::any_of(build_files,
                               [&](const char* file) { return fs::is_regular_file(above / file, ignored); });
  };
  const auto with_goldens = nearest(folder, has_goldens);
  return with_goldens ? with_goldens : nearest(folder, is_built);
}

std::vector<fs::path> scenario_files(const fs::path& project) { return yaml_files(project, "scenarios"); }

std::vector<fs::path> failure_files(const fs::path& project) { return yaml_files(project, "failures"); }

bool may_be_checked(const fs::path& file) {
  const auto text = read_yaml_file(file, "a scenario");
  return !text || text->find("golden") != std::string::npos || text->find("expect") != std::string::npos;
}

std::string golden_in(const fs::path& file) {
  auto text = read_yaml_file(file, "a scenario");
  if (!text || text->find("golden") == std::string::npos) return {};
  const auto root = parse_yaml(*std::move(text), file.string());
  const YamlNode* golden = root ? find_key(**root, "golden") : nullptr;
  return golden ? golden->text : std::string();
}

std::vector<fs::path> build_folders(const fs::path& project) {
  std::vector<fs::path> folders;
  add_builds_below(project, 0, folders);
  std::ranges::sort(folders);
  return folders;
}

}  // namespace rehearse
