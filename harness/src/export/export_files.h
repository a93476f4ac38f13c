// Where exports go: names of files, and writing many of them. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace rehearse {

/// Names for topics: "/SR1/WAIST/pose" is "SR1_WAIST_pose", and no two are alike.
class TopicNames {
 public:
  std::string name_for(std::string_view topic);

 private:
  std::set<std::string> taken_;
};

/// How a table of ours begins; nothing else does.
inline constexpr std::string_view table_magic = "time [s]";

/// Makes the folder if it isn't there.
Result<void> make_folder(const std::filesystem::path& folder);

/// Replaces the file, once all of it is written: on a full disk the old one stays.
Result<void> write_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// Appends lines to many files without keeping them open, and in large pieces. They take their places when all of them
/// are whole; what was begun and not finished is removed.
class LineFiles {
 public:
  LineFiles() = default;
  ~LineFiles();
  LineFiles(const LineFiles&) = delete;
  LineFiles& operator=(const LineFiles&) = delete;

  /// Begins the file with that line.
  Result<void> begin(const std::filesystem::path& file, std::string_view line);
  Result<void> append(const std::filesystem::path& file, std::string_view line);
  /// Writes what is left, and replaces the files.
  Result<void> finish();

 private:
  static constexpr std::size_t max_held = 16 << 20;  // [bytes]
  Result<void> flush();

  std::map<std::filesystem::path, std::string> held_;
  std::size_t size_ = 0;  // of all that is held
};

}  // namespace rehearse
