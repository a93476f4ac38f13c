#include "acting_faults.h"

namespace rehearse {
namespace {

constexpr double rounding = 1e-9;  // [steps]

void exert(double factor, FaultedCommand& faulted) {
  faulted.command.u *= factor;
  faulted.factor *= factor;
}

void apply(const ActuatorFault& fault, FaultedCommand& faulted) {
  JointCommand& command = faulted.command;
  switch (fault.kind) {
    case ActuatorFault::Kind::dead:
      exert(0.0, faulted);
      command.drive = drive_effort;
      break;
    case ActuatorFault::Kind::weak:
      exert(fault.share, faulted);
      faulted.drive_share *= fault.share;
      if (fault.share == 0.0) command.drive = drive_effort;
      break;
    case ActuatorFault::Kind::locked: faulted.is_locked = true; break;
    case ActuatorFault::Kind::reversed:
      exert(-1.0, faulted);
      command.q = -command.q;
      command.dq = -command.dq;
      break;
  }
}

}  // namespace

bool acts(double from, double until, double time, double time_step) {
  const double margin = rounding * time_step;
  return time >= from - margin && time < until - margin;
}

FaultedCommand under_faults(const std::vector<ActuatorFault>& faults, JointCommand command, double time,
                            double time_step) {
  FaultedCommand faulted{command};
  for (const ActuatorFault& fault : faults)
    if (acts(fault.from, fault.until, time, time_step)) apply(fault, faulted);
  return faulted;
}

}  // namespace rehearse
