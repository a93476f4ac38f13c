// A tick allocates no memory beside its step: it reads the world, hashes its state and records both into memory that it
// has. Only a full chunk of the recording needs some. In a program of its own, because it replaces operator new.
#include <rehearse/scenario.h>
#include <rehearse/world.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "core/recording/recorder.h"
#include "core/simulation/plant.h"
#include "small_traces.h"

namespace {
thread_local std::int64_t allocations = 0;  // of this thread: the compressor's don't delay a tick
}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
// std::stable_sort asks for this one, which ASan would answer itself
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace rehearse::test {
namespace {

TEST(Tick, AllocatesNothingBesideItsStep) {
  auto loaded = Scenario::load(std::filesystem::path(FIXTURES_DIR) / "scenarios/sr1_minimum.yaml");
  ASSERT_TRUE(loaded.ok()) << to_string(loaded.errors());
  Scenario scenario = *std::move(loaded);
  scenario.cameras.emplace();  // none
  auto plant = Plant::create(scenario);
  ASSERT_TRUE(plant.ok()) << to_string(plant.errors());
  const TemporaryFolder folder;
  auto recorder = Recorder::create(folder.path() / "run.mcap", scenario, {});
  ASSERT_TRUE(recorder.ok()) << to_string(recorder.errors());
  (*recorder)->declare(nullptr);

  Command command;
  for (const ScenarioBody& body : scenario.bodies) {
    BodyCommand& still = command.bodies.emplace_back();
    still.external.resize(body.model->links.size());
    still.devices.resize(body.model->devices.size());
    for (const double q : body.joints) still.joints.push_back({drive_displacement, q, 0.0, 0.0});
  }
  constexpr std::int64_t first = 100, last = 300;  // the memory has its size
  std::int64_t beside = 0, in_steps = 0;
  for (std::int64_t tick = 0; tick < last; ++tick) {
    const std::int64_t before = allocations;
    (*plant)->sense();
    TickHashes hashes;
    hashes.state = (*plant)->world().state_hash();
    ASSERT_TRUE((*recorder)->record_state(tick, (*plant)->seen(), (*plant)->read()).ok());
    ASSERT_TRUE((*recorder)->record_tick(tick, nullptr, hashes).ok());
    const std::int64_t sensed = allocations;
    ASSERT_TRUE((*plant)->step(command));
    (*plant)->obey(tick, command);
    if (tick < first) continue;
    beside += sensed - before;
    in_steps += allocations - sensed;
  }
  constexpr std::int64_t most = (last - first) / 20;  // a chunk that is full goes to its compressor
  EXPECT_LE(beside, most) << "in " << last - first << " ticks";
  EXPECT_GT(in_steps, 0) << "allocations are counted";
}

}  // namespace
}  // namespace rehearse::test
