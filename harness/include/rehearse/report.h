// Report: a run to look at in a browser, beside its golden if there is one, as one HTML file that needs nothing else.
//
// It has the verdict, a time line, the robots in motion, plots of all series, the pictures, what controllers said, and
// what both runs were made with. Its page is built by npm from tools/report and stands in share/rehearse; its data is
// described in tools/report/FORMAT.md. Nothing is simulated and no controller is run.
#pragma once

#include <rehearse/check.h>
#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// What somebody who judged the run has found: a check, which knows more than a comparison.
struct ReportVerdict {
  std::string sentence;                            // without a full stop
  std::string state;                               // "equal", "within", "beyond" or "failed"
  std::map<std::string, std::string> levels = {};  // "controller", "plant", "closed": each "equal", "within", ...
  std::optional<Divergence> first = std::nullopt;  // the place to look at first; none: the comparison's
};

struct ReportOptions {
  std::optional<double> from;       // [s], inclusive; none: the run's beginning
  std::optional<double> until;      // [s], exclusive; none: the run's end
  std::vector<std::string> topics;  // globs: whose series and pictures are in it; empty: all
  /// Of the comparison; none: those of the golden's scenario.
  std::optional<std::vector<ToleranceRule>> tolerances;
  std::optional<double> horizon;         // values are judged up to then [s]; none: all
  std::optional<ReportVerdict> verdict;  // none: that of the comparison
  /// The file that the run's scenario was read from, beside which models and their meshes stand; empty: they are looked
  /// for in the repository that the recording or the working directory is in.
  std::filesystem::path scenario;
  /// The page that gets the data; empty: the one that belongs to this library.
  std::filesystem::path page;
  /// Of the file; more than that no browser opens with pleasure [bytes].
  std::uintmax_t max_size = std::uintmax_t{400} << 20;
  /// Told how many of how many parts are done; null: nobody wants to know.
  std::function<void(std::int64_t, std::int64_t)> progress;
};

/// What was written.
struct ReportSummary {
  std::string verdict;                     // a sentence, without a full stop
  std::string state;                       // as in ReportVerdict, or "alone"
  std::optional<std::int64_t> first_tick;  // where it differs first; none: it doesn't
  std::int64_t begin = 0, end = 0;         // ticks: the first, and one past the last
  std::uintmax_t bytes = 0;                // of the file
  std::uintmax_t data_bytes = 0;           // of it: all but the page
  std::vector<std::string> omitted;        // what it leaves out, and why: sentences
};

/// Where the page stands that reports are made of: REHEARSE_REPORT_PAGE in the environment says it, for whoever works
/// on the page, else it belongs to this library. Fails, and says what to install, if it was not built.
Result<std::filesystem::path> report_page();

/// What opens a report, at that tick if there is one: "file:///home/me/a%20run.html#tick=123". Terminals make a link of
/// it.
std::string report_link(const std::filesystem::path& report, std::optional<std::int64_t> tick = std::nullopt);

/// How large the report of a recording would be, about, by the index of its file [bytes].
Result<std::uintmax_t> estimated_report_size(const std::filesystem::path& trace, const ReportOptions& options = {});

/// Writes the report of `trace`, beside `golden` if there is one, under another name until it is whole. A recording
/// that is cut or damaged is reported as far as it is whole. Fails, with nothing written, if `trace` or `golden` is no
/// recording of ours, if the page was not built, if the report would be larger than `max_size`, or if `report` exists
/// and isn't a report.
Result<ReportSummary> write_report(const std::filesystem::path& trace,
                                   const std::optional<std::filesystem::path>& golden,
                                   const std::filesystem::path& report, const ReportOptions& options = {});

/// The report of a check that failed, which `rehearse check` and the assertions of tests leave behind.
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
