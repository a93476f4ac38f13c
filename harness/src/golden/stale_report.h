// The report beside a trace goes when the trace does. Internal; on its own, because whoever keeps goldens writes none.
#pragma once

#include <filesystem>
#include <string_view>

#include "mcap/replaceable.h"

namespace rehearse {

/// How a report begins; nothing else does.
inline constexpr std::string_view report_magic = "<!doctype html><!-- a report of Rehearse -->";

/// Removes the report that has the trace's name with .html. What is no report of ours stays.
inline void remove_report(const std::filesystem::path& trace) {
  const std::filesystem::path file = std::filesystem::path(trace).replace_extension(".html");
  std::error_code ignored;
  const bool is_there = std::filesystem::is_regular_file(file, ignored);
  if (is_there && check_replaceable(file, report_magic, "report")) std::filesystem::remove(file, ignored);
}

}  // namespace rehearse
