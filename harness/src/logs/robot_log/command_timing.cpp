#include "command_timing.h"

#include <rehearse/compare.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace rehearse {
namespace {

/// Compares the commands of one tick with those in the log at another one.
bool agree(const std::vector<CommandPair>& actual, const std::vector<CommandPair>& logged) {
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const std::optional<double>& expected = logged[i].logged;
    if (!expected || identical(actual[i].actual, *expected)) continue;
    if (!(std::abs(actual[i].actual - *expected) <= actual[i].tolerance)) return false;
  }
  return true;
}

bool explains(std::int64_t different, std::int64_t of) { return of > 0 && different * 10 <= of; }

}  // namespace

void CommandTiming::count(int shift, bool agrees) {
  Count& count = counts_[static_cast<std::size_t>(shift + reach)];
  ++count.ticks;
  count.different += agrees ? 0 : 1;
}

void CommandTiming::add(std::vector<CommandPair> pairs) {
  Tick now{std::move(pairs)};
  if (!now.pairs.empty()) {
    now.differs = !agree(now.pairs, now.pairs);
    count(0, !now.differs);
  }
  for (std::size_t i = 0; i < last_.size(); ++i) {
    Tick& before = last_[i];
    if (now.pairs.size() != before.pairs.size() || now.pairs.empty()) continue;
    const int distance = static_cast<int>(i) + 1;
    const bool later = agree(before.pairs, now.pairs), earlier = agree(now.pairs, before.pairs);
    count(distance, later);
    count(-distance, earlier);
    if (distance > 1) continue;
    before.agrees_with_neighbour |= later;
    now.agrees_with_neighbour |= earlier;
  }
  if (!last_.empty() && last_[0].differs) {
    ++neighbours_.ticks;
    neighbours_.different += last_[0].agrees_with_neighbour ? 0 : 1;
  }
  last_.push_front(std::move(now));
  if (last_.size() > reach) last_.pop_back();
}

std::optional<LogTiming> CommandTiming::explanation() const {
  const std::int64_t stated = counts_[reach].different;
  std::optional<LogTiming> best;
  for (int distance = 1; distance <= reach; ++distance) {
    for (const int shift : {distance, -distance}) {
      const Count& count = counts_[static_cast<std::size_t>(shift + reach)];
      if (2 * count.ticks < counts_[reach].ticks || count.ticks < 2 || !explains(count.different, stated)) continue;
      if (!best || count.different < best->different) best = LogTiming{shift, count.ticks, count.different};
    }
  }
  if (!best && explains(neighbours_.different, neighbours_.ticks))
    best = LogTiming{std::nullopt, neighbours_.ticks, neighbours_.different};
  return best;
}

}  // namespace rehearse
