// Files that controllers read: recorded by their content, and named if they explain a difference.
#include <rehearse/check.h>
#include <rehearse/session.h>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class OpenedFiles : public RunTest {
 protected:
  std::string reader() const { return rig_with("file " + path("gain.txt").string()); }
  ReplayReport replayed() const {
    const auto report = replay_run();
    EXPECT_TRUE(report.ok()) << to_string(report.errors());
    return report ? *report : ReplayReport();
  }
};

TEST_F(OpenedFiles, StandInTheRecordingWithTheirContent) {
  write("gain.txt", "1.5\n");
  const Trace trace = record_run(reader());
  const mcap::StringMap* files = trace.find_metadata("rehearse.files");
  ASSERT_NE(files, nullptr);
  ASSERT_EQ(files->size(), 1u);
  EXPECT_EQ(files->begin()->first, "Rig/C: gain.txt");
  EXPECT_THAT(files->begin()->second, ::testing::MatchesRegex("4 bytes, [0-9a-f]+"));
  EXPECT_THAT(replayed().changed_files, IsEmpty());
}

TEST_F(OpenedFiles, NoneLeaveNoRecord) {
  EXPECT_EQ(record_run(rig_with("push 1")).find_metadata("rehearse.files"), nullptr);
}

TEST_F(OpenedFiles, ThatHaveChangedAreNamedByAReplay) {
  write("gain.txt", "1.5\n");
  record_run(reader());
  write("gain.txt", "1.6\n");
  const ReplayReport report = replayed();
  EXPECT_FALSE(report.equal());
  EXPECT_THAT(report.changed_files, ElementsAre("Rig/C: gain.txt has changed since the recording"));
}

TEST_F(OpenedFiles, ThatHaveChangedAreNamedByACheckWhichAccusesNobodyOfChance) {
  write("gain.txt", "1.5\n");
  record_run(reader(), "golden.mcap");
  write("gain.txt", "1.6\n");
  const auto report = check_scenario(load(reader()), path("golden.mcap"), path("actual.mcap"), {}, {record, run_plant});
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->controller, LevelState::differs);
  EXPECT_THAT(report->verdict.text(),
              HasSubstr("Rig/C: gain.txt has changed since the recording: the controller is the recorded one"));
  EXPECT_THAT(report->verdict.text(), Not(HasSubstr("chance")));
}

TEST_F(OpenedFiles, ThatAreMissingAreNamedByTheRefusal) {
  record_run(reader());
  EXPECT_EQ(summary_.ticks, 0);
  ASSERT_TRUE(summary_.failure);
  EXPECT_EQ(summary_.failure->message,
            "controller 'Rig/C' refuses to take part: initialize() returned false; gain.txt wasn't there");
  EXPECT_EQ(summary_.failure->hint, "if it belongs to shareDirPath(): REHEARSE_CHOREONOID_SHARE names that folder");
}

/// What is below shareDirPath() is in the recording, so a replay elsewhere finds it.
TEST_F(OpenedFiles, OfTheShareAreFoundByAReplayWithoutThem) {
  std::filesystem::create_directories(path("share/motion"));
  write("share/motion/gain.txt", "1.5\n");
  setenv("REHEARSE_CHOREONOID_SHARE", path("share").c_str(), 1);
  const Trace trace = record_run(rig_with("shared_file motion/gain.txt"));
  ASSERT_FALSE(summary_.failure) << summary_.failure->message;
  const auto* copy = trace.find_attachment("inputs/share/motion/gain.txt");
  ASSERT_NE(copy, nullptr);
  EXPECT_EQ(copy->text(), "1.5\n");
  std::filesystem::remove_all(path("share"));
  setenv("REHEARSE_CHOREONOID_SHARE", path("elsewhere").c_str(), 1);
  const ReplayReport report = replayed();
  EXPECT_TRUE(report.equal());
  EXPECT_FALSE(report.failure);
  EXPECT_THAT(report.changed_files, IsEmpty());
  EXPECT_EQ(getenv("REHEARSE_CHOREONOID_SHARE"), path("elsewhere").string());
  unsetenv("REHEARSE_CHOREONOID_SHARE");
}

/// A file that is there is read as it is.
TEST_F(OpenedFiles, OfTheShareThatHaveChangedAreNamedByAReplay) {
  std::filesystem::create_directories(path("share"));
  write("share/gain.txt", "1.5\n");
  setenv("REHEARSE_CHOREONOID_SHARE", path("share").c_str(), 1);
  record_run(rig_with("shared_file gain.txt"));
  write("share/gain.txt", "1.6\n");
  const ReplayReport report = replayed();
  EXPECT_FALSE(report.equal());
  EXPECT_THAT(report.changed_files, ElementsAre("Rig/C: gain.txt has changed since the recording"));
  unsetenv("REHEARSE_CHOREONOID_SHARE");
}

TEST_F(OpenedFiles, ThatAreMotionsAreFoundByAReplayWithoutThem) {
  write("walk.seq", "effort: 1.5\n");
  const Trace trace = record_run(rig_with("yaml " + path("walk.seq").string()));
  ASSERT_FALSE(summary_.failure) << summary_.failure->message;
  ASSERT_NE(trace.find_attachment("inputs/walk.seq"), nullptr);
  std::filesystem::remove(path("walk.seq"));
  const ReplayReport report = replayed();
  EXPECT_TRUE(report.equal());
  EXPECT_FALSE(report.failure);
}

TEST_F(OpenedFiles, ThatAreLargeAreRecordedByTheirDigestOnly) {
  write("walk.seq", "effort: 1.5\n# " + std::string(1 << 20, 'x') + "\n");
  const Trace trace = record_run(rig_with("yaml " + path("walk.seq").string()));
  EXPECT_EQ(trace.find_attachment("inputs/walk.seq"), nullptr);
  EXPECT_NE(trace.find_metadata("rehearse.files"), nullptr);
}

TEST_F(OpenedFiles, ThatAreMissingNowAreNamedByAReplay) {
  write("gain.txt", "1.5\n");
  record_run(reader());
  std::filesystem::remove(path("gain.txt"));
  const ReplayReport report = replayed();
  ASSERT_TRUE(report.failure);
  EXPECT_THAT(report.failure->message, HasSubstr("gain.txt wasn't there"));
  EXPECT_THAT(report.changed_files, ElementsAre("Rig/C: gain.txt wasn't found"));
}

}  // namespace
}  // namespace rehearse
