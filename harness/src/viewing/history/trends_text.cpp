// The trends of a history as text and as JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "core/compare/report_json.h"
#include "trends.h"

namespace rehearse {
namespace {

using Json = nlohmann::ordered_json;

/// "3f2a1bc, 2026-11-02".
std::string stamp_text(const HistoryStamp& stamp) {
  std::string text = stamp.commit.empty() ? "an unknown commit" : printable(stamp.commit.substr(0, 7));
  if (stamp.changed) text += " with changes";
  return stamp.date.empty() ? text : text + ", " + printable(stamp.date);
}

std::string name_of(const MarginTrend& trend) {
  return fmt::format("the margin of {} of {}", in_quotes(trend.text, 200), printable(trend.scenario));
}

std::string percent(double share) { return fmt::format("{:.3g} %", 100.0 * std::abs(share)); }

/// "shrank in 9 of the last 10 commits, by 21 %", "grew by 3 % over the last 10 commits".
std::string course_of(const MarginTrend& trend) {
  const std::string last = fmt::format("the last {}", count_text(trend.steps(), "commit"));
  const double change = trend.change.value_or(0.0);
  if (change > 0.0) return fmt::format("grew by {} over {}", percent(change), last);
  if (trend.shrank == 0) return "didn't change over " + last;
  return fmt::format("shrank in {} of {}{}", trend.shrank, last, change < 0.0 ? ", by " + percent(change) : "");
}

std::string lines_of(const MarginTrend& trend) {
  std::vector<double> values;
  for (const MarginPoint& point : trend.points) values.push_back(point.margin);
  std::string text = fmt::format("  {} {}", sparkline(values), with_unit(values.back(), trend.unit));
  if (const auto& share = trend.points.back().share; share)
    text += fmt::format(", {:.3g} % of the bound", 100.0 * *share);
  text += fmt::format(": {}\n", printable(trend.text, 200));
  if (trend.steps() > 0)
    text += fmt::format("    {}{}\n", course_of(trend),
                        trend.drifts ? fmt::format(": it drifts (p = {:.2g})", trend.chance) : "");
  if (trend.jump) text += fmt::format("    {}\n", jump_sentence(trend));
  return text;
}

Json json_of(const HistoryStamp& stamp) {
  return {{"commit", stamp.commit}, {"changed", stamp.changed}, {"date", stamp.date}};
}

Json json_of(const MarginTrend& trend) {
  Json points = Json::array();
  for (const MarginPoint& point : trend.points) {
    Json one = json_of(point.stamp);
    one["margin"] = point.margin;
    one["share"] = point.share ? Json(*point.share) : Json();
    one["tick"] = point.tick;
    points.push_back(one);
  }
  return {{"scenario", trend.scenario},
          {"expectation", trend.text},
          {"unit", trend.unit},
          {"steps", trend.steps()},
          {"shrank", trend.shrank},
          {"change", trend.change ? Json(*trend.change) : Json()},
          {"p", trend.chance},
          {"drifts", trend.drifts},
          {"jump", trend.jump ? points[*trend.jump] : Json()},
          {"points", points}};
}

}  // namespace

std::string with_unit(double number, const std::string& unit) {
  return fmt::format("{:.4g}{}{}", number, unit.empty() ? "" : " ", unit);
}

std::string sparkline(const std::vector<double>& values) {
  constexpr std::string_view blocks[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  if (values.empty()) return {};
  const auto [low, high] = std::ranges::minmax(values);
  std::string text;
  for (const double value : values) {
    const double share = high > low ? (value - low) / (high - low) : 0.5;
    text += blocks[static_cast<std::size_t>(std::min(7.0, share * 8.0))];
  }
  return text;
}

std::string drift_sentence(const MarginTrend& trend) { return name_of(trend) + " " + course_of(trend); }

std::string jump_sentence(const MarginTrend& trend) {
  const MarginPoint& before = trend.points[*trend.jump - 1];
  const MarginPoint& after = trend.points[*trend.jump];
  return fmt::format("{} {} from {:.4g} to {} at {}", name_of(trend), after.margin < before.margin ? "fell" : "rose",
                     before.margin, with_unit(after.margin, trend.unit), stamp_text(after.stamp));
}

std::string flaky_sentence(const FlakyCommit& flaky) {
  return fmt::format("{} has several verdicts at {}: {}", printable(flaky.scenario),
                     printable(flaky.commit.substr(0, 7)), fmt::join(flaky.codes, ", "));
}

std::string verdict(const Trends& trends) {
  const auto first = std::ranges::find_if(trends.margins, &MarginTrend::drifts);
  std::string text;
  if (first != trends.margins.end()) {
    text = drift_sentence(*first);
    const auto all = std::ranges::count_if(trends.margins, &MarginTrend::drifts);
    if (all > 1) text += fmt::format("; {} more of {} margins drift", all - 1, trends.margins.size());
  } else if (trends.margins.empty()) {
    text = "the history has no margins";
  } else {
    text = fmt::format("no drift: {} of {}", count_text(trends.margins.size(), "margin"),
                       count_text(trends.scenarios.size(), "scenario"));
  }
  if (!trends.flaky.empty()) text += "; " + flaky_sentence(trends.flaky[0]);
  if (trends.flaky.size() > 1) text += fmt::format(", and {} more", trends.flaky.size() - 1);
  return text;
}

std::string text_of(const Trends& trends) {
  std::string text;
  for (const ScenarioHistory& scenario : trends.scenarios) {
    text += fmt::format("{}: {}, the last: {}\n", printable(scenario.scenario), count_text(scenario.checks, "check"),
                        printable(scenario.code));
    for (const MarginTrend& trend : trends.margins)
      if (trend.scenario == scenario.scenario) text += lines_of(trend);
    for (const FlakyCommit& flaky : trends.flaky)
      if (flaky.scenario == scenario.scenario) text += fmt::format("  {}\n", flaky_sentence(flaky));
  }
  return text;
}

Json json_of(const Trends& trends) {
  Json object{{"verdict", verdict(trends)}, {"drifts", trends.drifts()}, {"significance", trends.options.significance},
              {"scenarios", Json::array()}, {"margins", Json::array()},  {"flaky", Json::array()}};
  for (const ScenarioHistory& scenario : trends.scenarios)
    object["scenarios"].push_back(
        {{"scenario", scenario.scenario}, {"checks", scenario.checks}, {"code", scenario.code}});
  for (const MarginTrend& trend : trends.margins) object["margins"].push_back(json_of(trend));
  for (const FlakyCommit& flaky : trends.flaky)
    object["flaky"].push_back({{"scenario", flaky.scenario}, {"commit", flaky.commit}, {"codes", flaky.codes}});
  return object;
}

}  // namespace rehearse
