// RecordedFiles: the files that controllers read in a run, for a replay where they are missing.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace rehearse {

/// While this object exists, controllers find the recorded copies of missing files: shareDirPath() is a folder with
/// copies, and motions that are missing elsewhere are read from it by their names. An existing file is read unchanged,
/// so that a change since the recording is noticed.
class RecordedFiles {
 public:
  explicit RecordedFiles(const mcap::Reader& recording);
  ~RecordedFiles();
  RecordedFiles(const RecordedFiles&) = delete;
  RecordedFiles& operator=(const RecordedFiles&) = delete;

 private:
  void set(const char* variable, const std::filesystem::path& value);

  std::filesystem::path folder_;                              // empty: nothing is missing
  std::map<std::string, std::optional<std::string>> before_;  // former values of the changed environment variables
};

}  // namespace rehearse
