#include "walking_pattern.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

namespace rehearse::tool {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double gravity = 9.80665;  // [m/s²]
constexpr int samples_per_frame = 8;
constexpr int max_frames = 5000;
constexpr double max_zmp_error = 0.01;  // [m]
constexpr int corrections = 8;          // of the ZMP by that of the whole body

enum Side { left, right };

constexpr std::array<std::string_view, 6> leg_joints{"LEG_HIP_R", "LEG_HIP_P",   "LEG_HIP_Y",
                                                     "LEG_KNEE",  "LEG_ANKLE_P", "LEG_ANKLE_R"};
constexpr std::array<std::pair<std::string_view, double>, 2> arm_posture{
    {{"ARM_SHOULDER_P", 0.2}, {"ARM_ELBOW", -1.2}}};  // [rad]

std::string joint_name(Side side, std::string_view name) { return (side == left ? "L" : "R") + std::string(name); }

/// The goals of the body at a moment, in the world frame with the floor at z = 0.
struct Goal {
  std::array<Vector3d, 2> ankles;  // by Side [m]
  Vector2d zmp;                    // [m]
};

/// From 0 to 1 with speed and acceleration 0 at both ends: the polynomial of least jerk.
double smooth(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

/// The steps, as a goal for each moment.
class Steps {
 public:
  Steps(const WalkParameters& parameters, double half_width) : parameters_(parameters), half_width_(half_width) {}

  double duration() const { return 2.0 * parameters_.pause + parameters_.steps * parameters_.step_time + closing(); }
  double distance() const { return (parameters_.steps - 1) * parameters_.step_length; }

  Goal at(double time) const {
    const double walking = time - parameters_.pause;
    const int step = std::clamp(static_cast<int>(std::floor(walking / parameters_.step_time)), -1, parameters_.steps);
    const double since = walking - step * parameters_.step_time;  // the step's beginning
    Goal goal;
    for (const Side side : {left, right}) goal.ankles[side] = ankle(side, step);
    if (step < 0) {
      goal.zmp = middle(goal);
      return goal;
    }
    const Goal begin = goal;
    const Side standing = step % 2 == 0 ? right : left;
    const Side swinging = standing == right ? left : right;
    const Vector2d from = step == 0 ? middle(begin) : below(begin, swinging);
    const Vector2d to = step == parameters_.steps ? middle(begin) : below(begin, standing);
    const double shift = step == parameters_.steps ? closing() : parameters_.double_support;
    goal.zmp = from + smooth(since / shift) * (to - from);
    if (step == parameters_.steps) return goal;
    const double swing = std::max(0.0, since - shift) / (parameters_.step_time - shift);
    Vector3d& foot = goal.ankles[swinging];
    foot.x() += smooth(swing) * (ankle(swinging, step + 1).x() - foot.x());
    foot.z() += parameters_.lift * 64.0 * std::pow(swing * (1.0 - swing), 3);  // 1 at half of the time
    return goal;
  }

 private:
  double closing() const { return 2.0 * parameters_.double_support; }  // until the ZMP is between the feet [s]

  /// Where the foot stands when a step begins. Even steps are the left foot's. Step k brings a foot to k + 1 step
  /// lengths, the last one to k.
  Vector3d ankle(Side side, int step) const {
    int before = step - 1;
    if ((before % 2 == 0) != (side == left)) --before;
    const int place = before < 0 ? 0 : std::min(before + 1, parameters_.steps - 1);
    return {place * parameters_.step_length, side == left ? half_width_ : -half_width_, parameters_.ankle_height};
  }
  Vector2d below(const Goal& goal, Side side) const {
    const double inwards = side == left ? -parameters_.zmp_inside : parameters_.zmp_inside;
    return goal.ankles[side].head<2>() + Vector2d(parameters_.zmp_ahead, inwards);
  }
  Vector2d middle(const Goal& goal) const { return 0.5 * (below(goal, left) + below(goal, right)); }

  const WalkParameters& parameters_;
  double half_width_;  // between the feet [m]
};

/// The path of the centre of mass of a linear inverted pendulum, whose capture point c = x + v / omega obeys
/// dc/dt = omega (c - zmp), and x dx/dt = omega (c - x) (J. Englsberger et al., Bipedal walking control based on
/// capture point dynamics, IROS 2011). The first equation is solved backwards in time from rest at the end, the second
/// one forwards from rest at the beginning: so both are stable.
std::vector<Vector2d> centre_path(const std::vector<Vector2d>& zmp, double omega, double dt) {
  const double decay = std::exp(-omega * dt);
  std::vector<Vector2d> capture_points(zmp.size(), zmp.back());
  for (std::size_t i = zmp.size() - 1; i-- > 0;) {
    const Vector2d p = 0.5 * (zmp[i] + zmp[i + 1]);
    capture_points[i] = p + decay * (capture_points[i + 1] - p);
  }
  std::vector<Vector2d> path(zmp.size(), capture_points.front());
  for (std::size_t i = 1; i < zmp.size(); ++i) {
    const Vector2d c = 0.5 * (capture_points[i - 1] + capture_points[i]);
    path[i] = c + decay * (path[i - 1] - c);
  }
  return path;
}

/// SR1's posture for given places of feet and waist.
class Body {
 public:
  explicit Body(const Model& model) : model_(model), posture_(model.joints.size(), 0.0) {
    for (const Side side : {left, right})
      for (std::size_t i = 0; i < leg_joints.size(); ++i) legs_[side][i] = joint_of(side, leg_joints[i]);
    for (const Side side : {left, right})
      for (const auto& [name, angle] : arm_posture) posture_[joint_of(side, name)] = angle;
    thigh_ = -origin(legs_[left][2]).z();
    shank_ = -origin(legs_[left][4]).z();
  }

  double half_width() const { return origin(legs_[left][0]).y(); }
  const std::vector<double>& posture() const { return posture_; }

  /// The links' poses with the centre of mass over `centre`, the waist upright at `height` and the feet flat at their
  /// goals. nullopt: a foot is out of a leg's reach.
  std::optional<std::vector<Isometry3d>> place(const Goal& goal, const Vector2d& centre, double height) {
    Isometry3d waist = Isometry3d::Identity();
    waist.translation() << centre + waist_from_centre_, height;
    for (int i = 0; i < 20; ++i) {
      for (const Side side : {left, right})
        if (!reach(side, goal.ankles[side] - waist.translation() - origin(legs_[side][0]))) return std::nullopt;
      auto links = forward_kinematics(model_, waist, posture_);
      const Vector2d missing = centre - mass_centre(links).head<2>();
      if (missing.norm() < 1e-9) {
        waist_from_centre_ = waist.translation().head<2>() - centre;
        return links;
      }
      waist.translation().head<2>() += missing;
    }
    return std::nullopt;
  }

  Vector3d mass_centre(const std::vector<Isometry3d>& links) const {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < links.size(); ++i)
      sum += model_.links[i].inertial.mass * (links[i] * model_.links[i].inertial.center);
    return sum / model_.mass();
  }

  /// Momentum, then angular momentum about the world's origin, of the motion from one moment to another, `time` apart.
  Eigen::Matrix<double, 6, 1> momentum(const std::vector<Isometry3d>& before, const std::vector<Isometry3d>& after,
                                       double time) const {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < after.size(); ++i) {
      const Inertial& inertial = model_.links[i].inertial;
      const Vector3d from = before[i] * inertial.center, to = after[i] * inertial.center;
      const Vector3d p = inertial.mass / time * (to - from);
      const Eigen::AngleAxisd turn(after[i].linear() * before[i].linear().transpose());
      const Eigen::Matrix3d axes = after[i].linear();
      sum.head<3>() += p;
      sum.tail<3>() +=
          0.5 * (from + to).cross(p) + axes * inertial.inertia * axes.transpose() * (turn.angle() / time * turn.axis());
    }
    return sum;
  }

