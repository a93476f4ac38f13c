// Goldens and runs that are damaged, of another format or incomplete, and full disks: existing files are not changed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sched.h>
#include <csignal>
#include <cstdlib>

#include "golden_folder.h"

namespace rehearse {
namespace {

using ::testing::AllOf;
using ::testing::ExitedWithCode;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::read_file;
using testing::SmallTrace;
using testing::write;
namespace fs = std::filesystem;

class GoldenDamage : public testing::GoldenFolder {
 protected:
  void flip_bit(const fs::path& file) const {
    std::string bytes = read_file(file);
    bytes[bytes.size() / 2] ^= 1;
    write(file, bytes);
  }
  std::string problem() const {
    const auto listed = list_goldens(store_, {});
    return listed && listed->size() == 1 ? listed->at(0).problem : "no golden, or several";
  }
  std::string settled() { return settle(SmallTrace()).message; }
  std::string accepted() {
    const auto done = store_.accept_pending(name_);
    return done ? "" : to_string(done.errors());
  }
};

TEST_F(GoldenDamage, ThatIsCutShortIsListedCheckedAndReplaced) {
  place_golden(SmallTrace());
  fs::resize_file(store_.trace_file(name_), fs::file_size(store_.trace_file(name_)) / 2);
  EXPECT_THAT(problem(), HasSubstr("truncated at byte"));
  EXPECT_THAT(settled(), HasSubstr("the golden can't be used: "));
  EXPECT_EQ(accepted(), "");
  EXPECT_TRUE(is_run(SmallTrace()));
  EXPECT_THAT(digest(), HasSubstr("replaced: the golden before it can't be read: truncated at byte"));
}

TEST_F(GoldenDamage, OfOneBitIsFoundAndKeepsTheHistoryThatCanBeRead) {
  place_golden(SmallTrace());
  flip_bit(store_.trace_file(name_));
  EXPECT_THAT(problem(), HasSubstr("damaged: "));
  EXPECT_THAT(settled(), HasSubstr("the golden can't be used: "));
  EXPECT_EQ(accepted(), "");
  EXPECT_THAT(digest(), AllOf(HasSubstr("\naccepted 2025-11-20, replaced: the golden before it can't be read"),
                              HasSubstr("\naccepted before\n  1. 2025-11-20 first\n")));
}

TEST_F(GoldenDamage, NoneIsAGoldenOfANewerFormatButItIsNotUsed) {
  SmallTrace newer;
  newer.provenance["trace_version"] = "2";
  newer.write(store_.trace_file(name_));
  write(store_.digest_file(name_), *digest_of(*Trace::load(store_.trace_file(name_))));
  const std::string before = read_file(store_.trace_file(name_));
  EXPECT_EQ(problem(), "it is of trace version 2, and this program reads version 1");
  EXPECT_THAT(settled(), HasSubstr("the golden can't be used: " + store_.trace_file(name_).string() +
                                   ": error: it is of trace version 2"));
  EXPECT_THAT(settled(), HasSubstr("install the version of Rehearse that wrote it: 0.1.0"));
  EXPECT_THAT(settled(), Not(HasSubstr("golden accept")));
  EXPECT_THAT(store_.pending(), IsEmpty());
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == before);
}

TEST_F(GoldenDamage, ARunOfANewerFormatBecomesNoGolden) {
  SmallTrace newer;
  newer.provenance["trace_version"] = "2";
  place_pending(newer);
  EXPECT_THAT(accepted(), HasSubstr("it is of trace version 2"));
  EXPECT_FALSE(store_.has(name_));
}

TEST_F(GoldenDamage, OfAnotherRobotSaysWhichChannelsAreMissing) {
  SmallTrace other;
  other.joint_names = {"ELBOW", "WRIST"};
  other.left_out = {"/Robot/Laser/scan"};
  other.scenario = "rehearse: 1\n# another robot\n";
  place_golden(other);
  const std::string message = settled();
  EXPECT_THAT(message, HasSubstr("/Robot/Laser/scan"));
  EXPECT_THAT(message, HasSubstr("scenario.yaml has changed since"));
}

TEST_F(GoldenDamage, WithoutAChannelSaysWhich) {
  SmallTrace old;
  old.left_out = {"/Robot/Foot/wrench"};
  place_golden(old);
  EXPECT_THAT(settled(), HasSubstr("/Robot/Foot/wrench: the channel is not in the golden"));
}

TEST_F(GoldenDamage, ARunThatIsDamagedIsNotAcceptedAndWaitsOn) {
  place_golden(SmallTrace());
  const std::string before = read_file(store_.trace_file(name_));
  place_pending(changed());
  flip_bit(store_.pending_file(name_));
  EXPECT_THAT(accepted(), HasSubstr("damaged: "));
  fs::resize_file(store_.pending_file(name_), 100);
  EXPECT_THAT(accepted(), HasSubstr("truncated at byte 100"));
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == before);
  EXPECT_TRUE(fs::exists(store_.pending_file(name_)));
  EXPECT_TRUE(store_.reject(name_));
}

TEST_F(GoldenDamage, ARunThatVanishedIsSaidToBeGone) {
  place_golden(SmallTrace());
  EXPECT_FALSE(settle(changed()).passed);
  fs::remove(store_.pending_file(name_));
  EXPECT_THAT(accepted(), HasSubstr("nothing waits to be accepted as '" + name_ + "'"));
}

TEST_F(GoldenDamage, WhatAnInterruptedAcceptanceLeftIsOverwritten) {
  place_golden(SmallTrace());
  place_pending(changed());
  write(store_.trace_file(name_).string() + ".new", "half a recor");
  write(store_.digest_file(name_).string() + ".new", "half a dig");
  EXPECT_EQ(accepted(), "");
  EXPECT_TRUE(store_.check_digest(name_));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "golden"), fs::directory_iterator()), 2);
}

