// The controllers of the bodies.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "project_run.h"

namespace rehearse::import {
namespace {

using body::Mapping;
namespace fs = std::filesystem;

/// True for a path of this or of another machine: /DIR/X.so, ${VARIABLE}/X.so, C:/DIR/X.dll.
bool is_placed(const std::string& path) {
  return path.starts_with('/') || path.starts_with("${") || (path.size() > 2 && path[1] == ':' && path[2] == '/');
}

}  // namespace

void ProjectReader::read_controllers(const ProjectItem& item, std::set<std::string>& names,
                                     std::vector<ProjectController>& controllers) {
  for (const auto& child : item.children) {
    if (child->type != "SimpleControllerItem") continue;
    if (auto controller = read_controller(*child, names)) controllers.push_back(*std::move(controller));
  }
}

/// The library as a scenario names it: a path, or a name for the search in builds and in REHEARSE_CONTROLLER_PATH.
std::string ProjectReader::library_of(const ProjectItem& item, const std::string& written, const std::string& base) {
  std::string path = written;
  std::ranges::replace(path, '\\', '/');
  const fs::path stem = fs::path(path).replace_extension();
  if (is_placed(path)) {
    std::error_code ignored;
    if (const auto file = expanded(stem.string() + ".so"); file && fs::exists(*file, ignored))
      return path.starts_with('/') ? file->string() : seen_as_library(*file);
    document().note(*item.node,
                    fmt::format("the library {} of the controller {} isn't there; it is searched by its name",
                                in_quotes(written, 200), in_quotes(item.name)));
    return stem.filename().string();
  }
  if (base != "Project directory") return stem.filename().string();
  return seen_as_library(project_.parent_path() / (stem.string() + ".so"));
}

/// The path from the scenario's folder; it has a slash, for a name without one is searched.
std::string ProjectReader::seen_as_library(const fs::path& file) const {
  const std::string seen = seen_from_folder(file);
  return seen.find('/') == std::string::npos ? "./" + seen : seen;
}

std::optional<ProjectController> ProjectReader::read_controller(const ProjectItem& item, std::set<std::string>& names) {
  Mapping keys = data_of(item, file_);
  const std::string written = keys.text({"controller"}).value_or("");
  const std::string base =
      keys.text({"base_directory", "baseDirectory", "RelativePathBase"}).value_or("Controller directory");
  if (written.empty()) {  // Choreonoid runs the project without it
    document().warning(*item.node,
                       fmt::format("the controller {} names no library; it is left out", in_quotes(item.name)),
                       "controller: the name of a library without its ending");
    left_out(item, "it names no library");
    return std::nullopt;
  }
  ProjectController controller;
  controller.name = unique_name(item.name, names);
  controller.library = library_of(item, written, base);
  controller.options = keys.text({"controller_options", "controllerOptions"}).value_or("");
  controller.delay = !keys.flag({"no_delay_mode", "isNoDelayMode", "isImmediateMode"}).value_or(false);
  if (keys.flag({"is_old_target_variable_mode", "isOldTargetVariableMode"}).value_or(false))
    document().warning(*item.node,
                       fmt::format("the controller {} is run in the old target variable mode in Choreonoid; "
                                   "here targets are q_target and dq_target",
                                   in_quotes(item.name)));
  keys.finish();
  read_controllers(item, names, controller.children);
  if (item.parent->type == "SimpleControllerItem" && !controller.children.empty())
    document().warning(*item.node,
                       fmt::format("the controller {} is a child, and has children itself: these are started and "
                                   "stopped, but never called, as in Choreonoid",
                                   in_quotes(item.name)));
  taken(item,
        fmt::format("controller {}: {}{}", controller.name, controller.library,
                    controller.options.empty() ? "" : fmt::format(", options {}", in_quotes(controller.options))));
  return controller;
}

}  // namespace rehearse::import