 private:
  std::size_t joint_of(Side side, std::string_view name) const {
    const int link = model_.find_joint(joint_name(side, name));
    return static_cast<std::size_t>(model_.links[static_cast<std::size_t>(link)].joint.id);
  }
  Vector3d origin(std::size_t joint) const {
    return model_.links[static_cast<std::size_t>(model_.joints[joint])].joint.origin.translation();
  }

  /// Sets a leg's joints so that the ankle is at `ankle`, seen from the hip, and the foot parallel to the waist.
  bool reach(Side side, const Vector3d& ankle) {
    const double down = std::hypot(ankle.y(), ankle.z());
    const double distance = std::hypot(ankle.x(), down);
    const double cosine = (distance * distance - thigh_ * thigh_ - shank_ * shank_) / (2.0 * thigh_ * shank_);
    if (ankle.z() >= 0.0 || std::abs(cosine) > 1.0) return false;
    const double roll = std::atan2(ankle.y(), -ankle.z());
    const double knee = std::acos(cosine);
    const double hip =
        std::atan2(-ankle.x(), down) - std::atan2(shank_ * std::sin(knee), thigh_ + shank_ * std::cos(knee));
    const std::array<double, 6> angles{roll, hip, 0.0, knee, -hip - knee, -roll};
    for (std::size_t i = 0; i < angles.size(); ++i) posture_[legs_[side][i]] = angles[i];
    return true;
  }

