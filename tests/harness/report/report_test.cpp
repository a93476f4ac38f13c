// The contents of a report, compared with its recordings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/check.h>
#include <rehearse/compare.h>
#include <rehearse/report.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <tuple>

#include "../small_traces.h"
#include "decoded_report.h"
#include "viewing/report/report_series.h"

namespace rehearse::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

class Report : public ::testing::Test {
 protected:
  void SetUp() override { options_.page = plain_page(folder_ / "page.html"); }

  DecodedReport alone() {
    actual_.write(folder_ / "actual.mcap");
    return written(std::nullopt);
  }
  DecodedReport beside_golden() {
    actual_.write(folder_ / "actual.mcap");
    golden_.write(folder_ / "golden.mcap");
    return written(folder_ / "golden.mcap");
  }
  DecodedReport written(const std::optional<std::filesystem::path>& golden) {
    const auto summary = write_report(folder_ / "actual.mcap", golden, folder_ / "report.html", options_);
    EXPECT_TRUE(summary) << (summary ? "" : to_string(summary.errors()));
    if (summary) summary_ = *summary;
    return DecodedReport(folder_ / "report.html");
  }
  /// The reason why there is no report.
  Diagnostic refusal(const std::filesystem::path& trace,
                     const std::optional<std::filesystem::path>& golden = std::nullopt) {
    const auto summary = write_report(trace, golden, folder_ / "report.html", options_);
    EXPECT_FALSE(summary);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html.part"));
    return summary ? Diagnostic() : summary.errors()[0];
  }

  TemporaryFolder folder_;
  SmallTrace actual_, golden_;
  ReportOptions options_;
  ReportSummary summary_;
};

std::vector<std::uint64_t> column(const Trace& trace, const std::string& series) {
  const auto place = trace.find_series(series);
  std::vector<std::uint64_t> bits;
  if (!place) return bits;
  const TraceChannel& channel = trace.channels()[place->channel];
  for (std::size_t row = 0; row < channel.rows(); ++row) bits.push_back(channel.bits(row, place->column));
  return bits;
}

/// Compares all series of a report with the traces.
void expect_same_numbers(const DecodedReport& report, const Trace& actual, const Trace* golden) {
  std::size_t expected = actual.series().size();
  for (const auto& [name, place] : actual.series()) {
    const Json& series = report.series(name);
    ASSERT_FALSE(series.is_null()) << name;
    EXPECT_EQ(report.values(series), column(actual, name)) << name;
    if (golden && !column(*golden, name).empty()) {
      ASSERT_FALSE(series["golden"].is_null()) << name;
      EXPECT_EQ(report.golden(series), column(*golden, name)) << name;
    }
    EXPECT_EQ(report.ticks(series["axis"]).size(), actual.channels()[place.channel].rows()) << name;
  }
  if (golden)
    for (const auto& [name, place] : golden->series())
      if (!actual.find_series(name)) {
        ++expected;
        EXPECT_TRUE(report.series(name)["values"].is_null()) << name;
        EXPECT_EQ(report.golden(report.series(name)), column(*golden, name)) << name;
      }
  EXPECT_EQ(report["series"].size(), expected);
}

TEST_F(Report, HasEveryNumberBitForBit) {
  actual_.ticks[0].q = -0.0;
  actual_.ticks[1].q = nan;
  actual_.ticks[2].q = std::bit_cast<double>(0xfff8000000001234);  // a NaN with a payload
  actual_.ticks[1].force = infinity;
  actual_.ticks[2].force = -5e-324;
  actual_.ticks[1].state_hash = 0xfedcba9876543210;
  for (SmallTick& tick : actual_.ticks) tick.u = std::bit_cast<double>(0x7ff800000000beef);
  const DecodedReport report = alone();
  expect_same_numbers(report, actual_.load(folder_ / "again.mcap"), nullptr);
  EXPECT_EQ(report.series("Robot/KNEE/q")["range"], Json({-0.0, -0.0}));
  EXPECT_EQ(report.series("Robot/KNEE/q")["unit"], "rad");
  EXPECT_EQ(report.series("Robot/KNEE/q")["group"], "state");
  EXPECT_EQ(report.series("Robot/Foot/force/z")["group"], "sensor");
  EXPECT_EQ(report.series("Robot/Pd/input/KNEE/q")["group"], "input");
  EXPECT_EQ(report.series("Robot/Pd/output/KNEE/u")["group"], "output");
  EXPECT_TRUE(report.series("Robot/Pd/output/KNEE/u")["range"].is_null());  // nothing but NaN
  EXPECT_EQ(report.series("state_hash")["kind"], "unsigned_integer");
  EXPECT_EQ(report.series("Robot/WHEEL/q")["wraps"], true);
}

