// The matrix detects each kind of difference between two recordings, and the place of the first.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <span>

#include "child_process.h"
#include "matrix_rows.h"
#include "recording_content.h"
#include "support/temporary_folder.h"

namespace rehearse::matrix {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr double time_step = 0.001;  // [s]

class Content : public ::testing::Test {
 protected:
  struct Recording {
    std::string topic = "/Box/joints", unit = "rad", note = "a scenario", outcome = "true", provenance = "gcc";
    std::vector<std::string> messages{"zero", "one", "two"};
    std::uint64_t delay = 0;         // [ns]
    std::vector<std::string> costs;  // of a controller; empty: they aren't counted
  };

  RecordingContent content(const Recording& recording, std::optional<std::uint64_t> before = std::nullopt) const {
    const fs::path file = folder_ / "recording.mcap";
    auto writer = mcap::Writer::create(file);
    EXPECT_TRUE(writer.ok());
    const auto bytes = [](const std::string& text) { return std::as_bytes(std::span(text)); };
    EXPECT_TRUE((*writer)->add_attachment("scenario.yaml", "text/yaml", bytes(recording.note)).ok());
    EXPECT_TRUE((*writer)->add_metadata("rehearse", {{"compiler", recording.provenance}}).ok());
    const auto ticks = (*writer)->add_channel(0, "/tick", "cdr");
    const auto channel = (*writer)->add_channel(0, recording.topic, "cdr", {{"unit", recording.unit}});
    for (std::size_t tick = 0; tick < recording.messages.size(); ++tick) {
      const std::uint64_t time = tick * 1'000'000 + recording.delay;
      EXPECT_TRUE((*writer)->write(channel, time, time, bytes(recording.messages[tick])).ok());
      EXPECT_TRUE((*writer)->write(ticks, tick * 1'000'000, tick * 1'000'000, bytes("tick")).ok());
    }
    if (!recording.costs.empty()) {
      const auto schema = (*writer)->add_schema(msg::ControlCost::type_name, "ros2msg", "uint64 allocations");
      const auto costs = (*writer)->add_channel(schema, "/Box/Hold/cost", "cdr");
      for (std::size_t tick = 0; tick < recording.costs.size(); ++tick)
        EXPECT_TRUE((*writer)->write(costs, tick * 1'000'000, tick * 1'000'000, bytes(recording.costs[tick])).ok());
    }
    EXPECT_TRUE((*writer)->add_metadata("rehearse.outcome", {{"complete", recording.outcome}}).ok());
    EXPECT_TRUE((*writer)->close().ok());
    auto read = content_of(file, before);
    EXPECT_TRUE(read.ok()) << to_string(read.errors());
    return *std::move(read);
  }

  /// The first difference from the usual recording; also checks that the hashes agree with it.
  std::string difference(const Recording& recording) const {
    const RecordingContent usual = content({}), other = content(recording);
    const std::string found = first_difference(usual, other, time_step);
    EXPECT_EQ(found.empty(), usual.hash() == other.hash());
    return found;
  }

