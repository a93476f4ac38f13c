// Forces from outside: pushes at a point, and controllers' external wrenches.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Wrenches : public EachSolver {
 protected:
  /// A box of 2 kg and 0.5 kg·m² about every axis, 1 m along x.
  std::unique_ptr<World> world_with_box(const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) const {
    WorldBody body = body_of(RobotBuilder(JointType::free, inertial(2.0, {0.5, 0.5, 0.5})).build(), {1, 0, 0});
    body.rotation = rotation;
    return make_world(weightless(GetParam()), {body});
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, Wrenches, each_solver, solver_name);

TEST_P(Wrenches, APushAtTheCentreOnlyMoves) {
  const auto world = world_with_box();
  world->push(0, 0, {4, 0, 0}, Vector3d::Zero(), Vector3d::Zero());
  run(*world, 1);
  expect_near(link_of(*world).acceleration, Vector3d(2, 0, 0), 1e-9);
  expect_near(link_of(*world).angular_acceleration, Vector3d::Zero(), 1e-9);
}

TEST_P(Wrenches, APushBesideTheCentreTurnsToo) {
  const auto world = world_with_box();
  world->push(0, 0, {4, 0, 0}, {0, 0.25, 0}, Vector3d::Zero());
  run(*world, 1);
  expect_near(link_of(*world).acceleration, Vector3d(2, 0, 0), 1e-9);
  expect_near(link_of(*world).angular_acceleration, Vector3d(0, 0, -2), 1e-9);  // (0, 0.25, 0) x (4, 0, 0) over 0.5
}

TEST_P(Wrenches, ThePointOfAPushIsInTheLinksFrameAndTheForceInTheWorlds) {
  const auto world = world_with_box(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ())));
  world->push(0, 0, {4, 0, 0}, {0.25, 0, 0}, Vector3d::Zero());  // the point is at world +y of the centre
  run(*world, 1);
  expect_near(link_of(*world).acceleration, Vector3d(2, 0, 0), 1e-9);
  expect_near(link_of(*world).angular_acceleration, Vector3d(0, 0, -2), 1e-9);
}

TEST_P(Wrenches, PushesAddUpAndLastOneStep) {
  const auto world = world_with_box();
  world->push(0, 0, {4, 0, 0}, Vector3d::Zero(), Vector3d::Zero());
  world->push(0, 0, {0, 2, 0}, Vector3d::Zero(), {0, 0, 1});
  run(*world, 1);
  expect_near(link_of(*world).acceleration, Vector3d(2, 1, 0), 1e-9);
  EXPECT_NEAR(link_of(*world).angular_acceleration.z(), 2.0, 1e-9);
  run(*world, 1);
  expect_near(link_of(*world).acceleration, Vector3d::Zero(), 1e-9);
}

TEST_P(Wrenches, AnExternalWrenchsTorqueIsAboutTheWorldsOrigin) {
  const auto world = world_with_box();
  Command command = idle(*world);
  command.bodies[0].external[0] = {{0, 3, 0}, Vector3d(1, 0, 0).cross(Vector3d(0, 3, 0))};  // through the centre
  world->actuate(command);
  run(*world, 1);
  expect_near(link_of(*world).acceleration, Vector3d(0, 1.5, 0), 1e-9);
  expect_near(link_of(*world).angular_acceleration, Vector3d::Zero(), 1e-9);

  command.bodies[0].external[0] = {{0, 3, 0}, Vector3d::Zero()};  // through the origin, 1 m beside the centre
  world->actuate(command);
  run(*world, 1);
  EXPECT_NEAR(link_of(*world).angular_acceleration.z(), -3.0 / 0.5, 1e-2);
}

TEST_P(Wrenches, AnExternalWrenchActsDuringOneStep) {
  const auto world = world_with_box();
  Command command = idle(*world);
  command.bodies[0].external[0].force = {2, 0, 0};
  world->actuate(command);
  run(*world, 2);
  EXPECT_NEAR(link_of(*world).velocity.x(), 0.001, 1e-12);
}

TEST_P(Wrenches, APushOnAChildActsThere) {
  RobotBuilder robot(JointType::fixed);
  robot.add("ARM", 0, JointType::revolute, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.1}), at(2, 0, 0));
  const auto world = make_world(weightless(GetParam()), {body_of(robot.build())});
  world->push(0, 1, {0, 1, 0}, {0.5, 0, 0}, Vector3d::Zero());
  run(*world, 1);
  EXPECT_NEAR(joint_of(*world).ddq, 0.5 / 0.1, 1e-3);
}

}  // namespace
}  // namespace rehearse
