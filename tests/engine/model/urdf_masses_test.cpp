// Moving links without mass: which are fixed, which get a default mass and which inertia, which are refused.
#include "urdf_texts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rehearse {
namespace {

using testing::HasSubstr;

std::string shape(const std::string& kind, const std::string& geometry, const std::string& xyz = "0 0 0",
                  const std::string& rpy = "0 0 0") {
  return "<" + kind + "><origin xyz='" + xyz + "' rpy='" + rpy + "'/><geometry>" + geometry + "</geometry></" + kind +
         ">";
}

/// A link without mass on a hinge below the world.
std::string arm(const std::string& shapes, const std::string& more = "") {
  return robot(link("world", "") + link("arm", shapes) + joint("hinge", "continuous", "world", "arm") + more);
}

Inertial arm_inertial(const std::string& shapes, const std::string& more = "") {
  const Model model = load(arm(shapes, more), {.default_mass = 6.0});
  return model.links[static_cast<std::size_t>(model.find_link("arm"))].inertial;
}

TEST(UrdfMasses, AMasslessFreeRootIsFixedAndItsChildrenMove) {
  const Model model =
      load(robot(link("base_link", "") + link("arm") + joint("hinge", "continuous", "base_link", "arm")));
  EXPECT_EQ(model.links[0].joint.type, JointType::fixed);
  EXPECT_THAT(to_string(model.report),
              HasSubstr("repair: root link 'base_link' has no mass; it is fixed to the world"));
}

TEST(UrdfMasses, ARootThatIsFixedAnywayIsNotRepaired) {
  const std::string text =
      robot(link("base_link", "") + link("arm") + joint("hinge", "continuous", "base_link", "arm"));
  const Model model = load(text, {.strict = true, .fixed_root = true});
  EXPECT_EQ(model.links[0].joint.type, JointType::free);  // as in the file
  EXPECT_EQ(to_string(model.report), "");
}

TEST(UrdfMasses, AFixedChildsMassKeepsARootFree) {
  const Model model = load(robot(link("base_link", "") + link("body") + joint("weld", "fixed", "base_link", "body")));
  EXPECT_EQ(model.links[0].joint.type, JointType::free);
}

TEST(UrdfMasses, AKinematicBodyNeedsNone) {
  const Model model = load(robot(link("base", "") + link("arm", "") + joint("hinge", "continuous", "base", "arm")),
                           {.strict = true, .kinematic = true});
  EXPECT_EQ(model.links[0].joint.type, JointType::free);
  EXPECT_EQ(model.mass(), 0.0);
}

TEST(UrdfMasses, WithoutADefaultAMovingLinkIsRefusedWithAHint) {
  EXPECT_THAT(refusal(arm("")), HasSubstr("link 'arm' moves but has no mass (give it or a link fixed to it an "
                                          "<inertial>, or state a default mass when loading it)"));
}

TEST(UrdfMasses, ADefaultMassIsARepair) {
  const Model model = load(arm(""), {.default_mass = 6.0});
  EXPECT_EQ(model.links[1].inertial.mass, 6.0);
  EXPECT_THAT(to_string(model.report),
              HasSubstr("repair: link 'arm' moves but has no mass; it gets the default of 6 kg"));
  EXPECT_FALSE(parse_urdf(arm(""), "test.urdf", {.strict = true, .default_mass = 6.0}).ok());
}

TEST(UrdfMasses, ADefaultMassLeavesOthersAlone) {
  const Model model = load(robot(link("world", "") + link("arm") + joint("hinge", "continuous", "world", "arm")),
                           {.strict = true, .default_mass = 6.0});
  EXPECT_EQ(model.links[1].inertial.mass, 2.0);
}

TEST(UrdfMasses, ADefaultMassIsSpreadOverTheBoxAroundTheCollisionShapes) {
  const Inertial inertial =
      arm_inertial(shape("collision", "<box size='1 2 3'/>", "0.5 0 0") + shape("visual", "<box size='9 9 9'/>"));
  EXPECT_EQ(inertial.center, Eigen::Vector3d(0.5, 0, 0));
  EXPECT_TRUE(inertial.inertia.isApprox(Eigen::Vector3d(6.5, 5, 2.5).asDiagonal().toDenseMatrix()));  // m/12 (b² + c²)
}

TEST(UrdfMasses, WithoutCollisionShapesTheVisibleOnesCount) {
  EXPECT_TRUE(arm_inertial(shape("visual", "<box size='1 2 3'/>"))
                  .inertia.isApprox(Eigen::Vector3d(6.5, 5, 2.5).asDiagonal().toDenseMatrix()));
}

TEST(UrdfMasses, TheBoxIsAroundShapesOfFixedLinksToo) {
  const Inertial inertial =
      arm_inertial(shape("collision", "<sphere radius='0.5'/>"),
                   link("tip", shape("collision", "<sphere radius='0.5'/>")) +
                       joint("weld", "fixed", "arm", "tip", "<origin xyz='2 0 0' rpy='0 0 0.4'/>"));
  EXPECT_TRUE(inertial.center.isApprox(Eigen::Vector3d(1, 0, 0)));
  EXPECT_TRUE(inertial.inertia.isApprox(Eigen::Vector3d(1, 5, 5).asDiagonal().toDenseMatrix()));  // 3 x 1 x 1 m
}

/// The box's sizes, computed from moments m/12 (b² + c²).
Eigen::Vector3d box_of(const Inertial& inertial) {
  const Eigen::Vector3d moments = inertial.inertia.diagonal() * 12.0 / inertial.mass;
  return (Eigen::Vector3d::Constant(moments.sum() / 2.0) - moments).cwiseSqrt();
}

TEST(UrdfMasses, TheBoxAroundATurnedShapeIsTight) {
  const double turn = 0.5;  // about y: z leans to x
  const double s = std::sin(turn), c = std::cos(turn);
  const Eigen::Vector3d box = box_of(arm_inertial(shape("collision", "<box size='1 2 3'/>", "0 0 0", "0 0.5 0")));
  EXPECT_TRUE(box.isApprox(Eigen::Vector3d(c * 1 + s * 3, 2, s * 1 + c * 3))) << box;
  const Eigen::Vector3d tube =
      box_of(arm_inertial(shape("collision", "<cylinder radius='0.5' length='3'/>", "0 0 0", "0 0.5 0")));
  EXPECT_TRUE(tube.isApprox(Eigen::Vector3d(s * 3 + c * 1, 1, c * 3 + s * 1))) << tube;
  const Eigen::Vector3d pill =
      box_of(arm_inertial(shape("collision", "<capsule radius='0.5' length='3'/>", "0 0 0", "0 0.5 0")));
  EXPECT_TRUE(pill.isApprox(Eigen::Vector3d(s * 3 + 1, 1, c * 3 + 1))) << pill;
}

TEST(UrdfMasses, WithoutShapesItIsABallOfWater) {
  const Inertial inertial = arm_inertial("");
  const double radius = std::cbrt(6.0 / 1000.0 / (4.0 / 3.0 * std::numbers::pi));
  EXPECT_EQ(inertial.center, Eigen::Vector3d::Zero());
  EXPECT_NEAR(inertial.inertia(1, 1), 0.4 * 6.0 * radius * radius, 1e-12);
}

}  // namespace
}  // namespace rehearse