TEST(SeriesGroup, IsThatOfTheTopic) {
  const auto group_of = [](const std::string& topic) {
    TraceChannel channel;
    channel.topic = topic;
    return series_group(channel);
  };
  EXPECT_EQ(group_of("/Robot/Pd/variable/integral"), "variable");
  EXPECT_EQ(group_of("/Robot/Pd/output/joints"), "output");
  EXPECT_EQ(group_of("/Robot/Pd/input/FOOT/contacts"), "input");
  EXPECT_EQ(group_of("/joy"), "input");
  EXPECT_EQ(group_of("/Robot/Foot/wrench"), "sensor");
  EXPECT_EQ(group_of("/Robot/BASE/twist"), "state");
  EXPECT_EQ(group_of("/Robot/Eye/camera_info"), "other");
}

TEST_F(Report, OfARunAloneSaysSo) {
  const DecodedReport report = alone();
  EXPECT_EQ(report["verdict"]["state"], "alone");
  EXPECT_EQ(report["runs"].size(), 1u);
  EXPECT_EQ(report["runs"][0]["role"], "actual");
  EXPECT_EQ(report["runs"][0]["file"], "actual.mcap");
  EXPECT_EQ(report["runs"][0]["facts"]["rehearse"], "0.1.0");
  EXPECT_EQ(report["begin"], 0);
  EXPECT_EQ(report["end"], 3);
  EXPECT_TRUE(report["first"].is_null());
  EXPECT_THAT(report["divergences"], IsEmpty());
  EXPECT_TRUE(report.series("Robot/KNEE/q")["tolerance"].is_null());
  EXPECT_EQ(report.text().find("<!doctype html><!-- a report of Rehearse -->\n<html>"), 0u);
  EXPECT_FALSE(summary_.first_tick);
  EXPECT_EQ(summary_.bytes, std::filesystem::file_size(folder_ / "report.html"));
}

/// A scenario of three ticks with these expectations.
std::string expecting(const std::string& expectations) {
  return "rehearse: 1\nname: small\nduration: 0.003\nbodies:\n  - {name: Robot, box: {size: [1, 1, 1]}, mass: "
         "1}\nexpect:\n" +
         expectations;
}

