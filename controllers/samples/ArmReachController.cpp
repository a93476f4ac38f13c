// Moves the tool of an arm to one pose after another. Inverse kinematics computes the joint displacements, and the
// joints follow a smooth trajectory to them. At the end the tool's pose is compared with the target.
//
// Inverse kinematics moves the body that it works on, so it works on a copy. For a target that can't be reached the
// controller writes a message, and the arm stays for the time of the movement.
//
// Options: the targets, each "X Y Z ROLL PITCH YAW" in quotes, [m] and [deg], in the world frame.

#include <algorithm>
#include <cmath>
#include <cnoid/EigenUtil>
#include <cnoid/JointPath>
#include <cnoid/SimpleController>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace {

constexpr double travel_time = 0.8;  // [s]
constexpr double leg_time = 1.0;     // until the tool is measured and the next leg begins [s]

/// From 0 to 1; speed and acceleration are zero at both ends.
double smooth(double s) { return s * s * s * (10.0 + s * (-15.0 + s * 6.0)); }

class ArmReachController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    body_ = io->body();
    tool_ = body_->link("TOOL");
    if (!tool_ || !read_targets()) {
      io->os() << io->controllerName() << " needs a link TOOL, and targets \"X Y Z ROLL PITCH YAW\" as options\n";
      return false;
    }
    for (cnoid::Link* joint : body_->joints()) {
      joint->setActuationMode(JointDisplacement);
      io->enableIO(joint);
      to_.push_back(joint->q());
    }
    io->enableInput(tool_, LinkPosition);
    thought_ = body_->clone();
    path_ = cnoid::JointPath::getCustomPath(thought_->rootLink(), thought_->link("TOOL"));
    path_->setIkJointLimitEnabled(true);
    return true;
  }

  bool start() override {
    begin_leg();
    return true;
  }

  bool control() override {
    if (io_->currentTime() >= leg_began_ + leg_time && leg_ < targets_.size()) {
      if (is_on_its_way_) tell_deviation();
      ++leg_;
      leg_began_ = io_->currentTime();
      begin_leg();
    }
    const double share = smooth(std::min((io_->currentTime() - leg_began_) / travel_time, 1.0));
    for (cnoid::Link* joint : body_->joints()) {
      const auto id = static_cast<std::size_t>(joint->jointId());
      joint->q_target() = from_[id] + share * (to_[id] - from_[id]);
    }
    return leg_ < targets_.size();
  }

 private:
  bool read_targets() {
    for (const std::string& option : io_->options()) {
      cnoid::Vector6 numbers;
      if (!cnoid::toVector6(option, numbers)) return false;
      cnoid::Isometry3 target = cnoid::Isometry3::Identity();
      target.translation() = numbers.head<3>();
      target.linear() = cnoid::rotFromRpy(cnoid::radian(cnoid::Vector3(numbers.tail<3>())));
      targets_.push_back(target);
    }
    return !targets_.empty();
  }

  /// Begins a leg at the end of the last one.
  void begin_leg() {
    from_ = to_;
    if (leg_ == targets_.size()) return;
    for (std::size_t id = 0; id < from_.size(); ++id) thought_->joint(static_cast<int>(id))->q() = from_[id];
    path_->calcForwardKinematics();
    is_on_its_way_ = path_->calcInverseKinematics(targets_[leg_]);
    if (!is_on_its_way_) {
      const cnoid::Vector3 place = targets_[leg_].translation();
      io_->os() << "target " << leg_ + 1 << " at " << cnoid::str(place) << " m is out of reach: the arm stays\n";
      return;
    }
    for (cnoid::Link* joint : path_->joints()) to_[static_cast<std::size_t>(joint->jointId())] = joint->q();
  }

  /// Rounded up: less than a micrometre is rounding, which differs between machines.
  void tell_deviation() {
    const cnoid::Isometry3 deviation = targets_[leg_].inverse() * tool_->T();
    const double micrometres = std::ceil(1e6 * deviation.translation().norm());
    const double millidegrees = std::ceil(1e3 * cnoid::degree(cnoid::omegaFromRot(deviation.linear()).norm()));
    io_->os() << "target " << leg_ + 1 << " reached within " << 0.001 * micrometres << " mm and "
              << 0.001 * millidegrees << " deg\n";
  }

  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::BodyPtr body_;
  cnoid::Link* tool_ = nullptr;
  cnoid::BodyPtr thought_;  // copy of the body for inverse kinematics
  std::shared_ptr<cnoid::JointPath> path_;
  std::vector<cnoid::Isometry3> targets_;
  std::size_t leg_ = 0;  // index of the current target
  bool is_on_its_way_ = false;
  double leg_began_ = 0.0;    // [s]
  std::vector<double> from_;  // joint displacements at the ends of the leg [rad]
  std::vector<double> to_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ArmReachController)
