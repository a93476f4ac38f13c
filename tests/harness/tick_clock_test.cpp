// The clock of a run, against a list of its ticks.
#include "core/compare/tick_clock.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "small_traces.h"

namespace rehearse {
namespace {

/// A clock of ticks whose numbers are milliseconds, each piece of the run added for itself.
TickClock clock_of(const std::vector<std::int64_t>& ticks) {
  const testing::TemporaryFolder folder;
  testing::SmallTrace run;
  run.ticks.clear();
  for (const std::int64_t tick : ticks) run.ticks.push_back({tick});
  run.write(folder / "run.mcap");
  TickClock clock;
  EXPECT_TRUE(Trace::load_in_pieces(
      folder / "run.mcap", [&](const Trace& piece) { clock.take(piece); }, 1));
  clock.put_in_order();
  return clock;
}

void expect_ticks(const TickClock& clock, std::vector<std::int64_t> ticks) {
  constexpr std::uint64_t step = 1'000'000;  // [ns]
  std::ranges::sort(ticks);
  ASSERT_EQ(clock.size(), ticks.size());
  EXPECT_EQ(clock.first_time(), static_cast<std::uint64_t>(ticks.front()) * step);
  EXPECT_EQ(clock.last_time(), static_cast<std::uint64_t>(ticks.back()) * step);
  for (std::size_t i = 0; i < ticks.size(); ++i)
    EXPECT_EQ(clock.time(i), static_cast<std::uint64_t>(ticks[i]) * step) << i;
  for (std::int64_t tick = 0; tick < ticks.back() + 3; ++tick) {
    const auto next = std::ranges::lower_bound(ticks, tick);
    const bool is_tick = next != ticks.end() && *next == tick;
    const auto after = is_tick ? next + 1 : next;
    const std::uint64_t time = static_cast<std::uint64_t>(tick) * step;
    EXPECT_EQ(clock.has(time), is_tick) << tick;
    EXPECT_FALSE(clock.has(time + 1)) << tick;
    EXPECT_EQ(clock.tick_at(time + 1), after == ticks.begin() ? 0 : *(after - 1)) << tick;
    const auto from = clock.next_time(time + 1);
    EXPECT_EQ(from.value_or(0), after == ticks.end() ? 0 : static_cast<std::uint64_t>(*after) * step) << tick;
  }
}

TEST(TickClock, HasTheTicksOfARun) {
  for (const std::vector<std::int64_t>& ticks : std::vector<std::vector<std::int64_t>>{
           {0, 1, 2, 3}, {5}, {5, 6}, {2, 3, 5, 6, 7, 11}, {1, 3, 5, 7, 8, 9}, {4, 5, 9, 10, 14, 15}})
    expect_ticks(clock_of(ticks), ticks);
}

TEST(TickClock, PutsPiecesInOrder) { expect_ticks(clock_of({7, 8, 9, 2, 3, 12, 4}), {7, 8, 9, 2, 3, 12, 4}); }

TEST(TickClock, HasNoTimeWithoutTicks) {
  const TickClock clock;
  EXPECT_TRUE(clock.empty());
  EXPECT_EQ(clock.tick_at(5), 0);
  EXPECT_FALSE(clock.has(0));
  EXPECT_FALSE(clock.next_time(0));
}

}  // namespace
}  // namespace rehearse
