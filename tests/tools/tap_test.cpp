// The verb tap: recordings of robots' loops, their replays, and what is left of them after a kill.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/tap_ring.h>
#include <rehearse/trace.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <cstring>
#include <map>
#include <set>
#include <thread>

#include "command.h"

namespace rehearse::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A program that runs beside the test.
class Beside {
 public:
  Beside(const fs::path& folder, const fs::path& program, const std::vector<std::string>& arguments,
         const std::string& output) {
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    process_ = fork();
    if (process_ != 0) return;
    const bool is_ready = chdir(folder.c_str()) == 0 && freopen((output + ".out").c_str(), "w", stdout) != nullptr &&
                          freopen((output + ".err").c_str(), "w", stderr) != nullptr;
    if (is_ready) execv(program.c_str(), pointers.data());
    _exit(127);
  }
  ~Beside() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    wait();
  }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  void kill(int number) const { ::kill(process_, number); }
  /// Its exit status, or 128 and the signal's number.
  int wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = 0;
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  pid_t process_ = 0;
};

void rest(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

class TapVerb : public Command {
 protected:
  TapVerb() : tap_(fmt::format("verb-{}", getpid())) { clear(); }
  ~TapVerb() override { clear(); }

  fs::path ring() const { return fmt::format("/dev/shm/rehearse-tap-{}-{}", geteuid(), tap_); }
  void clear() const {
    fs::remove(ring());
    fs::remove(ring().string() + ".before");
  }

  /// A chain of so many joints, J0, J1, ..., with an IMU.
  fs::path robot(int joints) const {
    std::string text = "<robot name=\"Walker\"><link name=\"BASE\"/>";
    std::string parent = "BASE";
    for (int i = 0; i < joints; ++i) {
      const std::string link = fmt::format("LINK{}", i);
      text += fmt::format(
          "<link name=\"{0}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" "
          "iyz=\"0\" izz=\"0.1\"/></inertial></link><joint name=\"J{1}\" type=\"revolute\"><parent link=\"{2}\"/>"
          "<child link=\"{0}\"/><axis xyz=\"0 1 0\"/><limit lower=\"-3\" upper=\"3\" effort=\"1000\" velocity=\"10\"/>"
          "</joint>",
          link, i, parent);
      parent = link;
    }
    text += "<gazebo reference=\"LINK0\"><sensor name=\"Imu\" type=\"imu\"/></gazebo></robot>";
    return write("walker.urdf", text);
  }
  std::vector<std::string> loop_words(int ticks, int joints, std::vector<std::string> words = {}) const {
    std::vector<std::string> all{tap_, robot(joints).string(), std::to_string(ticks), std::to_string(joints)};
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }
  /// Runs a loop to its end, and the recorder beside it. Returns the recorder's status.
  int record(const std::string& file, int ticks, int joints, const std::vector<std::string>& words = {},
             const std::vector<std::string>& options = {}, const fs::path& program = LOOP) {
    std::vector<std::string> all{"tap", tap_, "-o", file};
    all.insert(all.end(), options.begin(), options.end());
    Beside recorder(folder(), command, all, "recorder");
    EXPECT_EQ(run(program, loop_words(ticks, joints, words)).status, 0);
    return recorder.wait();
  }
  std::string said() const { return read_file(folder() / "recorder.out") + read_file(folder() / "recorder.err"); }
  /// The ticks in a file, also in one without an end.
  std::set<std::int64_t> ticks_in(const std::string& file) const {
    std::set<std::int64_t> ticks;
    const auto trace = Trace::load(folder() / file, Trace::Damage::tolerate);
    if (!trace || !trace->find_channel("/tick")) return ticks;
    for (const std::uint64_t tick : trace->integers("tick")) ticks.insert(static_cast<std::int64_t>(tick));
    return ticks;
  }
  /// The replay of a file by a guest.
  Outcome replay(const std::string& file, const std::string& guest) const {
    return rehearse({"replay", file, "--controller", guest});
  }
  const std::string& tap() const { return tap_; }

 private:
  std::string tap_;
};

TEST_F(TapVerb, RecordsLoopsThatReplayBitForBit) {
  struct Row {
    const char* name;
    fs::path program;
    int joints;
    std::vector<std::string> words;
    const char* guest;
  };
  const Row rows[] = {{"c", LOOP, 12, {}, GUEST},
                      {"cpp17", LOOP_CPP17, 12, {}, GUEST},
                      {"cpp20", LOOP_CPP20, 12, {}, GUEST},
                      {"late", LOOP, 12, {"late"}, GUEST},
                      {"fast", LOOP, 12, {"fast"}, GUEST},
                      {"joints", LOOP, 60, {}, GUEST},
                      {"variables", LOOP, 12, {"variables"}, GUEST_WITH_VARIABLES}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    const std::string file = std::string(row.name) + ".mcap";
    EXPECT_EQ(record(file, 2000, row.joints, row.words, {}, row.program), 0) << said();
    EXPECT_THAT(said(), HasSubstr("the loop closed its tap; 2000 ticks recorded in " + file));
    const Outcome replayed = replay(file, row.guest);
    EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
    EXPECT_THAT(replayed.out, HasSubstr(fmt::format("equal bit for bit: 2000 ticks, {} commanded numbers",
                                                    2000 * row.joints + 2000)));
    EXPECT_EQ(replayed.err, "");
  }
  EXPECT_FALSE(fs::exists(ring()));
}

TEST_F(TapVerb, FindsChangesOfTheControllerAtTheirFirstTick) {
  EXPECT_EQ(record("flight.mcap", 1000, 6), 0);
  for (const char* guest : {GUEST_WITH_GAIN, GUEST_WITH_SIGN, GUEST_LATE}) {
    const Outcome replayed = rehearse({"replay", "flight.mcap", "--controller", guest, "--json"});
    EXPECT_EQ(replayed.status, 1) << guest << replayed.err;
    EXPECT_EQ(replayed.json()["first"]["tick"], 0) << guest;
  }
}

TEST_F(TapVerb, WritesRecordingsThatAllVerbsRead) {
  EXPECT_EQ(record("flight.mcap", 500, 3, {"variables", "mark=100"}), 0);
  EXPECT_THAT(done({"info", "flight.mcap"}).out, HasSubstr("/Walker/Walk/output/joints"));
  EXPECT_THAT(done({"info", "flight.mcap"}).out, HasSubstr("memory_locked"));
  EXPECT_THAT(done({"cat", "flight.mcap", "--topics", "/events"}).out, HasSubstr("mark: a touch"));
  EXPECT_THAT(done({"diff", "flight.mcap", "flight.mcap"}).out, HasSubstr("equal"));
  done({"filter", "flight.mcap", "--topics", "/Walker/*", "-o", "part.mcap"});
  done({"recover", "flight.mcap", "-o", "whole.mcap"});
  EXPECT_EQ(replay("whole.mcap", GUEST_WITH_VARIABLES).status, 0);
  EXPECT_THAT(done({"replay", "flight.mcap", "--controller", GUEST_WITH_VARIABLES, "--tick", "7"}).out,
              HasSubstr("J0"));
  done({"report", "flight.mcap", "-o", "report.html"});
  EXPECT_EQ(rehearse({"doctor", "flight.mcap"}).status, 0) << rehearse({"doctor", "flight.mcap"}).out;
  const auto trace = Trace::load(folder() / "flight.mcap");
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->values("Walker/J2/q").size(), 500u);
  EXPECT_EQ(trace->values("Walker/Imu/angular_velocity/x").size(), 500u);
  EXPECT_EQ(trace->last("flight/dropped"), 0.0);
  const mcap::StringMap* flight = trace->find_metadata("rehearse.flight");
  ASSERT_NE(flight, nullptr);
  EXPECT_EQ(flight->at("gain"), "40");
}

