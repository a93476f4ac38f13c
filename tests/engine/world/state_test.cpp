// save() and restore(): the run continues with the same bits, in the same world and in a new one.

#include <rehearse/urdf.h>

#include <gmock/gmock.h>

#include <filesystem>

#include "robots.h"

namespace rehearse {
namespace {

/// SR1 on its feet under a stiff law that has no memory, so that all of the run is in the world.
class StandingSr1 {
 public:
  explicit StandingSr1(SolverSettings::Method method) {
    static const auto model = [] {
      auto loaded = load_urdf(std::filesystem::path(FIXTURES_DIR) / "models/sr1.urdf");
      EXPECT_TRUE(loaded.ok());
      return std::make_shared<const Model>(*std::move(loaded));
    }();
    world_ = make_world(settings_of(method), {body_of(model, {0, 0, 0.71}), floor_body()});
  }

  World& world() { return *world_; }

  /// One tick; the hash after it.
  std::uint64_t tick() {
    Command command = idle(*world_);
    const BodyObservation& seen = world_->sense().bodies[0];
    for (std::size_t id = 0; id < seen.joints.size(); ++id)
      command.bodies[0].joints[id] = effort(-3000.0 * seen.joints[id].q - 100.0 * seen.joints[id].dq);
    world_->actuate(command);
    EXPECT_TRUE(world_->step());
    return world_->state_hash();
  }

 private:
  std::unique_ptr<World> world_;
};

class State : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, State, each_solver, solver_name);

constexpr int checkpoints[] = {1, 40, 90};  // in free fall, at the touch-down, standing
constexpr int ticks_after = 300;

struct ReferenceRun {
  std::vector<std::uint64_t> hashes;  // hashes[i]: after tick i
  std::vector<std::vector<std::byte>> saved;
};

ReferenceRun reference_run(StandingSr1& robot) {
  ReferenceRun run;
  for (int tick = 0; tick < checkpoints[2] + ticks_after; ++tick) {
    for (const int checkpoint : checkpoints)
      if (tick == checkpoint) run.saved.push_back(robot.world().save());
    run.hashes.push_back(robot.tick());
  }
  return run;
}

void expect_to_go_on(StandingSr1& robot, const ReferenceRun& expected, int tick) {
  for (int i = tick; i < tick + ticks_after; ++i) ASSERT_EQ(robot.tick(), expected.hashes[i]) << "after tick " << i;
}

TEST_P(State, RestoredInPlaceTheRunGoesOnWithTheSameBits) {
  StandingSr1 robot(GetParam());
  const ReferenceRun expected = reference_run(robot);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(robot.world().restore(expected.saved[i]).ok());
    EXPECT_EQ(robot.world().tick(), checkpoints[i]);
    expect_to_go_on(robot, expected, checkpoints[i]);
  }
}

TEST_P(State, RestoredIntoANewWorldTheRunGoesOnWithTheSameBits) {
  StandingSr1 original(GetParam());
  const ReferenceRun expected = reference_run(original);
  for (int i = 0; i < 3; ++i) {
    StandingSr1 robot(GetParam());
    ASSERT_TRUE(robot.world().restore(expected.saved[i]).ok());
    expect_to_go_on(robot, expected, checkpoints[i]);
  }
}

TEST_P(State, SavingChangesNothing) {
  StandingSr1 watched(GetParam()), alone(GetParam());
  for (int i = 0; i < 50; ++i) {
    static_cast<void>(watched.world().save());
    ASSERT_EQ(watched.tick(), alone.tick());
  }
}

TEST_P(State, ARestoredWorldSensesWhatTheSavedOneDid) {
  StandingSr1 original(GetParam()), copy(GetParam());
  for (int i = 0; i < 100; ++i) original.tick();
  ASSERT_TRUE(copy.world().restore(original.world().save()).ok());
  const BodyObservation& expected = original.world().sense().bodies[0];
  const BodyObservation& actual = copy.world().sense().bodies[0];
  for (std::size_t i = 0; i < expected.devices.size(); ++i) {
    EXPECT_EQ(actual.devices[i].values, expected.devices[i].values);
    EXPECT_EQ(actual.devices[i].fresh, expected.devices[i].fresh);
  }
  for (std::size_t id = 0; id < expected.joints.size(); ++id) {
    EXPECT_EQ(actual.joints[id].q, expected.joints[id].q);
    EXPECT_EQ(actual.joints[id].ddq, expected.joints[id].ddq);
    EXPECT_EQ(actual.joints[id].u, expected.joints[id].u);
  }
  for (std::size_t i = 0; i < expected.links.size(); ++i)
    EXPECT_EQ(actual.links[i].acceleration, expected.links[i].acceleration);
}

TEST_P(State, AStateOfAnotherRobotIsRefused) {
  StandingSr1 robot(GetParam());
  const auto other = make_world(settings(), {free_box("Box", {1, 1, 1}, 1.0, {0, 0, 0})});
  const std::uint64_t before = robot.world().state_hash();
  const Result<void> restored = robot.world().restore(other->save());
  ASSERT_FALSE(restored.ok());
  EXPECT_THAT(restored.errors()[0].message, ::testing::HasSubstr("another robot"));
  EXPECT_EQ(robot.world().state_hash(), before);
}