TEST_F(Report, OfARunAloneHasAllViolatedExpectations) {
  actual_.scenario = expecting(
      "  - {channel: Robot/KNEE/q, below: 0.6}\n"
      "  - {channel: Robot/Foot/force/z, near: 650, within: 10, at: end}\n"
      "  - {channel: \"Robot/*/KNEE/u\", abs: true, below: 20, from: 0.001, until: 0.002}\n");
  actual_.ticks[1].u = -25.0;
  actual_.ticks[2].force = 700.0;
  const DecodedReport report = alone();
  const Json& expectations = report["expectations"];
  ASSERT_EQ(expectations.size(), 3u) << report["omitted"];
  EXPECT_EQ(expectations[0]["holds"], true);
  EXPECT_EQ(expectations[0]["text"], "Robot/KNEE/q below 0.6 rad");
  EXPECT_TRUE(expectations[0]["low"].is_null());
  EXPECT_EQ(expectations[0]["high"], 0.6);
  EXPECT_EQ(expectations[0]["begin"], 0);
  EXPECT_EQ(expectations[0]["end"], 2);
  EXPECT_EQ(expectations[1]["holds"], false);
  EXPECT_EQ(expectations[1]["low"], 640.0);
  EXPECT_EQ(expectations[1]["margin"], -40.0);
  EXPECT_EQ(expectations[1]["begin"], 2);
  EXPECT_EQ(expectations[1]["first"], Json({{"tick", 2}, {"value", 700.0}}));
  EXPECT_EQ(expectations[2]["series"], "Robot/Pd/output/KNEE/u");
  EXPECT_EQ(expectations[2]["low"], -20.0);
  EXPECT_EQ(expectations[2]["margin"], -5.0);
  EXPECT_EQ(expectations[2]["begin"], 1);
  EXPECT_EQ(expectations[2]["first"], Json({{"tick", 1}, {"value", 25.0}}));
  EXPECT_EQ(report["verdict"]["state"], "violated");
  EXPECT_EQ(report["verdict"]["sentence"],
            expectations[2]["sentence"].get<std::string>() + "; 1 more of 3 expectations is violated");
  EXPECT_EQ(report["verdict"]["besides"], "");
  EXPECT_EQ(summary_.first_tick, 1);
}

TEST_F(Report, BesideAGoldenTellsViolationsBeforeDifferences) {
  actual_.scenario = golden_.scenario = expecting("  - {channel: Robot/KNEE/q, below: 0.6}\n");
  actual_.ticks[1].force = 651.0;
  actual_.ticks[2].q = 0.7;
  const DecodedReport report = beside_golden();
  EXPECT_EQ(report["verdict"]["state"], "violated");
  EXPECT_THAT(report["verdict"]["sentence"].get<std::string>(),
              AllOf(StartsWith("expected Robot/KNEE/q below 0.6 rad: 0.7 rad at tick 2"),
                    HasSubstr("; differs: Robot/Foot/force/z is beyond ")));
  EXPECT_THAT(report["verdict"]["besides"].get<std::string>(),
              StartsWith("differs: Robot/Foot/force/z is beyond ±0.0001 N from tick 1"));
  EXPECT_EQ(summary_.first_tick, 1);
}

TEST_F(Report, JudgesThePartThatItDoesNotShow) {
  actual_.scenario = expecting("  - {channel: Robot/KNEE/q, below: 0.6}\n");
  actual_.ticks[0].q = 0.7;
  options_.from = 0.001;
  const DecodedReport report = alone();
  EXPECT_EQ(report["begin"], 1);
  ASSERT_EQ(report["expectations"].size(), 1u) << report["omitted"];
  EXPECT_EQ(report["expectations"][0]["first"]["tick"], 0);
}

TEST_F(Report, NamesTheWorstSeriesOfEachChannelByItsTolerance) {
  actual_.ticks[1].q = 0.5 + 1e-6;
  actual_.ticks[1].force = 700.0;
  options_.tolerances.emplace();
  options_.tolerances->resize(2);
  options_.tolerances->at(0).channel = "Robot/KNEE/q";
  options_.tolerances->at(0).atol = 1e-9;
  options_.tolerances->at(1).channel = "Robot/Foot/*";
  options_.tolerances->at(1).atol = 10.0;
  const DecodedReport report = beside_golden();
  EXPECT_EQ(report["worst"], Json({"Robot/KNEE/q", "Robot/Foot/force/z"}));
}

TEST_F(Report, HasTheCallStackOfTheFirstCommandBeyondTolerance) {
  actual_.ticks[0].u = std::nextafter(12.0, 13.0);
  actual_.ticks[2].u = 13.0;
  golden_.ticks[2].q = 0.6;
  std::vector<std::tuple<std::string, std::string, std::int64_t>> asked;
  options_.call_stack = [&](const std::string& controller, const std::string& command,
                            std::int64_t tick) -> Result<CallStack> {
    asked.emplace_back(controller, command, tick);
    return CallStack{controller, command, tick, {{"Pd::control", "pd.cpp", 12, 11, {"{", "  u = 13;"}}}};
  };
  const DecodedReport report = beside_golden();
  EXPECT_EQ(asked, (std::vector<std::tuple<std::string, std::string, std::int64_t>>{{"Robot/Pd", "KNEE/u", 2}}));
  EXPECT_EQ(report["call_stack"]["command"], "KNEE/u");
  EXPECT_EQ(report["call_stack"]["tick"], 2);
  EXPECT_EQ(report["call_stack"]["frames"][0]["line"], 12);
  EXPECT_EQ(report["call_stack"]["frames"][0]["source"][1], "  u = 13;");
}

