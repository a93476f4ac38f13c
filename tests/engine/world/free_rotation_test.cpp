// Free rotation: energy and angular momentum of a tumbling body.

#include <algorithm>
#include <cmath>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class FreeRotation : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, FreeRotation, each_solver, solver_name);

struct Rotation {
  Vector3d momentum;  // [N·m·s]
  double energy;      // [J]
};

Rotation rotation_of(const World& world, const Vector3d& moments) {
  const Eigen::Matrix3d axes = link_of(world).rotation.toRotationMatrix();
  const Vector3d spin = axes.transpose() * link_of(world).angular_velocity;
  const Vector3d momentum = moments.cwiseProduct(spin);
  return {axes * momentum, 0.5 * spin.dot(momentum)};
}

TEST_P(FreeRotation, KeepsEnergyAndAngularMomentumOfATumblingBody) {
  const Vector3d moments(0.01, 0.02, 0.025);
  for (const Vector3d& spin : {Vector3d(0.02, 5.0, 0.01), Vector3d(1.0, 10.0, 2.0), Vector3d(20.0, 1.0, 20.0)}) {
    SCOPED_TRACE(spin.transpose());
    RobotBuilder robot(JointType::free, inertial(1.0, moments));
    const auto world = make_world(weightless(GetParam()), {body_of(robot.build())});
    world->push(0, 0, Vector3d::Zero(), Vector3d::Zero(), moments.cwiseProduct(spin) / 0.001);
    run(*world, 1);
    const Rotation first = rotation_of(*world, moments);
    double turned = 0.0;
    for (int i = 0; i < 10'000; ++i) {
      ASSERT_TRUE(world->step());
      const Rotation now = rotation_of(*world, moments);
      ASSERT_NEAR(now.energy, first.energy, 1e-3 * first.energy) << "after " << i << " steps";
      ASSERT_NEAR(now.momentum.norm(), first.momentum.norm(), 1e-9 * first.momentum.norm());
      // the angular velocity is that in the middle of the step, the orientation that at its end
      ASSERT_LT((now.momentum - first.momentum).norm(), 0.001 * spin.norm() * first.momentum.norm());
      turned = std::max(turned, std::acos(std::clamp(link_of(*world).rotation.toRotationMatrix()(1, 1), -1.0, 1.0)));
    }
    EXPECT_GT(turned, 2.5);  // the middle axis turned over
  }
}

TEST_P(FreeRotation, OfABodyTooFastForTheStepStaysFinite) {
  const Vector3d moments(0.001, 0.02, 0.0205);
  RobotBuilder robot(JointType::free, inertial(1.0, moments));
  const auto world = make_world(weightless(GetParam()), {body_of(robot.build())});
  world->push(0, 0, Vector3d::Zero(), Vector3d::Zero(), Vector3d(10.0, 2000.0, 3000.0).cwiseProduct(moments) / 0.001);
  run(*world, 1);
  const double energy = rotation_of(*world, moments).energy;
  run(*world, 1000);
  EXPECT_LT(rotation_of(*world, moments).energy, 1.1 * energy);
}

}  // namespace
}  // namespace rehearse
