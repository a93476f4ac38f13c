// SR1 standing in a world of its own, with one way to hold its joints.
#pragma once

#include <rehearse/world.h>

#include <memory>
#include <vector>

namespace rehearse {

/// The torque that holds a joint where it began, by gains that depend on its index. q [rad], dq [rad/s]; returns [N·m].
double holding_torque(std::size_t joint, double beginning, double q, double dq);

class Standing {
 public:
  enum class Held { by_torque, by_limited_drive, by_torque_with_fingers };

  /// SR1 after its first half second.
  Standing(SolverSettings::Method method, Held held);

  void steps(int count);
  double height() const { return world_->sense().bodies[robot_].links[0].position.z(); }  // of the root [m]

 private:
  void hold();

  Held held_;
  std::unique_ptr<World> world_;
  Command command_;
  std::vector<JointReading> joints_;  // at the beginning
  std::size_t robot_ = 0;
};

}  // namespace rehearse
