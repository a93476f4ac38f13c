// The cost of a hand-over between two threads of a controller that take turns.

#include <rehearse/replay.h>
#include <rehearse/session.h>
#include <semaphore.h>

#include <fstream>
#include <thread>

#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

constexpr int ticks = 100, handed_over_in_a_tick = 1000;  // by ping_pong.cpp

/// Two threads of this process, which hand over as often as ping_pong.cpp in all ticks.
void hand_over() {
  sem_t ping, pong;
  sem_init(&ping, 0, 0);
  sem_init(&pong, 0, 0);
  constexpr int count = ticks * handed_over_in_a_tick / 2;
  std::thread other([&] {
    for (int i = 0; i < count; ++i) {
      sem_wait(&ping);
      sem_post(&pong);
    }
  });
  for (int i = 0; i < count; ++i) {
    sem_post(&ping);
    sem_wait(&pong);
  }
  other.join();
}

/// Work: a replay, per hand-over. Base: the same hand-overs by the kernel. At most 4 µs.
void hand_over_by_turns_over_kernel(benchmark::State& state) {
  const std::filesystem::path folder = Sr1Run::instance().folder(), file = folder / "ping_pong.mcap";
  std::ofstream(folder / "ping_pong.yaml") << "rehearse: 1\nduration: 0.1\nbodies:\n  - name: Pendulum\n    model: "
                                           << FIXTURES_DIR "/models/pendulum.urdf"
                                           << "\n    controllers: [{name: PingPong, library: " PING_PONG "}]\n";
  must(record(must(Scenario::load(folder / "ping_pong.yaml")), file));
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    const auto replay_all = [&] {
      if (!must(replay(file)).equal()) state.SkipWithError("the replay differs from the recording");
    };
    state.SetIterationTime(pairs.measure(replay_all, hand_over));
  }
  pairs.report(state, ticks * handed_over_in_a_tick, ticks * handed_over_in_a_tick);
}
BENCHMARK(hand_over_by_turns_over_kernel)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
