// Estimates the size of a report before it is made. Internal.
#pragma once

#include <rehearse/report.h>

#include <filesystem>
#include <span>

namespace rehearse {

/// Fails if the report of these recordings would be larger than `max_size`, and names a part of them that would be
/// small enough.
Result<void> check_report_size(std::span<const std::filesystem::path> traces, const std::filesystem::path& report,
                               const ReportOptions& options);

}  // namespace rehearse
