// Drives a scout through a room without touching anything: towards the most free space in its laser scan, and around
// low obstacles that only its depth camera sees.
//
// The area ahead is divided into sectors. The free distance of a sector is that of its nearest obstacle, by laser or by
// camera; the best sector is wide and needs little turning. Camera points above the floor count as obstacles; the
// height of a point follows from the camera's pose on the robot.
//
// Options: the cruising speed [m/s]; default 0.5.

#include <algorithm>
#include <array>
#include <cmath>
#include <cnoid/RangeCamera>
#include <cnoid/RangeSensor>
#include <cnoid/SimpleController>
#include <string>

namespace {

constexpr double wheel_radius = 0.1;  // [m]
constexpr double track = 0.32;        // between the wheels [m]
constexpr double axle = 0.1;          // above the floor [m]
constexpr double lowest = 0.03;       // points that are higher above the floor are obstacles [m]
constexpr double widest = 1.3;        // of the sectors, to either side [rad]
constexpr double keep_away = 0.35;    // distance from obstacles ahead [m]
constexpr double horizon = 3.0;       // a larger distance counts as this [m]
constexpr int sectors = 13;

class ScoutController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    const auto options = io->options();
    if (!options.empty()) cruise_ = std::stod(options[0]);
    time_step_ = io->timeStep();
    laser_ = io->body()->findDevice<cnoid::RangeSensor>();
    camera_ = io->body()->findDevice<cnoid::RangeCamera>();
    left_ = io->body()->joint("LEFT_WHEEL");
    right_ = io->body()->joint("RIGHT_WHEEL");
    if (!laser_ || !camera_ || !left_ || !right_) {
      io->os() << io->body()->modelName() << " lacks a laser, a depth camera, LEFT_WHEEL or RIGHT_WHEEL\n";
      return false;
    }
    io->enableInput(laser_);
    io->enableInput(camera_);
    io->enableOutput(left_, JointVelocity);
    io->enableOutput(right_, JointVelocity);
    return true;
  }

  bool control() override {
    if (laser_->constRangeData().empty()) return true;  // no measurement yet
    std::array<double, sectors> free = laser_space();
    limit_by_camera(free);
    const int best = best_sector(free);
    const double ahead = *std::min_element(free.begin() + sectors / 2 - 1, free.begin() + sectors / 2 + 2);
    const double speed = std::clamp(0.8 * (ahead - keep_away), 0.0, cruise_);  // [m/s]
    const double turn = std::clamp(2.0 * angle_of(best), -1.5, 1.5);           // [rad/s]
    approach(speed_, speed, 1.0 * time_step_);
    approach(turn_, turn, 6.0 * time_step_);
    left_->dq_target() = (speed_ - turn_ * track / 2.0) / wheel_radius;
    right_->dq_target() = (speed_ + turn_ * track / 2.0) / wheel_radius;
    return true;
  }

 private:
  /// Angle of a sector's middle, left is positive [rad].
  static double angle_of(int sector) { return widest * (2.0 * sector / (sectors - 1) - 1.0); }

  static int sector_of(double angle) {
    const int sector = static_cast<int>(std::lround((angle / widest + 1.0) / 2.0 * (sectors - 1)));
    return sector >= 0 && sector < sectors ? sector : -1;
  }

  static void approach(double& value, double wanted, double step) { value += std::clamp(wanted - value, -step, step); }

  /// Distance of the nearest obstacle in each sector [m].
  std::array<double, sectors> laser_space() const {
    std::array<double, sectors> free;
    free.fill(horizon);
    const auto& ranges = laser_->constRangeData();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const int sector = sector_of(laser_->minYawAngle() + laser_->yawStep() * static_cast<double>(i));
      if (sector >= 0) free[sector] = std::min(free[sector], ranges[i]);
    }
    return free;
  }

  /// Reduces the distances by obstacles on the floor that are below the laser's height.
  void limit_by_camera(std::array<double, sectors>& free) const {
    const cnoid::Isometry3 in_base = camera_->link()->offsetPosition() * camera_->T_local();
    for (const cnoid::Vector3f& point : camera_->constPoints()) {
      if (!std::isfinite(point.z())) continue;
      const cnoid::Vector3 place = in_base * point.cast<double>();
      if (place.z() + axle < lowest) continue;
      const int sector = sector_of(std::atan2(place.y(), place.x()));
      if (sector >= 0) free[sector] = std::min(free[sector], std::hypot(place.x(), place.y()));
    }
  }

  /// Index of the sector with the most space in it and beside it; of equal sectors the one with the least turning.
  int best_sector(const std::array<double, sectors>& free) {
    int best = last_best_;
    double most = -1.0;
    for (int i = 0; i < sectors; ++i) {
      double space = free[i];
      if (i > 0) space = std::min(space, free[i - 1] + 0.3);
      if (i + 1 < sectors) space = std::min(space, free[i + 1] + 0.3);
      const double value = space - 0.5 * std::abs(angle_of(i)) - 0.1 * std::abs(i - last_best_);
      if (value <= most) continue;
      most = value;
      best = i;
    }
    return last_best_ = best;
  }

  cnoid::RangeSensor* laser_ = nullptr;
  cnoid::RangeCamera* camera_ = nullptr;
  cnoid::Link* left_ = nullptr;
  cnoid::Link* right_ = nullptr;
  double cruise_ = 0.5;     // [m/s]
  double time_step_ = 0.0;  // [s]
  double speed_ = 0.0;      // [m/s]
  double turn_ = 0.0;       // [rad/s]
  int last_best_ = sectors / 2;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ScoutController)
