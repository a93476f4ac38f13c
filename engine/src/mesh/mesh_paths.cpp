#include "mesh_paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <system_error>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// `rest` below `directory`, as written or percent-decoded.
std::optional<fs::path> find_below(const fs::path& directory, const std::string& rest) {
  for (const std::string& path : {rest, percent_decoded(rest)}) {
    if (is_there(directory / path)) return directory / path;
  }
  return std::nullopt;
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

/// The names in a directory that equal `name` except for upper and lower case, in alphabetical order.
std::vector<std::string> names_like(const fs::path& directory, const std::string& name) {
  std::vector<std::string> alike;
  std::error_code problem;
  fs::directory_iterator entry(directory, problem);
  for (int looked_at = 0; !problem && entry != fs::directory_iterator() && looked_at < PackageSearch::most_entries;
       ++looked_at, entry.increment(problem)) {
    const std::string other = entry->path().filename().string();
    if (lower_case(other) == lower_case(name)) alike.push_back(other);
  }
  std::ranges::sort(alike);
  return alike;
}

/// The directories of an environment variable like PATH.
std::vector<fs::path> directories_of(const char* variable) {
  std::vector<fs::path> directories;
  const char* value = std::getenv(variable);
  std::string_view rest = value == nullptr ? "" : value;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) directories.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return directories;
}

constexpr std::size_t searched_ancestors = 6;
constexpr const char* ways =
    "package://NAME/PATH, model://NAME/PATH, file:///PATH, or a path relative to the model file";

}  // namespace

std::string percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char byte = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      decoded += static_cast<char>(byte);
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

Diagnostic no_such_file(const fs::path& file) {
  fs::path whole;
  for (const fs::path& part : file) {
    if (whole.empty() || part.empty() || is_there(whole / part)) {
      whole /= part;
      continue;
    }
    std::string message = fmt::format("there is no '{}' in {}", part.string(), whole.string());
    for (const std::string& other : names_like(whole, part.string())) message += fmt::format("; there is '{}'", other);
    return error(std::move(message));
  }
  return error(fmt::format("there is no '{}'", file.filename().string()));
}

MeshPaths::MeshPaths(const fs::path& model_file, Packages packages)
    : given_(std::move(packages)),
      ros_paths_(directories_of("ROS_PACKAGE_PATH")),
      ament_prefixes_(directories_of("AMENT_PREFIX_PATH")) {
  std::error_code ignored;
  fs::path directory = fs::absolute(model_file, ignored).lexically_normal().parent_path();
  for (; directory.has_relative_path(); directory = directory.parent_path()) above_.push_back(directory);
}

Result<MeshPlace> MeshPaths::find(const std::string& written) {
  if (written.empty()) return error("the name of its file is empty", ways);
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (!written.starts_with(scheme)) continue;
    const std::string path = written.substr(scheme.size());
    const std::size_t slash = path.find('/');
    if (slash == std::string::npos || path.find_first_not_of('/', slash) == std::string::npos) {
      return error(fmt::format("{} is not followed by a name and a path", scheme), ways);
    }
    const std::string rest = path.substr(path.find_first_not_of('/', slash));
    return slash == 0 ? find_without_package(rest) : find_in_package(path.substr(0, slash), rest);
  }
  if (written.starts_with("file://")) {
    const std::string path = written.substr(std::string_view("file://").size());
    if (!path.starts_with('/')) return error("file:// is not followed by an absolute path", "file:///PATH");
    if (const auto found = find_below("/", path)) return MeshPlace{*found, ""};
    return no_such_file(path);
  }
  if (const std::size_t scheme = written.find("://"); scheme != std::string::npos) {
    return error(fmt::format("nothing is read from {}", written.substr(0, scheme + 3)), ways);
  }
  return find_relative(written);
}

Result<MeshPlace> MeshPaths::find_relative(const std::string& written) {
  const fs::path directory = above_.empty() ? fs::path("/") : above_.front();
  if (const auto found = find_below(directory, written)) return MeshPlace{*found, ""};
  if (const auto found = find_above(written)) return *found;
  Diagnostic missing = no_such_file((directory / written).lexically_normal());
  if (written.find('\\') != std::string::npos) missing.hint = "write / instead of \\";
  return missing;
}

