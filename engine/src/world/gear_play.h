// GearPlay: the backlash of a joint's gear, and the rotor behind it. Private to the world library.
#pragma once

#include <rehearse/actuator.h>

#include <optional>

#include "simulated_body.h"

namespace rehearse {

/// In a step: prepare() with the motion of the rotor, then gain() and offset() for the joint's equation, and finish().
class GearPlay {
 public:
  /// `actuator` must outlive this. `inertia` of the rotor, as it acts at the joint [kg·m²] or [kg].
  GearPlay(const Actuator& actuator, double inertia) : actuator_(actuator), inertia_(inertia) {}

  /// `effort`: of the motor [N·m] or [N]; nullopt: it moves the rotor at `velocity`, whatever that needs. The joint is
  /// at `q` with the velocity `dq`. `slope`: by which the effort falls with the rotor's velocity, from that at `dq` on.
  void prepare(std::optional<double> effort, double velocity, double q, double dq, double time_step,
               double slope = 0.0);
  /// The effort of the gear on the joint is offset() - gain() * v, with the joint's velocity v at the step's end.
  double gain() const { return gain_; }
  double offset() const { return offset_; }
  void finish(double dq, double time_step);

  bool begun() const { return begun_ != 0.0; }
  double displacement() const { return angle_; }  // of the rotor, as it acts at the joint [rad] or [m]
  double rate() const { return rate_; }
  double effort() const { return effort_; }  // on the joint in the last step

  void visit_state(StateVisitor& visitor);

 private:
  const Actuator& actuator_;
  double inertia_;
  // state
  double begun_ = 0.0;  // 1: the rotor has a place
  double angle_ = 0.0, rate_ = 0.0, effort_ = 0.0;
  // scratch within a step
  double gain_ = 0.0, offset_ = 0.0;
  double free_rate_ = 0.0;       // at the step's end, if the teeth don't touch
  double rate_by_effort_ = 0.0;  // by which the gear's effort slows the rotor; 0: its motion is given
};

}  // namespace rehearse
