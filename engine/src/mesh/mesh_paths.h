// Where a mesh is that a model file names.
//
// package://NAME/REST (and model://NAME/REST, the same) is looked for, until REST is there, in
//   1. the directory that the user gives for NAME, and then nowhere else,
//   2. the directories above the model file that are called NAME,
//   3. ABOVE/NAME for each directory above it,
//   4. the directories whose package.xml says <name>NAME</name>, at most 4 levels below one of the 6 nearest
//      directories above it,
//   5. the entries of ROS_PACKAGE_PATH, themselves or below them as in 3 and 4, and share/NAME in those of
//      AMENT_PREFIX_PATH,
//   6. ABOVE/REST, without NAME: a guess, with a warning.
// A path without a scheme is relative to the model file, and then tried as in 6; file:// is absolute. Of directories
// above, the nearest counts first, up to the root. What is percent-encoded is tried as written first.
// PackageSearch says what bounds the search of 4.
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
  std::string warning;  // how it was guessed; empty: it wasn't. No path of the machine stands in it
};

class MeshPaths {
 public:
  using Packages = std::map<std::string, std::filesystem::path>;

  /// `model_file` as the user names it; `packages`: directories by the name of the package.
  MeshPaths(const std::filesystem::path& model_file, Packages packages);

  /// `written` as the model file has it. Of the result only that it exists is known.
  Result<MeshPlace> find(const std::string& written);

 private:
  Result<MeshPlace> find_in_package(const std::string& name, const std::string& rest);
  Result<MeshPlace> find_relative(const std::string& written);
  std::optional<MeshPlace> find_above(const std::string& rest) const;

  // Where the package may be, most likely first; not all of them need be there.
  std::vector<std::filesystem::path> places_above(const std::string& name);
  std::vector<std::filesystem::path> places_searched(const std::string& name);
  std::vector<std::filesystem::path> places_of_environment(const std::string& name);

  Diagnostic not_found(const std::string& name, const std::string& rest,
                       const std::vector<std::filesystem::path>& looked_in) const;

  std::vector<std::filesystem::path> above_;  // the nearest first, without the root
  Packages given_;
  std::vector<std::filesystem::path> ros_paths_;
  std::vector<std::filesystem::path> ament_prefixes_;
  PackageSearch search_;
};

/// "%20" becomes a blank, and so on; what isn't two hexadecimal digits stays.
std::string percent_decoded(std::string_view text);

/// Says that it isn't there, from where on, and if only the case of a name differs.
Diagnostic no_such_file(const std::filesystem::path& file);

}  // namespace rehearse
