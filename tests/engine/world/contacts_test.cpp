// Contacts: they support, they have friction, and their order depends on the scenario alone.

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

class Contacts : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, Contacts, each_solver, solver_name);

WorldBody tumbling_box(const Vector3d& position) {
  WorldBody box = free_box("Box", {0.2, 0.2, 0.2}, 2.0, position);
  box.rotation = Eigen::AngleAxisd(0.3, Vector3d(1, 2, 0).normalized());
  return box;
}

std::vector<WorldBody> pile() {
  std::vector<WorldBody> bodies{floor_body(), tumbling_box({0, 0, 0.3}), tumbling_box({0.05, 0.02, 0.6}),
                                tumbling_box({0.02, 0.06, 0.9})};
  for (std::size_t i = 1; i < bodies.size(); ++i) bodies[i].name += std::to_string(i);
  return bodies;
}

std::vector<std::uint64_t> hashes(World& world, int ticks) {
  std::vector<std::uint64_t> chain;
  for (int i = 0; i < ticks; ++i) {
    EXPECT_TRUE(world.step());
    chain.push_back(world.state_hash());
  }
  return chain;
}

TEST_P(Contacts, ABoxComesToRestOnTheFloor) {
  const auto world = make_world(settings(), {floor_body(), tumbling_box({0, 0, 0.3})});
  run(*world, 3000);
  EXPECT_NEAR(link_of(*world, 0, 1).position.z(), 0.1, 1e-3);
  EXPECT_LT(link_of(*world, 0, 1).velocity.norm(), 1e-2);
}

TEST_P(Contacts, FrictionHoldsABoxOnASlopeBelowItsAngle) {
  for (const double slope : {0.3, 0.9}) {  // the friction coefficient is tan(0.54)
    WorldSettings tilted = settings();
    tilted.solver.friction = 0.6;
    tilted.gravity = standard_gravity * Vector3d(std::sin(slope), 0, -std::cos(slope));
    const auto world = make_world(tilted, {floor_body(), free_box("Box", {0.4, 0.4, 0.1}, 2.0, {0, 0, 0.05})});
    run(*world, 500);
    if (slope < 0.54)
      EXPECT_NEAR(link_of(*world, 0, 1).position.x(), 0.0, 1e-2);
    else
      EXPECT_GT(link_of(*world, 0, 1).position.x(), 0.1);
  }
}

TEST_P(Contacts, AWorldGivesTheSameBitsWhateverAnotherOneDoesInBetween) {
  const auto alone = make_world(settings(), pile());
  const auto expected = hashes(*alone, 600);

  const auto disturbed = make_world(settings(), pile());
  WorldSettings others = settings();
  others.seed = 99;
  const auto other = make_world(others, pile());
  run(*other, 50);
  for (std::size_t tick = 0; tick < expected.size(); ++tick) {
    ASSERT_TRUE(disturbed->step());
    ASSERT_EQ(disturbed->state_hash(), expected[tick]) << "after tick " << tick;
    ASSERT_TRUE(other->step());
  }
}

TEST_P(Contacts, AThirdBodyThatTouchesNothingChangesNoBit) {
  // The solver's rows change only if the order or the number of contacts changes.
  std::vector<WorldBody> bodies = pile();
  const auto without = make_world(settings(), bodies);
  WorldBody far = free_box("Far", {0.1, 0.1, 0.1}, 1.0, {100, 0, 0});
  far.fixed = true;
  bodies.insert(bodies.begin(), far);
  const auto with = make_world(settings(), bodies);
  run(*without, 600);
  run(*with, 600);
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(link_of(*without, 0, i).position, link_of(*with, 0, i + 1).position);
    EXPECT_EQ(link_of(*without, 0, i).rotation.coeffs(), link_of(*with, 0, i + 1).rotation.coeffs());
  }
}

TEST(ContactsOfOneBody, LinksOfOneBodyPassThroughEachOther) {
  RobotBuilder robot(JointType::fixed);
  robot.add("SLED", 0, JointType::prismatic, Vector3d::UnitX(), inertial(1.0, {0.1, 0.1, 0.1}));
  robot.add_collision(0, Box{{1, 1, 1}});
  robot.add_collision(1, Box{{1, 1, 1}});
  const auto world = make_world(weightless(), {body_of(robot.build())});
  run(*world, 1, effort(1.0));
  EXPECT_NEAR(joint_of(*world).ddq, 1.0, 1e-6);
}

TEST(TheSeed, DecidesTheQuickSolversOrder) {
  WorldSettings one = settings_of(SolverSettings::Method::quick), two = one;
  two.seed = 1;
  const auto first = make_world(one, pile());
  const auto second = make_world(two, pile());
  run(*first, 600);
  run(*second, 600);
  EXPECT_NE(link_of(*first, 0, 3).position, link_of(*second, 0, 3).position);
}

TEST(Shapes, EveryKindRestsOnTheFloorAtItsOwnHeight) {
  const std::pair<Geometry, double> kinds[] = {
      {Box{{0.2, 0.2, 0.3}}, 0.15}, {Sphere{0.1}, 0.1}, {Cylinder{0.1, 0.4}, 0.2}, {Capsule{0.1, 0.2}, 0.2}};
  for (const auto& [geometry, height] : kinds) {
    const auto model = std::make_shared<const Model>(single_shape_model("Thing", geometry, 1.0, {}));
    const auto world = make_world({}, {floor_body(), body_of(model, {0, 0, height})});
    run(*world, 300);
    EXPECT_NEAR(link_of(*world, 0, 1).position.z(), height, 2e-3);
  }
}

}  // namespace
}  // namespace rehearse