TEST_P(State, KeepsTheTurnsOfAJoint) {
  RobotBuilder wheel(JointType::fixed);
  wheel.add("WHEEL", 0, JointType::continuous, Eigen::Vector3d::UnitY(), inertial(1.0, {0.5, 0.5, 0.5}));
  const auto original = make_world(weightless(GetParam()), {body_of(wheel.build())});
  run(*original, 1000, velocity(20.0));
  const auto copy = make_world(weightless(GetParam()), {body_of(wheel.build())});
  ASSERT_TRUE(copy->restore(original->save()).ok());
  EXPECT_EQ(joint_of(*copy).q, joint_of(*original).q);
  EXPECT_GT(joint_of(*copy).q, 19.0);
}

/// A box that turns and falls, with an arm on a hinge. `offset`: of the box's centre of mass from its link's frame [m].
WorldBody box_with_arm(const std::string& name, const Eigen::Vector3d& position, double offset = 0.0) {
  RobotBuilder robot(JointType::free, inertial(2.0, {0.1, 0.2, 0.3}, {offset, 0.0, 0.0}));
  robot.add("ARM", 0, JointType::revolute, Eigen::Vector3d::UnitY(), inertial(1.0, {0.1, 0.1, 0.1}, {0.2, 0.0, 0.0}));
  WorldBody body = body_of(robot.build(), position);
  body.name = name;
  return body;
}

TEST_P(State, IsTakenByTheNamesOfBodiesThatStandInAnotherOrder) {
  const auto original =
      make_world(settings_of(GetParam()), {box_with_arm("One", {0, 0, 1}), box_with_arm("Two", {3, 0, 5})});
  Command command = idle(*original);
  command.bodies[0].joints[0] = {drive_effort, 0.0, 0.0, 0.5};
  command.bodies[1].joints[0] = {drive_effort, 0.0, 0.0, -0.7};
  for (int tick = 0; tick < 50; ++tick) {
    original->actuate(command);
    ASSERT_TRUE(original->step());
  }
  const auto other = make_world(settings_of(GetParam()), {box_with_arm("Two", {}), box_with_arm("One", {})});
  const auto taken = other->take_state(*original);
  ASSERT_TRUE(taken.ok()) << to_string(taken.errors());
  EXPECT_EQ(other->tick(), 50);
  for (const int body : {0, 1}) {
    const BodyObservation &expected = original->sense().bodies[body], &actual = other->sense().bodies[1 - body];
    EXPECT_EQ(actual.joints[0].q, expected.joints[0].q);
    EXPECT_EQ(actual.joints[0].dq, expected.joints[0].dq);
    for (const int link : {0, 1}) {
      EXPECT_EQ(actual.links[link].position, expected.links[link].position);
      EXPECT_EQ(actual.links[link].rotation.coeffs(), expected.links[link].rotation.coeffs());
      EXPECT_EQ(actual.links[link].velocity, expected.links[link].velocity);
      EXPECT_EQ(actual.links[link].acceleration, expected.links[link].acceleration);
    }
  }
}

TEST_P(State, IsTakenWithTheLinksWhereTheyAreThoughTheirCentresOfMassAreOthers) {
  const auto original = make_world(settings_of(GetParam()), {box_with_arm("One", {0, 0, 1})});
  Command command = idle(*original);
  command.bodies[0].joints[0] = {drive_effort, 0.0, 0.0, 0.5};
  for (int tick = 0; tick < 50; ++tick) {
    original->actuate(command);
    ASSERT_TRUE(original->step());
  }
  const auto other = make_world(settings_of(GetParam()), {box_with_arm("One", {}, 0.05)});
  ASSERT_TRUE(other->take_state(*original).ok());
  const LinkReading &expected = original->sense().bodies[0].links[0], &actual = other->sense().bodies[0].links[0];
  EXPECT_LT((actual.position - expected.position).norm(), 1e-15);
  EXPECT_LT((actual.velocity - expected.velocity).norm(), 1e-15);
  EXPECT_LT((actual.acceleration - expected.acceleration).norm(), 1e-12);
}

TEST_P(State, ThatHasNoPartOfThatNameIsRefusedByIt) {
  const auto original = make_world(settings_of(GetParam()), {box_with_arm("One", {0, 0, 1})});
  const auto other =
      make_world(settings_of(GetParam()), {box_with_arm("One", {}), free_box("Box", {1, 1, 1}, 1.0, {5, 0, 0})});
  const auto refused = other->take_state(*original);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.errors()[0].message, "body 'Box' isn't in the state");
  WorldBody kinematic = box_with_arm("One", {});
  kinematic.kinematic = true;
  EXPECT_FALSE(make_world(settings_of(GetParam()), {kinematic})->take_state(*original).ok());
}

TEST(StateHash, TellsTicksAndSeedsApart) {
  const auto world = make_world({}, {free_box("Box", {1, 1, 1}, 1.0, {0, 0, 0})});
  const std::uint64_t first = world->state_hash();
  EXPECT_EQ(world->state_hash(), first);
  run(*world, 1);
  EXPECT_NE(world->state_hash(), first);
  WorldSettings other;
  other.seed = 5;
  EXPECT_NE(make_world(other, {free_box("Box", {1, 1, 1}, 1.0, {0, 0, 0})})->state_hash(), first);
}

}  // namespace
}  // namespace rehearse