TEST_F(Report, WithoutACallStackSaysWhy) {
  actual_.ticks[2].u = 13.0;
  options_.call_stack = [](const std::string&, const std::string&, std::int64_t) -> Result<CallStack> {
    return error("no gdb");
  };
  const DecodedReport report = beside_golden();
  EXPECT_TRUE(report["call_stack"].is_null());
  EXPECT_THAT(report["omitted"].dump(), HasSubstr("There is no call stack: no gdb"));
}

TEST_F(Report, HasBothRunsBitForBit) {
  actual_.lengthen(200);
  golden_.lengthen(200);
  for (std::size_t i = 0; i < 200; ++i) {  // equal except for last bits, so that a filter against the run is best
    golden_.ticks[i].q = std::sin(0.1 * static_cast<double>(i));
    actual_.ticks[i].q = std::nextafter(golden_.ticks[i].q, i % 3 == 0 ? 2.0 : golden_.ticks[i].q);
    golden_.ticks[i].force = 1.0 / (1.0 + static_cast<double>(i));
    actual_.ticks[i].force = golden_.ticks[i].force;
    actual_.ticks[i].u = std::cos(0.3 * static_cast<double>(i));
  }
  const DecodedReport report = beside_golden();
  const Trace golden = golden_.load(folder_ / "golden.mcap"), actual = actual_.load(folder_ / "again.mcap");
  expect_same_numbers(report, actual, &golden);
  EXPECT_EQ(report.series("Robot/KNEE/q")["golden"]["filter"], "xor-base");
  EXPECT_EQ(report.series("Robot/Foot/force/z")["golden"], "same");
}

TEST_F(Report, SaysWhatACompareSays) {
  actual_.lengthen(100);
  golden_.lengthen(100);
  for (const std::size_t tick : {40u, 41u, 42u, 60u}) actual_.ticks[tick].q += 1e-3;
  actual_.ticks[20].q += 1e-12;  // within
  actual_.ticks[50].rotation = {0.0, 0.0, std::sin(0.01), std::cos(0.01)};
  const DecodedReport report = beside_golden();
  const Comparison comparison =
      compare(golden_.load(folder_ / "golden.mcap"), actual_.load(folder_ / "again.mcap"), {});
  EXPECT_EQ(report["verdict"]["sentence"], verdict(comparison));
  EXPECT_EQ(report["verdict"]["state"], "beyond");
  const Json& first = report["divergences"][report["first"].get<std::size_t>()];
  EXPECT_EQ(first["tick"], 40);
  EXPECT_EQ(first["series"], "Robot/KNEE/q");
  EXPECT_EQ(first["beyond"], true);
  EXPECT_EQ(first["expected"], comparison.first->expected);
  EXPECT_EQ(first["actual"], comparison.first->actual);
  EXPECT_EQ(first["tolerance"], comparison.first->tolerance);
  EXPECT_EQ(first["stage"], "physics");
  EXPECT_EQ(summary_.first_tick, 40);
  EXPECT_EQ(report["divergences"][0]["tick"], 20);  // in any bit
  EXPECT_EQ(report["divergences"][0]["beyond"], false);
  EXPECT_EQ(report["spans"], Json({{40, 43}, {50, 51}, {60, 61}}));
  const Json& knee = report.series("Robot/KNEE/q");
  EXPECT_EQ(knee["differing"], 5);
  EXPECT_EQ(knee["beyond"], 4);
  EXPECT_EQ(knee["tolerance"], comparison.first->tolerance);
  EXPECT_EQ(report.series("Robot/BASE/orientation/z")["beyond"], 1);
  EXPECT_EQ(report.series("Robot/BASE/orientation/x")["beyond"], 1);  // all four are compared as one orientation
  EXPECT_EQ(report.series("Robot/BASE/position/x")["beyond"], 0);
}

