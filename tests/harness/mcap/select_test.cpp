#include <rehearse/messages.h>

#include <gmock/gmock.h>

#include "base/glob.h"
#include "core/trace/select.h"
#include "mcap_files.h"

using namespace rehearse;
using namespace rehearse::test;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

/// Ticks 5 to 9, one a millisecond, each after a message "a" (/a) of its time; the log begins at 2 s.
void write_ticks(const std::filesystem::path& file) {
  auto writer = std::move(*mcap::Writer::create(file));
  const auto a = writer->add_channel(0, "/a", "text");
  const auto ticks = writer->add_channel(
      writer->add_schema(msg::Tick::type_name, "ros2msg", msg::schema_text<msg::Tick>()), "/tick", "cdr");
  CdrWriter cdr;
  for (std::int64_t tick = 5; tick < 10; ++tick) {
    const std::uint64_t time = 2'000'000'000 + static_cast<std::uint64_t>(tick - 5) * 1'000'000;
    ASSERT_TRUE(writer->write(a, time, time, bytes_of(std::to_string(tick))));
    msg::Tick message;
    message.tick = tick;
    cdr.reset();
    msg::encode(message, cdr);
    ASSERT_TRUE(writer->write(ticks, time, time, cdr.bytes()));
  }
  ASSERT_TRUE(writer->close());
}

std::unique_ptr<mcap::Reader> open(const TempFile& file) { return std::move(*mcap::Reader::open(file.path())); }

/// The selected messages of /a.
std::vector<std::string> taken(mcap::Reader& reader, mcap::Selection selection) {
  auto selector = mcap::Selector::of(std::move(selection), reader);
  if (!selector) return {selector.errors()[0].message};
  std::vector<std::string> texts;
  EXPECT_TRUE(reader.for_each_message([&](const mcap::Message& message) {
    if (message.channel->topic == "/a" && selector->takes(message)) texts.push_back(text_of(message.data));
    return true;
  }));
  return texts;
}

std::string refusal(const Result<mcap::TimeBound>& result) { return result ? "" : result.errors()[0].message; }

}  // namespace

