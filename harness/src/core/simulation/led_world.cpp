#include "led_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/run/run.h"
#include "recorded_commands.h"

namespace rehearse {
namespace {

/// Records nothing in the steps before the moment, except the contacts.
class ContactsSink final : public Sink {
 public:
  explicit ContactsSink(Recorder& recorder) : recorder_(recorder) {}
  Result<void> emit(const TickData& now) override {
    state_hash = now.state_hash;
    recorder_.begin_with_contacts(*now.touching);
    return {};
  }

  std::uint64_t state_hash = 0;  // of the last tick

 private:
  Recorder& recorder_;
};

/// The number of ticks that cameras and range sensors must run before a moment. Then all captures that arrive at the
/// moment or later are captured again. It is twice the longest cycle, which is a second at most (renderer/vision.h).
std::int64_t lead_of(const Scenario& scenario) {
  double longest = 0.0;
  for (const ScenarioBody& body : scenario.bodies) {
    for (const Device& device : body.model->devices) {
      if (const auto* camera = std::get_if<Camera>(&device.kind)) longest = std::max(longest, 1.0 / camera->frame_rate);
      if (const auto* laser = std::get_if<RangeSensor>(&device.kind))
        longest = std::max(longest, 1.0 / laser->scan_rate);
    }
  }
  constexpr std::int64_t for_contacts = 2;  // contacts exist after a step
  return std::llround(std::ceil(2.0 * longest / scenario.time_step)) + for_contacts;
}

}  // namespace

RecordedCheckpoints checkpoints_before(const Trace& recording, const Scenario& scenario, std::int64_t moment) {
  const std::int64_t latest = moment - lead_of(scenario);
  const std::int64_t from = latest - std::llround(1.0 / scenario.time_step);  // a second before
  if (from > 0) {
    RecordedCheckpoints near(recording, scenario, from, moment);
    const std::vector<std::int64_t> ticks = near.ticks();
    if (ticks.size() > 1 && ticks.front() <= latest) return near;
  }
  return {recording, scenario};
}

std::int64_t latest_checkpoint(const RecordedCheckpoints& checkpoints, const Scenario& scenario, std::int64_t moment) {
  std::int64_t latest = 0;
  for (const std::int64_t tick : checkpoints.ticks())
    if (tick <= moment - lead_of(scenario)) latest = std::max(latest, tick);
  return latest;
}

Result<LedWorld> lead_world(const Scenario& scenario, const Trace& recording, RecordedCheckpoints& checkpoints,
                            std::int64_t from, std::int64_t moment, Plant& plant, WorldSource& world,
                            Recorder& recorder) {
  auto commands = REHEARSE_TRY(RecordedCommands::find(scenario, recording));
  ContactsSink sink(recorder);
  Run leading(scenario.time_step, world, commands, sink, from, moment);
  const auto restored = REHEARSE_TRY(begin_at_checkpoint(from, plant, checkpoints, commands, leading.command));
  REHEARSE_ASSERT(restored, "the checkpoint was chosen from the recorded ones");
  REHEARSE_TRY(leading.go());
  if (leading.interruption()) return *leading.interruption();
  if (!leading.broke_down()) return LedWorld{std::move(leading.command), sink.state_hash};
  return error_in(recording.file(), fmt::format("led by the recorded commands, the simulation exploded after tick {}",
                                                leading.tick() - 1));
}

}  // namespace rehearse
