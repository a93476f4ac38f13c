// What `rehearse check` appends to a history.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "check_outcome.h"
#include "command.h"
#include "viewing/history/history.h"

namespace rehearse::tool {

struct HistoryOptions {
  std::string file;  // empty: no history is kept
  std::string commit, date;
};

/// Declares --history, --commit and --date.
void add_history_options(CLI::App& options, HistoryOptions& history);

/// The stamp of all lines of a check. Fails if the date is wrong, or if this build leaves out the wing of histories.
Result<HistoryStamp> stamp_of(const HistoryOptions& history);

/// The line of a checked scenario; empty without a stamp.
std::string history_line(const std::optional<HistoryStamp>& stamp, const std::string& scenario,
                         const CheckReport& report);
/// The line of a scenario that can't be judged.
std::string history_line(const std::optional<HistoryStamp>& stamp, const std::string& scenario);

/// Appends the lines of all outcomes.
Result<void> append_outcomes(const HistoryOptions& history, const std::vector<CheckOutcome>& all);

}  // namespace rehearse::tool
