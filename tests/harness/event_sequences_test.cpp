// Comparison of two sequences of events.
#include "core/compare/event_sequences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rehearse {
namespace {

using ::testing::ElementsAre;

std::vector<EventEdge> edges(const std::vector<std::int64_t>& ticks, bool begins = true) {
  std::vector<EventEdge> made;
  for (const std::int64_t tick : ticks) {
    made.push_back({tick, static_cast<std::uint64_t>(tick), begins});
    begins = !begins;
  }
  return made;
}

/// "3=4" for a pair, "3-" for an event of the golden only, "-4" for an event of the run only; by tick.
std::vector<std::string> aligned(const std::vector<EventEdge>& golden, const std::vector<EventEdge>& actual) {
  std::vector<std::string> text;
  for (const EventPair& pair : align(golden, actual)) {
    std::string& entry = text.emplace_back();
    if (pair.golden) entry += std::to_string(golden[*pair.golden].tick);
    entry += pair.golden && pair.actual ? "=" : "-";
    if (pair.actual) entry += std::to_string(actual[*pair.actual].tick);
  }
  return text;
}

TEST(Align, PairsAsManyInOrderHoweverFarTheyAreApart) {
  EXPECT_THAT(aligned(edges({1, 100, 200}), edges({1, 190, 200})), ElementsAre("1=1", "100=190", "200=200"));
}

TEST(Align, LeavesOutWhatFitsLeast) {
  EXPECT_THAT(aligned(edges({1, 5, 6, 9}), edges({1, 9})), ElementsAre("1=1", "5-", "6-", "9=9"));
  EXPECT_THAT(aligned(edges({2, 9}), edges({1, 2, 3, 9})), ElementsAre("-1", "-2", "2=3", "9=9"));
}

TEST(Align, NeverPairsABeginningWithAnEnd) {
  EXPECT_THAT(aligned(edges({4}, true), edges({4}, false)), ElementsAre("-4", "4-"));
  EXPECT_THAT(aligned(edges({4, 8}, false), edges({8}, true)), ElementsAre("4-", "8=8"));
}

TEST(Align, HasNothingToSayOfNothing) {
  EXPECT_THAT(aligned({}, {}), ElementsAre());
  EXPECT_THAT(aligned(edges({3}), {}), ElementsAre("3-"));
}

TEST(Align, IsSoonDoneWithTensOfThousands) {
  std::vector<std::int64_t> many(60'000);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = static_cast<std::int64_t>(i);
  std::vector<std::int64_t> few(many.begin(), many.begin() + 20'000);
  EXPECT_EQ(align(edges(many), edges(few)).size(), many.size());
}

}  // namespace
}  // namespace rehearse
