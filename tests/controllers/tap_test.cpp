// The tap of a robot's loop: what it refuses, and what it costs.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <linux/seccomp.h>
#include <rehearse/tap.h>
#include <rehearse/tap_ring.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <rehearse/tap.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

static std::size_t allocations = 0;                                // of the process
#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__  // which have a malloc() of their own
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A name that no other test uses. Its ring is removed before and after.
class TapTest : public testing::Test {
 protected:
  TapTest() : name_("test-" + std::to_string(getpid())) { clear(); }
  ~TapTest() override { clear(); }

  fs::path ring() const { return "/dev/shm/rehearse-tap-" + std::to_string(geteuid()) + "-" + name_; }
  void clear() const {
    fs::remove(ring());
    fs::remove(ring().string() + ".before");
  }
  rehearse_tap* open(int replace = 0) const {
    rehearse_tap_options options{};
    options.megabytes = 1;
    options.replace = replace;
    return rehearse_tap_open(name_.c_str(), &options);
  }
  const char* name() const { return name_.c_str(); }
  static std::string error() { return rehearse_tap_error(); }

 private:
  std::string name_;
};

/// Runs a function in a process of its own. Returns its exit status.
template <class Function>
int in_a_process(Function function) {
  const pid_t child = fork();
  if (child == 0) _exit(function());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(TapTest, IsAFileOfItsUserAlone) {
  rehearse_tap* tap = open();
  ASSERT_NE(tap, nullptr) << error();
  struct stat found {};
  ASSERT_EQ(stat(ring().c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0600u);
  EXPECT_EQ(static_cast<std::size_t>(found.st_size), tap_words_place + (std::size_t{1} << 20));
  rehearse_tap_close(tap);
}

TEST_F(TapTest, RefusesNamesAndSeriesInWords) {
  EXPECT_EQ(rehearse_tap_open("a/b", nullptr), nullptr);
  EXPECT_THAT(error(), HasSubstr("letters, digits"));
  EXPECT_EQ(rehearse_tap_open("", nullptr), nullptr);
  EXPECT_EQ(rehearse_tap_open(nullptr, nullptr), nullptr);
  rehearse_tap_options options{};
  options.model = "/nowhere.urdf";
  EXPECT_EQ(rehearse_tap_open(name(), &options), nullptr);
  EXPECT_THAT(error(), HasSubstr("/nowhere.urdf"));
  EXPECT_FALSE(fs::exists(ring()));

  rehearse_tap* tap = open();
  const char* names[] = {"KNEE", "HIP", "KNEE"};
  EXPECT_EQ(rehearse_tap_joints(tap, "Walker", names, 3, REHEARSE_TAP_Q), -1);
  EXPECT_THAT(error(), HasSubstr("'KNEE' is named twice"));
  EXPECT_EQ(rehearse_tap_joints(tap, "Walker", names, 2, 8), -1);
  EXPECT_EQ(rehearse_tap_joints(tap, "Walker", names, 0, REHEARSE_TAP_Q), -1);
  EXPECT_EQ(rehearse_tap_joints(tap, "Walker", names, 2, REHEARSE_TAP_Q | REHEARSE_TAP_DQ), 0);
  EXPECT_EQ(rehearse_tap_joints(tap, "Walker", names, 1, REHEARSE_TAP_DQ), -1);
  EXPECT_THAT(error(), HasSubstr("'KNEE' is in an earlier series"));
  EXPECT_EQ(rehearse_tap_joints(tap, "Walker", names, 2, REHEARSE_TAP_U), 1);
  EXPECT_EQ(rehearse_tap_imu(tap, "Other", "Imu"), -1);
  EXPECT_THAT(error(), HasSubstr("are of one body, 'Walker'"));
  EXPECT_EQ(rehearse_tap_imu(tap, "Walker", "Imu"), 2);
  EXPECT_EQ(rehearse_tap_device(tap, "Walker", "Imu", 3), -1);
  EXPECT_EQ(rehearse_tap_device(tap, "Walker", "two\nlines", 3), -1);
  EXPECT_EQ(rehearse_tap_parameter(tap, "gain", "two\nlines"), -1);
  EXPECT_EQ(rehearse_tap_parameter(tap, "gain", "60"), 0);
  rehearse_tap_begin(tap, 0);
  rehearse_tap_end(tap);
  EXPECT_EQ(rehearse_tap_device(tap, "Walker", "Foot", 6), -1);
  EXPECT_THAT(error(), HasSubstr("before the first tick"));
  rehearse_tap_close(tap);
}

TEST_F(TapTest, RefusesASecondWriterAndWhatIsLeftOver) {
  rehearse_tap* tap = open();
  ASSERT_NE(tap, nullptr) << error();
  EXPECT_EQ(open(), nullptr);
  EXPECT_THAT(error(), HasSubstr("this process has a tap"));
  EXPECT_EQ(in_a_process([&] { return open() == nullptr && error().find("in use by process") < 99 ? 0 : 1; }), 0);
  rehearse_tap_close(tap);

  EXPECT_EQ(in_a_process([&] {  // it has a tick, and ends without closing its tap
              rehearse_tap* other = open(1);
              rehearse_tap_begin(other, 0);
              rehearse_tap_end(other);
              return other ? 0 : 1;
            }),
            0);
  EXPECT_EQ(open(), nullptr);
  EXPECT_THAT(error(), HasSubstr("which has ended, left a ring"));
  EXPECT_THAT(error(), HasSubstr("--recover"));
  tap = open(1);
  EXPECT_NE(tap, nullptr) << error();
  EXPECT_TRUE(fs::exists(ring().string() + ".before"));
  rehearse_tap_close(tap);
}

/// Leaves a ring with a tick, as a loop that dies does.
int leave_a_ring(rehearse_tap* tap) {
  rehearse_tap_begin(tap, 0);
  rehearse_tap_end(tap);
  return tap ? 0 : 1;
}

/// A word of the head of a ring's file.
void put(const fs::path& ring, std::size_t place, std::uint64_t word) {
  std::fstream file(ring, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(place));
  file.write(reinterpret_cast<const char*>(&word), sizeof word);
}

TEST_F(TapTest, RemovesARingOfWhichNothingIsLost) {
  ASSERT_EQ(in_a_process([&] { return leave_a_ring(open()); }), 0);
  put(ring(), offsetof(tap_ring_head, saved), ~std::uint64_t{0});  // all of it is in a file
  rehearse_tap_close(open());

  fs::remove(ring());
  std::ofstream(ring()) << std::string(1000, '\0');  // a loop was killed while it made it
  fs::permissions(ring(), fs::perms::owner_read | fs::perms::owner_write);
  rehearse_tap* tap = open();
  EXPECT_NE(tap, nullptr) << error();
  rehearse_tap_close(tap);

  fs::remove(ring());
  ASSERT_EQ(in_a_process([&] { return leave_a_ring(open()); }), 0);
  int ready[2], end[2];  // a recorder has the ring open
  ASSERT_EQ(pipe(ready) + pipe(end), 0);
  const pid_t recorder = fork();
  if (recorder == 0) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_start = tap_lock_of_reader;
    lock.l_len = 1;
    const int file = ::open(ring().c_str(), O_RDWR);
    char byte = fcntl(file, F_SETLK, &lock) == 0 ? 1 : 0;
    if (write(ready[1], &byte, 1) == 1) read(end[0], &byte, 1);
    _exit(0);
  }
  char is_ready = 0;
  ASSERT_EQ(read(ready[0], &is_ready, 1), 1);
  EXPECT_EQ(is_ready, 1);
  tap = open();
  EXPECT_NE(tap, nullptr) << error();
  rehearse_tap_close(tap);
  ASSERT_EQ(write(end[1], &is_ready, 1), 1);
  waitpid(recorder, nullptr, 0);
  for (const int file : {ready[0], ready[1], end[0], end[1]}) close(file);
}

/// Processes that open a tap at the same time, beside a ring that is left over: one of them gets it.
TEST_F(TapTest, HasOneWriterWhoeverComesAtTheSameTime) {
  for (int round = 0; round < 30; ++round) {
    ASSERT_EQ(in_a_process([&] { return leave_a_ring(open()); }), 0);
    int ended[2];
    ASSERT_EQ(pipe(ended), 0);
    std::vector<pid_t> processes;
    for (int i = 0; i < 3; ++i) {
      processes.push_back(fork());
      if (processes.back() != 0) continue;
      close(ended[1]);
      rehearse_tap* const tap = open(1);
      char byte = 0;
      if (tap) (void)!read(ended[0], &byte, 1);  // until all have tried
      _exit(tap ? 1 : 0);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(round % 5));
    int opened = 0, waited = 0;
    // Those that failed have ended; the one that has the tap waits.
    for (; waited < 2; ++waited) {
      int status = 0;
      ASSERT_GT(waitpid(-1, &status, 0), 0);
      opened += WEXITSTATUS(status);
    }
    close(ended[1]);
    int status = 0;
    ASSERT_GT(waitpid(-1, &status, 0), 0);
    opened += WEXITSTATUS(status);
    close(ended[0]);
    EXPECT_EQ(opened, 1);
    clear();
  }
}

TEST_F(TapTest, StatesTheFactsOfItsMachineAndProgram) {
  rehearse_tap* tap = open();
  ASSERT_NE(tap, nullptr) << error();
  std::ifstream file(ring(), std::ios::binary);
  std::string text(tap_words_place, 0);
  file.read(text.data(), tap_words_place);
  text = text.c_str() + tap_definitions_place;
  EXPECT_THAT(text, HasSubstr("machine\tprogram\ttap_test\n"));
  EXPECT_THAT(text, HasSubstr("machine\tarchitecture\t"));
  EXPECT_THAT(text, testing::ContainsRegex("machine\tlibm_build_id\t[0-9a-f]{40}\n"));
  rehearse_tap_close(tap);
}

/// A recorder that is a script: it has the loop's name, and nothing else of the loop.
TEST_F(TapTest, StartsItsRecorderWithoutTheLoopsFiles) {
  const fs::path folder = fs::temp_directory_path() / name();
  fs::create_directories(folder);
  std::ofstream(folder / "rehearse") << "#!/bin/sh\n"
                                        "echo \"$@\" > "
                                     << (folder / "words").string()
                                     << "\n"
                                        "ls /proc/$$/fd > "
                                     << (folder / "files").string()
                                     << "\n"
                                        "echo done > "
                                     << (folder / "done").string() << "\n";
  fs::permissions(folder / "rehearse", fs::perms::owner_all);
  const std::string path = getenv("PATH");
  rehearse_tap_options options{};
  options.megabytes = 1;
  options.spawn = REHEARSE_TAP_BLACK_BOX;
  options.output = "/data/walker.mcap";
  setenv("PATH", "/nowhere", 1);
  EXPECT_EQ(rehearse_tap_open(name(), &options), nullptr);
  EXPECT_THAT(error(), HasSubstr("the recorder 'rehearse' can't be started"));
  EXPECT_FALSE(fs::exists(ring()));

  setenv("PATH", (folder.string() + ":" + path).c_str(), 1);
  const int inherited = ::open("/dev/null", O_RDONLY);  // as a serial port
  EXPECT_GT(inherited, 2);
  rehearse_tap* tap = rehearse_tap_open(name(), &options);
  setenv("PATH", path.c_str(), 1);
  ASSERT_NE(tap, nullptr) << error();
  for (int i = 0; i < 500 && !fs::exists(folder / "done"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::string words, number;
  std::getline(std::ifstream(folder / "words") >> std::ws, words);
  EXPECT_EQ(words, "tap " + std::string(name()) + " -o /data/walker.mcap --black-box");
  for (std::ifstream files(folder / "files"); files >> number;) EXPECT_NE(number, std::to_string(inherited));
  close(inherited);
  rehearse_tap_close(tap);
  fs::remove_all(folder);
}

TEST_F(TapTest, RefusesForeignFilesLinksAndOtherVersions) {
  std::ofstream(ring()) << "something else";
  fs::permissions(ring(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(open(), nullptr);
  EXPECT_THAT(error(), HasSubstr("is no ring of a tap"));
  fs::permissions(ring(), fs::perms::all);
  EXPECT_EQ(open(), nullptr);
  EXPECT_THAT(error(), HasSubstr("others may open it"));
  fs::remove(ring());
  fs::create_symlink("/dev/null", ring());
  EXPECT_EQ(open(), nullptr);
  EXPECT_THAT(error(), HasSubstr("is a link"));
  fs::remove(ring());
  rehearse_tap* tap = open();
  rehearse_tap_begin(tap, 0);
  rehearse_tap_end(tap);
  rehearse_tap_close(tap);
  std::fstream file(ring(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(offsetof(tap_ring_head, version));
  file.put(9);
  file.close();
  EXPECT_EQ(open(), nullptr);
  EXPECT_THAT(error(), HasSubstr("is of version 9"));
}

TEST_F(TapTest, DoesNothingWithoutATap) {
  EXPECT_EQ(rehearse_tap_joints(nullptr, nullptr, nullptr, 0, 0), -1);
  EXPECT_EQ(rehearse_tap_imu(nullptr, nullptr, nullptr), -1);
  EXPECT_EQ(rehearse_tap_device(nullptr, nullptr, nullptr, 0), -1);
  EXPECT_EQ(rehearse_tap_commands(nullptr, nullptr, nullptr, 0, 0), -1);
  EXPECT_EQ(rehearse_tap_parameter(nullptr, nullptr, nullptr), 0);
  rehearse_tap_begin(nullptr, 0);
  EXPECT_EQ(rehearse_tap_write(nullptr, 0, nullptr, 0), 0);
  EXPECT_EQ(rehearse_tap_absent(nullptr, 0), 0);
  EXPECT_EQ(rehearse_tap_variable(nullptr, nullptr, 0), 0);
  EXPECT_EQ(rehearse_tap_text(nullptr, nullptr), 0);
  EXPECT_EQ(rehearse_tap_image(nullptr, nullptr, nullptr), 0);
  rehearse_tap_mark(nullptr, nullptr);
  rehearse_tap_end(nullptr);
  EXPECT_EQ(rehearse_tap_dropped(nullptr), 0u);
  rehearse_tap_close(nullptr);
  rehearse::Tap none;
  EXPECT_FALSE(none.is_open());
  rehearse::Tap::Tick tick = none.tick(0);
  EXPECT_TRUE(tick.write(0, std::vector<double>{1.0}));
}

TEST_F(TapTest, RefusesWrongCallsOfATickAndGoesOn) {
  rehearse_tap* tap = open();
  const char* names[] = {"KNEE"};
  const int knee = rehearse_tap_joints(tap, "Walker", names, 1, REHEARSE_TAP_Q);
  const double q = 0.5;
  EXPECT_EQ(rehearse_tap_write(tap, knee, &q, 1), -1);  // no tick has begun
  rehearse_tap_begin(tap, 0);
  EXPECT_EQ(rehearse_tap_write(tap, knee, &q, 2), -1);
  EXPECT_EQ(rehearse_tap_write(tap, 7, &q, 1), -1);
  EXPECT_EQ(rehearse_tap_absent(tap, -1), -1);
  EXPECT_EQ(rehearse_tap_variable(tap, std::string(201, 'x').c_str(), 1.0), -1);
  EXPECT_EQ(rehearse_tap_text(tap, ""), -1);
  EXPECT_EQ(rehearse_tap_image(tap, "Camera", ""), -1);
  EXPECT_EQ(rehearse_tap_image(tap, nullptr, "1.png"), -1);
  EXPECT_EQ(rehearse_tap_write(tap, knee, &q, 1), 0);
  int texts = 0;
  while (texts < 1000 && rehearse_tap_text(tap, std::string(4000, 'x').c_str()) == 0) ++texts;
  EXPECT_EQ(texts, 32);  // 128 KiB
  rehearse_tap_end(tap);
  rehearse_tap_begin(tap, 1);
  rehearse_tap_begin(tap, 2);
  rehearse_tap_end(tap);
  EXPECT_EQ(rehearse_tap_dropped(tap), 1u);
  rehearse_tap_close(tap);
}

/// A loop with 12 joints and an IMU. No process reads its ring, which is soon full.
class Loop {
 public:
  explicit Loop(rehearse_tap* tap) : tap_(tap) {
    std::vector<std::string> joints;
    std::vector<const char*> names;
    for (int i = 0; i < 12; ++i) joints.push_back("J" + std::to_string(i));
    for (const std::string& joint : joints) names.push_back(joint.c_str());
    q_ = rehearse_tap_joints(tap, "Walker", names.data(), 12, REHEARSE_TAP_Q | REHEARSE_TAP_DQ);
    imu_ = rehearse_tap_imu(tap, "Walker", "Imu");
    u_ = rehearse_tap_commands(tap, "Walker", names.data(), 12, REHEARSE_TAP_U);
  }
  void make_ticks(int count) {
    for (int i = 0; i < count; ++i) {
      rehearse_tap_begin(tap_, i);
      rehearse_tap_write(tap_, q_, numbers_.data(), 24);
      rehearse_tap_write(tap_, imu_, numbers_.data(), 6);
      rehearse_tap_write(tap_, u_, numbers_.data(), 12);
      rehearse_tap_variable(tap_, "phase", 0.5);
      rehearse_tap_text(tap_, "a line");
      rehearse_tap_image(tap_, "Camera", "frames/17.png");
      if (i % 1000 == 0) rehearse_tap_mark(tap_, "a mark");
      rehearse_tap_end(tap_);
    }
  }

 private:
  rehearse_tap* tap_;
  int q_, imu_, u_;
  std::array<double, 24> numbers_{};
};

TEST_F(TapTest, AllocatesNothingAndCausesNoPageFaultInATick) {
  rehearse_tap* tap = open();
  Loop loop(tap);
  loop.make_ticks(10);
  rusage before{}, after{};
  const std::size_t allocated = allocations;
#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
  EXPECT_GT(allocated, 0u);
#endif
  getrusage(RUSAGE_SELF, &before);
  loop.make_ticks(10'000);
  getrusage(RUSAGE_SELF, &after);
  EXPECT_EQ(allocations, allocated);
  EXPECT_EQ(after.ru_minflt - before.ru_minflt, 0);
  EXPECT_EQ(after.ru_majflt - before.ru_majflt, 0);
  EXPECT_GT(rehearse_tap_dropped(tap), 5000u);
  rehearse_tap_close(tap);
}

/// A reader beside a loop that doesn't wait for it: each record that it takes is whole, and has the numbers of one
/// tick.
TEST_F(TapTest, KeepsRecordsWholeWhileAnotherThreadReads) {
  constexpr std::uint64_t ticks = 200'000;
  rehearse_tap* tap = open();
  const std::vector<const char*> names{"A", "B", "C", "D", "E", "F"};
  const int series = rehearse_tap_joints(tap, "Walker", names.data(), names.size(), REHEARSE_TAP_Q);
  const int descriptor = ::open(ring().c_str(), O_RDWR);
  const std::size_t size = fs::file_size(ring());
  void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  ASSERT_NE(memory, MAP_FAILED);
  auto* const head = static_cast<tap_ring_head*>(memory);
  auto* const words = reinterpret_cast<std::uint64_t*>(static_cast<std::byte*>(memory) + tap_words_place);
  std::thread loop([&] {
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      const std::vector<double> numbers(names.size(), static_cast<double>(tick));
      rehearse_tap_begin(tap, static_cast<std::int64_t>(tick));
      rehearse_tap_write(tap, series, numbers.data(), numbers.size());
      rehearse_tap_end(tap);
    }
  });
  std::vector<std::uint64_t> record(tap_most_record_words);
  std::uint64_t place = 0, count = 0, taken = 0, last = 0, wrong = 0;
  while (last + 1 < ticks) {
    const tap_taken got = tap_ring_take(head, words, head->words, &place, record.data(), record.size(), &count);
    if (got == tap_nothing || got == tap_overtaken) continue;
    bool is_right =
        got == tap_record && record[2] == tap_record_hash(record.data(), count) && (taken == 0 || record[1] > last);
    for (std::uint64_t i = 5; is_right && i < count; ++i) {
      double number = 0;
      std::memcpy(&number, &record[i], sizeof number);
      is_right = number == static_cast<double>(record[1]);
    }
    if (!is_right && ++wrong > 10) break;
    last = record[1];
    ++taken;
  }
  loop.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(taken, 0u);
  munmap(memory, size);
  rehearse_tap_close(tap);
  close(descriptor);
}

/// The kernel kills a process in this mode at any system call but read, write and the end of a thread.
TEST_F(TapTest, CallsTheSystemInNoTick) {
  const auto ends_well = [&](bool calls) {
    return in_a_process([&] {
      Loop loop(open(1));
      if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) _exit(2);
      loop.make_ticks(10'000);
      if (calls) syscall(SYS_getppid);
      syscall(SYS_exit, 0);
      return 1;
    });
  };
  EXPECT_EQ(ends_well(true), -1);
  EXPECT_EQ(ends_well(false), 0);
}

}  // namespace
