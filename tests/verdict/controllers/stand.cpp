// A PD controller that holds every joint at its start angle, and reacts to its gyro. Built once without a fault, and
// once with each fault of the table of faults: FAULT is one of the names below.
#include <cnoid/AccelerationSensor>
#include <cnoid/RateGyroSensor>
#include <cnoid/SimpleController>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

inline int runs = 0;  // of the process

namespace {

enum Fault {
  none,
  gain,
  sign,
  late,
  swapped,
  stale,
  uninitialised,
  no_delay,
  no_delay_later,  // from tick 300 on
  words,
  last_part,
  announced,     // as last_part, and writes a line in the tick before
  more_sensors,  // reads a sensor and a link that it doesn't need
  more_joints,   // reads the effort of a joint, which it doesn't need
  rounding,      // rounds once more in each command
  earlier_runs,  // has another gain in the third and later runs of its process
};

/// Allocates memory that was used before and is not cleared.
double* used_memory() {
  constexpr std::size_t count = 24;
  volatile std::size_t size = count * sizeof(double);
  auto* garbage = static_cast<double*>(std::malloc(size));
  for (std::size_t i = 0; i < count; ++i)
    garbage[i] = static_cast<double>(std::chrono::steady_clock::now().time_since_epoch().count() % 1000003) * 1e-6;
  std::free(garbage);
  return static_cast<double*>(std::malloc(size));
}

class Stand : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    body_ = io->body();
    for (int i = 0; i < body_->numJoints(); ++i) {
      cnoid::Link* joint = body_->joint(i);
      joint->setActuationMode(cnoid::Link::JointEffort);
      io->enableIO(joint);
      io->enableInput(joint, cnoid::Link::JointVelocity);
      wanted_.push_back(joint->q());
    }
    gyro_ = body_->findDevice<cnoid::RateGyroSensor>();
    io->enableInput(gyro_);
    effort_.assign(wanted_.size(), 0.0);
    last_ = wanted_;
    if (FAULT == uninitialised) offset_ = used_memory();
    if (FAULT == no_delay) io->setNoDelayMode(true);
    if (FAULT == more_sensors) {
      io->enableInput(body_->findDevice<cnoid::AccelerationSensor>());
      io->enableInput(body_->rootLink(), cnoid::Link::LinkPosition);
    }
    if (FAULT == more_joints) io->enableInput(body_->joint("RLEG_KNEE"), cnoid::Link::JointEffort);
    if (FAULT == earlier_runs && ++runs > 2) strength_ = 1.001;
    if (!io->optionString().empty()) strength_ = std::stod(io->optionString());
    return true;
  }

  bool control() override {
    if (FAULT == words && body_->joint(0)->dq() < 0.0) io_->os() << "leaning back" << std::endl;
    const std::vector<double> before = effort_;
    const bool is_last_part = ++ticks_ > 500;
    if (FAULT == announced && ticks_ == 500) io_->os() << "a stiffer knee" << std::endl;
    if (FAULT == no_delay_later && ticks_ == 301) io_->setNoDelayMode(true);
    for (int i = 0; i < body_->numJoints(); ++i) {
      const cnoid::Link* joint = body_->joint(i);
      const bool knee = joint->jointName() == "RLEG_KNEE";
      const double p = knee && (FAULT == gain || ((FAULT == last_part || FAULT == announced) && is_last_part))
                           ? 8000.0 * 1.001
                           : 8000.0;
      const double d = knee && FAULT == sign ? -100.0 : 100.0;
      const double q = knee && FAULT == stale ? last_[i] : joint->q();
      last_[i] = joint->q();
      effort_[i] = strength_ * (p * (wanted_[i] - q) - d * joint->dq());
      if (knee) effort_[i] *= 1.0 + 0.001 * joint->q_upper();  // a value that it reads from its model
      if (joint->jointName().find("ANKLE_P") != std::string::npos) effort_[i] -= 5.0 * gyro_->w().y();
      if (knee && FAULT == uninitialised) effort_[i] += offset_[12];
      if (FAULT == rounding) effort_[i] = effort_[i] / 3.0 * 3.0;
    }
    const std::vector<double>& sent = FAULT == late ? before : effort_;
    for (int i = 0; i < body_->numJoints(); ++i) body_->joint(i)->u() = sent[i];
    if (FAULT == swapped) std::swap(body_->link("RLEG_KNEE")->u(), body_->link("LLEG_KNEE")->u());
    return true;
  }

 private:
  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Body* body_ = nullptr;
  cnoid::RateGyroSensor* gyro_ = nullptr;
  std::vector<double> wanted_;  // [rad]
  std::vector<double> last_;    // [rad]
  std::vector<double> effort_;  // [N·m]
  int ticks_ = 0;
  double strength_ = 1.0;     // factor of all gains
  double* offset_ = nullptr;  // [N·m]; never freed
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Stand)
