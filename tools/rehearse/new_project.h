// The files of tools/new_project at the time when the command was built.
#pragma once

#include <span>
#include <string_view>

namespace rehearse::tool {

struct ProjectFile {
  std::string_view path;  // relative to the project
  std::string_view text;  // @PROJECT@ is replaced by the project's name
};

std::span<const ProjectFile> new_project_files();

}  // namespace rehearse::tool
