#include "scenario_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>

#include "base/names.h"
#include "core/scenario/project.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

/// True for a source of a controller or of a test.
bool is_source(const fs::path& file) {
  constexpr std::array ends{".cpp", ".cc", ".cxx", ".c", ".h", ".hpp", ".rs", ".py", ".so"};
  return std::ranges::find(ends, file.extension().string()) != ends.end();
}

/// A scenario of the project, and the words that name it.
struct NamedScenario {
  fs::path file;
  std::vector<std::string> names;  // of the file, without its extension, and of the golden
};

std::vector<NamedScenario> scenarios_of_project() {
  std::vector<NamedScenario> scenarios;
  const auto project = find_project("./");
  if (!project) return scenarios;
  std::error_code ignored;
  for (const auto& some : {scenario_files(*project), failure_files(*project)})
    for (const fs::path& file : some) {
      NamedScenario scenario{fs::proximate(file, ignored), {file.stem().string()}};
      if (std::string golden = golden_in(file); !golden.empty()) scenario.names.push_back(std::move(golden));
      scenarios.push_back(std::move(scenario));
    }
  return scenarios;
}

Result<std::vector<std::string>> files_below(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    if (entry->path().extension() == ".yaml" && may_be_checked(entry->path())) files.push_back(entry->path().string());
  if (failed) return error(fmt::format("can't list the folder {}: {}", folder.string(), failed.message()));
  std::ranges::sort(files);
  if (files.empty())
    return error(fmt::format("no *.yaml below {} names a golden or expects something", folder.string()),
                 "name a scenario, or a folder of scenarios");
  return files;
}

/// True for a project's folder, which stands for all that the project checks.
bool has_scenarios(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "scenarios", ignored) || fs::is_directory(folder / "fixtures/scenarios", ignored);
}

/// The files of a project that may be checked, as paths from this folder.
std::vector<std::string> files_of(const fs::path& project) {
  std::vector<std::string> files;
  std::map<fs::path, fs::path> seen;  // folders, relative to this one
  std::error_code ignored;
  for (const auto& some : {failure_files(project), scenario_files(project)})
    for (const fs::path& file : some) {
      if (!may_be_checked(file)) continue;
      const auto [folder, is_new] = seen.try_emplace(file.parent_path());
      if (is_new) folder->second = fs::proximate(folder->first, ignored);
      files.push_back(fs::is_symlink(file, ignored) ? fs::proximate(file, ignored).string()
                                                    : (folder->second / file.filename()).lexically_normal().string());
    }
  return files;
}

}  // namespace

Result<std::vector<std::string>> files_named(const std::string& word) {
  std::error_code ignored;
  const fs::path path(word);
  const bool source = is_source(path);
  if (fs::is_directory(path, ignored)) return has_scenarios(path) ? files_of(path) : files_below(path);
  if (!source && (fs::exists(path, ignored) || path.has_parent_path())) return std::vector<std::string>{word};
  const std::string wanted = source || path.extension() == ".yaml" ? path.stem().string() : word;
  std::vector<std::string> found, names;
  for (const NamedScenario& scenario : scenarios_of_project()) {
    if (std::ranges::find(scenario.names, wanted) != scenario.names.end()) found.push_back(scenario.file.string());
    names.insert(names.end(), scenario.names.begin(), scenario.names.end());
  }
  if (found.size() == 1 && !source) return found;
  if (found.size() > 1)
    return error(fmt::format("'{}' names {} scenarios", word, found.size()),
                 fmt::format("name one: {}", listed(found, 4)));
  if (source)
    return error_in(word, "it is a source of a controller or a test, not a scenario",
                    found.empty() ? name_hint(wanted, names, "scenarios") : "its scenario: " + found[0]);
  const std::string hint = names.empty() ? "" : name_hint(wanted, names, "scenarios");
  if (path.extension() == ".yaml" || path.extension() == ".mcap") return error_in(word, "there is no such file", hint);
  return error(fmt::format("there is no file, scenario or golden '{}'", word), hint);
}

Result<std::vector<std::string>> files_named(const std::vector<std::string>& words) {
  std::vector<std::string> files;
  for (const std::string& word : words) {
    const auto named = REHEARSE_TRY(files_named(word));
    files.insert(files.end(), named.begin(), named.end());
  }
  return files;
}

Result<std::vector<std::string>> files_of_project() {
  if (const auto project = find_project("./")) return files_of(*project);
  return error(
      "this folder is of no project: no folder above it has a folder 'golden', a CMakeLists.txt, a pyproject.toml or "
      "a pytest.ini",
      "name a scenario, or go to a project's folder");
}

Diagnostic nothing_to_check() {
  return error(
      fmt::format("no scenario below scenarios or fixtures/scenarios of {} names a golden or expects something",
                  find_project("./").value_or(".").string()),
      "name a scenario");
}

void add_value_option(CLI::App& options, StatedValues& values) {
  const auto parts_of = [](const std::string& text) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
      throw CLI::ValidationError("--with", fmt::format("'{}' is not PATH=VALUE", text));
    return std::pair(text.substr(0, sign), text.substr(sign + 1));
  };
  options
      .add_option_function<std::vector<std::string>>(
          "--with",
          [&values, parts_of](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) values.push_back(parts_of(text));
          },
          "another value in the scenario, as bodies.Box.mass=2.5, by a path as in `vary:`; repeatable")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
}

}  // namespace rehearse::tool
