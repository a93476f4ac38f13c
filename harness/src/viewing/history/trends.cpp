#include "trends.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

namespace rehearse {
namespace {

constexpr std::size_t most_exact = 60;  // values whose distribution is computed
constexpr double jump_factor = 12.0;    // times the median of the other steps
constexpr std::size_t least_steps = 4;  // that measure the noise of a margin

/// Pairs of values that fall, and those that rise.
std::pair<std::int64_t, std::int64_t> count_pairs(const std::vector<double>& values) {
  std::int64_t falling = 0, rising = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = i + 1; k < values.size(); ++k) {
      falling += values[k] < values[i];
      rising += values[k] > values[i];
    }
  }
  return {falling, rising};
}

/// The share of the orders of n different values in which at least `falling` pairs fall. The number of such pairs is a
/// sum of independent numbers, of which the one of value i is 0 to i with equal probability.
double exact_chance(std::size_t n, std::int64_t falling) {
  std::vector<double> probability{1.0};
  for (std::size_t i = 1; i < n; ++i) {
    std::vector<double> next(probability.size() + i, 0.0);
    for (std::size_t pairs = 0; pairs < probability.size(); ++pairs)
      for (std::size_t more = 0; more <= i; ++more)
        next[pairs + more] += probability[pairs] / static_cast<double>(i + 1);
    probability = std::move(next);
  }
  // from the smallest on
  return std::accumulate(probability.rbegin(), probability.rend() - falling, 0.0);
}

/// The sum over groups of equal values in the variance of the pairs.
double variance_of_ties(std::vector<double> values) {
  std::ranges::stable_sort(values);
  double sum = 0.0;
  for (std::size_t begin = 0, end = 0; begin < values.size(); begin = end) {
    while (end < values.size() && values[end] == values[begin]) ++end;
    const auto size = static_cast<double>(end - begin);
    sum += size * (size - 1.0) * (2.0 * size + 5.0);
  }
  return sum;
}

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
  if (trend.jump) {
    const double step = values[*trend.jump] - values[*trend.jump - 1];
    for (std::size_t i = *trend.jump; i < values.size(); ++i) values[i] -= step;
  }
  trend.chance = chance_of_fall(values);
  const double fall = values.front() - values.back();
  trend.drifts = trend.chance * static_cast<double>(tested) <= options.significance && fall > 0.0 &&
                 fall >= options.least_change * std::abs(values.front());
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
  MarginPoint point{line.stamp, *margin.margin, margin.share, margin.tick};
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

double chance_of_fall(const std::vector<double>& values) {
  const auto [falling, rising] = count_pairs(values);
  const auto n = static_cast<double>(values.size());
  const double ties = variance_of_ties(values);
  if (ties == 0.0 && values.size() <= most_exact) return values.size() < 2 ? 1.0 : exact_chance(values.size(), falling);
  const double variance = (n * (n - 1.0) * (2.0 * n + 5.0) - ties) / 18.0;
  if (!(variance > 0.0)) return 1.0;
  const auto fall = static_cast<double>(falling - rising);
  const double corrected = fall > 0.0 ? fall - 1.0 : fall < 0.0 ? fall + 1.0 : 0.0;
  return 0.5 * std::erfc(corrected / std::sqrt(variance) / std::numbers::sqrt2);
}

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