  static Recording with_messages(std::vector<std::string> messages) {
    Recording recording;
    recording.messages = std::move(messages);
    return recording;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(Content, IsTheSameWhoeverMadeTheRecording) {
  Recording by_clang;
  by_clang.provenance = "clang";
  EXPECT_EQ(difference(by_clang), "");
}

TEST_F(Content, DiffersWhereAMessageDoes) {
  EXPECT_EQ(difference(with_messages({"zero", "0ne", "2wo"})), "tick 1 (0.001 s), /Box/joints");
  EXPECT_EQ(difference(with_messages({"zero", "one"})), "tick 2 (0.002 s), /tick");
  EXPECT_EQ(difference(with_messages({"zero", "one", "two", "three"})), "tick 3 (0.003 s), /tick");
}

TEST_F(Content, DiffersWhereAMessageComesLater) {
  Recording late;
  late.delay = 1;
  EXPECT_EQ(difference(late), "tick 0 (0 s), /Box/joints");
}

TEST_F(Content, DiffersByChannelsAttachmentsAndOutcome) {
  Recording other;
  other.topic = "/Ball/joints";
  EXPECT_EQ(difference(other), "channel /Box/joints isn't there");
  other = {};
  other.unit = "deg";
  EXPECT_EQ(difference(other), "channel /Box/joints is defined otherwise");
  other = {};
  other.note = "another scenario";
  EXPECT_EQ(difference(other), "attachment scenario.yaml differs");
  other = {};
  other.outcome = "false";
  EXPECT_THAT(difference(other), HasSubstr("the outcome"));
}

TEST_F(Content, HasTheCostsBesideTheRest) {
  Recording counted, other;
  counted.costs = {"0", "3", "0"};
  other.costs = {"0", "3", "1"};
  EXPECT_EQ(difference(counted), "") << "counting changes no other message";
  const auto first = [this](const Recording& a, const Recording& b) {
    return first_difference(content(a).costs, content(b).costs, time_step);
  };
  EXPECT_EQ(first(counted, counted), "");
  EXPECT_EQ(first(counted, other), "tick 2 (0.002 s), /Box/Hold/cost");
  EXPECT_EQ(first(counted, {}), "channel /Box/Hold/cost isn't there");
  EXPECT_EQ(first({}, counted), "channel /Box/Hold/cost is new");
}

TEST_F(Content, OfAFirstPartIsThatOfAShorterRun) {
  Recording shorter = with_messages({"zero", "one", "closed here"});
  shorter.outcome = "2 ticks";
  const std::uint64_t second_tick = 2'000'000;  // [ns]
  EXPECT_EQ(first_difference(content({}, second_tick), content(shorter, second_tick), time_step), "");
  EXPECT_NE(first_difference(content({}), content(shorter), time_step), "");
}

TEST_F(Content, OfADamagedRecordingIsNotRead) {
  content({});
  const fs::path file = folder_ / "recording.mcap";
  fs::resize_file(file, fs::file_size(file) - 40);
  EXPECT_FALSE(content_of(file).ok());
  EXPECT_FALSE(content_of(folder_ / "none.mcap").ok());
}

TEST_F(Content, OfARunThatWasMovedByALastBitDiffersFromTheStart) {
  const std::string scenario = FIXTURES_DIR "/scenarios/drop_box.yaml";
  const auto recorded = [&](std::vector<std::string> options) {
    std::vector<std::string> command{PROBE, "record", folder_.path().string(), "0.1"};
    command.insert(command.end(), options.begin(), options.end());
    command.push_back(scenario);
    const auto done = run(command, {}, folder_ / "log.txt");
    EXPECT_TRUE(done.ok()) << to_string(done.errors());
    return *content_of(folder_ / "drop_box.mcap");
  };
  const RecordingContent plain = recorded({});
  EXPECT_EQ(first_difference(plain, recorded({}), time_step), "");
  EXPECT_THAT(first_difference(plain, recorded({"--nudge"}), time_step), HasSubstr("tick 0 (0 s), /Box"));
}

TEST_F(Content, IsNotThereIfTheProgramFails) {
  const auto failed = run({"sh", "-c", "echo it went wrong; exit 3"}, {}, folder_ / "log.txt");
  ASSERT_FALSE(failed.ok());
  EXPECT_THAT(to_string(failed.errors()), HasSubstr("ended with status 3: it went wrong"));
  EXPECT_THAT(to_string(run({"no_such_program"}, {}, folder_ / "log.txt").errors()), HasSubstr("can't be started"));
}

TEST_F(Content, ComesFromTheSurroundingsThatWereAskedFor) {
  setenv("KEPT", "1", 1);
  Surroundings surroundings;
  surroundings.folder = "/usr";
  surroundings.variables = {{"ADDED", "2"}, {"KEPT", std::nullopt}};
  EXPECT_TRUE(
      run({"sh", "-c", R"(test "$ADDED$KEPT$PWD" = 2/usr && test -n "$PATH")"}, surroundings, folder_ / "log.txt")
          .ok());
  surroundings.variables.erase("KEPT");
  surroundings.bare = true;
  EXPECT_TRUE(run({"sh", "-c", R"(test "$ADDED$KEPT$PWD" = 2/usr)"}, surroundings, folder_ / "log.txt").ok());
}

TEST(Matrix, RefusesARowAndABuildThatAreNone) {
  const auto status = [](const std::string& arguments) {
    return WEXITSTATUS(std::system((MATRIX " " + arguments + " > /dev/null 2>&1").c_str()));
  };
  EXPECT_EQ(status("--row 'no such row'"), 2);
  EXPECT_EQ(status("--build other=/usr"), 2);
  EXPECT_EQ(status("no_such_scenario"), 2);
  EXPECT_EQ(status("--first 0"), 2);
  EXPECT_EQ(status("--list"), 0);
}

#ifdef MATRIX_ROWS  // not under sanitizers
TEST(Matrix, HasATestForEveryRow) {
  std::ifstream stream(MATRIX_ROWS);
  std::vector<std::string> tested, listed;
  for (std::string name; std::getline(stream, name);) tested.push_back(name);
  for (const Row& row : rows({})) listed.push_back(row.name);
  EXPECT_THAT(tested, ::testing::UnorderedElementsAreArray(listed));
}
#endif

}  // namespace
}  // namespace rehearse::matrix
