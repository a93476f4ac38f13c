// StretchRun: the world of a scenario in a stretch of a recording. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>
#include <rehearse/world.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "flown_motion.h"

namespace rehearse {

class StretchRun {
 public:
  /// `nominal`: the scenario in whose world the states of the stretches were saved. All must outlive this.
  StretchRun(const Scenario& scenario, const Scenario& nominal, const FlownMotion& motion);

  /// The numbers that the world has in the compared ticks, by tick, then by series. `start`: displacements, then
  /// velocities of the joints that move, if the stretch has no state. None: the simulation exploded.
  Result<std::optional<Eigen::VectorXd>> predict(const FlownStretch& stretch, const Eigen::VectorXd& start);

 private:
  Result<void> begin(const FlownStretch& stretch, const Eigen::VectorXd& start);
  void take(std::int64_t tick, const FlownStretch& stretch, const Eigen::VectorXd& start, Eigen::VectorXd& numbers);

  const Scenario& scenario_;
  const Scenario& nominal_;
  const FlownMotion& motion_;
  std::vector<WorldBody> bodies_;
  std::unique_ptr<World> world_;
  std::unique_ptr<World> saved_;  // of the nominal scenario
};

/// The ids of a body's joints that move.
std::vector<std::size_t> movable_joints(const Model& model);

}  // namespace rehearse
