// RecordedFiles: the files that controllers read in a run, for a replay where they are missing.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace rehearse {

/// While it exists, controllers find the recorded copies of files that aren't there: shareDirPath() is a folder with
/// copies, and motions that are missing elsewhere are read from it by their names. A file that is there is read as it
/// is, so that its change is noticed.
class RecordedFiles {
 public:
  explicit RecordedFiles(const mcap::Reader& recording);
  ~RecordedFiles();
  RecordedFiles(const RecordedFiles&) = delete;
  RecordedFiles& operator=(const RecordedFiles&) = delete;

 private:
  void set(const char* variable, const std::filesystem::path& value);

  std::filesystem::path folder_;                              // empty: nothing is missing
  std::map<std::string, std::optional<std::string>> before_;  // environment variables that were changed
};

}  // namespace rehearse
