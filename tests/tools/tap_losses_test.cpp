// The verb tap, when a loop or the recorder is killed, or the disk is full. REHEARSE_WHOLE_TAP=1 in the environment
// makes as many kills and ticks as the nightly run; it takes half an hour.
#include <sys/stat.h>

#include <cstdlib>
#include <random>

#include "tap/tap_verb.h"

namespace rehearse::test {
namespace {

using testing::HasSubstr;

/// How often a row is repeated by day and at night.
int times(int by_day, int at_night) { return std::getenv("REHEARSE_WHOLE_TAP") != nullptr ? at_night : by_day; }

/// The number in the first 8 bytes of a file.
std::uint64_t number_in(const fs::path& file) {
  std::uint64_t number = 0;
  std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(&number), sizeof number);
  return number;
}

/// [kB]; 0: the process has ended.
long peak_memory_of(pid_t process) {
  std::ifstream status(fmt::format("/proc/{}/status", process));
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stol(line.substr(6));
  return 0;
}

/// The loop never sleeps, so that it is killed at any instruction.
TEST_F(TapVerb, KeepsAllEndedTicksOfALoopThatIsKilled) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "killed.mcap", "--again"}, "recorder");
  const std::vector<std::string> words = loop_words(1'000'000'000, 3);
  std::minstd_rand random(82);
  const int kills = times(20, 1000);
  std::size_t all = 0;
  for (int i = 0; i < kills; ++i) {
    const fs::path counter = write("counter", std::string(8, '\0'));
    std::vector<std::string> of_this = words;
    of_this.push_back("counter=" + counter.string());
    Beside loop(folder(), LOOP, of_this, "loop");
    while (number_in(counter) == 0) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    loop.kill(SIGKILL);
    EXPECT_EQ(loop.wait(), 128 + SIGKILL);
    const std::string file = "killed.mcap";  // it is removed each time
    const auto reports = [&] {
      const std::string out = read_file(folder() / "recorder.out");
      return std::ranges::count(out, '\n');
    };
    for (int waited = 0; waited < 2000 && reports() <= i; ++waited) rest(10);
    const std::uint64_t ended = number_in(counter);
    const std::set<std::int64_t> ticks = ticks_in(file);
    ASSERT_GE(ticks.size(), ended) << said();
    ASSERT_LE(ticks.size(), ended + 1);
    ASSERT_EQ(*ticks.rbegin() + 1, static_cast<std::int64_t>(ticks.size()));
    all += ticks.size();
    fs::remove(folder() / file);
  }
  recorder.kill(SIGTERM);
  EXPECT_EQ(recorder.wait(), 3);
  std::printf("%d kills of the loop, %zu ticks, all there\n", kills, all);
}