TEST_F(GoldenDamage, AnAcceptanceInterruptedBetweenItsTwoFilesIsFinishedByAcceptingAgain) {
  place_golden(SmallTrace());
  const std::string old_digest = digest();
  place_pending(changed());
  fs::copy_file(store_.pending_file(name_), folder_ / "run.mcap");
  EXPECT_EQ(accepted(), "");
  write(store_.digest_file(name_).string() + ".new", digest());
  write(store_.digest_file(name_), old_digest);  // the recording is new, the digest isn't
  ASSERT_FALSE(store_.check_digest(name_));
  EXPECT_EQ(store_.check_digest(name_).errors()[0].hint, "an acceptance was interrupted: accept the run again");
  const std::string trace = read_file(store_.trace_file(name_));
  fs::copy_file(folder_ / "run.mcap", store_.pending_file(name_));
  EXPECT_EQ(accepted(), "");
  EXPECT_TRUE(store_.check_digest(name_));
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == trace);
}

/// If either of the two new files can't be written, both old files stay unchanged.
TEST_F(GoldenDamage, OldFilesStayIfEitherNewOneCanNotBeWritten) {
  place_golden(SmallTrace());
  const std::string trace = read_file(store_.trace_file(name_)), text = digest();
  for (const fs::path& file : {store_.trace_file(name_), store_.digest_file(name_)}) {
    place_pending(changed());
    const fs::path draft = file.string() + ".new";
    fs::create_directories(draft / "in the way");
    EXPECT_THAT(accepted(), HasSubstr(draft.string() + ": error: can't be written")) << draft;
    fs::remove_all(draft);
    EXPECT_TRUE(read_file(store_.trace_file(name_)) == trace);
    EXPECT_TRUE(digest() == text);
    EXPECT_TRUE(fs::exists(store_.pending_file(name_)));
  }
}

TEST_F(GoldenDamage, OldFilesStayIfAFileMayNotGrow) {
  place_golden(SmallTrace());
  place_pending(changed());
  const std::string trace = read_file(store_.trace_file(name_)), text = digest();
  rlimit unlimited{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, unlimited.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto done = store_.accept_pending(name_);
  setrlimit(RLIMIT_FSIZE, &unlimited);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(done);
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == trace);
  EXPECT_TRUE(digest() == text);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "golden"), fs::directory_iterator()), 2);
}

constexpr int no_disk = 77;

/// Accepts on a disk of `kilobytes`, in a separate process with a private disk. Ends with 0 if the golden was replaced,
/// 1 if it wasn't and is complete, 2 if it is lost.
int accept_on_disk(const fs::path& disk, const fs::path& old_run, const fs::path& run, int kilobytes) {
  const std::string size = "size=" + std::to_string(kilobytes) + "k";
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("none", disk.c_str(), "tmpfs", 0, size.c_str()) != 0)
    return no_disk;
  GoldenStore store(disk, disk.string() + ".pending");
  if (!store.accept("Disk.Test", old_run)) return 3;
  const std::string before = read_file(store.trace_file("Disk.Test"));
  const bool done = store.accept("Disk.Test", run).ok();
  if (!store.check_digest("Disk.Test")) return 2;
  const bool left = read_file(store.trace_file("Disk.Test")) == before;
  return done && !left ? 0 : !done && left ? 1 : 2;
}

TEST_F(GoldenDamage, SurvivesEveryDiskThatIsTooSmallForTheNewOne) {
  SmallTrace().write(folder_ / "old.mcap");
  SmallTrace run = changed();  // its digest is far larger than what the old recording would leave free
  for (std::int64_t i = 0; i < 500; ++i) run.events.push_back({{0, 2000000}, 2, "note", "Robot/Pd", "the same again"});
  run.write(folder_ / "run.mcap");
  fs::create_directories(folder_ / "disk");
  constexpr int page = 4;  // [kB], in which such a disk is filled
  int refused = 0;
  for (int kilobytes = page, last = -1; last != 0; kilobytes += page) {
    ASSERT_LT(kilobytes, 1000);
    const pid_t child = fork();
    if (child == 0) _exit(accept_on_disk(folder_ / "disk", folder_ / "old.mcap", folder_ / "run.mcap", kilobytes));
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    last = WEXITSTATUS(status);
    if (last == no_disk) GTEST_SKIP() << "only root may mount a disk";
    ASSERT_TRUE(WIFEXITED(status));
    ASSERT_NE(last, 2) << "the golden was lost on a disk of " << kilobytes << " kB";
    refused += last == 1 ? 1 : 0;
  }
  EXPECT_GE(refused, 2);  // some for the recording, some for the digest
}

TEST_F(GoldenDamage, InAFolderThatMayNotBeWrittenSaysSo) {
  place_golden(SmallTrace());
  place_pending(changed());
  const std::string before = read_file(store_.trace_file(name_));
  fs::permissions(folder_ / "golden",
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  const auto accept_as_nobody = [this] {
    constexpr uid_t nobody = 65534;
    if (geteuid() == 0 && setuid(nobody) != 0) _exit(0);
    std::fprintf(stderr, "%s", accepted().c_str());
    _exit(1);
  };
  EXPECT_EXIT(accept_as_nobody(), ExitedWithCode(1),
              "can't be written: Permission denied \\(make the folder .*golden writable, or name another folder with "
              "REHEARSE_GOLDEN_DIR\\)");
  fs::permissions(folder_ / "golden", fs::perms::owner_all);
  EXPECT_TRUE(read_file(store_.trace_file(name_)) == before);
}

}  // namespace
}  // namespace rehearse
