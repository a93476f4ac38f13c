#include "gear_play.h"

#include <cmath>

namespace rehearse {

// With the gap's half b, the side s = +-1 that touches and the rotor's effort u, the unknowns at the step's end are the
// rotor's rate w, the joint's v and the effort e:
//   J (w - w0) = h (u - slope (w - dq) - e)      e = k (angle + h w - q - h v - s b) + c (w - v)
void GearPlay::prepare(std::optional<double> effort, double velocity, double q, double dq, double time_step,
                       double slope) {
  if (begun_ == 0.0) {
    begun_ = 1.0;
    angle_ = q;
    rate_ = dq;
  }
  const double half = 0.5 * actuator_.backlash;
  rate_by_effort_ = effort ? time_step / (inertia_ + time_step * slope) : 0.0;
  free_rate_ = effort ? rate_ + rate_by_effort_ * (*effort + slope * (dq - rate_)) : velocity;
  gain_ = offset_ = 0.0;
  const double reach = angle_ - q + time_step * (free_rate_ - dq);
  if (std::abs(reach) <= half) return;
  const double penetration = angle_ - q - std::copysign(half, reach);
  const double rigid = actuator_.contact_stiffness * time_step + actuator_.contact_damping;
  const double yield = 1.0 + rigid * rate_by_effort_;
  gain_ = rigid / yield;
  offset_ = (actuator_.contact_stiffness * penetration + rigid * free_rate_) / yield;
}

void GearPlay::finish(double dq, double time_step) {
  effort_ = offset_ - gain_ * dq;
  rate_ = free_rate_ - rate_by_effort_ * effort_;
  angle_ += time_step * rate_;
}

void GearPlay::visit_state(StateVisitor& visitor) {
  for (double* number : {&begun_, &angle_, &rate_, &effort_}) visitor.visit(*number);
}

}  // namespace rehearse