Result<MeshPlace> MeshPaths::find_without_package(const std::string& path) {
  Result<MeshPlace> relative = find_relative(path);
  const std::size_t slash = path.find('/');
  if (relative || slash == std::string::npos) return relative;
  Result<MeshPlace> packaged = find_in_package(path.substr(0, slash), path.substr(slash + 1));
  return packaged ? packaged : relative;
}

std::optional<MeshPlace> MeshPaths::find_above(const std::string& rest) const {
  if (fs::path(rest).is_absolute()) return std::nullopt;
  for (const fs::path& directory : above_) {
    if (const auto found = find_below(directory, rest)) {
      return MeshPlace{*found, fmt::format("it is taken from {}, a guess",
                                           found->lexically_normal().lexically_relative(above_.front()).string())};
    }
  }
  return std::nullopt;
}

Result<MeshPlace> MeshPaths::find_in_package(const std::string& name, const std::string& rest) {
  if (const auto given = given_.find(name); given != given_.end()) {
    if (const auto found = find_below(given->second, rest)) return MeshPlace{*found, ""};
    Diagnostic missing = no_such_file((given->second / rest).lexically_normal());
    missing.hint = fmt::format("package '{}' was given as {}", name, given->second.string());
    return missing;
  }
  if (name == "HOME")  // ${HOME} of a body
    for (const fs::path& home : directories_of("HOME"))
      if (const auto found = find_below(home, rest)) return MeshPlace{*found, ""};
  std::vector<fs::path> looked_in;
  for (const auto places : {&MeshPaths::places_above, &MeshPaths::places_searched, &MeshPaths::places_of_environment}) {
    for (const fs::path& directory : (this->*places)(name)) {
      if (std::error_code ignored; !fs::is_directory(directory, ignored)) continue;
      if (const auto found = find_below(directory, rest)) return MeshPlace{*found, ""};
      looked_in.push_back(directory);
    }
  }
  if (auto found = find_above(rest)) {
    found->warning = fmt::format("package '{}' doesn't contain the file; {}", name, found->warning);
    return *found;
  }
  return not_found(name, rest, looked_in);
}

std::vector<fs::path> MeshPaths::places_above(const std::string& name) {
  std::vector<fs::path> places;
  std::ranges::copy_if(above_, std::back_inserter(places),
                       [&name](const fs::path& directory) { return directory.filename() == name; });
  for (const fs::path& directory : above_) places.push_back(directory / name);
  return places;
}

std::vector<fs::path> MeshPaths::places_searched(const std::string& name) {
  for (std::size_t i = 0; i < std::min(above_.size(), searched_ancestors); ++i) search_.look_into(above_[i]);
  return search_.packages(name);
}

std::vector<fs::path> MeshPaths::places_of_environment(const std::string& name) {
  std::vector<fs::path> places;
  for (const fs::path& entry : ros_paths_) {
    if (entry.filename() == name) places.push_back(entry);
    places.push_back(entry / name);
    search_.look_into(entry);
  }
  for (fs::path& package : search_.packages(name)) places.push_back(std::move(package));
  for (const fs::path& prefix : ament_prefixes_) places.push_back(prefix / "share" / name);
  return places;
}

Diagnostic MeshPaths::not_found(const std::string& name, const std::string& rest,
                                const std::vector<fs::path>& looked_in) const {
  Diagnostic missing = looked_in.empty() ? error(fmt::format("there is no package '{}'", name))
                                         : no_such_file((looked_in.front() / rest).lexically_normal());
  std::string directory = "DIRECTORY";
  for (const fs::path& guess : search_.directories(name)) {
    if (!find_below(guess, rest)) continue;
    directory = guess.string();
    break;
  }
  missing.hint = fmt::format("say where the package is: --package {0}={1}, or packages: {{{0}: {1}}} in a scenario",
                             name, directory);
  if (search_.gave_up()) {
    missing.hint += fmt::format("; the search for it ended after {} directory entries", PackageSearch::most_entries);
  }
  return missing;
}

}  // namespace rehearse