TEST_F(Report, JudgesByTheTolerancesThatItIsGiven) {
  actual_.ticks[1].q += 0.01;
  ToleranceRule loose;
  loose.channel = "Robot/KNEE/q";
  loose.atol = 0.1;
  options_.tolerances = std::vector<ToleranceRule>{loose};
  const DecodedReport report = beside_golden();
  EXPECT_EQ(report["verdict"]["state"], "within");
  EXPECT_EQ(report.series("Robot/KNEE/q")["tolerance"], 0.1);
  EXPECT_THAT(report["spans"], IsEmpty());
  options_.verdict = ReportVerdict{"the controller is to blame", "beyond", {{"controller", "differs"}}};
  const DecodedReport judged = beside_golden();
  EXPECT_EQ(judged["verdict"]["sentence"], "the controller is to blame");
  EXPECT_EQ(judged["verdict"]["levels"]["controller"], "differs");
}

TEST_F(Report, KeepsAtMostAThousandSpans) {
  actual_.lengthen(4001);
  golden_.lengthen(4001);
  for (std::size_t i = 0; i < 4000; i += 3) actual_.ticks[i].q = 0.6;
  const DecodedReport report = beside_golden();
  EXPECT_LE(report["spans"].size(), 1000u);
  EXPECT_EQ(report["spans"].front()[0], 0);
  EXPECT_EQ(report["spans"].back()[1], 4000);
}

TEST_F(Report, HasPicturesByteForByte) {
  actual_.ticks[1].image.pixels[0] = 255;
  const DecodedReport report = beside_golden();
  const Json& camera = report["cameras"][0];
  EXPECT_EQ(camera["name"], "Robot/Eye");
  EXPECT_EQ(camera["kind"], "color");
  EXPECT_EQ(camera["width"], 4);
  EXPECT_EQ(camera["height"], 2);
  ASSERT_EQ(camera["pictures"].size(), 3u);
  EXPECT_EQ(report.bytes(camera["pictures"][0]["actual"]), encode_png(actual_.ticks[0].image));
  EXPECT_EQ(report.bytes(camera["pictures"][1]["actual"]), encode_png(actual_.ticks[1].image));
  EXPECT_EQ(report.bytes(camera["pictures"][1]["golden"]), encode_png(golden_.ticks[1].image));
  EXPECT_EQ(camera["pictures"][0]["golden"], "same");
  EXPECT_EQ(camera["pictures"][2]["actual"]["id"], camera["pictures"][0]["actual"]["id"]);  // the same bytes
  EXPECT_EQ(camera["pictures"][0]["differing"], 0);
  EXPECT_EQ(camera["pictures"][1]["differing"], 1);
  EXPECT_EQ(camera["pictures"][1]["actual"]["media_type"], "image/png");
}

TEST_F(Report, ShowsDistancesAsGrey) {
  actual_.ticks[0].depth = {1.0F, 3.0F, static_cast<float>(infinity), 2.0F};
  for (std::size_t i = 1; i < 3; ++i) actual_.ticks[i].depth = {1.0F, 1.0F, 1.0F, 1.0F};
  const DecodedReport report = alone();
  const Json& camera = report["cameras"][1];
  EXPECT_EQ(camera["kind"], "depth");
  EXPECT_EQ(camera["near"], 1.0);
  EXPECT_EQ(camera["far"], 3.0);
  const auto image = decode_png(report.bytes(camera["pictures"][0]["actual"]));
  ASSERT_TRUE(image);
  EXPECT_EQ(image->pixels, (std::vector<std::uint8_t>{255, 255, 255, 1, 1, 1, 0, 0, 0, 128, 128, 128}));
}

