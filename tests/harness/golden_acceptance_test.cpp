// The records that an acceptance writes into a golden, and those that it removes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/golden.h>

#include "golden_folder.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using testing::EnvironmentVariable;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::read_file;
using testing::SmallTrace;
using ::testing::StartsWith;
using testing::write;
namespace fs = std::filesystem;

class GoldenAcceptance : public testing::GoldenFolder {
 protected:
  std::vector<Acceptance> history() const {
    const auto golden = Trace::load(store_.trace_file(name_));
    EXPECT_TRUE(golden);
    return history_of(golden->metadata());
  }
};

TEST_F(GoldenAcceptance, OfAFirstRunSaysWhen) {
  place_golden(SmallTrace());
  ASSERT_EQ(history().size(), 1u);
  EXPECT_EQ(history()[0].date, "2025-11-20");
  EXPECT_EQ(history()[0].kind, "first");
  EXPECT_THAT(history()[0].moved, IsEmpty());
  EXPECT_THAT(digest(), HasSubstr("\n\naccepted 2025-11-20, first\n\nprovenance\n"));
}

TEST_F(GoldenAcceptance, AddsWhatMovedToTheHistoryOfTheOldOne) {
  place_golden(SmallTrace());
  place_golden(changed());
  ASSERT_EQ(history().size(), 2u);
  EXPECT_EQ(history()[0].kind, "first");
  EXPECT_EQ(history()[1].kind, "replaced");
  EXPECT_THAT(history()[1].verdict,
              HasSubstr("differs: Robot/Pd/output/KNEE/u is beyond ±0.001 N·m from tick 1 (0.001 s) on, worst 87 N·m"));
  EXPECT_THAT(history()[1].moved, ElementsAre("/Robot/Pd/output/joints KNEE/u: 87 N·m at tick 1, 1 of 3 values"));
  EXPECT_THAT(digest(), HasSubstr("\naccepted 2025-11-20, replaced: differs: Robot/Pd/output/KNEE/u is"));
  EXPECT_THAT(digest(), HasSubstr("\n  /Robot/Pd/output/joints KNEE/u: 87 N·m at tick 1, 1 of 3 values\n"));
}

TEST_F(GoldenAcceptance, OfTheSameRunChangesNothing) {
  place_golden(SmallTrace());
  const std::string trace = read_file(store_.trace_file(name_)), text = digest();
  setenv("SOURCE_DATE_EPOCH", "1800000000", 1);
  place_pending(SmallTrace());
  const auto accepted = store_.accept_pending(name_);
  ASSERT_TRUE(accepted);
  EXPECT_FALSE(accepted->changed);
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == trace);
  EXPECT_TRUE(digest() == text);
  EXPECT_FALSE(fs::exists(store_.pending_file(name_)));
}

TEST_F(GoldenAcceptance, OfTheSameNumbersByAnotherVersionOrScenarioIsOne) {
  place_golden(SmallTrace());
  SmallTrace run;
  run.provenance["rehearse"] = "0.2.0";
  place_golden(run);
  ASSERT_EQ(history().size(), 2u);
  EXPECT_THAT(history()[1].verdict, HasSubstr("equal bit for bit"));
  EXPECT_THAT(history()[1].moved, ElementsAre(StartsWith(R"(note: rehearse was "0.1.0" and is "0.2.0")")));
  run.scenario = "rehearse: 1\n# other\n";
  place_golden(run);
  EXPECT_THAT(history()[2].moved, ElementsAre("note: scenario.yaml has changed since the golden was recorded"));
}

TEST_F(GoldenAcceptance, TwiceAtTheSameTimeGivesTheSameBytes) {
  place_golden(SmallTrace());
  place_golden(changed());
  const std::string trace = read_file(store_.trace_file(name_));
  fs::remove(store_.trace_file(name_));
  place_golden(SmallTrace());
  place_golden(changed());
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == trace);
}

TEST_F(GoldenAcceptance, OfACopyOfAGoldenTakesTheHistoryOfTheOneItReplaces) {
  place_golden(changed());
  fs::copy_file(store_.trace_file(name_), folder_ / "copy.mcap");
  fs::remove(store_.trace_file(name_));
  place_golden(SmallTrace());
  ASSERT_TRUE(store_.accept(name_, folder_ / "copy.mcap"));
  ASSERT_EQ(history().size(), 2u);
  EXPECT_EQ(history()[1].kind, "replaced");
  EXPECT_TRUE(is_run(changed()));
}

