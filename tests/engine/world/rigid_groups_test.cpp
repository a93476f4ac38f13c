// Links behind fixed joints move as one body with their parent.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class RigidGroups : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, RigidGroups, each_solver, solver_name);

Eigen::Isometry3d tilted_mount() {
  Eigen::Isometry3d mount = at(0.3, 0.1, -0.2);
  mount.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return mount;
}

/// A free link with a second one fixed to it, tilted.
std::shared_ptr<const Model> two_links() {
  RobotBuilder robot(JointType::free, inertial(2.0, {0.1, 0.2, 0.3}));
  robot.add("TOOL", 0, JointType::fixed, Vector3d::UnitX(), inertial(1.0, {0.01, 0.02, 0.03}, {0.05, 0, 0}),
            tilted_mount());
  return robot.build();
}

/// The same body as one link; mass, centre and inertia summed by hand.
std::shared_ptr<const Model> one_link() {
  const Eigen::Matrix3d turn = tilted_mount().linear();
  const Vector3d tool = tilted_mount() * Vector3d(0.05, 0, 0);
  const Vector3d center = tool / 3.0;
  const auto moved = [](double mass, const Vector3d& by) -> Eigen::Matrix3d {
    return mass * (by.squaredNorm() * Eigen::Matrix3d::Identity() - by * by.transpose());
  };
  Inertial total;
  total.mass = 3.0;
  total.center = center;
  total.inertia = Eigen::Matrix3d(Vector3d(0.1, 0.2, 0.3).asDiagonal()) + moved(2.0, center) +
                  turn * Vector3d(0.01, 0.02, 0.03).asDiagonal() * turn.transpose() + moved(1.0, tool - center);
  return RobotBuilder(JointType::free, total).build();
}

TEST_P(RigidGroups, MoveAsOneLinkOfTheSummedInertia) {
  const auto grouped = make_world(settings(), {body_of(two_links())});
  const auto single = make_world(settings(), {body_of(one_link())});
  for (int i = 0; i < 500; ++i) {
    for (World* world : {grouped.get(), single.get()}) {
      world->push(0, 0, {3, -2, 5}, {0.1, 0.2, 0}, {0.3, 0.1, -0.2});
      ASSERT_TRUE(world->step());
    }
  }
  expect_near(link_of(*grouped).position, link_of(*single).position, 1e-9);
  expect_near(link_of(*grouped).velocity, link_of(*single).velocity, 1e-9);
  expect_near(link_of(*grouped).rotation.coeffs(), link_of(*single).rotation.coeffs(), 1e-9);
  EXPECT_GT(link_of(*grouped).angular_velocity.norm(), 0.1);
}

TEST_P(RigidGroups, EachLinkKeepsItsOwnFrame) {
  const auto world = make_world(settings(), {body_of(two_links())});
  LinkReading before;
  for (int i = 0; i < 500; ++i) {
    before = link_of(*world, 0);
    world->push(0, 0, Vector3d::Zero(), Vector3d::Zero(), {0.3, 0.1, -0.2});
    ASSERT_TRUE(world->step());
  }
  const LinkReading& root = link_of(*world, 0);
  const LinkReading& tool = link_of(*world, 1);
  const Vector3d lever = root.rotation * tilted_mount().translation();
  const Vector3d w = root.angular_velocity;
  EXPECT_GT(w.norm(), 0.1);
  expect_near(tool.position, root.position + lever, 1e-12);
  EXPECT_NEAR(tool.rotation.angularDistance(root.rotation * Eigen::Quaterniond(tilted_mount().linear())), 0.0, 1e-7);
  expect_near(tool.velocity, root.velocity + w.cross(lever), 1e-12);
  const Vector3d lever_before = before.rotation * tilted_mount().translation();  // accelerations are those of then
  const Vector3d turning = before.angular_velocity.cross(before.angular_velocity.cross(lever_before));
  expect_near(tool.acceleration, root.acceleration + root.angular_acceleration.cross(lever_before) + turning, 1e-9);
}

TEST_P(RigidGroups, AShapeOfAFixedLinkTouchesTheFloor) {
  RobotBuilder robot(JointType::free, inertial(1.0, {0.01, 0.01, 0.01}));
  robot.add("FOOT", 0, JointType::fixed, Vector3d::UnitX(), inertial(1.0, {0.01, 0.01, 0.01}), at(0, 0, -0.3));
  robot.add_collision(1, Box{{0.4, 0.4, 0.1}});
  const auto world = make_world(settings(), {body_of(robot.build(), {0, 0, 0.36}), floor_body()});
  run(*world, 1000);
  EXPECT_NEAR(link_of(*world, 0).position.z(), 0.35, 1e-3);
}

TEST_P(RigidGroups, LinksFixedToAFixedBaseNeverMove) {
  RobotBuilder robot(JointType::fixed);
  robot.add("POST", 0, JointType::fixed, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}), at(0, 0, 2));
  robot.add("ARM", 1, JointType::revolute, Vector3d::UnitY(), inertial(1.0, {0.1, 0.1, 0.1}, {0.5, 0, 0}), at(0, 0, 1));
  const auto world = make_world(settings(), {body_of(robot.build(), {1, 0, 0})});
  run(*world, 300);
  EXPECT_EQ(link_of(*world, 1).position, Vector3d(1, 0, 2));
  EXPECT_EQ(link_of(*world, 1).velocity, Vector3d::Zero());
  expect_near(link_of(*world, 2).position, Vector3d(1, 0, 3), 1e-4);
  EXPECT_GT(joint_of(*world).q, 0.1);  // the arm fell
}

TEST_P(RigidGroups, ABodyThatTheScenarioFixesNeverMoves) {
  WorldBody box = free_box("Box", {0.1, 0.1, 0.1}, 1.0, {0, 0, 1});
  box.fixed = true;
  const auto world = make_world(settings(), {box});
  world->push(0, 0, {100, 0, 0}, Vector3d::Zero(), {0, 0, 10});
  run(*world, 10);
  EXPECT_EQ(link_of(*world).position, Vector3d(0, 0, 1));
  EXPECT_EQ(link_of(*world).rotation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

}  // namespace
}  // namespace rehearse
