// Where runs beside each other write, so that none finds what another writes. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>
#include <utility>

namespace rehearse {

/// Holds a folder for one process at a time, for as long as it lives. Waits for the others. A folder that doesn't exist
/// is made.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

/// A folder inside another that no other run uses, removed with all that is in it. One that a killed process left is
/// removed by the next run there.
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
  int descriptor_;  // locked while the run goes on
};

/// A run that is compared with a golden, in a folder of its own. What it leaves there (its trace, pictures, a report)
/// moves to where runs wait for a decision when the run is over, whole.
class WaitingRun {
 public:
  /// `pending`: where runs wait. `name`: of the golden.
  static Result<WaitingRun> begin(const std::filesystem::path& pending, const std::string& name);

  const std::filesystem::path& folder() const { return folder_.path(); }

  /// Moves what is left in the folder. If there is no trace, the one that waited before the run began goes: it is no
  /// longer what the program does. Paths in `text` follow. Returns what to say if another run of this golden wrote
  /// there meanwhile; else empty.
  Result<std::string> publish(std::string& text);

 private:
  /// Which file waits; all 0: none.
  struct Identity {
    unsigned long device = 0, inode = 0;
    long seconds = 0, nanoseconds = 0;
    bool operator==(const Identity&) const = default;
  };
  static Identity identity_of(const std::filesystem::path& file);

  WaitingRun(RunFolder folder, std::filesystem::path pending, std::filesystem::path trace)
      : folder_(std::move(folder)),
        pending_(std::move(pending)),
        trace_(std::move(trace)),
        before_(identity_of(trace_)) {}

  RunFolder folder_;
  std::filesystem::path pending_;
  std::filesystem::path trace_;  // where it will wait
  Identity before_;              // what waited when the run began
};

}  // namespace rehearse
