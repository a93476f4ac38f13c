// A history: the results of checks over the commits of a project, a line of JSON for each scenario and check.
//
// A line has sorted keys, no clock's time and no machine's name. So lines of several machines and branches can be
// merged by a tool that knows only lines.
#pragma once

#include <rehearse/check.h>
#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The state of a project at a check.
struct HistoryStamp {
  std::string commit;    // empty: unknown
  bool changed = false;  // a file differs from the commit, or isn't in it
  std::string date;      // "2026-11-27" or "2026-11-27T06:50:00Z"; empty: not given
};

/// The stamp of a check. `commit`: as the user states it; empty: the HEAD of the git repository that contains `folder`;
/// unknown without git or without a repository. `history`: its changes don't count as changes of the project. Fails if
/// the date has another form.
Result<HistoryStamp> stamp_of(std::string commit, std::string date, const std::filesystem::path& folder,
                              const std::filesystem::path& history);

/// The margin of an expectation in one run.
struct HistoryMargin {
  std::string text;              // the expectation
  std::optional<double> margin;  // distance from the violation, in `unit`; none: undecided, or nothing was compared
  double value = 0.0, bound = 0.0;
  std::string unit;             // as recordings have it; empty: unknown
  std::optional<double> share;  // of the bound's magnitude; none: the bound is 0
  std::int64_t tick = 0;
};

struct HistoryLine {
  HistoryStamp stamp;
  std::string scenario;  // its name, or that of a test
  std::string code;      // of the verdict (verdict_code.h)
  bool proved = false;   // nothing was simulated
  std::vector<HistoryMargin> margins;
  /// Of controllers, by name and count: "Arm/Hold", "allocations"; empty: they weren't counted.
  std::map<std::string, std::map<std::string, std::uint64_t>> costs;
  nlohmann::json first;  // the first difference, as in the JSON of a check; null: none
};

HistoryLine line_of(const HistoryStamp& stamp, const std::string& scenario, const CheckReport& report);

/// One line of JSON, without its newline.
std::string text_of(const HistoryLine& line);

/// Appends lines, each with its newline, in one write under a lock: processes that append at the same time don't mix
/// their lines. An incomplete last line of a killed process stays a line by itself. Fails if the file can't be written.
Result<void> append_to_history(const std::filesystem::path& file, const std::vector<std::string>& lines);

struct History {
  std::vector<HistoryLine> lines;  // in the order of the file
  Diagnostics bad;                 // lines that are no line of a history, each with its place
};

/// Reads all lines. Fails if the file can't be read.
Result<History> read_history(const std::filesystem::path& file);

}  // namespace rehearse
