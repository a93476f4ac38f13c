// Plant: the simulated side of the loop. Bodies, cameras, range sensors, noise, joystick: commands go in, observations
// come out. What commands it, controllers or a recording, it does not know.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>
#include <rehearse/world.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "noise_maker.h"
#include "renderer/vision.h"
#include "world/scanner.h"

namespace rehearse {

class Plant {
 public:
  /// The scenario must outlive this.
  static Result<std::unique_ptr<Plant>> create(const Scenario& scenario);
  /// The same with the noise of another scenario.
  static Result<std::unique_ptr<Plant>> create(const Scenario& scenario, const Scenario& noise_of);

  World& world() { return *world_; }
  std::int64_t tick() const { return world_->tick(); }
  std::string renderer_description() const { return vision_ ? vision_->renderer_description() : ""; }

  /// What is to be seen at the beginning of a tick. To be called once for each tick, in order.
  void sense();
  /// The joints as they are, devices as they are read.
  const Observation& seen() const { return seen_; }
  /// What goes to controllers: the joints as they are read too.
  const Observation& read() const { return noise_.has_joints() ? read_ : seen_; }

  /// One step under a command, and the scenario's pushes. The command's wrenches are used up. False: it exploded.
  bool step(Command& command);
  /// Devices do what controllers said to them in a tick (-1: before the run), from the next one on; a light's new state
  /// is what it reads there, to those who listen. The words are used up.
  void obey(std::int64_t tick, Command& command);

  /// The world has been set to the state at the beginning of this tick. Cameras and range sensors capture from there on
  /// as if they had never stopped, but what they had captured before is lost.
  void begin_at(std::int64_t tick);

 private:
  Plant(const Scenario& scenario, const Scenario& noise_of) : scenario_(scenario), noise_(noise_of) {}

  const Scenario& scenario_;
  std::unique_ptr<World> world_;
  std::unique_ptr<Vision> vision_;  // null: no camera runs
  std::unique_ptr<Scanner> scanner_;
  NoiseMaker noise_;
  Observation seen_;
  Observation read_;                                             // used only if joints have noise
  std::vector<std::vector<std::optional<DeviceReading>>> told_;  // by body and device: a light's new state
};

/// One step of a scenario's world, at its own tick, under a command and the scenario's pushes. False: it exploded.
bool step_world(World& world, const Scenario& scenario, const Command& command);

/// External wrenches act in one step only.
void use_up_wrenches(Command& command);

/// What a scenario makes a world of.
std::vector<WorldBody> world_bodies(const Scenario& scenario);
WorldSettings world_settings(const Scenario& scenario);

}  // namespace rehearse
