// The residual of ODE's solvers.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

std::unique_ptr<World> held_arm(const SolverSettings& solver, int ticks) {
  WorldSettings settings;
  settings.solver = solver;
  auto world = make_world(settings, {body_of(loaded_arm())});
  Command command = idle(*world);
  for (JointCommand& joint : command.bodies[0].joints) joint = displacement(0.0);
  world->actuate(command);
  run(*world, ticks);
  return world;
}

SolverSettings iterating(int iterations) {
  SolverSettings solver;
  solver.method = SolverSettings::Method::quick;
  solver.iterations = iterations;
  return solver;
}

TEST(TheResidual, FallsWithTheIterations) {
  const Residual few = held_arm(iterating(5), 200)->residual();
  const Residual many = held_arm(iterating(2000), 200)->residual();
  EXPECT_EQ(few.iterations, 5);
  EXPECT_EQ(few.joint.body, 0);
  EXPECT_GT(few.joint.link, 0);
  EXPECT_GT(few.share, 0.05);
  EXPECT_LT(many.share, 0.003);
}

/// The force that is missing at a link of 60 g is small.
TEST(TheResidual, OfALightLinkIsTheVelocityThatItsDriveMisses) {
  RobotBuilder robot(JointType::fixed);
  robot.add("CROSS", 0, JointType::revolute, Vector3d::UnitY(), inertial(0.06, Vector3d::Constant(1e-5)));
  robot.add("BODY", 1, JointType::revolute, Vector3d::UnitX(), inertial(40.0, {4.0, 4.0, 1.0}, {0.02, 0.0, 0.9}));
  const auto residual_of = [&robot](const SolverSettings& solver) {
    WorldSettings settings;
    settings.solver = solver;
    auto world = make_world(settings, {body_of(robot.build())});
    Command command = idle(*world);
    for (JointCommand& joint : command.bodies[0].joints) joint = displacement(0.0);
    world->actuate(command);
    Residual worst;
    for (int tick = 0; tick < 200; ++tick) {
      run(*world, 1);
      if (world->residual().velocity >= worst.velocity) worst = world->residual();
    }
    return worst;
  };
  const Residual quick = residual_of(iterating(50));
  EXPECT_EQ(quick.missed.body, 0);
  EXPECT_GT(quick.velocity, 1.0);
  EXPECT_LT(quick.share, 0.15);
  EXPECT_EQ(residual_of({}).missed.body, -1);
}

TEST(TheResidual, OfTheExactSolverIsThatOfRounding) {
  SolverSettings exact;
  exact.method = SolverSettings::Method::exact;
  const Residual residual = held_arm(exact, 200)->residual();
  EXPECT_EQ(residual.iterations, 0);
  EXPECT_LT(residual.share, 1e-6);
}

TEST(TheResidual, IsNotMeasuredWhereTheExactSolverSolved) {
  SolverSettings exact;
  exact.method = SolverSettings::Method::exact;
  EXPECT_EQ(held_arm(exact, 20)->residual().joint.body, -1);
}

/// A robot that swings beside a crowd of boxes on a plate, which is left to the quick solver.
TEST(TheResidual, LeavesOutJointsThatTheDirectSolverSolved) {
  std::vector<WorldBody> bodies{floor_body(), body_of(loaded_arm(), {0.0, 5.0, 3.0}),
                                free_box("Plate", {3.0, 3.0, 0.02}, 5.0, {0.0, 0.0, 0.0099})};
  for (int i = 0; i < 30; ++i)
    bodies.push_back(free_box("Box" + std::to_string(i), Vector3d::Constant(0.1), 0.1,
                              {0.3 * (i % 6) - 0.75, 0.3 * (i / 6) - 0.6, 0.0698}));
  const auto world = make_world({}, std::move(bodies));
  for (int tick = 0; tick < 100; ++tick) {
    ASSERT_TRUE(world->step());
    ASSERT_EQ(world->residual().share, 0.0);
  }
  EXPECT_EQ(world->unsolved().contacts, 124);
  EXPECT_LT(world->unsolved().contact_share, 0.15);
}

/// 500 kg on one of 16 boxes of 1 kg under it, which is more than the direct solver takes.
TEST(TheResidual, IsMeasuredAtContactsThatAreLeftToTheQuickSolver) {
  std::vector<WorldBody> bodies{floor_body(), free_box("Heavy", {0.4, 0.4, 0.1}, 500.0, {0.0, 0.0, 0.15})};
  for (int i = 0; i < 16; ++i)
    bodies.push_back(free_box("Box" + std::to_string(i), {0.08, 0.08, 0.1}, 1.0,
                              {0.1 * (i % 4) - 0.15, 0.1 * (i / 4) - 0.15, 0.05}));
  const auto world = make_world({}, std::move(bodies));
  run(*world, 100);
  EXPECT_GT(world->unsolved().contacts, 60);
  EXPECT_GT(world->unsolved().contact_share, 0.15);
}

TEST(TheResidual, IsThatOfNoBodyWithoutJoints) {
  const auto world = make_world({}, {floor_body(), free_box("Box", Vector3d::Constant(0.2), 1.0, {0.0, 0.0, 0.1})});
  run(*world, 10);
  EXPECT_EQ(world->residual().joint.body, -1);
}

}  // namespace
}  // namespace rehearse
