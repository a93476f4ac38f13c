// Recordings killed by SIGKILL at random moments: from before the file exists to after the end. The remaining file can
// be read and recovered, at most a second of simulation is lost, and a golden is never changed.
//
// REHEARSE_KILLS: the number of kills; the page contribute/robustness_tests.md has the results of a thousand.
#include "recording_process.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <thread>

namespace rehearse::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double time_step = 0.001;          // [s]
constexpr std::int64_t a_second = 1000 + 1;  // ticks: a second of simulation, and the tick that was under way

int kills() {
  const char* text = std::getenv("REHEARSE_KILLS");
  return text == nullptr ? 21 : std::max(1, std::atoi(text));
}

/// The results of all recordings.
struct Figures {
  int kills = 0;
  int finished = 0;               // it was over before
  int nothing = 0;                // no tick is saved: the kill came before the first chunk was due
  int traces_lost = 0;            // the remaining file can't be read, or more than a second is lost
  std::int64_t lost_at_most = 0;  // ticks
};

class Kill : public ::testing::Test {
 protected:
  Kill() : counter_(folder() / "calls") {}

  const fs::path& folder() const { return scratch_.path(); }

  /// A pendulum under the controller that counts; `computing` in each call [microseconds].
  fs::path scenario(const std::string& golden, double duration, int computing, double start) const {
    const fs::path file = folder() / "pendulum.yaml";
    std::ofstream text(file);
    text << "rehearse: 1\nduration: " << duration << "\ntime_step: " << time_step << "\n";
    if (!golden.empty()) text << "golden: " << golden << "\n";
    text << "bodies:\n  - name: Pendulum\n    model: " << (fs::path(FIXTURES_DIR) / "models/pendulum.urdf").string()
         << "\n    joints: {hinge: " << start
         << " deg}\n    controllers:\n      - name: Ticking\n        library: " << TICKING << "\n        options: \""
         << (folder() / "calls").string() << " " << computing << "\"\n";
    return file;
  }

  /// The processes of a command: one writes the recording, its child runs the controllers.
  enum class Victim { parent, child, both };

  /// Runs the command and kills a process of it after a while; true if it had ended before.
  bool run_and_kill(const std::vector<std::string>& words, std::chrono::microseconds after,
                    Victim victim = Victim::parent) {
    counter_.reset();
    const pid_t parent = start(words, folder() / "log", [] { setenv("CI", "true", 1); });
    std::this_thread::sleep_for(after);
    pid_t child = 0;
    std::ifstream("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children") >> child;
    if (victim != Victim::parent && child > 0) kill(child, SIGKILL);
    if (victim != Victim::child || child == 0) kill(parent, SIGKILL);
    const int status = wait_for(parent);
    return victim == Victim::child ? status == 0 : status >= 0;
  }

  /// The duration of the command without a kill.
  std::chrono::microseconds whole_run(const std::vector<std::string>& words) {
    const auto begin = Clock::now();
    counter_.reset();
    const int status = wait_for(start(words, folder() / "log", [] { setenv("CI", "true", 1); }));
    EXPECT_LE(status, 1) << read_file(folder() / "log");
    return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin);
  }

  void examine(const fs::path& trace, bool finished, std::int64_t most_lost, Figures& figures) const {
    ++figures.kills;
    figures.finished += finished ? 1 : 0;
    const std::int64_t reached = counter_.calls();  // calls, so ticks 0 to reached - 1
    const auto last = save_what_is_left(trace, folder() / "saved.mcap");
    if (!last) ++figures.nothing;
    const std::int64_t saved = last.value_or(-1) + 1;
    const std::int64_t lost = std::max<std::int64_t>(0, reached - saved);
    figures.lost_at_most = std::max(figures.lost_at_most, lost);
    EXPECT_LE(lost, most_lost) << "reached " << reached << " ticks, saved " << saved;
    if (HasFailure()) ++figures.traces_lost;
  }

  static void tell(const char* what, const Figures& figures) {
    std::printf(
        "%s: %d kills, %d after the end, %d before anything was due, %d traces lost, at most %.3f s of simulation "
        "lost\n",
        what, figures.kills, figures.finished, figures.nothing, figures.traces_lost,
        static_cast<double>(figures.lost_at_most) * time_step);
  }

  /// Kills recordings of several speeds.
  Figures kill_recordings(Victim victim, std::int64_t most_lost);

  TemporaryFolder scratch_;
  CallCounter counter_;
  std::mt19937 random_{20261120};
};

/// From long before the first tick to a little after the end.
std::chrono::microseconds moment(std::mt19937& random, std::chrono::microseconds whole) {
  std::uniform_int_distribution<std::int64_t> distribution(0, whole.count() * 23 / 20);
  return std::chrono::microseconds(distribution(random));
}

Figures Kill::kill_recordings(Victim victim, std::int64_t most_lost) {
  Figures figures;
  for (const int computing : {0, 50, 1000}) {  // far faster than time, some 15 times as fast, about as fast
    const double duration = computing == 1000 ? 1.2 : computing == 50 ? 4.0 : 8.0;  // [s] simulated
    const fs::path trace = folder() / "run.mcap";
    const std::vector<std::string> words{REHEARSE_COMMAND, "record", scenario("", duration, computing, 20.0).string(),
                                         "-o", trace.string()};
    const auto whole = whole_run(words);
    for (int i = 0; i < (kills() + 2) / 3 && !HasFailure(); ++i) {
      fs::remove(trace);
      const bool finished = run_and_kill(words, moment(random_, whole), victim);
      examine(trace, finished, most_lost, figures);
    }
  }
  return figures;
}

TEST_F(Kill, OfARecordingLosesAtMostASecondOfSimulation) { tell("record", kill_recordings(Victim::parent, a_second)); }

TEST_F(Kill, OfBothProcessesLosesNoMore) { tell("record, both", kill_recordings(Victim::both, a_second)); }

TEST_F(Kill, OfTheProcessWithTheControllersLosesNoTick) { tell("record, child", kill_recordings(Victim::child, 0)); }

/// A check that differs from its golden records a run that is to wait, and may not touch the golden.
TEST_F(Kill, OfACheckNeverTouchesTheGolden) {
  const fs::path golden = folder() / "golden.mcap";
  wait_for(start({REHEARSE_COMMAND, "record", scenario("", 4.0, 0, 20.0).string(), "-o", golden.string()},
                 folder() / "log"));
  const std::string before = read_file(golden);
  ASSERT_FALSE(before.empty()) << read_file(folder() / "log");
  const fs::path changed = scenario("", 4.0, 0, 21.0);
  const std::vector<std::string> words{REHEARSE_COMMAND, "check", changed.string(), "--golden", golden.string()};
  setenv("REHEARSE_PENDING", (folder() / "pending").c_str(), 1);
  const auto whole = whole_run(words);
  for (int i = 0; i < (kills() + 3) / 4; ++i) {
    run_and_kill(words, moment(random_, whole));
    ASSERT_TRUE(read_file(golden) == before) << "kill " << i;
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder() / "pending"))
    if (entry.is_regular_file() && entry.path().extension() == ".mcap")
      save_what_is_left(entry.path(), folder() / "saved.mcap");
}

}  // namespace
}  // namespace rehearse::test
