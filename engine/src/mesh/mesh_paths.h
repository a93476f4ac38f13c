// Finds the mesh file that a model file names.
//
// For package://NAME/REST (and likewise model://NAME/REST) these places are searched in order until REST exists:
//   1. the directory that the user gives for NAME, and then nowhere else,
//   2. the directories above the model file that are called NAME,
//   3. ABOVE/NAME for each directory above it,
//   4. the directories whose package.xml contains <name>NAME</name>, at most 4 levels below one of the 6 nearest
//      directories above it,
//   5. the entries of ROS_PACKAGE_PATH, themselves or below them as in 3 and 4, and share/NAME in those of
//      AMENT_PREFIX_PATH,
//   6. ABOVE/REST, without NAME: a guess, with a warning.
// A path without a scheme is relative to the model file, and then tried as in 6; file:// is absolute. Of directories
// above, the nearest is tried first, up to the root. A percent-encoded path is tried as written first.
// The limits of search 4 are in PackageSearch.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "package_search.h"

namespace rehearse {

struct MeshPlace {
  std::filesystem::path file;
  std::string warning;  // how the place was guessed, without absolute paths; empty: it wasn't guessed
};

class MeshPaths {
 public:
  using Packages = std::map<std::string, std::filesystem::path>;

  /// `model_file` as the user names it; `packages`: directories by the name of the package.
  MeshPaths(const std::filesystem::path& model_file, Packages packages);

  /// `written`: the path as in the model file. The result exists, but may be anything, for example a directory.
  Result<MeshPlace> find(const std::string& written);

 private:
  Result<MeshPlace> find_in_package(const std::string& name, const std::string& rest);
  /// `path`: of package:///PATH, as some exporters write it: relative, or beginning with a package's name.
  Result<MeshPlace> find_without_package(const std::string& path);
  Result<MeshPlace> find_relative(const std::string& written);
  std::optional<MeshPlace> find_above(const std::string& rest) const;

  // Possible directories of the package, the most likely first; they need not exist.
  std::vector<std::filesystem::path> places_above(const std::string& name);
  std::vector<std::filesystem::path> places_searched(const std::string& name);
  std::vector<std::filesystem::path> places_of_environment(const std::string& name);

  Diagnostic not_found(const std::string& name, const std::string& rest,
                       const std::vector<std::filesystem::path>& looked_in) const;

  std::vector<std::filesystem::path> above_;  // directories above the model file, the nearest first, without the root
  Packages given_;
  std::vector<std::filesystem::path> ros_paths_;
  std::vector<std::filesystem::path> ament_prefixes_;
  PackageSearch search_;
};

/// Decodes "%20" to a blank, and so on; a '%' without two hexadecimal digits stays as it is.
std::string percent_decoded(std::string_view text);

/// Reports a missing file: the first part of its path that is missing, and whether only the case of a name differs.
Diagnostic no_such_file(const std::filesystem::path& file);

}  // namespace rehearse
