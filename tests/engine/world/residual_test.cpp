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

}  // namespace
}  // namespace rehearse
