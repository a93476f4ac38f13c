#include <rehearse/report.h>

#include "core/golden/stale_report.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// True if the difference that fails the check is within tolerance.
bool differs_in_bits_alone(const CheckReport& checked) {
  return !checked.within() && !checked.other_duration && checked.first && !checked.first->is_beyond();
}

/// The trace that the check left; empty: none. A file from an earlier check is ignored.
fs::path trace_left(const CheckReport& checked, const fs::path& actual) {
  const bool run_is_wrong = checked.run && (checked.run_is_wrong() || checked.run->failure);
  std::error_code ignored;
  if (run_is_wrong && fs::is_regular_file(actual, ignored)) return actual;
  const fs::path plant = actual.parent_path() / "plant" / actual.filename();
  if (checked.plant == LevelState::differs && fs::is_regular_file(plant, ignored)) return plant;
  return {};
}

}  // namespace

ReportVerdict report_verdict(const CheckReport& checked) {
  ReportVerdict verdict;
  verdict.sentence = checked.verdict.text();
  verdict.besides =
      checked.verdict.text_without({VerdictCode::expectations_violated, VerdictCode::expectations_undecided});
  verdict.state = checked.failed()                        ? "failed"
                  : first_violation(checked.expectations) ? "violated"
                  : differs_in_bits_alone(checked)        ? "bits"
                  : !checked.within()                     ? "beyond"
                  : checked.equal()                       ? "equal"
                                                          : "within";
  verdict.levels = {{"controller", std::string(to_string(checked.controller))},
                    {"plant", std::string(to_string(checked.plant))},
                    {"closed", std::string(to_string(checked.closed))}};
  verdict.first = checked.first;
  return verdict;
}

Result<std::optional<FailureReport>> write_failure_report(const CheckReport& checked, const Scenario& scenario,
                                                          const fs::path& golden, const fs::path& actual,
                                                          ReportOptions options) {
  std::error_code ignored;
  for (const fs::path& file : {actual, actual.parent_path() / "plant" / actual.filename()})
    if (!fs::exists(file, ignored)) remove_report(file);
  if (checked.within() && !checked.failed()) return std::optional<FailureReport>();
  const fs::path trace = trace_left(checked, actual);
  if (trace.empty()) return std::optional<FailureReport>();
  options.title = scenario.name;
  options.tolerances = scenario.tolerances;
  options.horizon = checked.horizon;
  options.verdict = report_verdict(checked);
  options.comparison = trace == actual ? checked.comparison : checked.plant_comparison;
  if (trace != actual)
    options.expectations.emplace();  // they were judged on the closed loop
  else if (!checked.expectations.empty())
    options.expectations = checked.expectations;
  options.scenario = scenario.file;
  if (checked.run && trace == actual) options.control_times = checked.run->control_times;
  const std::optional<fs::path> beside = fs::is_regular_file(golden, ignored) ? std::optional(golden) : std::nullopt;
  const fs::path file = fs::path(trace).replace_extension(".html");
  auto written = REHEARSE_TRY(write_report(trace, beside, file, options));
  return std::optional(FailureReport{file, std::move(written)});
}

}  // namespace rehearse
