// The file of a report: the page, with the data in its place. Internal.
#pragma once

#include <rehearse/report.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "core/golden/stale_report.h"
#include "core/mcap/draft.h"
#include "report_blobs.h"

namespace rehearse {

/// The first of these files that exists; their paths are relative to the folder of this library. Empty: none.
std::filesystem::path beside_library(std::initializer_list<const char*> files);

/// Writes a report from its head to its end, under a temporary name until it is complete.
class ReportFile {
 public:
  /// `page`: the page to fill. `sources`: files that must not be overwritten. Fails if `file` exists and isn't a
  /// report.
  static Result<ReportFile> begin(const std::filesystem::path& file, const std::filesystem::path& page,
                                  std::span<const std::filesystem::path> sources);

  void put_blob(const std::string& id, ByteSpan coded);
  /// Writes the object; then the file is renamed to its final name.
  Result<void> finish(const ReportJson& object);

  std::uintmax_t bytes() const { return bytes_; }
  std::uintmax_t data_bytes() const { return data_bytes_; }

 private:
  ReportFile(mcap::Draft draft, std::filesystem::path file, std::string tail);
  void put(std::string_view text);
  void put_data(std::string_view text);

  mcap::Draft draft_;
  std::filesystem::path file_;  // final name of the file
  std::ofstream stream_;
  std::string tail_;  // of the page
  std::string line_;  // element of a blob
  std::uintmax_t bytes_ = 0, data_bytes_ = 0;
};

}  // namespace rehearse
