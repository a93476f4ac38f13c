// Bodies at rest aren't simulated until something moves them: when they sleep, what wakes them, and what remains as it
// was.
#include <gmock/gmock.h>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr double sleeper_side = 0.2;  // [m]
constexpr double sleeper_mass = 1.0;  // [kg]
constexpr int steps_to_rest = 1500;   // in which a stack comes to rest and sleeps

WorldSettings sleepy(SolverSettings::Method method = SolverSettings::Method::direct) {
  WorldSettings settings = settings_of(method);
  settings.solver.sleep_after = 0.2;
  return settings;
}

WorldBody box(const std::string& name, const Vector3d& position) {
  return free_box(name, {sleeper_side, sleeper_side, sleeper_side}, sleeper_mass, position);
}

/// The floor, and on it a stack of boxes A, B, C and apart from it a box D.
std::vector<WorldBody> scene() {
  return {floor_body(), box("A", {0, 0, 0.1}), box("B", {0.02, 0, 0.3}), box("C", {0, 0.03, 0.5}),
          box("D", {1, 0, 0.1})};
}

/// A body sleeps: nothing of its motion changes in a step, and nothing remains of its velocity.
bool sleeps(World& world, int body) {
  const Vector3d before = link_of(world, 0, body).position;
  const Vector3d velocity = link_of(world, 0, body).velocity;
  EXPECT_TRUE(world.step());
  return velocity.isZero(0.0) && link_of(world, 0, body).position == before &&
         link_of(world, 0, body).velocity.isZero(0.0);
}

std::string sleepers(World& world) {
  std::string names;
  for (int body = 1; body < static_cast<int>(world.sense().bodies.size()); ++body)
    if (sleeps(world, body)) names += static_cast<char>('A' + body - 1);
  return names;
}

class Sleeping : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, Sleeping, each_solver, solver_name);

TEST_P(Sleeping, IsWhatBodiesDoWhenAllHaveComeToRest) {
  const auto world = make_world(sleepy(GetParam()), scene());
  run(*world, 150);
  EXPECT_EQ(sleepers(*world), "") << "before the time";
  run(*world, steps_to_rest);
  EXPECT_EQ(sleepers(*world), "ABCD");
  const auto awake = make_world(settings_of(GetParam()), scene());
  run(*awake, 150 + steps_to_rest);
  for (int body = 1; body <= 4; ++body)
    EXPECT_LT((link_of(*world, 0, body).position - link_of(*awake, 0, body).position).norm(), 2e-3) << body;
}

TEST(Sleep, IsOffByDefault) {
  const auto world = make_world(settings_of(SolverSettings::Method::quick), scene());
  run(*world, steps_to_rest);
  EXPECT_EQ(sleepers(*world), "");
}

TEST_P(Sleeping, EndsForAllThatTouch) {
  const auto world = make_world(sleepy(GetParam()), scene());
  run(*world, steps_to_rest);
  world->push(2, 0, {20.0, 0, 0}, Vector3d::Zero(), Vector3d::Zero());
  EXPECT_TRUE(world->step());
  EXPECT_GT(link_of(*world, 0, 2).velocity.norm(), 1e-5);
  EXPECT_EQ(sleepers(*world), "D");
  run(*world, steps_to_rest);
  EXPECT_EQ(sleepers(*world), "ABCD") << "again";
}

TEST(Sleep, EndsByABodyThatFallsOnThem) {
  std::vector<WorldBody> bodies = scene();
  bodies.push_back(box("E", {0, 0, 3.0}));
  const auto world = make_world(sleepy(), std::move(bodies));
  run(*world, 650);  // 2.07 m
  EXPECT_EQ(sleepers(*world), "ABCD");
  run(*world, 100);
  EXPECT_EQ(sleepers(*world), "D");
  run(*world, 3000);
  EXPECT_EQ(sleepers(*world), "ABCDE");
}

TEST(Sleep, EndsByASurfaceThatMoves) {
  std::vector<WorldBody> bodies = scene();
  bodies[0].fixed = false;
  bodies[0].kinematic = true;
  const auto world = make_world(sleepy(), std::move(bodies));
  run(*world, steps_to_rest);
  EXPECT_EQ(sleepers(*world), "ABCD");
  Command command = idle(*world);
  command.bodies[0].given[0].twist = LinkTwist{{0.5, 0, 0}, Vector3d::Zero()};
  world->actuate(command);
  run(*world, 100);
  EXPECT_EQ(sleepers(*world), "");
  EXPECT_GT(link_of(*world, 0, 4).position.x(), 1.01) << "it is carried along";
}

TEST(Sleep, IsNotForBodiesInTheAir) {
  WorldSettings settings = sleepy();
  settings.gravity.setZero();
  const auto world = make_world(settings, {floor_body(), box("A", {0, 0, 2})});
  run(*world, steps_to_rest);
  world->push(1, 0, {0, 0, 1}, Vector3d::Zero(), Vector3d::Zero());
  run(*world, 1);
  EXPECT_GT(link_of(*world, 0, 1).velocity.z(), 0.0);
}

TEST(Sleep, KeepsTheForcesOfContacts) {
  const auto world = make_world(sleepy(), scene());
  world->watch(0, 0);
  const auto load = [&] {
    double sum = 0.0;
    for (const auto& contacts : world->sense().bodies[0].contacts)
      for (const ContactReading& contact : contacts) sum += contact.force.z();
    return sum;
  };
  run(*world, steps_to_rest);
  EXPECT_EQ(sleepers(*world), "ABCD");
  EXPECT_NEAR(load(), -4 * sleeper_mass * standard_gravity, 0.2);
  EXPECT_FALSE(world->touching().empty());
  const double asleep = load();
  run(*world, 1000);
  EXPECT_NEAR(load(), asleep, 1e-9);
}

TEST_P(Sleeping, IsPartOfTheState) {
  const auto world = make_world(sleepy(GetParam()), scene());
  run(*world, 100);
  for (const int more : {0, 120, 1000, 500}) {  // awake, nearly asleep, asleep
    run(*world, more);
    const auto copy = make_world(sleepy(GetParam()), scene());
    ASSERT_TRUE(copy->restore(world->save()));
    EXPECT_EQ(copy->state_hash(), world->state_hash());
    for (int step = 0; step < 300; ++step) {
      if (step == 250)
        for (World* each : {world.get(), copy.get()}) each->push(3, 0, {1, 0, 0}, Vector3d::Zero(), Vector3d::Zero());
      ASSERT_TRUE(world->step() && copy->step());
      ASSERT_EQ(copy->state_hash(), world->state_hash()) << step;
    }
  }
}

TEST(Sleep, IsTakenByNameIntoAWorldWithMoreBodies) {
  const auto world = make_world(sleepy(), scene());
  run(*world, steps_to_rest);
  std::vector<WorldBody> more = scene();
  more.push_back(box("E", {3, 0, 0.1}));
  const auto other = make_world(sleepy(), std::move(more));
  const auto missing = other->take_state(*world);
  EXPECT_FALSE(missing) << "E isn't in the state";
  const auto same = make_world(sleepy(), scene());
  ASSERT_TRUE(same->take_state(*world));
  EXPECT_EQ(sleepers(*same), "ABCD");
  const auto awake = make_world(settings_of(SolverSettings::Method::direct), scene());
  EXPECT_TRUE(awake->take_state(*world)) << "a world without sleep takes the motion alone";
}

}  // namespace
}  // namespace rehearse