TEST_F(GoldenAcceptance, GivesAGoldenWithoutHistoryItsFirst) {
  SmallTrace().write(store_.trace_file(name_));  // in the form of earlier versions
  write(store_.digest_file(name_), *digest_of(*Trace::load(store_.trace_file(name_))));
  EXPECT_TRUE(store_.check_digest(name_));
  EXPECT_THAT(digest(), Not(HasSubstr("\naccepted")));
  place_golden(changed());
  ASSERT_EQ(history().size(), 1u);
  EXPECT_EQ(history()[0].kind, "replaced");
}

TEST_F(GoldenAcceptance, ListsWhatIsMissingAndBoundsTheList) {
  SmallTrace run;
  run.left_out = {"/Robot/Laser/scan"};
  place_golden(SmallTrace());
  place_golden(run);
  EXPECT_THAT(history()[1].moved, ElementsAre("/Robot/Laser/scan: the channel is missing"));
  Comparison many;
  for (int i = 0; i < 40; ++i) {
    Divergence worst;
    worst.difference = i;
    worst.tolerance = 1.0;
    worst.unit = "m";
    ChannelComparison& channel = many.channels.emplace_back();
    channel.channel = "/channel" + std::to_string(i);
    channel.values = 10;
    channel.differing = channel.beyond = 1;
    channel.first = channel.first_bit = channel.worst = worst;
  }
  const std::vector<std::string> lines = moved_lines(many);
  ASSERT_EQ(lines.size(), 11u);
  EXPECT_EQ(lines[0], "/channel39: 39 m at tick 0, 1 of 10 values");
  EXPECT_EQ(lines[10], "and 30 channels more");
}

TEST_F(GoldenAcceptance, IsDatedByUtcOrBySourceDateEpoch) {
  EXPECT_EQ(*date_of_today(), "2025-11-20");
  setenv("SOURCE_DATE_EPOCH", "0", 1);
  EXPECT_EQ(*date_of_today(), "1970-01-01");
  for (const char* wrong : {"today", "-1", "12 ", "99999999999999"}) {
    setenv("SOURCE_DATE_EPOCH", wrong, 1);
    ASSERT_FALSE(date_of_today()) << wrong;
    EXPECT_THAT(date_of_today().errors()[0].message, HasSubstr(wrong));
  }
  unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_THAT(*date_of_today(), ::testing::MatchesRegex("20[0-9][0-9]-[0-9][0-9]-[0-9][0-9]"));
}

TEST_F(GoldenAcceptance, WritesNothingIfItsDateIsWrong) {
  setenv("SOURCE_DATE_EPOCH", "yesterday", 1);
  place_pending(SmallTrace());
  EXPECT_FALSE(store_.accept_pending(name_));
  EXPECT_FALSE(store_.has(name_));
  EXPECT_TRUE(fs::exists(store_.pending_file(name_)));
}

TEST_F(GoldenAcceptance, RejectingRemovesTheRunAndItsPictures) {
  SmallTrace other;
  other.ticks[1].image.pixels[0] = 200;
  place_golden(SmallTrace());
  EXPECT_FALSE(settle(other).passed);
  EXPECT_GE(std::distance(fs::directory_iterator(folder_ / "pending"), fs::directory_iterator()), 2);
  ASSERT_TRUE(store_.reject(name_));
  EXPECT_TRUE(fs::is_empty(folder_ / "pending"));
  EXPECT_TRUE(is_run(SmallTrace()));
  ASSERT_FALSE(store_.reject(name_));
  EXPECT_THAT(store_.reject(name_).errors()[0].message, HasSubstr("nothing waits"));
}

TEST_F(GoldenAcceptance, NamesWhatWaitsIfNothingWaitsByThatName) {
  place_pending(SmallTrace());
  ASSERT_FALSE(store_.accept_pending("Golden.Other"));
  EXPECT_EQ(store_.accept_pending("Golden.Other").errors()[0].hint, "waiting: " + name_);
  EXPECT_FALSE(store_.reject("../pending/" + name_));
}

TEST_F(GoldenAcceptance, RemovingTakesBothFilesOrNone) {
  place_golden(SmallTrace());
  ASSERT_TRUE(store_.remove(name_));
  EXPECT_TRUE(fs::is_empty(folder_ / "golden"));
  place_golden(SmallTrace());
  write(store_.digest_file(name_), "notes of mine");
  ASSERT_FALSE(store_.remove(name_));
  EXPECT_THAT(store_.remove(name_).errors()[0].message, HasSubstr("so they aren't removed"));
  fs::remove(store_.digest_file(name_));
  EXPECT_FALSE(store_.remove(name_));
  EXPECT_TRUE(store_.has(name_));
}

}  // namespace
}  // namespace rehearse
