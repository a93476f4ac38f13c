// PackageSearch: finds packages by the name that their package.xml states, within bounds.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace rehearse {

/// The cost of a search is bounded: it reads at most `most_entries` directory entries, `most_levels` levels deep. It
/// doesn't enter hidden or linked directories, and starts neither at nor above the user's home nor at the first level
/// below the root: so a model file in such a directory doesn't cause a search of the whole disk.
class PackageSearch {
 public:
  static constexpr int most_entries = 20'000;
  static constexpr int most_levels = 4;

  /// Searches `root` and below, level by level, names in alphabetical order. Each directory is read only once.
  void look_into(const std::filesystem::path& root);

  /// The directories whose package.xml contains that name, in the order in which they were found.
  std::vector<std::filesystem::path> packages(const std::string& name) const;
  /// The directories of that name, in the order in which they were found.
  std::vector<std::filesystem::path> directories(const std::string& name) const;
  /// True if the search reached its limit; there may be more directories.
  bool gave_up() const { return entries_ > most_entries; }

 private:
  std::vector<std::filesystem::path> enter(const std::filesystem::path& directory);

  int entries_ = 0;
  std::set<std::filesystem::path> seen_;
  std::multimap<std::string, std::filesystem::path> packages_;
  std::multimap<std::string, std::filesystem::path> directories_;
};

}  // namespace rehearse