/// Recorders are killed, one after the other, and a reader looks into the ring meanwhile.
TEST_F(TapVerb, LosesNothingWhenTheRecorderIsKilled) {
  const fs::path counter = write("counter", std::string(8, '\0'));
  const int kills = times(6, 200);
  const std::vector<std::string> words{"paced", "longest", "megabytes=8", "counter=" + counter.string()};
  Beside loop(folder(), LOOP, loop_words(1500 * (kills + 1), 3, words), "loop");
  std::minstd_rand random(82);
  for (int i = 0; i < kills; ++i) {
    Beside recorder(folder(), command, {"tap", tap(), "-o", fmt::format("part{}.mcap", i)}, "recorder");
    rest(static_cast<int>(random() % 2000));
    if (i % 10 == 0) {
      EXPECT_EQ(rehearse({"tap", tap(), "--recover", "-o", fmt::format("look{}.mcap", i)}).status, 0);
    }
    recorder.kill(SIGKILL);
    recorder.wait();
  }
  Beside recorder(folder(), command, {"tap", tap(), "-o", "last.mcap"}, "recorder");
  EXPECT_EQ(loop.wait(), 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  const std::uint64_t ended = number_in(counter);
  std::set<std::int64_t> ticks = ticks_in("last.mcap");
  for (int i = 0; i < kills; ++i) ticks.merge(ticks_in(fmt::format("part{}.mcap", i)));
  EXPECT_EQ(ticks.size(), ended);
  EXPECT_THAT(read_file(folder() / "loop.out"), HasSubstr("0\nlongest"));
  std::printf("%d kills of the recorder, %zu ticks, all there; from begin to end: %s\n", kills, ticks.size(),
              read_file(folder() / "loop.out").c_str());
}

/// A disk of 100 to 400 kB for each recorder.
TEST_F(TapVerb, LosesNothingWhenTheDiskIsFull) {
  if (std::system("unshare -m mount -t tmpfs -o size=64k none /mnt 2> /dev/null") != 0)
    GTEST_SKIP() << "this process may not mount a small disk";
  const fs::path counter = write("counter", std::string(8, '\0'));
  const int rounds = times(2, 50);
  write("fill.sh", "mkdir -p disk && mount -t tmpfs -o size=$1k none disk && " + command.string() +
                       " tap $2 -o disk/flight.mcap --keep-free 0; status=$?; cp disk/flight.mcap $3; exit $status\n");
  Beside loop(folder(), LOOP,
              loop_words(1'000'000'000, 12, {"paced", "fast", "longest", "counter=" + counter.string()}), "loop");
  std::minstd_rand random(82);
  for (int i = 0; i < rounds; ++i) {
    const Outcome filled = run("/usr/bin/unshare", {"-m", "sh", "fill.sh", std::to_string(100 + random() % 300), tap(),
                                                    fmt::format("part{}.mcap", i)});
    EXPECT_EQ(filled.status, 2) << filled.out << filled.err;
    EXPECT_THAT(filled.err, HasSubstr("No space left on device"));
  }
  Beside recorder(folder(), command, {"tap", tap(), "-o", "last.mcap"}, "recorder");
  rest(1500);
  loop.kill(SIGKILL);
  loop.wait();
  EXPECT_EQ(recorder.wait(), 3) << said();
  const std::uint64_t ended = number_in(counter);
  std::set<std::int64_t> ticks = ticks_in("last.mcap");
  for (int i = 0; i < rounds; ++i) ticks.merge(ticks_in(fmt::format("part{}.mcap", i)));
  EXPECT_GE(ticks.size(), ended);
  EXPECT_LE(ticks.size(), ended + 1);
  std::printf("%d full disks, %zu ticks, all there\n", rounds, ticks.size());
}

/// A long flight in eight files: the recorder's memory doesn't grow, and merged they are one recording.
TEST_F(TapVerb, NeedsNoMoreMemoryForALongFlight) {
  const fs::path counter = write("counter", std::string(8, '\0'));
  const std::int64_t ticks = times(40'000, 2'000'000);
  const int split = times(1, 20), files_at_least = times(3, 8), growth = times(12'000, 4'000);
  Beside recorder(folder(), command, {"tap", tap(), "-o", "part.mcap", "--split", std::to_string(split)}, "recorder");
  Beside loop(folder(), LOOP, loop_words(static_cast<int>(ticks), 12, {"paced", "fast", "counter=" + counter.string()}),
              "loop");
  std::vector<long> memory;
  for (const std::int64_t at : {ticks / 2, ticks - ticks / 100}) {
    while (number_in(counter) < static_cast<std::uint64_t>(at)) rest(20);
    memory.push_back(peak_memory_of(recorder.process()));
  }
  EXPECT_EQ(loop.wait(), 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  EXPECT_GT(memory[0], 0);
  EXPECT_LT(memory[1], memory[0] + growth) << "[kB]";
  std::vector<std::string> merge{"merge"};
  for (int i = 0; exists(fmt::format("part_{}.mcap", i)); ++i) merge.push_back(fmt::format("part_{}.mcap", i));
  const std::size_t files = merge.size() - 1;
  EXPECT_GE(files, static_cast<std::size_t>(files_at_least)) << said();
  merge.insert(merge.end(), {"-o", "whole.mcap"});
  EXPECT_EQ(rehearse(merge).status, 0);
  const Outcome replayed = replay("whole.mcap", GUEST);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr(fmt::format("equal bit for bit: {} ticks", ticks)));
  const long all = memory_of({"replay", "whole.mcap", "--controller", GUEST});
  const long half = memory_of({"replay", "whole.mcap", "--controller", GUEST, "--until",
                               fmt::format("{}", 0.5e-4 * static_cast<double>(ticks))});
  EXPECT_LT(all, half + 8'000) << "[kB]";
  std::printf("%lld ticks in %zu files; recorder's memory %ld kB at half of them, %ld kB at the end; replay %ld, %ld\n",
              static_cast<long long>(ticks), files, memory[0], memory[1], half, all);
}

TEST_F(TapVerb, OfARingSavesWhatADeadLoopLeft) {
  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"crash=3000", "megabytes=8"})).status, 128 + SIGKILL);
  ASSERT_TRUE(fs::exists(ring()));
  EXPECT_EQ(run(LOOP, loop_words(10, 3)).status, 1);
  const Outcome saved = rehearse({"tap", tap(), "--recover", "-o", "crash.mcap"});
  EXPECT_EQ(saved.status, 0) << saved.err;
  EXPECT_THAT(saved.out, HasSubstr("3000 ticks recorded in crash.mcap"));
  EXPECT_FALSE(fs::exists(ring()));
  EXPECT_EQ(replay("crash.mcap", GUEST).status, 0) << replay("crash.mcap", GUEST).err;

  EXPECT_EQ(run(LOOP, loop_words(5000, 3, {"crash=3000", "megabytes=8"})).status, 128 + SIGKILL);
  rehearse({"tap", tap(), "--recover", "--last", "0.5", "-o", "last.mcap"});
  const std::set<std::int64_t> ticks = ticks_in("last.mcap");
  EXPECT_EQ(ticks.size(), 500u);
  EXPECT_EQ(*ticks.rbegin(), 2999);
}

TEST_F(TapVerb, LetsALoopRestartWithoutWaiting) {
  Beside recorder(folder(), command, {"tap", tap(), "-o", "first.mcap"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(1000, 3, {"paced", "crash=900"})).status, 128 + SIGKILL);
  rest(50);
  EXPECT_EQ(run(LOOP, loop_words(200, 3)).status, 0);
  EXPECT_EQ(recorder.wait(), 3) << said();
  EXPECT_EQ(ticks_in("first.mcap").size(), 900u);
  EXPECT_EQ(rehearse({"tap", tap(), "-o", "second.mcap"}).status, 0);
  EXPECT_EQ(replay("second.mcap", GUEST).status, 0);
}

}  // namespace
}  // namespace rehearse::test
