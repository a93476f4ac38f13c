// The output files of exports: their names, and writing many of them. Internal.
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

/// Unique file names for topics: "/SR1/WAIST/pose" is "SR1_WAIST_pose".
class TopicNames {
 public:
  std::string name_for(std::string_view topic);

 private:
  std::set<std::string> taken_;
};

/// The beginning of a table of Rehearse, and of no other file.
inline constexpr std::string_view table_magic = "time [s]";

/// Makes the folder if it doesn't exist.
Result<void> make_folder(const std::filesystem::path& folder);

/// Replaces the file after all bytes are written: on a full disk the old file stays.
Result<void> write_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// Appends lines to many files in large pieces, without keeping them open. The files are renamed to their targets when
/// all of them are complete; unfinished files are removed.
class LineFiles {
 public:
  LineFiles() = default;
  ~LineFiles();
  LineFiles(const LineFiles&) = delete;
  LineFiles& operator=(const LineFiles&) = delete;

  /// Begins the file with this line.
  Result<void> begin(const std::filesystem::path& file, std::string_view line);
  Result<void> append(const std::filesystem::path& file, std::string_view line);
  /// Writes the remaining lines, and replaces the files.
  Result<void> finish();

 private:
  static constexpr std::size_t max_held = 16 << 20;  // [bytes]
  Result<void> flush();

  std::map<std::filesystem::path, std::string> held_;
  std::size_t size_ = 0;  // size of all lines that aren't written yet [bytes]
};

}  // namespace rehearse
