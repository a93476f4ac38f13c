// The quick solver's residual, and iterating until it is small.

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
  solver.iterations = iterations;
  return solver;
}

TEST(TheResidual, FallsWithTheIterations) {
  const Residual few = held_arm(iterating(5), 200)->residual();
  const Residual many = held_arm(iterating(2000), 200)->residual();
  EXPECT_EQ(few.iterations, 5);
  EXPECT_EQ(few.body, 0);
  EXPECT_GT(few.link, 0);
  EXPECT_GT(few.share, 0.05);
  EXPECT_LT(many.share, 0.003);
}

TEST(TheResidual, OfTheExactSolverIsThatOfRounding) {
  SolverSettings exact;
  exact.method = SolverSettings::Method::exact;
  const Residual residual = held_arm(exact, 200)->residual();
  EXPECT_EQ(residual.iterations, 0);
  EXPECT_LT(residual.share, 1e-6);
}

TEST(TheResidual, IsThatOfNoBodyWithoutJoints) {
  const auto world = make_world({}, {floor_body(), free_box("Box", Vector3d::Constant(0.2), 1.0, {0.0, 0.0, 0.1})});
  run(*world, 10);
  EXPECT_EQ(world->residual().body, -1);
}

TEST(ASolverThatConverges, IteratesOnlyWhereItIsNeeded) {
  SolverSettings solver = iterating(20);
  solver.converge = true;
  const auto loaded = held_arm(solver, 200);
  EXPECT_GT(loaded->residual().iterations, 20);
  EXPECT_LE(loaded->residual().share, 0.003);
  EXPECT_NEAR(joint_of(*loaded, 0).q, 0.0, 1e-4);

  WorldSettings weightless;
  weightless.gravity.setZero();
  weightless.solver = solver;
  const auto idle_arm = make_world(weightless, {body_of(loaded_arm())});
  run(*idle_arm, 10);
  EXPECT_EQ(idle_arm->residual().iterations, 20);
}

TEST(ASolverThatConverges, RepeatsARestoredStateBitByBit) {
  SolverSettings solver = iterating(20);
  solver.converge = true;
  const auto world = held_arm(solver, 100);
  const auto state = world->save();
  run(*world, 100);
  const std::uint64_t end = world->state_hash();
  ASSERT_TRUE(world->restore(state).ok());
  run(*world, 100);
  EXPECT_EQ(world->state_hash(), end);
}

}  // namespace
}  // namespace rehearse
