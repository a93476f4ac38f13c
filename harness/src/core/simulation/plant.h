// Plant: the simulated side of the loop (bodies, cameras, range sensors, noise, joystick). It reads commands and
// returns observations. It is independent of the source of the commands: controllers or a recording.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>
#include <rehearse/world.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "renderer/vision.h"
#include "sensor_errors.h"
#include "world/scanner.h"

namespace rehearse {

class Plant {
 public:
  /// The scenario must outlive this. `noise_of`: the scenario with the noise; null: the same.
  static Result<std::unique_ptr<Plant>> create(const Scenario& scenario, const Scenario* noise_of = nullptr);

  World& world() { return *world_; }
  std::int64_t tick() const { return world_->tick(); }
  std::string renderer_description() const { return vision_ ? vision_->renderer_description() : ""; }

  /// Makes the observation at the beginning of a tick. Must be called once for each tick, in order.
  void sense();
  /// True joint values, readings of devices.
  const Observation& seen() const { return seen_; }
  /// The observation for controllers, with readings of joints too.
  const Observation& read() const { return errors_.has_joints() ? read_ : seen_; }
  /// The true values of sensors whose recording has them.
  const std::vector<TrueReading>& truths() const { return errors_.truths(); }

  /// Makes one step under a command and the scenario's pushes. The command's wrenches are set to zero. False: the world
  /// exploded.
  bool step(Command& command);
  /// Applies the commands of controllers to devices, given in a tick (-1: before the run); they act from the next tick
  /// on. A light's new state is its reading in that tick, for controllers that enabled it. The commands in `command`
  /// are no longer fresh afterwards.
  void obey(std::int64_t tick, Command& command);

  /// The world has been set to the state at the beginning of this tick. Cameras and range sensors capture from there on
  /// as if they had never stopped, but earlier captures are lost.
  /// `readings`: of save_readings() at this tick; else readings don't depend on earlier ticks.
  void begin_at(std::int64_t tick, std::span<const std::byte> readings);
  /// The part of the state that isn't the world's: SensorErrors::save().
  std::vector<std::byte> save_readings() { return errors_.save(); }

 private:
  Plant(const Scenario& scenario, const Scenario& noise_of) : scenario_(scenario), errors_(noise_of) {}

  const Scenario& scenario_;
  std::unique_ptr<World> world_;
  std::unique_ptr<Vision> vision_;  // null: no camera runs
  std::unique_ptr<Scanner> scanner_;
  SensorErrors errors_;
  Observation seen_;
  Observation read_;                                             // used only if joints have errors
  std::vector<std::vector<std::optional<DeviceReading>>> told_;  // by body and device: a light's new state
};

/// Makes one step of a scenario's world, at its present tick, under a command and the scenario's pushes. False: it
/// exploded.
bool step_world(World& world, const Scenario& scenario, const Command& command);

/// Sets external wrenches to zero: they act in one step only.
void use_up_wrenches(Command& command);

/// The bodies of the world of a scenario.
std::vector<WorldBody> world_bodies(const Scenario& scenario);

}  // namespace rehearse