  const Model& model_;
  std::array<std::array<std::size_t, 6>, 2> legs_{};  // joint ids, by Side, in the order of leg_joints
  double thigh_ = 0.0, shank_ = 0.0;                  // lengths [m]
  std::vector<double> posture_;                       // by joint id [rad]
  Vector2d waist_from_centre_ = Vector2d::Zero();     // when it was placed last, to begin from [m]
};

/// The ZMP of the whole body at each moment: where the floor's force has no moment about x and y. With momentum P and
/// angular momentum L about the origin: dL/dt = zmp x f + centre x weight, dP/dt = f + weight.
std::vector<Vector2d> whole_body_zmp(const Body& body, const std::vector<std::vector<Isometry3d>>& poses, double mass,
                                     double dt) {
  std::vector<Vector2d> zmp(poses.size());
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    const Eigen::Matrix<double, 6, 1> change =
        (body.momentum(poses[i], poses[i + 1], dt) - body.momentum(poses[i - 1], poses[i], dt)) / dt;
    const Vector3d centre = body.mass_centre(poses[i]);
    const double up = change(2) + mass * gravity;  // force of the floor [N]
    zmp[i] << (mass * gravity * centre.x() - change(4)) / up, (mass * gravity * centre.y() + change(3)) / up;
  }
  zmp.front() = zmp[1];
  zmp.back() = zmp[zmp.size() - 2];
  return zmp;
}

std::optional<Diagnostic> missing_joint(const Model& model) {
  std::vector<std::string_view> names(leg_joints.begin(), leg_joints.end());
  for (const auto& joint : arm_posture) names.push_back(joint.first);
  for (const Side side : {left, right})
    for (const std::string_view name : names)
      if (model.find_joint(joint_name(side, name)) < 0)
        return error(fmt::format("{} has no joint {}", model.name, joint_name(side, name)), "SR1 has it");
  return std::nullopt;
}

std::optional<Diagnostic> mistake_in(const WalkParameters& parameters) {
  if (parameters.steps < 1) return error(fmt::format("steps is {}", parameters.steps), "at least 1");
  if (!(parameters.double_support > 0.0 && parameters.step_time > parameters.double_support))
    return error(
        fmt::format("a step takes {} s, of which {} s on both feet", parameters.step_time, parameters.double_support),
        "time on both feet, and time to swing a foot");
  if (!(parameters.frame_rate > 0.0 && parameters.pause >= 0.0))
    return error(fmt::format("frame rate {}, pause {} s", parameters.frame_rate, parameters.pause),
                 "a frame rate above 0, a pause from 0");
  return std::nullopt;
}

/// The first joint that is beyond its limits, with its displacement.
std::optional<Diagnostic> limit_exceeded(const Model& model, const std::vector<double>& posture, double time) {
  for (const int link : model.joints) {
    const Joint& joint = model.links[static_cast<std::size_t>(link)].joint;
    const double q = posture[static_cast<std::size_t>(joint.id)];
    if (q < joint.lower || q > joint.upper)
      return error(fmt::format("{} is {:.4f} rad at {:.3f} s", joint.name, q, time),
                   fmt::format("from {} to {}", joint.lower, joint.upper));
  }
  return std::nullopt;
}

}  // namespace

