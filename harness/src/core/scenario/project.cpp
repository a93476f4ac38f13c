#include "core/scenario/project.h"

#include <algorithm>
#include <string>

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

std::vector<fs::path> build_folders(const fs::path& project) {
  std::vector<fs::path> folders;
  std::error_code missing;
  for (fs::directory_iterator entry(project, missing), end; !missing && entry != end; entry.increment(missing)) {
    std::error_code ignored;
    if (entry->path().filename().string().starts_with("build") && entry->is_directory(ignored))
      folders.push_back(entry->path());
  }
  std::ranges::sort(folders);
  return folders;
}

}  // namespace rehearse
