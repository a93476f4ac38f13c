#include "world_source.h"

#include <cstddef>
#include <vector>

namespace rehearse {

Result<bool> WorldSource::observe(TickData& now) {
  REHEARSE_ASSERT(plant_.tick() == now.tick, "run and world are at the same tick");
  plant_.sense();
  now.seen = &plant_.seen();
  now.read = &plant_.read();
  now.truths = &plant_.truths();
  now.state_hash = plant_.world().state_hash();
  now.touching = &plant_.world().touching();
  remarks_.observe(now.tick, plant_.world(), plant_.seen(), now.command, now.events);
  if (now.is_closing) return true;
  if (altered_) apply_alterations(now);
  if (checkpoint_interval_ == 0 || now.tick % checkpoint_interval_ != 0) return true;
  now.checkpoint = plant_.world().save();
  trial_.begin(now.tick / checkpoint_interval_, now.checkpoint);
  const std::vector<std::byte> readings = plant_.save_readings();
  now.checkpoint.insert(now.checkpoint.end(), readings.begin(), readings.end());
  return true;
}

/// Devices and joystick are recorded with their altered readings; joints and links are recorded with their true values,
/// too.
void WorldSource::apply_alterations(TickData& now) {
  altered_read_ = *now.read;
  altered_->apply(now.tick, altered_read_);
  altered_seen_ = *now.seen;
  altered_seen_.joystick = altered_read_.joystick;
  for (std::size_t body = 0; body < altered_seen_.bodies.size(); ++body)
    altered_seen_.bodies[body].devices = altered_read_.bodies[body].devices;
  now.seen = &altered_seen_;
  now.read = &altered_read_;
}

Result<bool> WorldSource::advance(TickData& now, Commander& commands) {
  trial_.step(now.command);
  const bool alive = plant_.step(now.command);
  trial_.compare(plant_.world());
  commands.act_late(now);
  plant_.obey(now.tick, now.command);
  return alive;
}

Result<bool> begin_at_checkpoint(std::int64_t tick, Plant& plant, RecordedCheckpoints& checkpoints,
                                 RecordedCommands& commands, Command& command) {
  command = commands.initial();
  plant.obey(-1, command);
  for (std::int64_t past = commands.pass_over(tick); past < tick; ++past) {
    commands.put(past, Timing::same_step, command);
    use_up_wrenches(command);
    commands.put(past, Timing::next_step, command);
    plant.obey(past, command);
  }
  if (tick == 0) return true;
  std::vector<std::byte> readings;
  const auto restored = checkpoints.restore(tick, plant.world(), &readings);
  if (restored && *restored) plant.begin_at(tick, readings);
  return restored;
}

}  // namespace rehearse
