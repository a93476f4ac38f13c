// A Stewart platform, whose six legs bear it by forces that statics gives.

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr int legs = 6;
constexpr double platform_mass = 20.0, lower_mass = 1.0, upper_mass = 0.5;  // [kg]
constexpr double lower_center = 0.15, upper_center = -0.1;                  // from the pivot; from the tip [m]
const Vector3d platform_center{0.05, -0.02, 0.6};                           // of its mass, beside its middle [m]

struct Leg {
  Vector3d pivot, tip;

  explicit Leg(int i) {
    const double side = i % 2 ? 1.0 : -1.0, third = 2.0 * pi / 3.0 * (i / 2);
    const double low = third + side * 0.15, high = third + side * 0.85 + 0.2;  // [rad]; the platform is turned
    pivot = Vector3d(0.4 * std::cos(low), 0.4 * std::sin(low), 0.0);
    tip = Vector3d(0.2 * std::cos(high), 0.2 * std::sin(high), 0.6);
  }
  double length() const { return (tip - pivot).norm(); }
  Vector3d direction() const { return (tip - pivot) / length(); }
};

/// Each leg: a universal joint, and a slider whose end carries the platform in a ball.
WorldBody base() {
  RobotBuilder robot(JointType::fixed);
  WorldBody body;
  std::vector<double> joints;
  for (int i = 0; i < legs; ++i) {
    const Leg leg(i);
    const Vector3d d = leg.direction();
    const std::string name = std::to_string(i);
    const int first = 3 * i + 1;
    robot.add("CROSS" + name, 0, JointType::revolute, Vector3d::UnitX(), inertial(0.05, {1e-4, 1e-4, 1e-4}),
              at(leg.pivot.x(), leg.pivot.y(), leg.pivot.z()));
    robot.add("LOWER" + name, first, JointType::revolute, Vector3d::UnitY(),
              inertial(lower_mass, {1e-2, 1e-2, 1e-3}, {0.0, 0.0, lower_center}));
    robot.add("UPPER" + name, first + 1, JointType::prismatic, Vector3d::UnitZ(),
              inertial(upper_mass, {5e-3, 5e-3, 5e-4}, {0.0, 0.0, upper_center}));
    joints.insert(joints.end(), {std::atan2(-d.y(), d.z()), std::asin(d.x()), leg.length()});
  }
  body = body_of(robot.build());
  body.joints = joints;
  return body;
}

/// The efforts of the sliders. A leg has no moment about its pivot, so that statics of the leg gives the force at its
/// tip across it, and statics of the platform gives those along the legs.
Eigen::Matrix<double, legs, 1> efforts() {
  const Vector3d g{0.0, 0.0, -standard_gravity};
  Eigen::Matrix<double, 6, legs> along;
  Eigen::Matrix<double, 6, 1> load;
  load << platform_mass * g, Vector3d::Zero();
  std::array<Vector3d, legs> directions;
  for (int i = 0; i < legs; ++i) {
    const Leg leg(i);
    const Vector3d d = directions[i] = leg.direction(), arm = leg.tip - platform_center;
    const double moment = lower_center * lower_mass + (leg.length() + upper_center) * upper_mass;  // [kg·m]
    const Vector3d across = -moment / leg.length() * (g - d.dot(g) * d);                           // on the leg
    load.head<3>() -= across;
    load.tail<3>() -= arm.cross(across);
    along.col(i) << d, arm.cross(d);
  }
  const Eigen::Matrix<double, legs, 1> forces = along.fullPivLu().solve(load);  // on the legs
  Eigen::Matrix<double, legs, 1> efforts;
  for (int i = 0; i < legs; ++i) efforts[i] = -forces[i] - upper_mass * directions[i].dot(g);
  return efforts;
}

TEST(DirectSolver, BearsAStewartPlatformAsStaticsDemands) {
  WorldSettings settings;
  WorldBody platform = body_of([] {
    RobotBuilder robot(JointType::free, inertial(platform_mass, {0.3, 0.3, 0.5}));
    return robot.build();
  }());
  platform.name = "Platform";
  platform.position = platform_center;
  for (int i = 0; i < legs; ++i) {
    Connection ball;
    ball.name = "ball" + std::to_string(i);
    ball.type = LoopJoint::Type::spherical;
    ball.link = 3 * i + 3;
    ball.other_body = 1;
    settings.connections.push_back(ball);
  }
  const auto world = make_world(settings, {base(), platform});
  Command command = idle(*world);
  for (int i = 0; i < legs; ++i) command.bodies[0].joints[3 * i + 2] = displacement(joint_of(*world, 3 * i + 2).q);
  world->actuate(command);
  run(*world, 1000);
  const auto expected = efforts();
  for (int i = 0; i < legs; ++i) EXPECT_NEAR(joint_of(*world, 3 * i + 2).u, expected[i], 0.02) << i;
  expect_near(link_of(*world, 0, 1).position, platform_center, 1e-5);
}

}  // namespace
}  // namespace rehearse
