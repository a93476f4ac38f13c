#include "test_reports.h"

#include <rehearse/report.h>

#include <cstdlib>
#include <string_view>

#include "core/golden/run_folder.h"
#include "core/host/source_age.h"
#include "core/scenario/trace_scenario.h"
#include "core/simulation/recorded_view.h"
#include "test_process.h"
#include "test_recordings.h"
#include "viewing/report/call_stack.h"

namespace rehearse::internal {
namespace {

namespace fs = std::filesystem;

enum class Wanted { never, of_failures, always };

Wanted wanted() {
  const char* stated = std::getenv("REHEARSE_REPORT");
  const std::string_view word = stated ? stated : "";
  return word == "always" ? Wanted::always : word == "never" ? Wanted::never : Wanted::of_failures;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// The scenario of the test's file, or else of its recording.
Result<Scenario> scenario_of_test(const Trace& trace, const fs::path& file) {
  return file.empty() ? recorded_scenario(trace) : Scenario::load(file);
}

ReportOptions options_of(const Trace& trace, const std::string& test, const TestVerdict& verdict,
                         const ComparedTest& compared) {
  ReportOptions options;
  options.title = test;
  options.tolerances = compared.tolerances;
  options.horizon = compared.horizon;
  options.scenario = compared.scenario;
  if (const auto scenario = scenario_of_test(trace, compared.scenario))
    options.notes = notes_on_old_libraries(*scenario, {});
  if (compared.checked) {
    options.verdict = report_verdict(*compared.checked);
    if (compared.checked->controller == LevelState::differs) options.call_stack = call_stack_of(compared.golden, {});
  } else if (!verdict.passed) {
    options.verdict = ReportVerdict{first_line(verdict.message), compared.differs_in_bits_alone ? "bits" : "beyond"};
  }
  return options;
}

std::vector<std::uint8_t> thumbnail_of(const Trace& trace, const fs::path& scenario_file, std::int64_t tick) {
  const auto scenario = scenario_of_test(trace, scenario_file);
  return scenario ? rehearse::thumbnail_of(*scenario, trace, tick) : std::vector<std::uint8_t>();
}

/// The address for a message: a link, in CI a path.
std::string address_of(const fs::path& file, std::optional<std::int64_t> tick = std::nullopt) {
  return is_ci() ? file.lexically_proximate(fs::current_path()).string() : report_link(file, tick);
}

}  // namespace

fs::path traces_folder() { return fs::path(test_folders().output) / "traces"; }

std::string keep_test_result(TestResult result, const Trace* trace, const fs::path& scenario) {
  if (wanted() == Wanted::never) return {};
  const fs::path folder = traces_folder();
  if (trace && result.state != TestResult::State::passed)
    result.picture = thumbnail_of(*trace, scenario, result.tick.value_or(0));
  result.seconds = seconds_of_test();
  result.project = test_folders().fixtures.empty() ? fs::current_path() : fs::path(test_folders().fixtures);
  const FolderLock alone(folder);
  keep_result(folder, result);
  const auto index = refresh_index(folder, wanted() == Wanted::always);
  return index && result.state != TestResult::State::passed ? "\nall tests: " + address_of(*index) : "";
}

void drop_test_result(const std::string& test, const std::string& kind) {
  if (wanted() == Wanted::never) return;
  const FolderLock alone(traces_folder());
  drop_result(traces_folder(), test, kind);
}

std::string keep_test_report(const Trace& trace, const std::string& test, const std::string& kind,
                             const TestVerdict& verdict, const ComparedTest& compared) {
  if (wanted() == Wanted::never) return {};
  const fs::path file = traces_folder() / (test + (kind == "golden" ? "" : "." + kind) + ".html");
  std::error_code ignored;
  std::string told;
  TestResult result;
  result.test = test;
  result.kind = kind;
  result.state = verdict.passed ? TestResult::State::passed : TestResult::State::differs;
  result.verdict = compared.checked ? compared.checked->verdict.text()
                   : verdict.passed ? (kind != "golden"   ? "as expected"
                                       : is_proved(trace) ? "as its golden, proved without simulating"
                                                          : "as its golden")
                                    : first_line(verdict.message);
  const bool has_golden = fs::is_regular_file(compared.golden, ignored);
  if (!verdict.passed || wanted() == Wanted::always) {
    const FolderLock alone(traces_folder());  // programs that run in parallel may run the same test
    const auto golden = has_golden ? std::optional(compared.golden) : std::nullopt;
    const auto written = write_report(trace.file(), golden, file, options_of(trace, test, verdict, compared));
    if (written) {
      result.report = file;
      result.tick = written->first_tick;
      told = (is_ci() ? "\nreport: " : "\nin a browser: ") + address_of(file, written->first_tick);
    } else {
      told = "\nthere is no report to look at: " + written.errors()[0].message;
    }
  } else {
    fs::remove(file, ignored);  // the report of an earlier run, in which it failed
  }
  return told + keep_test_result(std::move(result), &trace, compared.scenario);
}

}  // namespace rehearse::internal
