// The files that a project names: by paths with variables, and of another machine.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "project_run.h"

namespace rehearse::import {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_levels = 6;  // folders above the project that are searched

/// "${NAME}/rest" in two parts; an empty name: there is no variable.
struct VariablePath {
  std::string variable;
  std::string rest;
};

VariablePath split_variable(const std::string& written) {
  const std::size_t end = written.starts_with("${") ? written.find('}') : std::string::npos;
  if (end == std::string::npos) return {"", written};
  return {written.substr(2, end - 2),
          written.substr(std::min(written.find_first_not_of('/', end + 1), written.size()))};
}

/// The folders above a file, the nearest first, at most `most_levels`; neither the root nor a folder of the root.
std::vector<fs::path> folders_above(const fs::path& file) {
  std::error_code ignored;
  std::vector<fs::path> folders;
  for (fs::path above = fs::absolute(file, ignored).lexically_normal().parent_path();
       folders.size() < most_levels && above.has_relative_path() && above.parent_path().has_relative_path();
       above = above.parent_path())
    folders.push_back(above);
  return folders;
}

/// The ends of a path, the longest first; each has a folder and a name.
std::vector<fs::path> ends_of(const std::string& path) {
  std::vector<fs::path> parts, ends;
  for (const fs::path& part : fs::path(path).lexically_normal())
    if (part != ".." && part != "." && !part.has_root_directory() && !part.empty()) parts.push_back(part);
  for (std::size_t first = 0; first + 2 <= parts.size(); ++first) {
    fs::path& end = ends.emplace_back();
    for (std::size_t i = first; i < parts.size(); ++i) end /= parts[i];
  }
  return ends;
}

/// The folders of the project's checkout in which a plugin's part may lie: those within the folders above the project,
/// up to the one with .git. Without one there are none.
std::vector<fs::path> folders_of_parts(const std::vector<fs::path>& above) {
  std::error_code ignored;
  const auto root =
      std::ranges::find_if(above, [&](const fs::path& each) { return fs::exists(each / ".git", ignored); });
  std::vector<fs::path> parts;
  if (root == above.end()) return parts;
  for (auto folder = above.begin(); folder != std::next(root); ++folder) {
    std::vector<fs::path> within;
    for (const auto& entry : fs::directory_iterator(*folder, ignored))
      if (entry.is_directory(ignored)) within.push_back(entry.path());
    std::ranges::sort(within);
    parts.insert(parts.end(), within.begin(), within.end());
  }
  return parts;
}

}  // namespace

std::optional<fs::path> ProjectReader::expanded(const std::string& written) const {
  const auto [variable, rest] = split_variable(written);
  const auto folder = folder_of(variable);
  return folder ? std::optional(*folder / rest) : std::nullopt;
}

std::optional<fs::path> ProjectReader::folder_of(const std::string& variable) const {
  if (variable.empty()) return project_.parent_path();
  if (const auto given = options_.model.packages.find(variable); given != options_.model.packages.end())
    return given->second;
  if (variable == "PROJECT_DIR") return project_.parent_path();
  if (variable == "SHARE" && !options_.share.empty()) return options_.share;
  const char* home = variable == "HOME" ? std::getenv("HOME") : nullptr;
  return home == nullptr ? std::nullopt : std::optional<fs::path>(home);
}

/// A file with the same last folders and name: in the given folders, above the project, in the share folder, or with
/// two folders in a part of the checkout. Projects name files by where their author installs them.
std::optional<fs::path> ProjectReader::find_similar(const std::string& written) const {
  std::vector<fs::path> folders = options_.search;
  const std::vector<fs::path> above = folders_above(project_);
  folders.insert(folders.end(), above.begin(), above.end());
  if (!options_.share.empty()) folders.push_back(options_.share);
  std::error_code ignored;
  const auto file_in = [&](const std::vector<fs::path>& places, const fs::path& end) -> std::optional<fs::path> {
    for (const fs::path& folder : places)
      for (const fs::path& name : {end, fs::path(end).replace_extension(".body")})  // formerly .wrl or .yaml
        if (fs::is_regular_file(folder / name, ignored)) return folder / name;
    return std::nullopt;
  };
  const std::vector<fs::path> ends = ends_of(split_variable(written).rest);
  for (const fs::path& end : ends)
    if (const auto file = file_in(folders, end)) return file;
  const std::vector<fs::path> parts = folders_of_parts(above);
  for (const fs::path& end : ends)
    if (end.has_parent_path() && end.parent_path().has_parent_path())
      if (const auto file = file_in(parts, end)) return file;
  const fs::path beside = project_.parent_path() / fs::path(written).filename();
  return fs::is_regular_file(beside, ignored) ? std::optional(beside) : std::nullopt;
}

std::optional<fs::path> ProjectReader::find_file(const std::string& written, const YamlNode& at) {
  const auto [variable, rest] = split_variable(written);
  const auto folder = folder_of(variable);
  std::error_code ignored;
  if (const auto file = expanded(written); file && fs::exists(*file, ignored)) return file;
  if (folder && variable == "SHARE")  // installation moves samples there
    if (const fs::path sample = folder->parent_path() / "sample" / rest; fs::exists(sample, ignored)) return sample;
  if (const auto similar = find_similar(written)) {
    const fs::path seen = similar->lexically_normal().lexically_proximate(
        fs::absolute(project_, ignored).lexically_normal().parent_path());
    document().warning(at, fmt::format("{} isn't there; {} is taken, a guess", in_quotes(written, 200), seen.string()),
                       variable.empty() ? "" : fmt::format("--variable {}=DIR names the folder", variable));
    return similar;
  }
  if (folder) return *folder / rest;  // whoever reads it reports that it is missing
  document().error(at, fmt::format("{} is below ${{{}}}, whose folder is unknown", in_quotes(written, 200), variable),
                   variable == "SHARE" ? "--share DIR: Choreonoid's share folder, which has default/materials.yaml"
                                       : fmt::format("--variable {}=DIR", variable));
  return std::nullopt;
}

}  // namespace rehearse::import
