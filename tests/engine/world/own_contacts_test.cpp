// Links of one body that touch each other.

#include <gmock/gmock.h>

#include "mesh_bodies.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;
using ::testing::IsEmpty;

class OwnContacts : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, OwnContacts, each_solver, solver_name);

/// Two fingers of 0.1 m on a rail along x, their middles 0.5 m apart.
Model gripper(const Geometry& finger) {
  RobotBuilder robot(JointType::fixed);
  robot.add_collision(0, Box{{1.0, 0.2, 0.2}});  // the palm; the fingers are in it all the time
  for (const double x : {-0.25, 0.25}) {
    robot.add(x < 0 ? "LEFT" : "RIGHT", 0, JointType::prismatic, Vector3d(x < 0 ? 1 : -1, 0, 0),
              inertial(0.5, {0.01, 0.01, 0.01}), at(x, 0, 0));
    robot.add_collision(x < 0 ? 1 : 2, finger);
  }
  return *robot.build();
}

/// The distance between the fingers' middles after closing for a second [m].
double closed(const WorldSettings& settings, WorldBody body) {
  WorldSettings weightless = settings;
  weightless.gravity.setZero();
  const auto world = make_world(weightless, {std::move(body)});
  EXPECT_THAT(world->remarks(), IsEmpty());
  Command command = idle(*world);
  for (JointCommand& joint : command.bodies[0].joints) joint = effort(1.0);
  for (int i = 0; i < 1000; ++i) {
    world->actuate(command);
    EXPECT_TRUE(world->step());
  }
  return link_of(*world, 2).position.x() - link_of(*world, 1).position.x();
}

WorldBody body_of(const Model& model) { return rehearse::body_of(std::make_shared<const Model>(model)); }

TEST_P(OwnContacts, StopFingersThatCloseOnEachOther) {
  for (const Geometry& finger : {Geometry(Box{{0.1, 0.1, 0.1}}), Geometry(box_mesh({0.1, 0.1, 0.1}))}) {
    Model model = gripper(finger);
    model.links[1].collides_with_own = model.links[2].collides_with_own = true;
    EXPECT_NEAR(closed(settings(), body_of(model)), 0.1, 1e-3);

    WorldBody all = body_of(gripper(finger));
    all.self_collision = true;
    EXPECT_NEAR(closed(settings(), all), 0.1, 1e-3);
  }
}

TEST_P(OwnContacts, NeedBothLinks) {
  Model model = gripper(Box{{0.1, 0.1, 0.1}});
  EXPECT_LT(closed(settings(), body_of(model)), -0.5);
  model.links[1].collides_with_own = true;
  EXPECT_LT(closed(settings(), body_of(model)), -0.5);
}

/// Four links of 0.3 m in a row, each 0.2 m from the one before: they overlap with their neighbours only.
WorldBody chain(double length) {
  RobotBuilder robot(JointType::fixed);
  robot.add_collision(0, Box{{length, 0.1, 0.1}});
  for (int i = 1; i < 4; ++i) {
    robot.add("LINK" + std::to_string(i), i - 1, JointType::revolute, Vector3d::UnitY(),
              inertial(1.0, {0.01, 0.01, 0.01}), at(0.2, 0, 0));
    robot.add_collision(i, Box{{length, 0.1, 0.1}});
  }
  WorldBody body = rehearse::body_of(robot.build());
  body.self_collision = true;
  return body;
}

TEST_P(OwnContacts, AreNotMadeBetweenNeighbours) {
  WorldSettings weightless = settings();
  weightless.gravity.setZero();
  const auto world = make_world(weightless, {chain(0.3)});
  EXPECT_THAT(world->remarks(), IsEmpty());
  run(*world, 500);
  for (int i = 0; i < 4; ++i) expect_near(link_of(*world, i).position, Vector3d(0.2 * i, 0, 0), 1e-9);
}

TEST_P(OwnContacts, AreNotMadeBetweenWhatOverlapsAtZeroAndThatIsSaid) {
  WorldSettings weightless = settings();
  weightless.gravity.setZero();
  WorldBody body = chain(0.5);
  body.joints = {0.3, 0.2, 0.1};  // the zero pose decides, not the start pose
  const auto world = make_world(weightless, {body});
  const Diagnostics remarks = world->remarks();
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_EQ(remarks[0].severity, Severity::warning);
  EXPECT_EQ(remarks[0].message,
            "body 'Robot': these links overlap when all joints are at zero, so they don't touch each other: "
            "'ROOT' and 'LINK2', 'LINK1' and 'LINK3'");
  run(*world, 200);
  for (int i = 1; i < 4; ++i) EXPECT_LT(link_of(*world, i).velocity.norm(), 1e-9);
}

TEST_P(OwnContacts, AreNotMadeWithinWhatFixedJointsHold) {
  RobotBuilder robot(JointType::free, inertial(1.0, {0.01, 0.01, 0.01}));
  robot.add("HAT", 0, JointType::fixed, Vector3d::UnitX(), inertial(1.0, {0.01, 0.01, 0.01}), at(0, 0, 0.05));
  robot.add("ARM", 1, JointType::revolute, Vector3d::UnitY(), inertial(1.0, {0.01, 0.01, 0.01}), at(0, 0, 0.05));
  for (int link = 0; link < 3; ++link) robot.add_collision(link, Box{{0.2, 0.2, 0.2}});
  WorldBody body = rehearse::body_of(robot.build());
  body.self_collision = true;
  WorldSettings weightless = settings();
  weightless.gravity.setZero();
  const auto world = make_world(weightless, {body});
  EXPECT_THAT(world->remarks(), IsEmpty());  // the arm's joint connects it to both
  run(*world, 200);
  EXPECT_EQ(link_of(*world, 2).position, Vector3d(0, 0, 0.1));
}

}  // namespace
}  // namespace rehearse