TEST_F(Report, HasWhatHappened) {
  actual_.events = {{msg::Time::from_ns(2'000'000), 2, "error", "Robot/Pd", "</script><b>it fell</b>"}};
  golden_.events = {{msg::Time::from_ns(1'000'000), 1, "note", "Robot/Pd", "hello"}};
  actual_.contact_changes = {{msg::Time::from_ns(1'000'000), 1, "Robot/FOOT", "Floor/Floor", true}};
  const DecodedReport report = beside_golden();
  ASSERT_EQ(report["events"].size(), 2u);
  EXPECT_EQ(report["events"][0],
            (Json{{"run", 1}, {"tick", 1}, {"severity", "note"}, {"source", "Robot/Pd"}, {"text", "hello"}}));
  EXPECT_EQ(report["events"][1]["text"], "</script><b>it fell</b>");
  EXPECT_EQ(report["contacts"][0],
            (Json{{"run", 0}, {"tick", 1}, {"a", "Robot/FOOT"}, {"b", "Floor/Floor"}, {"begins", true}}));
}

/// Of a run with many messages those nearest to the first difference are listed, and all of them are in blobs.
TEST_F(Report, ListsTheMessagesNearTheFirstDifference) {
  constexpr std::int64_t ticks = 40, lines = 300;  // a tick
  actual_.lengthen(ticks);
  for (std::int64_t i = 0; i < ticks * lines; ++i)
    actual_.events.push_back({msg::Time::from_ns(static_cast<std::uint64_t>(i / lines) * 1'000'000), i / lines, "note",
                              "Robot/Pd", "line " + std::to_string(i)});
  golden_ = actual_;
  actual_.ticks[30].u += 1.0;
  const DecodedReport report = beside_golden();
  const auto& [all, first, blobs] =
      std::tuple(report["messages"]["all"].get<std::int64_t>(), report["messages"]["first"].get<std::size_t>(),
                 report["messages"]["blobs"]);
  EXPECT_EQ(all, 2 * ticks * lines);
  Json stored = Json::array();
  for (const Json& blob : blobs) {
    const std::vector<std::uint8_t> text = report.bytes(blob);
    const Json some = Json::parse(text.begin(), text.end());
    EXPECT_EQ(blob["messages"], some.size());
    stored.insert(stored.end(), some.begin(), some.end());
  }
  ASSERT_EQ(std::ssize(stored), all);
  EXPECT_EQ(stored[first][1], report["events"][0]["tick"]);
  EXPECT_EQ(stored[first][4], report["events"][0]["text"]);
  EXPECT_EQ(report["events"].size(), 5000u);
  EXPECT_LT(report["events"].front()["tick"], 30);
  EXPECT_GT(report["events"].back()["tick"], 30);
  std::vector<std::string> of_golden;
  for (const Json& message : stored)
    if (message[0] == 1) of_golden.push_back(message[4]);
  ASSERT_EQ(std::ssize(of_golden), ticks * lines);
  for (std::int64_t i = 0; i < ticks * lines; ++i)
    ASSERT_EQ(of_golden[static_cast<std::size_t>(i)], "line " + std::to_string(i));
}

TEST_F(Report, OfASpanHasNoOtherTicks) {
  actual_.lengthen(10);
  golden_.lengthen(10);
  actual_.ticks[5].q = 0.9;
  options_.from = 0.003;
  options_.until = 0.006;
  const DecodedReport report = beside_golden();
  EXPECT_EQ(report["begin"], 3);
  EXPECT_EQ(report["end"], 6);
  EXPECT_EQ(report.ticks(report.series("Robot/KNEE/q")["axis"]), (std::vector<std::int64_t>{3, 4, 5}));
  EXPECT_EQ(summary_.first_tick, 5);
  options_.until.reset();
  options_.from = 7.0;
  EXPECT_THAT(refusal(folder_ / "actual.mcap").message, HasSubstr("nothing was recorded in the span"));
}

