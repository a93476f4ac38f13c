// Contact properties of links in a URDF.
#include "urdf_texts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rehearse {
namespace {

using testing::HasSubstr;

/// base, an arm on a hinge, and additional elements.
Model with_surface(const std::string& more) {
  return load(robot(link("base") + link("arm") + joint("hinge", "continuous", "base", "arm") + more));
}

std::string surface_block(const std::string& reference, const std::string& content) {
  return "<gazebo reference='" + reference + "'>" + content + "</gazebo>";
}

Surface arm_surface(const std::string& content) { return with_surface(surface_block("arm", content)).links[1].surface; }

TEST(UrdfSurfaces, AreReadOfTheLinkAndOfNoOther) {
  const Model model =
      with_surface(surface_block("arm",
                                 "<mu1>0.5</mu1><mu2> 0.25\n</mu2><kp>1e5</kp><kd>10</kd><minDepth>0.001</minDepth>"
                                 "<maxVel>0.1</maxVel><fdir1>0 3 4</fdir1>"));
  const Surface& arm = model.links[1].surface;
  EXPECT_EQ(arm.friction, 0.5);
  EXPECT_EQ(arm.second_friction, 0.25);
  EXPECT_EQ(arm.stiffness, 1e5);
  EXPECT_EQ(arm.damping, 10.0);
  EXPECT_EQ(arm.min_depth, 0.001);
  EXPECT_EQ(arm.max_velocity, 0.1);
  EXPECT_FALSE(arm.restitution);
  ASSERT_TRUE(arm.friction_direction);
  EXPECT_TRUE(arm.friction_direction->isApprox(Eigen::Vector3d(0, 0.6, 0.8)));
  EXPECT_EQ(to_string(model.report), "");
  EXPECT_FALSE(model.links[0].surface.friction);
  EXPECT_FALSE(model.links[0].surface.stiffness);
}

TEST(UrdfSurfaces, MayHaveTheWordsOfSdf) {
  const Surface arm = arm_surface("<mu>0.5</mu><min_depth>0.001</min_depth><max_vel>0.1</max_vel>");
  EXPECT_EQ(arm.friction, 0.5);
  EXPECT_EQ(arm.min_depth, 0.001);
  EXPECT_EQ(arm.max_velocity, 0.1);
}

TEST(UrdfSurfaces, MayHaveTheirNumbersInAttributes) {
  EXPECT_EQ(arm_surface("<mu1 value='10.0'/>").friction, 10.0);
  EXPECT_EQ(arm_surface("<kp value='1e6'></kp>").stiffness, 1e6);
}

TEST(UrdfSurfaces, HaveNoDirectionIfItIsZero) { EXPECT_FALSE(arm_surface("<fdir1>0 0 0</fdir1>").friction_direction); }

TEST(UrdfSurfaces, AreGatheredFromSeveralBlocks) {
  const Model model = with_surface(surface_block("arm", "<mu1>0.5</mu1>") + surface_block("arm", "<mu2>0.25</mu2>") +
                                   surface_block("arm", "<kp>3</kp>"));
  EXPECT_EQ(model.links[1].surface.friction, 0.5);
  EXPECT_EQ(model.links[1].surface.second_friction, 0.25);
  EXPECT_EQ(model.links[1].surface.stiffness, 3.0);
}

TEST(UrdfSurfaces, WithoutSenseAreLeftOut) {
  const Model model = with_surface(
      surface_block("arm", "<mu1>-1</mu1><kp>0</kp><kd>-1</kd><minDepth>-1</minDepth><maxVel>-1</maxVel>"));
  const Surface& arm = model.links[1].surface;
  EXPECT_FALSE(arm.friction || arm.stiffness || arm.damping || arm.min_depth || arm.max_velocity);
  EXPECT_EQ(model.report.size(), 5u) << to_string(model.report);
}

TEST(UrdfSurfaces, OfABlockWithoutALinkAreNoted) {
  for (const char* gazebo : {"<gazebo>", "<gazebo reference=''>"})
    EXPECT_EQ(to_string(with_surface(gazebo + std::string("<mu1>1</mu1></gazebo>")).report),
              "test.urdf:1: note: <gazebo><mu1> without a link is ignored\n");
}

TEST(UrdfSurfaces, AreThoseOfPyBulletToo) {
  const Model model = load(robot(
      link("base", std::string(some_inertial) +
                       "<contact><lateral_friction value='0.5'/><stiffness value='3e4'/><damping value='1e3'/>"
                       "<restitution value='0.25'/><spinning_friction value='0.1'/><rolling_friction value='0.01'/>"
                       "<friction_anchor/></contact>")));
  const Surface& base = model.links[0].surface;
  EXPECT_EQ(base.friction, 0.5);
  EXPECT_EQ(base.stiffness, 3e4);
  EXPECT_EQ(base.damping, 1e3);
  EXPECT_EQ(base.restitution, 0.25);
  EXPECT_EQ(base.torsional_friction, 0.1);
  EXPECT_EQ(base.rolling_friction, 0.01);
  EXPECT_THAT(to_string(model.report), HasSubstr("note: <contact><friction_anchor> is ignored"));
}

TEST(UrdfSurfaces, WeightCanBeTakenFromALink) {
  const auto has_weight = [](const std::string& content) {
    return with_surface(surface_block("arm", content)).links[1].has_weight;
  };
  EXPECT_TRUE(with_surface("").links[1].has_weight);
  for (const char* off : {"<gravity>false</gravity>", "<gravity>0</gravity>", "<turnGravityOff>true</turnGravityOff>",
                          "<turnGravityOff>True</turnGravityOff>", "<turn_gravity_off>1</turn_gravity_off>"})
    EXPECT_FALSE(has_weight(off)) << off;
  for (const char* on : {"<gravity>true</gravity>", "<gravity> 1 </gravity>", "<turnGravityOff>false</turnGravityOff>"})
    EXPECT_TRUE(has_weight(on)) << on;
  EXPECT_TRUE(with_surface(surface_block("arm", "<gravity>0</gravity>")).links[0].has_weight);
}

TEST(UrdfSurfaces, LinksCollideWithTheirOwnIfToldSo) {
  EXPECT_FALSE(with_surface("").links[1].collides_with_own);
  for (const char* on : {"<selfCollide>true</selfCollide>", "<self_collide>1</self_collide>"}) {
    const Model model = with_surface(surface_block("arm", on));
    EXPECT_TRUE(model.links[1].collides_with_own) << on;
    EXPECT_FALSE(model.links[0].collides_with_own) << on;
  }
}

TEST(UrdfSurfaces, ARobotCanCollideWithItselfButForALink) {
  const Model model = with_surface("<gazebo><self_collide>true</self_collide></gazebo>" +
                                   surface_block("arm", "<selfCollide>false</selfCollide>"));
  EXPECT_TRUE(model.links[0].collides_with_own);
  EXPECT_FALSE(model.links[1].collides_with_own);
}

TEST(UrdfSurfaces, AStaticRobotIsFixedToTheWorld) {
  const std::string crate = link("crate");
  EXPECT_EQ(load(robot(crate + "<gazebo><static>true</static></gazebo>")).links[0].joint.type, JointType::fixed);
  EXPECT_EQ(load(robot(crate + "<gazebo><static>false</static></gazebo>")).links[0].joint.type, JointType::free);
}

TEST(UrdfSurfaces, ALinkIsMeantBeforeAJointOfItsName) {
  const Model model = load(robot(link("base") + link("arm") + joint("arm", "continuous", "base", "arm") +
                                 surface_block("arm", "<mu1>0.5</mu1>")));
  EXPECT_EQ(model.links[1].surface.friction, 0.5);
  EXPECT_EQ(to_string(model.report), "");
}

TEST(UrdfSurfaces, WhatGazeboSaysOfAJointIsOnlyNoted) {
  EXPECT_EQ(to_string(with_surface(surface_block("hinge", "<implicitSpringDamper>1</implicitSpringDamper>")).report),
            "test.urdf:1: note: <gazebo><implicitSpringDamper> is ignored\n");
}

}  // namespace
}  // namespace rehearse
