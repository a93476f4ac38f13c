// Results as lines of JSON. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "base/file_descriptor.h"

namespace rehearse {

nlohmann::ordered_json json_of_result(const CaseResult& result);
/// None: it is no result.
std::optional<CaseResult> result_of_json(const nlohmann::ordered_json& object);

/// Without line break.
std::string line_of(const CaseResult& result);
/// None: the line is no result, as one that was cut.
std::optional<CaseResult> result_of_line(std::string_view line);

/// The sentence with # in the place of each number: equal for failures of one kind.
std::string without_numbers(std::string_view sentence);

/// A file to which one process appends results. Nothing is buffered, so that a kill cuts the last line at most.
class ResultFile {
 public:
  /// Locks the file. Fails if another process has it open. A line that was cut is removed.
  static Result<ResultFile> open(const std::filesystem::path& file);

  /// Fails if the disk is full; nothing of the line is left then.
  Result<void> append(const CaseResult& result);

 private:
  ResultFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  std::filesystem::path path_;
  FileDescriptor descriptor_;
};

}  // namespace rehearse
