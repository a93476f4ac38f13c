// How large a report would be, known before the work is done. Internal.
#pragma once

#include <rehearse/report.h>

#include <filesystem>
#include <span>

namespace rehearse {

/// Fails if the report of these recordings would be larger than `max_size`, and says which part of them would not be.
Result<void> check_report_size(std::span<const std::filesystem::path> traces, const std::filesystem::path& report,
                               const ReportOptions& options);

}  // namespace rehearse
