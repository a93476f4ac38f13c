// The files of tools/new_project at the time when the command was built.
#pragma once

#include <span>
#include <string_view>

namespace rehearse::tool {

struct ProjectFile {
  std::string_view language;  // of the projects that have this file; empty: of all; "built": of all but Python
  std::string_view path;      // relative to the project
  std::string_view text;      // names between @, as @PROJECT@, are replaced
};

std::span<const ProjectFile> new_project_files();

/// The repository of Rehearse from which this command was built; empty: not known.
struct BuiltFrom {
  std::string_view repository;  // its address
  std::string_view commit;
};

BuiltFrom built_from();

}  // namespace rehearse::tool
