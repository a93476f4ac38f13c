// Stacks of boxes: more contacts than the solvers need, on which ODE's exact solver fails in some steps.

#include <cmath>

#include <gmock/gmock.h>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr double box_side = 0.2;  // [m]

/// A floor and boxes, each by `shift` further than the one below.
std::unique_ptr<World> stacked_boxes(SolverSettings::Method method, int boxes,
                                     const Vector3d& shift = Vector3d::Zero()) {
  std::vector<WorldBody> bodies{floor_body()};
  for (int i = 0; i < boxes; ++i)
    bodies.push_back(free_box("Box" + std::to_string(i), {box_side, box_side, box_side}, 1.0,
                              Vector3d(0, 0, box_side / 2) + i * (box_side * Vector3d::UnitZ() + shift)));
  return make_world(settings_of(method), std::move(bodies));
}

/// How far any box is from its place in a stack that rests.
double farthest_from_place(const World& world, int boxes, const Vector3d& shift) {
  double worst = 0.0;
  for (int i = 0; i < boxes; ++i) {
    const Vector3d place = Vector3d(0, 0, box_side / 2 + i * box_side) + i * Vector3d(shift.x(), shift.y(), 0.0);
    worst = std::max(worst, (link_of(world, 0, i + 1).position - place).norm());
  }
  return worst;
}

class Stacks : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, Stacks, each_solver, solver_name);

TEST_P(Stacks, OfTwoBoxesStandWhereverTheyBegin) {
  for (const Vector3d& shift : {Vector3d(0, 0, 0), Vector3d(0, 0, -1e-4), Vector3d(0, 0, 0.001),
                                Vector3d(0.01, 0, -1e-4), Vector3d(0.01, 0.02, 0), Vector3d(0.05, 0.03, -1e-4)}) {
    SCOPED_TRACE(shift.transpose());
    const auto world = stacked_boxes(GetParam(), 2, shift);
    run(*world, 2000);
    EXPECT_LT(farthest_from_place(*world, 2, shift), 5e-4);
  }
}

TEST_P(Stacks, OfTenBoxesStandForTenSeconds) {
  const auto world = stacked_boxes(GetParam(), 10);
  run(*world, 10'000);
  EXPECT_LT(farthest_from_place(*world, 10, Vector3d::Zero()), 2e-3);
}

/// 500 kg on 1 kg, in cubes of 0.1 m: the light one carries the heavy one.
TEST(DirectSolver, StacksAHeavyCubeOnALightOne) {
  const Vector3d cube = Vector3d::Constant(0.1);
  const auto world = make_world(
      settings_of(SolverSettings::Method::direct),
      {floor_body(), free_box("Light", cube, 1.0, {0, 0, 0.05}), free_box("Heavy", cube, 500.0, {0, 0, 0.15})});
  run(*world, 3000);
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.05, 3e-5);
  EXPECT_NEAR(link_of(*world, 0, 2).position.z(), 0.15, 6e-5);
  EXPECT_LT(link_of(*world, 0, 2).velocity.norm(), 1e-5);  // contacts yield within the surface layer
}

TEST(DirectSolver, StacksTenCubesThatDontCreep) {
  const auto world = stacked_boxes(SolverSettings::Method::direct, 10);
  run(*world, 9000);
  std::vector<Vector3d> places;
  for (int i = 1; i <= 10; ++i) places.push_back(link_of(*world, 0, i).position);
  run(*world, 1000);
  for (int i = 1; i <= 10; ++i)
    EXPECT_LT((link_of(*world, 0, i).position - places[static_cast<std::size_t>(i - 1)]).norm(), 1e-6) << i;
  EXPECT_LT(farthest_from_place(*world, 10, Vector3d::Zero()), 3e-4);
}

TEST(ExactSolver, ReportsTheStepsThatTheQuickSolverMakes) {
  const auto world = stacked_boxes(SolverSettings::Method::exact, 2, {0, 0, -1e-4});
  int failures = 0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(world->step());
    if (world->solver_message().empty()) continue;
    ++failures;
    EXPECT_THAT(world->solver_message(), ::testing::StartsWith("ODE message 3: LCP internal error"));
  }
  EXPECT_GE(failures, 1);
  EXPECT_LT(failures, 10);
}

TEST(ExactSolver, GoesOnWithTheSameBitsAfterAFailure) {
  const auto world = stacked_boxes(SolverSettings::Method::exact, 4, {0, 0, -1e-4});
  const auto begin = world->save();
  run(*world, 50);
  const std::uint64_t end = world->state_hash();
  const auto fresh = stacked_boxes(SolverSettings::Method::exact, 4, {0, 0, -1e-4});
  ASSERT_TRUE(fresh->restore(begin).ok());
  run(*fresh, 50);
  EXPECT_EQ(fresh->state_hash(), end);
}

}  // namespace
}  // namespace rehearse
