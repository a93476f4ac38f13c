#include "clock_estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/median.h"

namespace rehearse {
namespace {

constexpr double largest_drift = 1e-3;

}  // namespace

void ClockEstimate::Block::add(const Point& point) {
  ++count;
  sum_x += point.x;
  if (!hull.empty() && point.x == hull.back().x) {
    if (point.y >= hull.back().y) return;
    hull.pop_back();
  }
  const auto is_above = [&] {  // the last point is above the line from the one before it to the new one
    const Point &a = hull[hull.size() - 2], &b = hull.back();
    return (b.y - a.y) * (point.x - a.x) >= (point.y - a.y) * (b.x - a.x);
  };
  while (hull.size() > 1 && is_above()) hull.pop_back();
  hull.push_back(point);
}

std::pair<ClockEstimate::Point, double> ClockEstimate::Block::lowest(double slope) const {
  const auto delay = [slope](const Point& point) { return point.y - slope * point.x; };
  const Point& found = *std::ranges::min_element(hull, {}, delay);
  return {found, delay(found)};
}

void ClockEstimate::add(std::int64_t stamp, std::int64_t log_time) {
  const std::int64_t delay = log_time - stamp;
  if (blocks_.empty()) {
    first_time_ = log_time;
    first_delay_ = delay;
  }
  const Point point{static_cast<double>(log_time - first_time_), static_cast<double>(delay - first_delay_)};
  if (blocks_.empty() || blocks_.back().count == block_size_) {
    if (blocks_.size() == most_blocks) merge_pairs();
    Block& block = blocks_.emplace_back();
    block.first_stamp = stamp;
    block.first_x = point.x;
  }
  blocks_.back().add(point);
}

void ClockEstimate::merge_pairs() {
  std::vector<Block> merged;
  for (std::size_t i = 0; i + 1 < blocks_.size(); i += 2) {
    Block& into = merged.emplace_back(std::move(blocks_[i]));
    const Block& next = blocks_[i + 1];
    const std::int64_t count = into.count + next.count;
    const double sum_x = into.sum_x + next.sum_x;
    for (const Point& point : next.hull) into.add(point);
    into.count = count;
    into.sum_x = sum_x;
  }
  blocks_ = std::move(merged);
  block_size_ *= 2;
}

double ClockEstimate::usual_slope(Blocks blocks, std::size_t reach) {
  double slope = 0.0;
  for (int round = 0; round < 2; ++round) {
    std::vector<double> slopes;
    for (std::size_t i = 0; i < blocks.size(); ++i)
      for (std::size_t j = i + 1; j < blocks.size() && j - i <= reach; ++j) {
        const Point a = blocks[i].lowest(slope).first, b = blocks[j].lowest(slope).first;
        if (b.x > a.x) slopes.push_back((b.y - a.y) / (b.x - a.x));
      }
    if (slopes.empty()) return 0.0;
    slope = std::clamp(upper_median(std::move(slopes)), -largest_drift, largest_drift);
  }
  return slope;
}

std::vector<std::size_t> ClockEstimate::steps(Blocks blocks) {
  constexpr double times_usual = 20.0, least = 2e6;  // [ns]
  constexpr std::size_t lasting = 3;                 // [blocks]
  if (blocks.size() < 3 * lasting) return {};
  const double slope = usual_slope(blocks, 4);
  std::vector<double> delays, changes;
  for (const Block& block : blocks) delays.push_back(block.lowest(slope).second);
  for (std::size_t i = 1; i < delays.size(); ++i) changes.push_back(std::abs(delays[i] - delays[i - 1]));
  const double jump = times_usual * upper_median(changes) + least;
  const auto level = [&](std::size_t from) {
    const auto first = delays.begin() + static_cast<std::ptrdiff_t>(from);
    return upper_median(std::vector<double>(first, first + lasting));
  };
  std::vector<std::size_t> found;
  for (std::size_t i = lasting; i + lasting <= delays.size(); ++i)
    if (changes[i - 1] > jump && std::abs(level(i) - level(i - lasting)) > jump) found.push_back(i);
  return found;
}

std::vector<ClockEstimate::Block> ClockEstimate::plausible(Blocks blocks) {
  constexpr double far = 10.0, rounding = 10e3;  // [usual distances], [ns]
  const double slope = usual_slope(blocks, blocks.size());
  std::vector<double> delays, distances;
  for (const Block& block : blocks) delays.push_back(block.lowest(slope).second);
  const double usual = upper_median(delays);
  for (const double delay : delays) distances.push_back(std::abs(delay - usual));
  const double least = usual - far * upper_median(std::move(distances)) - rounding;
  std::vector<Block> kept;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (delays[i] >= least) kept.push_back(blocks[i]);
  return 4 * kept.size() >= 3 * blocks.size() ? kept : std::vector<Block>(blocks.begin(), blocks.end());
}

std::pair<double, double> ClockEstimate::line(Blocks blocks) {
  Block all;
  std::int64_t count = 0;
  double sum_x = 0.0;
  for (const Block& block : blocks) {
    for (const Point& point : block.hull) all.add(point);
    count += block.count;
    sum_x += block.sum_x;
  }
  const double middle = sum_x / static_cast<double>(count);
  const std::pair level(0.0, all.lowest(0.0).second);
  const auto after = std::ranges::find_if(all.hull, [&](const Point& point) { return point.x > middle; });
  if (after == all.hull.begin() || after == all.hull.end()) return level;
  const Point &a = *(after - 1), &b = *after;
  const double slope = (b.y - a.y) / (b.x - a.x);
  if (std::abs(slope) > largest_drift) return level;
  return {slope, a.y - slope * a.x};
}

LogClockReport ClockEstimate::report_of(Blocks all, bool may_agree) const {
  constexpr double longest_delay = 1e9;  // [ns]
  const std::vector<Block> blocks = plausible(all);
  std::vector<double> delays;
  for (const Block& block : blocks) delays.push_back(block.lowest(0.0).second + static_cast<double>(first_delay_));
  const auto [least, most] = std::ranges::minmax(delays);
  LogClockReport report;
  report.least_delay = least * 1e-9;
  report.reference = all[0].first_stamp;
  if (may_agree && least >= 0.0 && most <= longest_delay) return report;
  const auto [slope, value] = line(blocks);
  report.drift = slope;
  report.offset = first_delay_ + std::llround(value + slope * all[0].first_x);
  return report;
}

std::vector<LogClockReport> ClockEstimate::report() const {
  std::vector<LogClockReport> reports;
  std::size_t from = 0;
  std::vector<std::size_t> ends = steps(blocks_);
  ends.push_back(blocks_.size());
  for (const std::size_t end : ends) {
    if (end > from) reports.push_back(report_of(Blocks(blocks_).subspan(from, end - from), ends.size() == 1));
    from = end;
  }
  return reports;
}

}  // namespace rehearse
