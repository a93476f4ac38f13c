#include "check_history.h"

#include <fmt/format.h>

#include "core/scenario/project.h"
#include "wings.h"

namespace rehearse::tool {

void add_history_options(CLI::App& options, HistoryOptions& history) {
  options
      .add_option("--history", history.file,
                  "append a line of JSON for each scenario, with its verdict and margins; rehearse history reads them")
      ->type_name("FILE");
  options.add_option("--commit", history.commit, "of --history: the commit (the HEAD of the project's git repository)")
      ->type_name("ID")
      ->needs("--history");
  options.add_option("--date", history.date, "of --history: the date, as 2026-11-27 or 2026-11-27T06:50:00Z (none)")
      ->type_name("DATE")
      ->needs("--history");
}

Result<HistoryStamp> stamp_of(const HistoryOptions& history) {
  if constexpr (!has_viewing) {
    return left_out("the option --history", "viewing");
  } else {
    return rehearse::stamp_of(history.commit, history.date, find_project("./").value_or("."), history.file);
  }
}

std::string history_line(const std::optional<HistoryStamp>& stamp, const std::string& scenario,
                         const CheckReport& report) {
  if constexpr (has_viewing)
    if (stamp) return text_of(line_of(*stamp, scenario, report));
  return {};
}

std::string history_line(const std::optional<HistoryStamp>& stamp, const std::string& scenario) {
  CheckReport report;
  report.verdict = {VerdictCode::undecided_bad_input, ""};
  return history_line(stamp, scenario, report);
}

Result<void> append_outcomes(const HistoryOptions& history, const std::vector<CheckOutcome>& all) {
  if constexpr (has_viewing) {
    std::vector<std::string> lines;
    for (const CheckOutcome& outcome : all) lines.push_back(outcome.history);
    return append_to_history(history.file, lines);
  }
  return {};
}

}  // namespace rehearse::tool
