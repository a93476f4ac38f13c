// Lets an arm grasp a block, lift it, and carry it aside: joints go by position through a few postures.
//
// Between two postures each joint follows a cubic without a jump of speed. The commanded closing of the gripper is
// farther than the block allows: the effort limit of the fingers' joints determines the grasping force. At the
// beginning of the lift the controller writes a message that states whether both fingers touch something.

#include <algorithm>
#include <array>
#include <cmath>
#include <cnoid/SimpleController>
#include <cstddef>
#include <vector>

namespace {

/// The joint displacements at a time.
struct Posture {
  double time;                     // [s]
  double pan, lift, elbow, wrist;  // [rad]
  double grip;                     // of each finger [m]
};

constexpr double down = 1.5707963267948966;  // of lift and elbow together: the fingers point down [rad]

constexpr std::array<Posture, 6> postures{{
    {0.0, 0.0, 0.0, 0.0, 0.0, 0.02},
    {0.8, 0.0, 0.95, down - 0.95, 0.0, 0.02},  // above the block
    {1.2, 0.0, 1.3, down - 1.3, 0.0, 0.02},    // around it
    {1.5, 0.0, 1.3, down - 1.3, 0.0, 0.0},     // closed
    {2.2, 0.0, 0.8, down - 0.8, 0.0, 0.0},     // lifted
    {3.0, 0.9, 0.8, down - 0.8, 0.0, 0.0},     // aside
}};
constexpr std::size_t closed = 3;

class GraspController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    for (const char* name : {"PAN", "LIFT", "ELBOW", "WRIST", "GRIP"}) {
      cnoid::Link* joint = io->body()->joint(name);
      if (!joint) {
        io->os() << io->body()->modelName() << " has no joint " << name << "\n";
        return false;
      }
      io->enableOutput(joint, JointDisplacement);
      joints_.push_back(joint);
    }
    for (const char* name : {"left_finger", "right_finger"}) {
      fingers_.push_back(io->body()->link(name));
      io->enableInput(fingers_.back(), LinkContactState);
    }
    return true;
  }

  bool control() override {
    const double time = io_->currentTime();
    std::size_t next = 1;
    while (next + 1 < postures.size() && postures[next].time <= time) ++next;
    const Posture& from = postures[next - 1];
    const Posture& to = postures[next];
    const double s = std::clamp((time - from.time) / (to.time - from.time), 0.0, 1.0);
    const double share = s * s * (3.0 - 2.0 * s);
    const std::array<double, 5> begin{from.pan, from.lift, from.elbow, from.wrist, from.grip};
    const std::array<double, 5> end{to.pan, to.lift, to.elbow, to.wrist, to.grip};
    for (std::size_t i = 0; i < joints_.size(); ++i) joints_[i]->q_target() = begin[i] + share * (end[i] - begin[i]);
    if (next == closed + 1 && !has_said_) say_grasp();
    return time < postures.back().time;
  }

 private:
  void say_grasp() {
    const bool holds = std::all_of(fingers_.begin(), fingers_.end(),
                                   [](const cnoid::Link* finger) { return !finger->contactPoints().empty(); });
    io_->os() << (holds ? "both fingers touch the block" : "there is nothing between the fingers") << std::endl;
    has_said_ = true;
  }

  cnoid::SimpleControllerIO* io_ = nullptr;
  std::vector<cnoid::Link*> joints_;
  std::vector<cnoid::Link*> fingers_;
  bool has_said_ = false;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(GraspController)