Result<WalkingPattern> walking_pattern(const Model& sr1, const WalkParameters& parameters) {
  if (auto missing = missing_joint(sr1)) return *missing;
  if (auto mistake = mistake_in(parameters)) return *mistake;
  Body body(sr1);
  const Steps steps(parameters, body.half_width());
  const double last_frame = std::ceil(steps.duration() * parameters.frame_rate);
  if (!(last_frame < max_frames))
    return error(fmt::format("the pattern has {:.0f} frames", last_frame + 1.0), fmt::format("at most {}", max_frames));
  const double dt = 1.0 / (samples_per_frame * parameters.frame_rate);
  std::vector<Goal> goals;
  std::vector<Vector2d> wanted;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(last_frame) * samples_per_frame; ++i) {
    goals.push_back(steps.at(static_cast<double>(i) * dt));
    wanted.push_back(goals.back().zmp);
  }

  WalkingPattern pattern;
  pattern.duration = last_frame / parameters.frame_rate;
  pattern.distance = steps.distance();
  const auto start = body.place(goals.front(), wanted.front(), parameters.waist_height);
  double height = start ? body.mass_centre(*start).z() : parameters.waist_height;  // of the mass centre [m]
  std::vector<Vector2d> pendulum_zmp = wanted;
  for (int round = 0; round <= corrections; ++round) {
    const auto centres = centre_path(pendulum_zmp, std::sqrt(gravity / height), dt);
    std::vector<std::vector<Isometry3d>> poses;
    pattern.frames.clear();
    for (std::size_t i = 0; i < goals.size(); ++i) {
      auto links = body.place(goals[i], centres[i], parameters.waist_height);
      const double time = static_cast<double>(i) * dt;
      if (!links)
        return error(fmt::format("a foot is out of reach at {:.3f} s", time),
                     "shorter steps, a lower waist, or less lift");
      if (auto mistake = limit_exceeded(sr1, body.posture(), time)) return *mistake;
      poses.push_back(*std::move(links));
      if (i % samples_per_frame == 0) pattern.frames.push_back(body.posture());
    }
    const auto zmp = whole_body_zmp(body, poses, sr1.mass(), dt);
    pattern.zmp_error = 0.0;
    for (std::size_t i = 0; i < zmp.size(); ++i) {
      const Vector2d error = wanted[i] - zmp[i];
      pattern.zmp_error = std::max(pattern.zmp_error, error.norm());
      pendulum_zmp[i] += error;
    }
  }
  if (!(pattern.zmp_error < max_zmp_error))
    return error(fmt::format("the whole body's ZMP is {:.3f} m from the wanted one", pattern.zmp_error),
                 "slower steps");
  return pattern;
}

std::string motion_text(const WalkingPattern& pattern, const WalkParameters& parameters) {
  std::string text = fmt::format(
      "# SR1 walks {:.2f} m ahead in {} steps, a pattern of tools/make_walk.\n"
      "# Steps of {} m in {} s, of which {} s on both feet; feet are lifted by {} m, the waist is at {} m. The whole\n"
      "# body's zero moment point is at most {:.4f} m from the wanted one, {} m ahead of the standing foot's ankle and "
      "{} m\n# inside of it. By joint id [rad]: right leg (hip roll, pitch, yaw; knee; ankle pitch, roll), right arm "
      "(7), left\n# leg (6), left arm (7), waist (3).\n"
      "type: CompositeSeq\ncontent: BodyMotion\nformat_version: 4\nframe_rate: {}\nnum_frames: {}\ncomponents:\n"
      "  - type: MultiValueSeq\n    content: JointDisplacement\n    num_parts: {}\n    frames:\n",
      pattern.distance, parameters.steps, parameters.step_length, parameters.step_time, parameters.double_support,
      parameters.lift, parameters.waist_height, pattern.zmp_error, parameters.zmp_ahead, parameters.zmp_inside,
      parameters.frame_rate, pattern.frames.size(), pattern.frames.front().size());
  for (const std::vector<double>& frame : pattern.frames) {
    std::vector<double> rounded;  // to 1e-5 rad; + 0.0 turns -0 into 0
    for (const double q : frame) rounded.push_back(std::round(q * 1e5) / 1e5 + 0.0);
    text += fmt::format("      - [ {} ]\n", fmt::join(rounded, ", "));
  }
  return text;
}

}  // namespace rehearse::tool
