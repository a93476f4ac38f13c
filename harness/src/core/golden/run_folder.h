// Separate folders for parallel runs, so that no run finds the files of another run. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "base/file_descriptor.h"
#include "base/file_identity.h"

namespace rehearse {

/// Locks a folder for one process at a time, during its lifetime. Waits for other processes. Creates the folder if it
/// doesn't exist.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  FileDescriptor descriptor_;
};

/// A folder inside another folder for one run at a time; it is removed with its contents. The next process there
/// removes the folder of a killed one.
class RunFolder {
 public:
  static Result<RunFolder> make(const std::filesystem::path& parent);
  RunFolder(RunFolder&& other) noexcept;
  ~RunFolder();
  RunFolder& operator=(RunFolder&&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  RunFolder(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

  std::filesystem::path path_;
  FileDescriptor descriptor_;  // locked during the run
};

/// A run that is compared with a golden, in a separate folder. When the run is over, its complete results (its trace,
/// pictures, a report) are moved to the pending folder.
class WaitingRun {
 public:
  /// `folder`: in the pending folder; no other run has it at the same time. `name`: name of the golden.
  WaitingRun(const RunFolder& folder, const std::string& name);
  /// Empties the folder.
  ~WaitingRun();
  WaitingRun(const WaitingRun&) = delete;
  WaitingRun& operator=(const WaitingRun&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

  /// Moves the files in the folder. If there is no trace, removes the pending trace from before the run, which is out
  /// of date. Paths in `text` are adapted. Returns a message if another run of this golden wrote there meanwhile; else
  /// empty.
  Result<std::string> publish(std::string& text);

 private:
  std::filesystem::path folder_;
  std::filesystem::path pending_;
  std::filesystem::path trace_;         // its future pending path
  std::optional<FileIdentity> before_;  // of the pending file when the run began
};

}  // namespace rehearse
