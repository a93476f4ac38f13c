#include "trends.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "chance_of_fall.h"

namespace rehearse {
namespace {

constexpr double jump_factor = 12.0;    // times the median of the other steps
constexpr std::size_t least_steps = 4;  // that measure the noise of a margin

double median_of(std::vector<double> values) {
  std::ranges::stable_sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// The point before which the largest step is, if the other steps don't explain it.
std::optional<std::size_t> jump_in(const std::vector<double>& values, double least_change) {
  if (values.size() < 3) return std::nullopt;
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(std::abs(values[i] - values[i - 1]));
  const auto largest = std::ranges::max_element(steps);
  const auto at = static_cast<std::size_t>(largest - steps.begin());
  const double size = *largest;
  steps.erase(largest);
  const double usual = median_of(steps);
  const bool is_known = steps.size() >= least_steps || std::ranges::max(steps) == 0.0;
  if (!is_known || !(size > jump_factor * usual) || !(size >= least_change * std::abs(values[at]))) return std::nullopt;
  return at + 1;
}

std::vector<double> margins_of(const MarginTrend& trend) {
  std::vector<double> values;
  for (const MarginPoint& point : trend.points) values.push_back(point.margin);
  return values;
}

/// `tested`: the number of margins that are tested together.
void judge(MarginTrend& trend, const TrendOptions& options, std::size_t tested) {
  std::vector<double> values = margins_of(trend);
  if (values.size() < 2) return;
  for (std::size_t i = 1; i < values.size(); ++i) trend.shrank += values[i] < values[i - 1];
  if (values.front() != 0.0) trend.change = (values.back() - values.front()) / std::abs(values.front());
  trend.jump = jump_in(values, options.least_change);
  trend.chance = chance_of_fall(values);
  const double fall = values.front() - values.back();
  const double largest_step = trend.jump ? values[*trend.jump - 1] - values[*trend.jump] : 0.0;
  const double without_jump = std::min(fall, fall - largest_step);
  trend.drifts = trend.chance * static_cast<double>(tested) <= options.significance && without_jump > 0.0 &&
                 without_jump >= options.least_change * std::abs(values.front());
}

/// Lines in the order of their dates, if all have one. Equal dates keep the order of the lines.
std::vector<const HistoryLine*> in_order(const std::vector<HistoryLine>& lines, const std::string& scenario) {
  std::vector<const HistoryLine*> own;
  for (const HistoryLine& line : lines)
    if (line.scenario == scenario) own.push_back(&line);
  const auto date = [](const HistoryLine* line) -> const std::string& { return line->stamp.date; };
  if (std::ranges::none_of(own, &std::string::empty, date)) std::ranges::stable_sort(own, {}, date);
  return own;
}

bool is_certain(const HistoryStamp& stamp) { return !stamp.commit.empty() && !stamp.changed; }

void add_point(MarginTrend& trend, const HistoryLine& line, const HistoryMargin& margin) {
  MarginPoint point{line.stamp, *margin.margin, margin.share, margin.tick, margin.value};
  trend.unit = margin.unit;
  const auto same = std::ranges::find_if(trend.points, [&](const MarginPoint& earlier) {
    return is_certain(line.stamp) && is_certain(earlier.stamp) && earlier.stamp.commit == line.stamp.commit;
  });
  if (same == trend.points.end())
    trend.points.push_back(std::move(point));
  else
    *same = std::move(point);
}

void add_margins(const std::vector<const HistoryLine*>& lines, Trends& trends) {
  std::map<std::string, std::size_t> of_text;  // the trend of each expectation
  for (const HistoryLine* line : lines) {
    for (const HistoryMargin& margin : line->margins) {
      if (!margin.margin) continue;
      const auto [found, is_new] = of_text.try_emplace(margin.text, trends.margins.size());
      if (is_new) trends.margins.push_back({line->scenario, margin.text, margin.unit, {}, 0, {}, 1.0, false, {}});
      add_point(trends.margins[found->second], *line, margin);
    }
  }
}

void add_flaky(const std::vector<const HistoryLine*>& lines, Trends& trends) {
  std::vector<FlakyCommit> commits;
  for (const HistoryLine* line : lines) {
    if (!is_certain(line->stamp)) continue;
    auto found = std::ranges::find(commits, line->stamp.commit, &FlakyCommit::commit);
    if (found == commits.end()) found = commits.insert(found, {line->scenario, line->stamp.commit, {}});
    if (std::ranges::find(found->codes, line->code) == found->codes.end()) found->codes.push_back(line->code);
  }
  for (FlakyCommit& commit : commits)
    if (commit.codes.size() > 1) trends.flaky.push_back(std::move(commit));
}

}  // namespace

bool Trends::drifts() const { return std::ranges::any_of(margins, &MarginTrend::drifts); }

Trends trends_of(const std::vector<HistoryLine>& lines, const TrendOptions& options) {
  Trends trends;
  trends.options = options;
  for (const HistoryLine& line : lines)
    if (std::ranges::find(trends.scenarios, line.scenario, &ScenarioHistory::scenario) == trends.scenarios.end())
      trends.scenarios.push_back({line.scenario, 0, ""});
  for (ScenarioHistory& scenario : trends.scenarios) {
    const auto own = in_order(lines, scenario.scenario);
    scenario.checks = own.size();
    scenario.code = own.back()->code;
    add_margins(own, trends);
    add_flaky(own, trends);
  }
  for (MarginTrend& trend : trends.margins)
    if (trend.points.size() > options.last)
      trend.points.erase(trend.points.begin(), trend.points.end() - static_cast<std::ptrdiff_t>(options.last));
  for (MarginTrend& trend : trends.margins) judge(trend, options, trends.margins.size());
  return trends;
}

}  // namespace rehearse
