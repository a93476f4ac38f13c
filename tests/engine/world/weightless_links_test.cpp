// Links on which gravity doesn't act.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class WeightlessLinks : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, WeightlessLinks, each_solver, solver_name);

WorldBody without_weight(WorldBody body, const std::vector<std::size_t>& links) {
  Model model = *body.model;
  for (const std::size_t link : links) model.links[link].has_weight = false;
  body.model = std::make_shared<const Model>(std::move(model));
  return body;
}

TEST_P(WeightlessLinks, Float) {
  const auto world = make_world(settings(), {without_weight(free_box("Box", {1, 1, 1}, 3.0, {0, 0, 1}), {0})});
  run(*world, 500);
  EXPECT_EQ(link_of(*world).position, Vector3d(0, 0, 1));
  EXPECT_EQ(link_of(*world).velocity, Vector3d::Zero());
}

/// A dumbbell along x, 1 kg at the origin and 3 kg at x = 1 m, connected by a fixed joint.
WorldBody dumbbell() {
  RobotBuilder robot(JointType::free, inertial(1.0, {0.1, 0.1, 0.1}));
  robot.add("FAR", 0, JointType::fixed, Vector3d::UnitX(), inertial(3.0, {0.1, 0.1, 0.1}), at(1, 0, 0));
  return body_of(robot.build(), {0, 0, 5});
}

TEST_P(WeightlessLinks, HoldUpOnlyTheirPartOfARigidBody) {
  const auto world = make_world(settings(), {without_weight(dumbbell(), {1})});
  run(*world, 1);
  // 1 kg pulls at 4 kg, 0.75 m beside their centre: about y, I = 0.2 + 1 * 0.75² + 3 * 0.25²
  const double down = 1.0 * standard_gravity / 4.0;
  const double turn = -1.0 * standard_gravity * 0.75 / (0.2 + 0.5625 + 0.1875);  // its near end falls: about -y
  const LinkReading& near = link_of(*world);
  EXPECT_NEAR(near.angular_acceleration.y(), turn, 1e-6);
  EXPECT_NEAR(near.acceleration.z(), -down + 0.75 * turn, 1e-6);
}

TEST_P(WeightlessLinks, OfAWholeRigidBodyMakeItFloat) {
  const auto world = make_world(settings(), {without_weight(dumbbell(), {0, 1})});
  run(*world, 300);
  EXPECT_EQ(link_of(*world).position, Vector3d(0, 0, 5));
}

TEST_P(WeightlessLinks, AreNotFeltByAForceSensor) {
  for (const bool weightless : {false, true}) {
    RobotBuilder robot(JointType::fixed);
    robot.add("ARM", 0, JointType::prismatic, Vector3d::UnitX(), inertial(2.0, {0.1, 0.1, 0.1}));
    robot.add("HAND", 1, JointType::fixed, Vector3d::UnitX(), inertial(1.5, {0.1, 0.1, 0.1}), at(0, 0.5, 0));
    robot.add_device("Force", 1, ForceSensor{});
    WorldBody body = body_of(robot.build());
    if (weightless) body = without_weight(body, {2});
    const auto world = make_world(settings(), {body});
    run(*world, 100);
    EXPECT_NEAR(device_of(*world, 0)[2], -(weightless ? 2.0 : 3.5) * standard_gravity, 1e-3);
    EXPECT_NEAR(device_of(*world, 0)[3], -(weightless ? 0.0 : 1.5 * 0.5) * standard_gravity, 1e-3);
  }
}

}  // namespace
}  // namespace rehearse