TEST(McapSelect, ReadsMoments) {
  EXPECT_EQ(*mcap::parse_time_bound("3.5"), (mcap::TimeBound{3'500'000'000, mcap::TimeOrigin::beginning}));
  EXPECT_EQ(*mcap::parse_time_bound("+0.001"), (mcap::TimeBound{1'000'000, mcap::TimeOrigin::first_message}));
  EXPECT_EQ(*mcap::parse_time_bound("1700000000.123456789"),
            (mcap::TimeBound{1'700'000'000'123'456'789, mcap::TimeOrigin::clock}));
  EXPECT_EQ(*mcap::parse_time_bound(".5"), (mcap::TimeBound{500'000'000, mcap::TimeOrigin::beginning}));
  EXPECT_EQ(*mcap::parse_time_bound("7."), (mcap::TimeBound{7'000'000'000, mcap::TimeOrigin::beginning}));
  EXPECT_EQ(mcap::parse_time_bound("18446744073.709551615")->ns, ~std::uint64_t{0});
}

TEST(McapSelect, ReadsDates) {
  const std::uint64_t second = 1'000'000'000, noon = 1'795'694'400 * second;
  for (const char* text :
       {"2026-11-26T12:00:00Z", "2026-11-26 12:00:00 UTC", "2026-11-26T12:00", "2026-11-26T12:00:00"})
    EXPECT_EQ(*mcap::parse_time_bound(text), (mcap::TimeBound{noon, mcap::TimeOrigin::clock})) << text;
  EXPECT_EQ(mcap::parse_time_bound("2026-11-26 12:00:01.000000005 UTC")->ns, noon + second + 5);
  for (const char* text : {"2026-11-26", "2026-13-26T12:00:00Z", "2026-02-29T12:00:00Z", "2026-11-26T24:00:00Z",
                           "2026-11-26T12:00:00+01:00", "2026-11-26T12:00:00.Z1", "1969-11-26T12:00:00Z"})
    EXPECT_THAT(refusal(mcap::parse_time_bound(text)), HasSubstr("is no time")) << text;
}

TEST(McapSelect, CountsFromTheFirstMessageOfALogWithoutTicks) {
  const TempFile file;
  {
    auto writer = std::move(*mcap::Writer::create(file.path()));
    const auto a = writer->add_channel(0, "/a", "text");
    const std::uint64_t noon = 1'795'694'400'000'000'000;
    for (std::uint64_t i = 0; i < 4; ++i) {
      const std::uint64_t time = noon + i * 1'000'000'000;
      ASSERT_TRUE(writer->write(a, time, time, bytes_of(std::to_string(i))));
    }
    ASSERT_TRUE(writer->close());
  }
  const auto reader = open(file);
  const auto moment = [](const char* text) { return *mcap::parse_time_bound(text); };
  EXPECT_THAT(taken(*reader, {.from = moment("1"), .until = moment("3")}), ElementsAre("1", "2"));
  EXPECT_THAT(taken(*reader, {.from = moment("+2")}), ElementsAre("2", "3"));
  EXPECT_THAT(taken(*reader, {.from = moment("2026-11-26T12:00:03Z")}), ElementsAre("3"));
  EXPECT_THAT(taken(*reader, {.from = moment("1795694402")}), ElementsAre("2", "3"));
  EXPECT_THAT(taken(*reader, {.from = moment("4")}), ElementsAre("nothing was recorded in the span that is asked for"));
}

TEST(McapSelect, RefusesWhatIsNoMoment) {
  for (const char* text : {"", "+", ".", "-1", "1e3", "1.0000000001", "18446744073.709551616", "1 ", "nan", "1,5",
                           "++1", "99999999999999999999"}) {
    EXPECT_THAT(refusal(mcap::parse_time_bound(text)), HasSubstr("is no time")) << text;
  }
}

TEST(McapSelect, ReadsSpansOfTicks) {
  EXPECT_EQ(*mcap::parse_tick_span("10..20"), (mcap::TickSpan{10, 20}));
  EXPECT_EQ(*mcap::parse_tick_span("10.."), (mcap::TickSpan{10, {}}));
  EXPECT_EQ(*mcap::parse_tick_span("..20"), (mcap::TickSpan{{}, 20}));
  EXPECT_EQ(*mcap::parse_tick_span("7"), (mcap::TickSpan{7, 7}));
  for (const char* text : {"", "..", "a..b", "20..10", "1...2", "1-2", "1.5", "99999999999999999999"}) {
    EXPECT_FALSE(mcap::parse_tick_span(text)) << text;
  }
}

TEST(McapSelect, TakesTopicsByPatterns) {
  const mcap::Selection selection{.topics = {"/SR1/*", "/tick"}};
  EXPECT_TRUE(selection.takes_topic("/SR1/WAIST/pose"));
  EXPECT_TRUE(selection.takes_topic("/tick"));
  EXPECT_FALSE(selection.takes_topic("/ticks"));
  EXPECT_TRUE(mcap::Selection{}.takes_topic("/anything"));
}

TEST(McapSelect, TakesTimesFromTheFirstUpToTheLastWithoutIt) {
  const TempFile file;
  write_ticks(file.path());
  const auto reader = open(file);
  const auto moment = [](const char* text) { return *mcap::parse_time_bound(text); };
  EXPECT_THAT(taken(*reader, {}), ElementsAre("5", "6", "7", "8", "9"));
  EXPECT_THAT(taken(*reader, {.from = moment("2.001"), .until = moment("2.003")}), ElementsAre("6", "7"));
  EXPECT_THAT(taken(*reader, {.from = moment("+0.001"), .until = moment("+0.003")}), ElementsAre("6", "7"));
  EXPECT_THAT(taken(*reader, {.until = moment("1")}),
              ElementsAre("nothing was recorded in the span that is asked for"));
}

TEST(McapSelect, TakesTicksWithBothEnds) {
  const TempFile file;
  write_ticks(file.path());
  const auto reader = open(file);
  EXPECT_THAT(taken(*reader, {.ticks = mcap::TickSpan{6, 8}}), ElementsAre("6", "7", "8"));
  EXPECT_THAT(taken(*reader, {.ticks = mcap::TickSpan{8, {}}}), ElementsAre("8", "9"));
  EXPECT_THAT(taken(*reader, {.ticks = mcap::TickSpan{{}, 5}}), ElementsAre("5"));
  EXPECT_THAT(taken(*reader, {.from = *mcap::parse_time_bound("+0.002"), .ticks = mcap::TickSpan{6, 8}}),
              ElementsAre("7", "8"));
}

TEST(McapSelect, SaysWhichTicksThereAre) {
  const TempFile file;
  write_ticks(file.path());
  const auto reader = open(file);
  EXPECT_THAT(taken(*reader, {.ticks = mcap::TickSpan{100, 200}}), ElementsAre(HasSubstr("it has ticks 5 to 9")));
  const TempFile other;
  write_small_file(other.path());
  const auto without = open(other);
  EXPECT_THAT(taken(*without, {.ticks = mcap::TickSpan{1, 2}}), ElementsAre(HasSubstr("it has no ticks")));
}

TEST(McapSelect, RefusesAPatternThatMatchesNothing) {
  const TempFile file;
  write_ticks(file.path());
  const auto reader = open(file);
  EXPECT_THAT(taken(*reader, {.topics = {"/a", "/b*"}}), ElementsAre("no topic matches '/b*'"));
}
