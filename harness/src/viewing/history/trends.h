// Trends: how the margins of a history go on over its commits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "history.h"

namespace rehearse {

struct TrendOptions {
  std::size_t last = 20;       // commits that are judged, the newest ones
  double significance = 0.05;  // largest probability that a whole history without drift is said to drift
  double least_change = 0.01;  // relative change below which nothing drifts or jumps
};

/// The margin at one commit: of its last check.
struct MarginPoint {
  HistoryStamp stamp;
  double margin = 0.0;
  std::optional<double> share;
  std::int64_t tick = 0;
  double value = 0.0;  // of the expression, in the unit of the margin
};

struct MarginTrend {
  std::string scenario, text, unit;
  std::vector<MarginPoint> points;  // the judged ones, the oldest first
  std::size_t shrank = 0;           // steps from one point to the next in which the margin shrank
  std::optional<double> change;     // from the first to the last point, as a share of the first; none: that is 0
  double chance = 1.0;              // chance_of_fall()
  /// It shrank, by the least change also without the step of a jump, and the chance over all margins is small.
  bool drifts = false;
  /// The point before which the margin changed by far more than in the other steps.
  std::optional<std::size_t> jump;

  std::size_t steps() const { return points.empty() ? 0 : points.size() - 1; }
};

/// A commit that had several verdicts on one scenario, though nothing differed from it.
struct FlakyCommit {
  std::string scenario, commit;
  std::vector<std::string> codes;  // in the order of their first occurrence
};

struct ScenarioHistory {
  std::string scenario;
  std::size_t checks = 0;
  std::string code;  // of the last check
};

struct Trends {
  std::vector<ScenarioHistory> scenarios;  // in the order of their first line, as all lists
  std::vector<MarginTrend> margins;
  std::vector<FlakyCommit> flaky;
  TrendOptions options;

  bool drifts() const;
};

/// The points are in the order of the dates if each line of the scenario has one, else in the order of the lines. Lines
/// of one commit are one point; a line without a commit, or with changed files, is a point by itself.
Trends trends_of(const std::vector<HistoryLine>& lines, const TrendOptions& options = {});

// Text.

/// "0.4 rad": four digits.
std::string with_unit(double number, const std::string& unit);
/// "▁▄█": a block for each value, as high as it is between the smallest and the largest.
std::string sparkline(const std::vector<double>& values);
/// "the margin of 'stays upright' of walk shrank in 9 of the last 10 commits, by 21 %".
std::string drift_sentence(const MarginTrend& trend);
/// "the margin of 'stays upright' of walk fell from 0.4 to 0.2 rad at 3f2a1bc, 2026-11-02".
std::string jump_sentence(const MarginTrend& trend);
/// "walk has several verdicts at 3f2a1bc: same, controller.unsteady".
std::string flaky_sentence(const FlakyCommit& flaky);
/// One sentence without a full stop: the first drift and the number of others, or that there is none.
std::string verdict(const Trends& trends);
/// The lines of all margins, for a terminal.
std::string text_of(const Trends& trends);
/// An object: verdict, drifts, scenarios, margins, flaky.
nlohmann::ordered_json json_of(const Trends& trends);

}  // namespace rehearse
