// CheckpointTrial: tests whether the checkpoints of a run are exact.
//
// Some of them are restored into a second world, which then makes the same step as the run's own. The states after it
// must have equal bits. It tests the first checkpoint and those whose number is a power of two. So a long run costs a
// dozen additional steps, not a second run.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/world.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace rehearse {

class CheckpointTrial {
 public:
  /// The scenario must outlive this.
  explicit CheckpointTrial(const Scenario& scenario) : scenario_(scenario) {}

  /// Called when the run has saved its checkpoint of that number, counted from 0.
  void begin(std::int64_t number, std::span<const std::byte> state);
  /// Called before the run makes a step under this command.
  void step(const Command& command);
  /// Called after the step of the run.
  void compare(const World& world);

  /// "exact", or "inexact: ..." with the first inexact checkpoint.
  std::string verdict() const { return finding_.empty() ? exact : "inexact: " + finding_; }
  static constexpr const char* exact = "exact";

 private:
  const Scenario& scenario_;
  std::unique_ptr<World> twin_;
  bool under_way_ = false;
  std::string finding_;
};

}  // namespace rehearse