TEST_F(Report, OfSomeTopicsSaysWhatItLeavesOut) {
  options_.topics = {"/Robot/joints", "*/image"};
  const DecodedReport report = alone();
  EXPECT_EQ(report["series"].size(), 2u);
  EXPECT_EQ(report["cameras"].size(), 1u);
  EXPECT_THAT(summary_.omitted, Contains(HasSubstr("which were not asked for")));
}

TEST_F(Report, ShowsWhatOnlyOneOfTheRunsHas) {
  actual_.left_out = {"/Robot/Foot/wrench"};
  golden_.left_out = {"/Robot/Eye/image", "/Robot/Laser/scan"};
  const DecodedReport report = beside_golden();
  const Trace golden = golden_.load(folder_ / "golden.mcap"), actual = actual_.load(folder_ / "again.mcap");
  expect_same_numbers(report, actual, &golden);
  EXPECT_TRUE(report.series("Robot/Foot/force/z")["values"].is_null());
  EXPECT_TRUE(report.series("Robot/Laser/ranges/0")["golden"].is_null());
  EXPECT_TRUE(report["cameras"][0]["pictures"][0]["differing"].is_null());
}

TEST_F(Report, OfRunsOfDifferentLengthHasTwoAxes) {
  golden_.lengthen(8);
  actual_.ticks[2].q = 0.7;
  const DecodedReport report = beside_golden();
  const Json& knee = report.series("Robot/KNEE/q");
  EXPECT_EQ(report.ticks(knee["axis"]).size(), 3u);
  EXPECT_EQ(report.ticks(knee["golden_axis"]).size(), 8u);
  EXPECT_EQ(report["end"], 8);
  EXPECT_EQ(report.golden(knee).size(), 8u);
}

TEST_F(Report, OfARunWithoutTicksSaysSo) {
  actual_.ticks.clear();
  const DecodedReport report = alone();
  EXPECT_EQ(report["begin"], report["end"]);
  EXPECT_EQ(report["verdict"]["sentence"], "the recording has no ticks");
  EXPECT_THAT(report["series"], IsEmpty());
  const DecodedReport both = beside_golden();
  EXPECT_EQ(both["verdict"]["state"], "beyond");
}

TEST_F(Report, OfAFailedRunSaysHowItEnded) {
  actual_.outcome = {{"ticks", "3"}, {"complete", "false"}, {"failure", "Robot/Pd crashed at tick 2"}};
  const DecodedReport report = alone();
  EXPECT_EQ(report["verdict"]["state"], "failed");
  EXPECT_EQ(report["verdict"]["sentence"], "Robot/Pd crashed at tick 2");
  EXPECT_EQ(report["runs"][0]["complete"], false);
}

TEST_F(Report, OfACutRecordingHasWhatIsWhole) {
  actual_.lengthen(3000);  // several chunks
  for (std::size_t i = 0; i < actual_.ticks.size(); ++i) actual_.ticks[i].q = std::sin(static_cast<double>(i));
  actual_.write(folder_ / "actual.mcap");
  std::filesystem::resize_file(folder_ / "actual.mcap", std::filesystem::file_size(folder_ / "actual.mcap") * 2 / 3);
  const DecodedReport report = written(std::nullopt);
  EXPECT_GT(report["end"], 500);
  EXPECT_LT(report["end"], 3000);
  EXPECT_THAT(summary_.omitted, Contains(HasSubstr("The recording is incomplete")));
  EXPECT_EQ(report["runs"][0]["complete"], false);
  EXPECT_THAT(report["runs"][0]["outcome"].get<std::string>(), HasSubstr("was cut"));
}

