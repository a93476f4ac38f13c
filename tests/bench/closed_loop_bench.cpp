// The cost of recording a controller relative to the simulation of the robot alone.

#include <rehearse/replay.h>
#include <rehearse/session.h>

#include "pairs.h"
#include "pinned_child.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

constexpr std::int64_t slice = 100;  // ticks measured at a time

/// A session that begins again when it is over.
class EndlessSession {
 public:
  void run(std::int64_t ticks) {
    for (std::int64_t i = 0; i < ticks; ++i) must(session_->step());
  }
  void prepare(std::int64_t ticks) {
    const Sr1Run& sr1 = Sr1Run::instance();
    if (session_ && session_->tick() + ticks <= sr1.ticks()) return;
    if (session_) must(session_->finish());
    session_ = must(Session::create(sr1.scenario(), sr1.folder() / "endless.mcap", {}));
  }

 private:
  std::unique_ptr<Session> session_;
};

/// The world alone, told what the controller told it in the recording: the same trajectory, bit for bit, without
/// sensing, controllers or recording.
class BareLoop {
 public:
  void run(std::int64_t ticks) {
    const std::vector<Command>& commands = Sr1Run::instance().commands();
    for (std::int64_t i = 0; i < ticks; ++i) {
      world_->actuate(commands[static_cast<std::size_t>(world_->tick())]);
      world_->step();
    }
  }
  void prepare(std::int64_t ticks) {
    const Sr1Run& sr1 = Sr1Run::instance();
    if (!world_ || world_->tick() + ticks > sr1.ticks()) world_ = sr1.make_world();
  }

 private:
  std::unique_ptr<World> world_;
};

/// Work: Session::step() (sense, control, actuate, step, record). Base: World::actuate() and World::step().
void closed_loop_over_bare_loop(benchmark::State& state) {
  EndlessSession session;
  BareLoop bare;
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    session.prepare(slice);
    bare.prepare(slice);
    state.SetIterationTime(pairs.measure([&] { session.run(slice); }, [&] { bare.run(slice); }));
  }
  pairs.report(state, slice, slice);
}
BENCHMARK(closed_loop_over_bare_loop)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: the whole of replay(), opening the trace and loading the library included. Base: Session::step().
void replay_over_closed_loop(benchmark::State& state) {
  const Sr1Run& sr1 = Sr1Run::instance();
  EndlessSession session;
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    session.prepare(slice);
    const auto replay_all = [&] {
      if (!must(replay(sr1.trace())).equal()) state.SkipWithError("the replay differs from the recording");
    };
    state.SetIterationTime(pairs.measure(replay_all, [&] { session.run(slice); }));
  }
  pairs.report(state, static_cast<double>(sr1.ticks()), slice);
}
BENCHMARK(replay_over_closed_loop)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace

Work make_closed_loop_work() {
  return [session = std::make_shared<EndlessSession>()] {
    session->prepare(slice);
    session->run(slice);
  };
}

}  // namespace rehearse
