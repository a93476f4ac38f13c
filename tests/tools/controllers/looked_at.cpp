// A controller to be looked at in gdb. Comments mark lines for the tests. Its options may be "crash N": in which call
// of control().
#include <cnoid/RateGyroSensor>
#include <cnoid/SimpleController>
#include <sstream>
#include <string>

namespace {

/// In front of the controller when BEHIND_ANOTHER is defined: then control() is called through a thunk.
class Before {
 public:
  virtual ~Before() = default;
  virtual int first() { return 1; }
};

class LookedAt :
#ifdef BEHIND_ANOTHER
    public Before,
#endif
    public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    std::string deed;
    std::istringstream(io->optionString()) >> deed >> crash_at_;
    body_ = io->body();
    joint_ = body_->joint(0);
    joint_->setActuationMode(cnoid::Link::JointTorque);
    io->enableInput(joint_, cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity);
    io->enableOutput(joint_);
    gyro_ = body_->findDevice<cnoid::RateGyroSensor>();
    io->enableInput(gyro_);
    tree_->write("gain", 2.5);
    tree_->openListing("feet")->append("left");
    return true;  // initialized
  }

  bool control() override {
    const double angle = joint_->q();  // begins
    const double rate = joint_->dq();
    double torque = -2.0 * angle - 0.1 * rate;
#ifdef STIFFER_FROM
    if (calls_ >= STIFFER_FROM) torque *= 1.5;
#endif
    joint_->u() = torque;  // commands
    if (calls_ == crash_at_) nothing_->u() = 1.0;  // crashes
    ++calls_;                                      // has commanded
    return true;
  }

 private:
  int calls_ = 0;
  int crash_at_ = -1;
  cnoid::BodyPtr body_;
  cnoid::LinkPtr joint_;
  cnoid::RateGyroSensor* gyro_ = nullptr;
  cnoid::Link* nothing_ = nullptr;
  cnoid::LinkPtr no_link_;
  cnoid::MappingPtr tree_ = new cnoid::Mapping;
  cnoid::Vector3 ahead_{1.0, 2.5, -3.0};
  cnoid::Matrix3 turn_ = cnoid::Vector3(1.0, 2.0, 3.0).asDiagonal();
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_rows_ =
      (Eigen::Matrix<double, 2, 3>() << 1, 2, 3, 4, 5, 6).finished();
  cnoid::Isometry3 pose_{cnoid::Translation3(0.5, 0.0, 1.0)};
  cnoid::Quaternion half_{0.0, 1.0, 0.0, 0.0};
  cnoid::VectorX gains_ = cnoid::VectorX::LinSpaced(4, 0.0, 1.5);
  cnoid::VectorX empty_;
  cnoid::AngleAxis about_{0.25, cnoid::Vector3::UnitZ()};
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(LookedAt)
