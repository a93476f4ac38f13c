// The recordings of a report, as files. Internal.
#pragma once

#include <rehearse/report.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "report_run.h"

namespace rehearse {

/// A recording, or the requested part of it, which is a temporary file meanwhile.
class SourceFile {
 public:
  static Result<SourceFile> make(const std::filesystem::path& file, const std::filesystem::path& scratch,
                                 const ReportOptions& options);
  ~SourceFile() {
    std::error_code ignored;
    if (!scratch_.empty()) std::filesystem::remove(scratch_, ignored);
  }
  SourceFile(SourceFile&& other) noexcept
      : path_(std::move(other.path_)), scratch_(std::exchange(other.scratch_, std::filesystem::path())) {}
  SourceFile& operator=(SourceFile&&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  SourceFile(std::filesystem::path path, std::filesystem::path scratch)
      : path_(std::move(path)), scratch_(std::move(scratch)) {}

  std::filesystem::path path_;
  std::filesystem::path scratch_;  // empty: there is none
};

/// Reads a recording of Rehearse, whose name in messages is `name`.
Result<ReportedRun> read_run(const SourceFile& file, const std::filesystem::path& name);

}  // namespace rehearse
