// Recordings that can't be written any further: the error names the file and the reason, the written part stays
// readable, and other files don't change.
#include "recording_process.h"

#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <sched.h>
#include <csignal>
#include <fstream>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int bad_input = 2;  // the command's exit status

class FullDisk : public ::testing::Test {
 protected:
  FullDisk() : counter_(folder() / "calls") {
    std::ofstream(folder() / "pendulum.yaml")
        << "rehearse: 1\nduration: 3\nbodies:\n  - name: Pendulum\n    model: "
        << (fs::path(FIXTURES_DIR) / "models/pendulum.urdf").string()
        << "\n    joints: {hinge: 20 deg}\n    controllers:\n      - name: Ticking\n        library: " << TICKING
        << "\n        options: \"" << (folder() / "calls").string() << " 0\"\n";
  }

  const fs::path& folder() const { return scratch_.path(); }
  std::string log() const { return read_file(folder() / "log"); }

  int record(const fs::path& trace, const std::function<void()>& prepare = {}) const {
    return wait_for(start({REHEARSE_COMMAND, "record", (folder() / "pendulum.yaml").string(), "-o", trace.string()},
                          folder() / "log", prepare));
  }

  /// The remaining file of a recording that couldn't continue.
  void examine_rest(const fs::path& trace) const { save_what_is_left(trace, folder() / "saved.mcap"); }

  TemporaryFolder scratch_;
  CallCounter counter_;
};

void allow_files_of(rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);  // write() fails then
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
}

TEST_F(FullDisk, OfAnySizeEndsARecordingWithTheReason) {
  const fs::path trace = folder() / "run.mcap";
  ASSERT_EQ(record(trace), 0) << log();
  const std::uintmax_t whole = fs::file_size(trace);
  constexpr int steps = 12;
  for (int step = 0; step < steps; ++step) {
    fs::remove(trace);
    const auto size = static_cast<rlim_t>(whole) * static_cast<rlim_t>(step) / steps;
    EXPECT_EQ(record(trace, [=] { allow_files_of(size); }), bad_input) << size;
    const std::string told = trace.string() + ": error: can't write the trace: File too large";
    EXPECT_THAT(log(), HasSubstr(size == 0 ? "" : told));  // without any space the log is empty, too
    EXPECT_LE(fs::file_size(trace), size);
    examine_rest(trace);
    ASSERT_FALSE(HasFailure()) << size << " of " << whole << " bytes";
  }
}

TEST_F(FullDisk, ThatIsADeviceWithoutRoomSaysSo) {
  EXPECT_EQ(record("/dev/full"), bad_input);
  EXPECT_THAT(log(),
              HasSubstr("/dev/full: error: can't write the trace: No space left on device (make room on the disk "
                        "/dev, or name another file with -o)"));
  EXPECT_THAT(log(), HasSubstr("error: the recording ends: noticed at tick "));
  EXPECT_THAT(log(), Not(HasSubstr("under Pendulum/Ticking"))) << "no controller fills a disk by being called";
}

constexpr int no_disk = 77;

/// Runs in a separate process with a private disk.
int record_on_disk(const fs::path& disk, const std::string& size, const std::function<int(const fs::path&)>& run) {
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("none", disk.c_str(), "tmpfs", 0, size.c_str()) != 0)
    return no_disk;
  std::ofstream(disk / "golden.mcap") << "a golden";
  const int status = run(disk / "run.mcap");
  return read_file(disk / "golden.mcap") == "a golden" ? status : 1;
}

TEST_F(FullDisk, OfARealKindLeavesWhatWasThereBefore) {
  fs::create_directories(folder() / "disk");
  for (const int kilobytes : {8, 40, 100}) {
    const std::string size = "size=" + std::to_string(kilobytes) + "k";
    const pid_t child = fork();
    if (child == 0) {
      _exit(record_on_disk(folder() / "disk", size, [this](const fs::path& trace) {
        const int status = record(trace);
        examine_rest(trace);
        return HasFailure() ? 1 : status;
      }));
    }
    const int status = wait_for(child);
    if (status == no_disk) GTEST_SKIP() << "only root may mount a disk";
    EXPECT_EQ(status, bad_input) << kilobytes << " kB: " << log();
    EXPECT_THAT(log(), HasSubstr("can't write the trace: No space left on device (make room on the disk " +
                                 fs::canonical(folder() / "disk").string() + ", or name"));
  }
}

/// recover() and its like write whole files or none.
TEST_F(FullDisk, LeavesNoHalfFileBehindOfARecovery) {
  const fs::path trace = folder() / "run.mcap";
  ASSERT_EQ(record(trace), 0) << log();
  fs::resize_file(trace, fs::file_size(trace) - 100);
  const fs::path saved = folder() / "saved.mcap";
  std::ofstream(saved) << "\x89MCAP0\r\nold";
  const std::string before = read_file(saved);
  for (const rlim_t size : {0, 1000, 20000}) {
    EXPECT_EQ(wait_for(start({REHEARSE_COMMAND, "recover", trace.string(), "-o", saved.string()}, folder() / "log",
                             [=] { allow_files_of(size); })),
              bad_input);
    EXPECT_THAT(log(), HasSubstr(size == 0 ? "" : "error: can't write the trace: File too large"));
    EXPECT_TRUE(read_file(saved) == before);
    EXPECT_FALSE(fs::exists(saved.string() + ".part"));
  }
}

}  // namespace
}  // namespace rehearse::test
