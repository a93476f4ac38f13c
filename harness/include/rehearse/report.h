// Report: an HTML file that shows a run in a browser, beside its golden if there is one. It needs no other file.
//
// A report contains the verdict, a time line, the robots in motion and plots of all series. It also has the pictures,
// the messages of controllers, and the provenance of both runs. npm builds the page from tools/report; it is installed
// in share/rehearse. tools/report/FORMAT.md describes its data. No simulation and no controller is run.
#pragma once

#include <rehearse/check.h>
#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The verdict of a check. In contrast to a comparison it covers expectations and failures, and has one verdict per
/// level.
struct ReportVerdict {
  std::string sentence;  // without a full stop
  /// "equal", "within", "bits" (bits differ that must not, all within tolerance), "beyond", "violated" or "failed".
  std::string state;
  std::map<std::string, std::string> levels = {};  // "controller", "plant", "closed": each "equal", "within", ...
  std::optional<Divergence> first = std::nullopt;  // first difference to show; none: that of the comparison
  /// The sentence without violated expectations, which the page lists; none: it contains none.
  std::optional<std::string> besides = std::nullopt;
};

/// A frame of a call stack.
struct StackFrame {
  std::string function, file;
  int line = 0;                     // 0: unknown
  int begin = 0;                    // line of source[0]
  std::vector<std::string> source;  // the lines around; empty: the file can't be read
};

/// The call stack of a controller in control() at a tick, at the line that last changes the command in the tick; the
/// innermost frame comes first.
struct CallStack {
  std::string controller;  // BODY/NAME
  std::string command;     // JOINT/QUANTITY: hinge/u; empty: a command of no joint
  std::int64_t tick = 0;
  std::vector<StackFrame> frames;
};

struct ReportOptions {
  std::string title;                // of the page: the scenario or the test; empty: the recording's file
  std::optional<double> from;       // [s], inclusive; none: the run's beginning
  std::optional<double> until;      // [s], exclusive; none: the run's end
  std::vector<std::string> topics;  // globs of the topics whose series and pictures are included; empty: all
  /// Tolerances of the comparison; none: those of the golden's scenario.
  std::optional<std::vector<ToleranceRule>> tolerances;
  std::optional<double> horizon;  // values are judged up to this time [s]; none: all
  /// The comparison of both recordings, whose findings are shown; none: both are compared.
  std::optional<Comparison> comparison;
  std::optional<ReportVerdict> verdict;  // none: that of the comparison and the expectations
  std::vector<std::string> notes;        // sentences below the verdict, such as of a library that is out of date
  /// The judged expectations; none: those of the recorded scenario are judged.
  std::optional<std::vector<ExpectationResult>> expectations;
  /// The file of the run's scenario, beside which models and meshes are. Empty: they are searched in the repository
  /// that contains the recording or the working directory.
  std::filesystem::path scenario;
  /// The page into which the data is written; empty: the page of this library.
  std::filesystem::path page;
  /// Called for the first command that differs, with the members of CallStack; null: the report has no call stack.
  std::function<Result<CallStack>(const std::string& controller, const std::string& command, std::int64_t tick)>
      call_stack;
  /// The times of control() in the run, by the clock of this machine; empty: the report shows none.
  std::vector<ControlTimes> control_times = {};
  /// The coverage of the run's controllers as to_json(CoverageReport) writes it (coverage.h); empty: the report has
  /// none.
  std::string coverage = {};
  /// About the largest size of the data; browsers open larger files slowly. A longer run is shown in part: `omitted`
  /// says which [bytes].
  std::uintmax_t max_size = 28'000'000;
  /// Called with the number of finished parts and of all parts; null: not.
  std::function<void(std::int64_t, std::int64_t)> progress;
};

/// The result of write_report().
struct ReportSummary {
  std::string verdict;                     // a sentence, without a full stop
  std::string state;                       // as in ReportVerdict, or "alone"
  std::optional<std::int64_t> first_tick;  // of the first difference, or else of the first violation; none: neither
  std::int64_t begin = 0, end = 0;         // ticks: the first, and one past the last
  std::uintmax_t bytes = 0;                // of the file
  std::uintmax_t data_bytes = 0;           // size of the data: the file without the page
  std::vector<std::string> omitted;        // omitted parts with reasons: sentences
};

/// The page from which reports are made: REHEARSE_REPORT_PAGE in the environment, for developers of the page, else the
/// page of this library. If the page was not built, it fails with a message that names the packages to install.
Result<std::filesystem::path> report_page();

/// A link that opens a report, at that tick if given: "file:///home/me/a%20run.html#tick=123". Terminals make it
/// clickable.
std::string report_link(const std::filesystem::path& report, std::optional<std::int64_t> tick = std::nullopt);

/// Writes a page without a run: the coverage of one or more recordings beside the source of the controllers, with the
/// recording and the tick in which each line is executed first. `coverage`: as ReportOptions::coverage. `page`: as
/// ReportOptions::page. Returns the size of the file [bytes]. Fails if `file` exists and isn't a report, if it can't be
/// written, if the page wasn't built, or if `coverage` isn't such a text.
Result<std::uintmax_t> write_coverage_page(const std::string& coverage, const std::filesystem::path& file,
                                           const std::filesystem::path& page = {});

/// Writes the report of `trace`, beside `golden` if there is one, under a temporary name until it is complete. A
/// recording that is cut or damaged is reported up to the damage. The memory that it takes doesn't depend on the length
/// of the run. Fails, and writes nothing, in these cases: `trace` or `golden` is no recording of Rehearse, the page was
/// not built, or `report` exists and isn't a report.
Result<ReportSummary> write_report(const std::filesystem::path& trace,
                                   const std::optional<std::filesystem::path>& golden,
                                   const std::filesystem::path& report, const ReportOptions& options = {});

/// The report of a failed check, written by `rehearse check` and the assertions of tests.
struct FailureReport {
  std::filesystem::path file;
  ReportSummary summary;
};

/// The verdict of a check, for the head of a report.
ReportVerdict report_verdict(const CheckReport& checked);

/// Writes the report of a check that isn't within tolerance. It shows the fresh trace of the check (check_scenario:
/// `actual`, or else that of the plant level) beside the golden. The report has the trace's name with .html, in the
/// same folder. None if nothing failed, or if there is no such trace, as for a check of the controller level alone. The
/// report of a trace that no longer exists is removed. The scenario's tolerances decide.
Result<std::optional<FailureReport>> write_failure_report(const CheckReport& checked, const Scenario& scenario,
                                                          const std::filesystem::path& golden,
                                                          const std::filesystem::path& actual,
                                                          ReportOptions options = {});

}  // namespace rehearse
