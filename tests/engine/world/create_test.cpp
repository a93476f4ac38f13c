// Bodies that a world refuses: everything on which ODE would abort.

#include <gmock/gmock.h>

#include <limits>

#include "robots.h"

namespace rehearse {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(const WorldBody& body) {
  const auto world = World::create({}, {body});
  return world ? "" : to_string(world.errors());
}

WorldBody arm_of(const Inertial& inertial) {
  RobotBuilder robot(JointType::fixed);
  robot.add("ARM", 0, JointType::revolute, Eigen::Vector3d::UnitY(), inertial);
  return body_of(robot.build());
}

TEST(WorldCreation, RefusesAMovingLinkWithoutMass) {
  EXPECT_THAT(refusal(arm_of(inertial(0.0, {1, 1, 1}))),
              AllOf(HasSubstr("body 'Robot'"), HasSubstr("link 'ARM' moves but has no mass")));
}

TEST(WorldCreation, RefusesANegativeMass) {
  EXPECT_THAT(refusal(arm_of(inertial(-1.0, {1, 1, 1}))), HasSubstr("link 'ARM' moves but has no mass"));
}

TEST(WorldCreation, RefusesAMassThatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(arm_of(inertial(nan, {1, 1, 1}))), HasSubstr("ARM"));
}

TEST(WorldCreation, RefusesAnInertiaThatIsNotPositiveDefinite) {
  EXPECT_THAT(refusal(arm_of(inertial(1.0, {1, 0, 1}))),
              HasSubstr("the inertia of link 'ARM' is not positive definite"));
}

TEST(WorldCreation, RefusesAnInertiaThatIsNoNumber) {
  EXPECT_THAT(refusal(arm_of(inertial(1.0, {1, std::numeric_limits<double>::infinity(), 1}))),
              HasSubstr("the inertia of link 'ARM' is not positive definite"));
}

TEST(WorldCreation, RefusesACountOfDisplacementsThatDoesNotFit) {
  WorldBody body = arm_of(inertial(1.0, {1, 1, 1}));
  body.joints = {0.0, 0.0};
  EXPECT_THAT(refusal(body), HasSubstr("the model has 1 joints, but 2 initial displacements were given"));
}

TEST(WorldCreation, NamesEveryMistakeOfEveryBody) {
  WorldBody second = arm_of(inertial(1.0, {0, 1, 1}));
  second.name = "Second";
  const auto world = World::create({}, {arm_of(inertial(0.0, {1, 1, 1})), second});
  ASSERT_FALSE(world.ok());
  EXPECT_EQ(world.errors().size(), 2u);
}

TEST(WorldCreation, ALinkWithoutMassMayBeFixed) {
  EXPECT_EQ(refusal(body_of(RobotBuilder(JointType::fixed).build())), "");
  WorldBody box = free_box("Box", {1, 1, 1}, 0.0, {0, 0, 0});
  EXPECT_THAT(refusal(box), HasSubstr("has no mass"));
  box.fixed = true;
  EXPECT_EQ(refusal(box), "");
}

TEST(WorldCreation, AMasslessLinkMayBeFixedToOneWithMass) {
  RobotBuilder robot(JointType::free, inertial(1.0, {1, 1, 1}));
  robot.add("TIP", 0, JointType::fixed, Eigen::Vector3d::UnitX(), {}, at(0, 0, 1));
  EXPECT_EQ(refusal(body_of(robot.build())), "");
}

TEST(WorldExplosion, AnAbsurdEffortEndsTheRunAndNotTheProcess) {
  for (const SolverSettings::Method method : {SolverSettings::Method::quick, SolverSettings::Method::exact}) {
    const auto world = make_world(weightless(method), {arm_of(inertial(1.0, {1, 1, 1}))});
    Command command = idle(*world);
    command.bodies[0].joints[0] = effort(1e308);
    bool alive = true;
    for (int i = 0; i < 10 && alive; ++i) {
      world->actuate(command);
      alive = world->step();
    }
    EXPECT_FALSE(alive);
  }
}

}  // namespace
}  // namespace rehearse