TEST_F(Report, IsRefusedForWhatIsNoRecording) {
  std::ofstream(folder_ / "text.mcap") << "not MCAP";
  EXPECT_THAT(to_string(refusal(folder_ / "text.mcap")), HasSubstr("text.mcap"));
  actual_.provenance.clear();
  actual_.write(folder_ / "bag.mcap");
  EXPECT_FALSE(refusal(folder_ / "missing.mcap").message.empty());
  {
    const auto bag = mcap::Writer::create(folder_ / "bag.mcap");
    ASSERT_TRUE((*bag)->close());
  }
  EXPECT_THAT(refusal(folder_ / "bag.mcap").message, HasSubstr("not a recording of Rehearse"));
  golden_.write(folder_ / "golden.mcap");
  EXPECT_THAT(refusal(folder_ / "golden.mcap", folder_ / "bag.mcap").file, HasSubstr("bag.mcap"));
  SmallTrace later;
  later.provenance["trace_version"] = "99";
  later.write(folder_ / "later.mcap");
  EXPECT_THAT(refusal(folder_ / "later.mcap").message, HasSubstr("99"));
}

TEST_F(Report, ReplacesReportsAndNothingElse) {
  alone();
  alone();  // over the first
  std::ofstream(folder_ / "report.html") << "<!doctype html><p>somebody's homepage";
  EXPECT_THAT(refusal(folder_ / "actual.mcap").message, HasSubstr("won't replace"));
  EXPECT_THAT(read_file(folder_ / "report.html"), HasSubstr("homepage"));
  std::filesystem::remove(folder_ / "report.html");
  std::filesystem::create_directory(folder_ / "report.html");
  EXPECT_THAT(refusal(folder_ / "actual.mcap").message, HasSubstr("directory"));
}

TEST_F(Report, NeedsItsPage) {
  actual_.write(folder_ / "actual.mcap");
  options_.page = folder_ / "missing.html";
  EXPECT_THAT(refusal(folder_ / "actual.mcap").file, HasSubstr("missing.html"));
  std::ofstream(folder_ / "other.html") << "<html></html>";
  options_.page = folder_ / "other.html";
  EXPECT_THAT(refusal(folder_ / "actual.mcap").message, HasSubstr("no page of reports"));
}

/// The findings of a check come from the check: the report judges none of them again.
TEST_F(Report, OfAFailedCheckShowsTheFindingsOfTheCheck) {
  for (SmallTick& tick : actual_.ticks) tick.u = 20.0;
  actual_.scenario = "rehearse: 1\nname: run\nduration: 1\nexpect:\n  - {channel: Robot/KNEE/q, below: 9}\n";
  const Trace golden = golden_.load(folder_ / "golden.mcap"), actual = actual_.load(folder_ / "actual.mcap");
  CheckReport checked;
  checked.closed = LevelState::differs;
  checked.verdict = {VerdictCode::controller_changed, "the sentence of the check"};
  checked.run.emplace();
  checked.comparison = compare(golden, actual, {});
  ChannelComparison& found = checked.comparison->channels.at(0);
  found.first->note = "the finding of the check";
  checked.first = found.first_bit = found.first;
  checked.expectations.emplace_back();
  checked.expectations[0].text = "what the check expected";
  Scenario scenario;
  scenario.name = "walk";
  const auto written =
      write_failure_report(checked, scenario, folder_ / "golden.mcap", folder_ / "actual.mcap", options_);
  ASSERT_TRUE(written) << to_string(written.errors());
  ASSERT_TRUE(*written);
  EXPECT_EQ((*written)->summary.verdict, "the sentence of the check");
  const DecodedReport report((*written)->file);
  EXPECT_EQ(report["title"], "walk");
  EXPECT_EQ(report["verdict"]["state"], "violated");
  checked.expectations.clear();
  EXPECT_EQ(report_verdict(checked).state, "beyond");
  checked.first->note.clear();
  checked.first->tolerance = 1e9;
  EXPECT_EQ(report_verdict(checked).state, "bits") << "nothing is beyond its tolerance";
  ASSERT_EQ(report["divergences"].size(), 1u);
  EXPECT_EQ(report["divergences"][0]["note"], "the finding of the check");
  ASSERT_EQ(report["expectations"].size(), 1u);
  EXPECT_EQ(report["expectations"][0]["text"], "what the check expected");
}

}  // namespace
}  // namespace rehearse::testing
