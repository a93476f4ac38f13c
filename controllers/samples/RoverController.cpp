// Drives a four-wheeled rover ahead and stops it before an obstacle that its range sensor measures.
//
// It slows down in time to brake evenly: at a distance d from the place to stop, v = sqrt(2 a d). Only obstacles in the
// rover's lane count; a beam without a hit counts as free.
//
// Options: the distance from the obstacle at which to stop [m]; default 0.5.

#include <algorithm>
#include <cmath>
#include <cnoid/RangeSensor>
#include <cnoid/SimpleController>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace {

constexpr double wheel_radius = 0.1;  // [m]
constexpr double lane = 0.3;          // half its width [m]
constexpr double cruise = 1.0;        // [m/s]
constexpr double braking = 0.8;       // [m/s²]
constexpr double pick_up = 1.0;       // [m/s²]

class RoverController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    time_step_ = io->timeStep();
    const auto options = io->options();
    if (!options.empty()) stop_before_ = std::stod(options[0]);
    sensor_ = io->body()->findDevice<cnoid::RangeSensor>();
    if (!sensor_) {
      io->os() << io->body()->modelName() << " has no range sensor\n";
      return false;
    }
    io->enableInput(sensor_);
    for (const char* name : {"WHEEL_FL", "WHEEL_FR", "WHEEL_RL", "WHEEL_RR"}) {
      cnoid::Link* wheel = io->body()->joint(name);
      if (!wheel) {
        io->os() << io->body()->modelName() << " has no joint " << name << "\n";
        return false;
      }
      io->enableOutput(wheel, JointVelocity);
      wheels_.push_back(wheel);
    }
    return true;
  }

  bool control() override {
    const double room = std::max(0.0, free_way() - stop_before_);
    const double allowed = std::min(cruise, std::sqrt(2.0 * braking * room));
    speed_ = std::min(allowed, speed_ + pick_up * time_step_);
    for (cnoid::Link* wheel : wheels_) wheel->dq_target() = speed_ / wheel_radius;
    return speed_ > 0.0;
  }

 private:
  /// Distance to the nearest obstacle in the lane, straight ahead [m]; 0 before the first measurement.
  double free_way() const {
    const std::vector<double>& ranges = sensor_->constRangeData();
    if (ranges.empty()) return 0.0;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double yaw = sensor_->minYawAngle() + sensor_->yawStep() * static_cast<double>(i);
      if (std::isfinite(ranges[i]) && std::abs(ranges[i] * std::sin(yaw)) < lane)
        nearest = std::min(nearest, ranges[i] * std::cos(yaw));
    }
    return nearest;
  }

  cnoid::RangeSensor* sensor_ = nullptr;
  std::vector<cnoid::Link*> wheels_;
  double stop_before_ = 0.5;  // [m]
  double time_step_ = 0.0;    // [s]
  double speed_ = 0.0;        // [m/s]
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(RoverController)