TEST_F(TapVerb, RefusesAControllerThatReadsWhatTheTapLacks) {
  EXPECT_EQ(record("flight.mcap", 10, 3), 0);
  const Outcome replayed = replay("flight.mcap", GUEST_THAT_READS_EFFORTS);
  EXPECT_EQ(replayed.status, 2);
  EXPECT_THAT(replayed.err, HasSubstr("reads u of link 'LINK0', which was not recorded"));
}

TEST_F(TapVerb, KeepsAllEndedTicksOfALoopThatIsKilled) {
  EXPECT_EQ(record("none.mcap", 1, 3), 0);  // all files are in memory
  for (int i = 0; i < 20; ++i) {
    const std::string file = fmt::format("killed{}.mcap", i),
                      counter = (folder() / fmt::format("counter{}", i)).string();
    Beside recorder(folder(), command, {"tap", tap(), "-o", file}, "recorder");
    Beside loop(folder(), LOOP, loop_words(1'000'000'000, 3, {"paced", "counter=" + counter, "megabytes=8"}), "loop");
    rest(80 + 13 * i);
    loop.kill(SIGKILL);
    EXPECT_EQ(loop.wait(), 128 + SIGKILL);
    EXPECT_EQ(recorder.wait(), 3) << said();
    EXPECT_THAT(said(), HasSubstr("the loop's process ended without closing its tap"));
    std::uint64_t ended = 0;
    const std::string bytes = read_file(counter);
    if (bytes.size() == sizeof ended) std::memcpy(&ended, bytes.data(), sizeof ended);
    const std::set<std::int64_t> ticks = ticks_in(file);
    EXPECT_GE(ticks.size(), ended);
    EXPECT_LE(ticks.size(), ended + 1);
    if (!ticks.empty()) EXPECT_EQ(*ticks.rbegin() + 1, static_cast<std::int64_t>(ticks.size()));
  }
}

TEST_F(TapVerb, LosesNothingWhenTheRecorderIsKilled) {
  for (int i = 0; i < 6; ++i) {
    clear();
    const std::string first = fmt::format("first{}.mcap", i), second = fmt::format("second{}.mcap", i);
    Beside killed(folder(), command, {"tap", tap(), "-o", first}, "killed");
    Beside loop(folder(), LOOP, loop_words(1500, 3, {"paced"}), "loop");
    rest(300 + 150 * i);
    killed.kill(SIGKILL);
    killed.wait();
    Beside recorder(folder(), command, {"tap", tap(), "-o", second}, "recorder");
    EXPECT_EQ(loop.wait(), 0);
    EXPECT_EQ(recorder.wait(), 0) << said();
    EXPECT_EQ(ticks_in(second).size(), 1500u) << said();  // the ring still had all
    EXPECT_THAT(read_file(folder() / "loop.out"), HasSubstr("0"));
  }
}

TEST_F(TapVerb, OfARingSavesWhatADeadLoopLeft) {
  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"crash=3000", "megabytes=8"})).status, -1);
  ASSERT_TRUE(fs::exists(ring()));
  EXPECT_EQ(run(LOOP, loop_words(10, 3)).status, 1);
  const Outcome saved = rehearse({"tap", tap(), "--recover", "-o", "crash.mcap"});
  EXPECT_EQ(saved.status, 0) << saved.err;
  EXPECT_THAT(saved.out, HasSubstr("3000 ticks recorded in crash.mcap"));
  EXPECT_FALSE(fs::exists(ring()));
  EXPECT_EQ(replay("crash.mcap", GUEST).status, 0) << replay("crash.mcap", GUEST).err;

  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"crash=3000", "megabytes=8"})).status, -1);
  rehearse({"tap", tap(), "--recover", "--last", "0.5", "-o", "last.mcap"});
  const std::set<std::int64_t> ticks = ticks_in("last.mcap");
  EXPECT_EQ(ticks.size(), 500u);
  EXPECT_EQ(*ticks.rbegin(), 2999);
}

