// Removes the report beside a trace together with the trace. Internal; a separate file, because code that stores
// goldens writes no reports.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/replaceable.h"

namespace rehearse {

/// The beginning of a report, and of no other file.
inline constexpr std::string_view report_magic = "<!doctype html><!-- a report of Rehearse -->";

/// Removes the report that has the trace's name with .html. A file that is no report of Rehearse stays.
inline void remove_report(const std::filesystem::path& trace) {
  const std::filesystem::path file = std::filesystem::path(trace).replace_extension(".html");
  std::error_code ignored;
  const bool is_there = std::filesystem::is_regular_file(file, ignored);
  if (is_there && check_replaceable(file, report_magic, "report")) std::filesystem::remove(file, ignored);
}

}  // namespace rehearse
