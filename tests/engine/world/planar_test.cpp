// Root links that stay in the plane of x and z.
#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Planar : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, Planar, each_solver, solver_name);

WorldBody thrown_box() {
  WorldBody box = free_box("Box", {0.2, 0.3, 0.4}, 2.0, {0.0, 0.5, 1.0});
  box.linear_velocity = {0.3, 0.2, 0.1};
  box.angular_velocity = {1.0, 2.0, 3.0};
  box.planar = true;
  return box;
}

TEST_P(Planar, MoveFreelyInThePlaneOnly) {
  const auto world = make_world(weightless(GetParam()), {thrown_box()});
  run(*world, 1000);
  const LinkReading& link = link_of(*world, 0);
  EXPECT_NEAR(link.position.x(), 0.3, 1e-6);
  EXPECT_NEAR(link.position.y(), 0.5, 1e-6);
  EXPECT_NEAR(link.position.z(), 1.1, 1e-6);
  constexpr double spin_lost = 5e-3;  // the torque that ends the other spins acts on a tumbling body [rad/s]
  expect_near(link.angular_velocity, Vector3d(0.0, 2.0, 0.0), spin_lost);
  EXPECT_NEAR(link.angular_velocity.x(), 0.0, 1e-6);
  EXPECT_NEAR(link.angular_velocity.z(), 0.0, 1e-6);
  expect_near(link.rotation * Vector3d::UnitY(), Vector3d::UnitY(), 1e-6);
  EXPECT_NEAR(Eigen::AngleAxisd(link.rotation).angle(), 2.0, spin_lost);
}

/// A push from the side, and one that would tip the box over: without the plane it falls.
TEST_P(Planar, WithstandPushesFromTheSide) {
  for (const bool planar : {true, false}) {
    WorldBody box = free_box("Box", {0.4, 0.1, 1.0}, 5.0, {0.0, 0.0, 0.5 - 1e-6});
    box.planar = planar;
    const auto world = make_world(settings(), {floor_body(), box});
    for (int tick = 0; tick < 1000; ++tick) {
      if (tick < 200) world->push(1, 0, {0.0, 40.0, 0.0}, {0.0, 0.0, 0.4}, Vector3d::Zero());
      run(*world, 1);
    }
    const LinkReading& link = world->sense().bodies[1].links[0];
    EXPECT_EQ(std::abs(link.position.y()) < 1e-3, planar);
    EXPECT_EQ(link.position.z() > 0.49, planar);
  }
}

TEST_P(Planar, RepeatFromASavedState) {
  const auto world = make_world(settings(), {floor_body(), thrown_box()});
  run(*world, 300);
  const auto state = world->save();
  run(*world, 300);
  const std::uint64_t end = world->state_hash();
  ASSERT_TRUE(world->restore(state).ok());
  run(*world, 300);
  EXPECT_EQ(world->state_hash(), end);
}

}  // namespace
}  // namespace rehearse
