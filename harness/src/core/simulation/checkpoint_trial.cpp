#include "checkpoint_trial.h"

#include <fmt/format.h>

#include <bit>

#include "plant.h"

namespace rehearse {

void CheckpointTrial::begin(std::int64_t number, std::span<const std::byte> state) {
  const bool tried = number == 0 || std::has_single_bit(static_cast<std::uint64_t>(number));
  if (!tried || !finding_.empty()) return;
  if (!twin_) {
    auto world = World::create(scenario_, world_bodies(scenario_));
    REHEARSE_ASSERT(world, "a second world can be made like the first");
    twin_ = std::move(*world);
  }
  const auto restored = twin_->restore(state);
  REHEARSE_ASSERT(restored, "a world of the same bodies has a state of the same size");
  under_way_ = true;
}

void CheckpointTrial::step(const Command& command) {
  if (under_way_ && !step_world(*twin_, scenario_, command)) under_way_ = false;  // the run's own world will fail, too
}

void CheckpointTrial::compare(const World& world) {
  if (!std::exchange(under_way_, false) || twin_->state_hash() == world.state_hash()) return;
  finding_ =
      fmt::format("restored at tick {}, the world is in another state at tick {}", world.tick() - 1, world.tick());
}

}  // namespace rehearse
