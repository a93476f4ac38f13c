// Sleep: bodies at rest aren't simulated until something moves them. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/model.h>
#include <rehearse/world_settings.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "simulated_body.h"
#include "touches.h"

namespace rehearse {

/// A body can sleep if it is one rigid body without joints and devices. It rests while no point of it is faster than
/// SolverSettings::sleep_speed. Bodies that touch each other sleep together, once all have rested for
/// SolverSettings::sleep_after and nothing else that moves touches one of them. They wake together: if a force is
/// applied to one of them, if it is connected, given a motion or another mass, or if something that moves or that
/// doesn't sleep touches it. While they sleep their contacts have the forces of their last step.
class Sleep {
 public:
  Sleep(const WorldSettings& settings, const std::vector<std::unique_ptr<SimulatedBody>>& bodies);

  /// Before the contacts of a step are added to it: wakes bodies.
  void wake(const Touches& touches);
  /// True if the contact has no part in the step: each of its bodies sleeps or never moves.
  bool is_asleep(const Touches::Contact& contact) const;
  /// After the step: lets bodies sleep.
  void end_step(const Touches& touches);

  /// Nothing if bodies never sleep.
  void visit_state(StateVisitor& visitor);
  void after_restore();

 private:
  struct Sleeper {
    dBodyID body;
    const SimulatedBody& owner;
    double radius;  // distance of the farthest point of its shapes from the centre of mass, at most [m]
    // state
    std::int32_t steps_at_rest = 0;
    std::int32_t asleep = 0;  // 1: it sleeps
  };
  static constexpr std::size_t none = ~std::size_t{0};

  std::size_t index_of(dBodyID body) const;
  /// Groups of sleepers that touch, by the index of one of them; entries of members refer to it.
  std::vector<std::size_t> groups_of(const Touches& touches) const;
  bool moves(const Touches::Contact::Side& side) const;
  double speed_of(const Sleeper& sleeper) const;
  static void set_asleep(Sleeper& sleeper, bool asleep);

  std::int32_t steps_ = 0;  // at rest before it sleeps
  double speed_ = 0.0;      // [m/s]
  std::vector<Sleeper> sleepers_;
  std::map<dBodyID, std::size_t> indices_;  // of sleepers_
};

}  // namespace rehearse