TEST_F(TapVerb, LetsALoopRestartWithoutWaiting) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "first.mcap"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(1000, 3, {"paced", "crash=900"})).status, -1);
  rest(50);
  EXPECT_EQ(run(LOOP, loop_words(200, 3)).status, 0);
  EXPECT_EQ(recorder.wait(), 3) << said();
  EXPECT_EQ(ticks_in("first.mcap").size(), 900u);
  EXPECT_EQ(rehearse({"tap", tap(), "-o", "second.mcap"}).status, 0);
  EXPECT_EQ(replay("second.mcap", GUEST).status, 0);
}

TEST_F(TapVerb, WritesABlackBoxWhenItIsAskedFor) {
  const std::vector<std::string> options{"--black-box", "--last", "0.2"};
  EXPECT_EQ(record("quiet.mcap", 400, 3, {"paced"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("nothing asked for the black box"));
  EXPECT_FALSE(exists("quiet.mcap"));

  EXPECT_EQ(record("mark.mcap", 800, 3, {"paced", "mark=500"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the loop set a mark"));
  EXPECT_EQ(ticks_in("mark.mcap").size(), 200u);
  EXPECT_THAT(rehearse({"cat", "mark.mcap", "--topics", "/events"}).out, HasSubstr("mark: a touch"));

  EXPECT_EQ(record("beyond.mcap", 800, 3, {"paced", "beyond=500"}, options), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the effort 1e+06 of joint J0 is beyond the model's 1000"));
  EXPECT_EQ(*ticks_in("beyond.mcap").rbegin(), 500);

  Beside recorder(folder(), command, {"tap", tap(), "-o", "dead.mcap", "--black-box", "--last", "0.2"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"paced", "crash=600"})).status, -1);
  EXPECT_EQ(recorder.wait(), 3) << said();
  const std::set<std::int64_t> ticks = ticks_in("dead.mcap");
  EXPECT_EQ(ticks.size(), 200u);
  EXPECT_EQ(*ticks.rbegin(), 599);
}

TEST_F(TapVerb, SplitsFilesThatMergeIntoOneRecording) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "part.mcap", "--split", "1"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(6000, 60, {"paced"})).status, 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  std::vector<std::string> merge{"merge"};
  for (int i = 1; exists(i == 1 ? "part.mcap" : fmt::format("part-{}.mcap", i)); ++i)
    merge.push_back(i == 1 ? "part.mcap" : fmt::format("part-{}.mcap", i));
  EXPECT_GE(merge.size(), 4u) << said();
  merge.insert(merge.end(), {"-o", "whole.mcap"});
  EXPECT_EQ(rehearse(merge).status, 0);
  const Outcome replayed = replay("whole.mcap", GUEST);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("equal bit for bit: 6000 ticks"));
}

TEST_F(TapVerb, NeverReplacesAFileAndEndsWholeWhenTheDiskIsFull) {
  write("flight.mcap", "a file of the user");
  EXPECT_EQ(record("flight.mcap", 10, 3), 0);
  EXPECT_EQ(read_file(folder() / "flight.mcap"), "a file of the user");
  EXPECT_EQ(ticks_in("flight-2.mcap").size(), 10u);

  Beside recorder(folder(), command, {"tap", tap(), "-o", "full.mcap", "--keep-free", "900000000"}, "recorder");
  Beside loop(folder(), LOOP, loop_words(3000, 3, {"paced"}), "loop");
  EXPECT_EQ(recorder.wait(), 2) << said();
  EXPECT_THAT(said(), HasSubstr("the disk is nearly full"));
  EXPECT_EQ(rehearse({"doctor", "full.mcap"}).status, 0) << rehearse({"doctor", "full.mcap"}).out;
  EXPECT_EQ(loop.wait(), 0);
}

TEST_F(TapVerb, RefusesASecondRecorderForeignRingsAndOtherVersions) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "one.mcap"}, "recorder");
  Beside loop(folder(), LOOP, loop_words(100'000, 3, {"paced"}), "loop");
  for (int i = 0; i < 500 && !exists("one.mcap"); ++i) rest(10);
  const Outcome second = rehearse({"tap", tap(), "-o", "two.mcap"});
  EXPECT_EQ(second.status, 2);
  EXPECT_THAT(second.err, HasSubstr("records this tap already"));
  recorder.kill(SIGTERM);
  EXPECT_EQ(recorder.wait(), 0) << said();
  EXPECT_THAT(said(), HasSubstr("the recording was stopped"));
  EXPECT_TRUE(fs::exists(ring()));  // its loop goes on
  loop.kill(SIGKILL);
  loop.wait();

  std::string bytes = read_file(ring());
  const auto refused = [&](std::size_t at, char byte) {
    std::string other = bytes;
    other[at] = byte;
    write("ring", other);
    chmod((folder() / "ring").c_str(), 0600);
    return rehearse({"tap", "./ring", "--recover", "-o", "ring.mcap"}).err;
  };
  EXPECT_THAT(refused(0, 'x'), HasSubstr("it is no ring of a tap"));
  EXPECT_THAT(refused(offsetof(tap_ring_head, version), 2), HasSubstr("the ring is of version 2"));
  EXPECT_THAT(refused(offsetof(tap_ring_head, time_step) + 3, 7), HasSubstr("the head of the ring is damaged"));
  EXPECT_THAT(refused(tap_definitions_place + 1, 'x'), HasSubstr("the series of the ring are damaged"));
  bytes.resize(100);
  EXPECT_THAT(refused(50, 'x'), HasSubstr("it is no ring of a tap"));
}

TEST_F(TapVerb, RecordsALoopWithoutAModelAsALog) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "bare.mcap"}, "recorder");
  EXPECT_EQ(run(LOOP, {tap(), "", "100", "3"}).status, 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  EXPECT_EQ(ticks_in("bare.mcap").size(), 100u);
  const Outcome replayed = replay("bare.mcap", GUEST);
  EXPECT_EQ(replayed.status, 2);
}

}  // namespace
}  // namespace rehearse::test
