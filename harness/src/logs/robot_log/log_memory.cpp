#include "log_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rehearse {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

}  // namespace

void CommandRecord::begin(std::int64_t time, const std::vector<CommandColumn>& columns) {
  first_time_ = (time + 500) / 1000;
  for (const CommandColumn& column : columns) {
    names_.push_back(column.name);
    ranges_.push_back(column.range);
  }
}

bool CommandRecord::begins_steadily(double time_step) const {
  constexpr double ticks = 20.0, longest_gap = 5.0;  // [ticks]
  const double step = time_step * 1e6;
  auto last = static_cast<double>(first_time_);
  for (const auto& [time, commands] : commands_) {
    if (static_cast<double>(time) - last > longest_gap * step) return false;
    last = static_cast<double>(time);
    if (last >= static_cast<double>(first_time_) + ticks * step) return true;
  }
  return false;
}

void CommandRecord::add(std::int64_t time, const std::vector<CommandPair>& pairs) {
  const std::int64_t at = (time + 500) / 1000;
  if (std::ranges::all_of(pairs, [](const CommandPair& pair) { return pair.logged.has_value(); }))
    for (const CommandPair& pair : pairs) off_[at].push_back(pair.actual - *pair.logged);
  std::vector<double>& commands = commands_[at];
  for (const CommandPair& pair : pairs) commands.push_back(pair.whole);
}

std::optional<std::int64_t> memory_of(const CommandRecord& from_the_start, const CommandRecord& started_later,
                                      double time_step) {
  constexpr std::int64_t fewest = 20;
  constexpr double share_of_range = 1e-9;  // commands alike, also after an input that is far off
  std::vector<double> low, high;
  for (const auto& [time, commands] : from_the_start.all()) {
    low.resize(std::max(low.size(), commands.size()), std::numeric_limits<double>::infinity());
    high.resize(low.size(), -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < commands.size(); ++i) {
      low[i] = std::min(low[i], commands[i]);
      high[i] = std::max(high[i], commands[i]);
    }
  }
  std::int64_t compared = 0, last_compared = 0, last_different = -1;  // the last two: [us]
  for (const auto& [time, later] : started_later.all()) {
    const auto same_time = from_the_start.all().find(time);
    if (same_time == from_the_start.all().end() || same_time->second.size() != later.size()) continue;
    ++compared;
    last_compared = time;
    for (std::size_t i = 0; i < later.size(); ++i)
      if (const bool are_nan = std::isnan(later[i]) && std::isnan(same_time->second[i]);
          !are_nan && !(std::abs(later[i] - same_time->second[i]) <= share_of_range * (high[i] - low[i])))
        last_different = time;
  }
  if (compared < fewest) return std::nullopt;
  if (last_different < 0) return 0;
  const std::int64_t first = started_later.first_time();
  if (last_different - first > (last_compared - first) / 2) return std::nullopt;
  return std::llround(static_cast<double>(last_different - first) * 1e-6 / time_step) + 1;
}

namespace {

/// The magnitudes of a number over some ticks.
struct Magnitudes {
  double least = std::numeric_limits<double>::infinity(), largest = 0.0, growth = 0.0;

  void add(double number) {
    const double magnitude = std::abs(number);
    if (!std::isfinite(magnitude)) return;
    least = std::min(least, magnitude);
    largest = std::max(largest, magnitude);
    growth = std::max(growth, magnitude - least);
  }
};

}  // namespace

bool is_no_state(const CommandRecord& from_the_start, const CommandRecord& started_later) {
  constexpr std::size_t fewest = 200;  // ticks of a stretch
  constexpr double factor = 10.0, share_of_range = 0.2, share_of_all = 0.05, rounding = 1e-9;
  const std::vector<double>& ranges = from_the_start.ranges();
  std::vector<std::vector<double>> apart;  // of the two controllers, by tick after the later start
  for (const auto& [time, later] : started_later.all()) {
    const auto whole = from_the_start.all().find(time);
    if (whole == from_the_start.all().end() || whole->second.size() != ranges.size() || later.size() != ranges.size())
      continue;
    std::vector<double>& numbers = apart.emplace_back();
    for (std::size_t i = 0; i < later.size(); ++i) numbers.push_back(later[i] - whole->second[i]);
  }
  std::vector<std::int64_t> longest, stretch;  // times [us]
  auto interruption = from_the_start.interruptions().begin();
  for (const auto& [time, off] : from_the_start.off()) {
    for (; interruption != from_the_start.interruptions().end() && *interruption <= time; ++interruption)
      stretch.clear();
    if (off.size() == ranges.size() && stretch.size() < apart.size()) stretch.push_back(time);
    if (stretch.size() > longest.size()) longest = stretch;
  }
  if (longest.size() < fewest) return false;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    Magnitudes of_log, of_states;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t tick = longest.size() / 2; tick < longest.size(); ++tick) {
      const double off = from_the_start.off().at(longest[tick])[i];
      const double logged = from_the_start.all().at(longest[tick])[i] - off;
      of_log.add(off);
      of_states.add(apart[tick][i]);
      low = std::min(low, logged);
      high = std::max(high, logged);
    }
    const double least = std::max(share_of_range * (high - low), share_of_all * ranges[i]);
    const double scale = of_states.largest > rounding * ranges[i] ? of_log.largest / of_states.largest : 0.0;
    if (of_log.growth >= least && of_log.growth > factor * scale * of_states.growth) return true;
  }
  return false;
}

LogCertainty::LogCertainty(std::optional<std::int64_t> memory, bool knows_beginning)
    : memory_(memory), known_from_(knows_beginning ? 0 : memory.value_or(never)) {}

bool LogCertainty::take(std::int64_t tick, bool interrupted, bool agrees, bool moves) {
  if (interrupted) {
    known_from_ = memory_ ? tick + 1 + *memory_ : never;
    agreed_ = moved_ = 0;
    return false;
  }
  const bool is_certain = tick >= known_from_ || (agreed_ >= enough_ticks && moved_ >= enough_moves);
  agreed_ = agrees ? agreed_ + 1 : 0;
  moved_ = agrees ? moved_ + (moves ? 1 : 0) : 0;
  if (agreed_ >= enough_ticks && moved_ >= enough_moves) known_from_ = std::min(known_from_, tick);
  return is_certain;
}

void RestOfLog::add(double at, const std::vector<double>& off) {
  if (off.empty() || (ticks_ > 0 && off.size() != low_.size())) return;
  if (ticks_++ == 0) {
    from_ = at;
    low_ = high_ = off;
  }
  for (std::size_t i = 0; i < off.size(); ++i) {
    low_[i] = std::min(low_[i], off[i]);
    high_[i] = std::max(high_[i], off[i]);
  }
}

std::optional<LogRest> RestOfLog::report(const std::vector<CommandColumn>& columns) const {
  std::optional<LogRest> worst;
  for (std::size_t i = 0; i < std::min(low_.size(), columns.size()); ++i) {
    const LogRest rest{columns[i].name, columns[i].unit, from_, ticks_, low_[i], high_[i], columns[i].range};
    if (!worst || rest.share() > worst->share()) worst = rest;
  }
  return worst;
}

}  // namespace rehearse
