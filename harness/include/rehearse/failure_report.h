// The report of a check that failed: what `rehearse check` and the assertions of tests leave behind to look at.
#pragma once

#include <rehearse/check.h>
#include <rehearse/report.h>

#include <filesystem>
#include <optional>

namespace rehearse {

struct FailureReport {
  std::filesystem::path file;
  ReportSummary summary;
};

/// What a check has found, for the head of a report.
ReportVerdict report_verdict(const CheckReport& checked);

/// Writes the report of a check that isn't within, of the fresh trace that it left (check_scenario: `actual`, or else
/// that of the plant level) beside the golden, beside that trace and under its name with .html. None if nothing failed,
/// or if there is no such trace, as of a check of the controller level alone. The report of a trace that is no longer
/// there is removed. The scenario's tolerances decide.
Result<std::optional<FailureReport>> write_failure_report(const CheckReport& checked, const Scenario& scenario,
                                                          const std::filesystem::path& golden,
                                                          const std::filesystem::path& actual,
                                                          ReportOptions options = {});

}  // namespace rehearse
