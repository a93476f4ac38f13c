// Mistakes in a part that the robot can do without, or with one sensible correction: the rest of the robot is loaded.
#include "urdf_texts.h"

#include <gmock/gmock.h>

namespace rehearse {
namespace {

using testing::HasSubstr;

const std::string two_feet = link("base") + link("left_foot") + link("right_foot") +
                             joint("left", "continuous", "base", "left_foot") +
                             joint("right", "continuous", "base", "right_foot");

std::vector<std::string> device_names(const Model& model) {
  std::vector<std::string> names;
  for (const Device& device : model.devices) names.push_back(device.name);
  return names;
}

TEST(LenientUrdf, LeavesOutASensorThatItCannotReadAndKeepsTheOthers) {
  const Model model =
      load(robot(two_feet + block("base",
                                  "<sensor name='laser' type='ray'><ray><scan><horizontal><samples>3</samples>"
                                  "<min_angle></min_angle><max_angle>1</max_angle></horizontal></scan>"
                                  "<range><min>0</min><max>1</max></range></ray></sensor>"
                                  "<sensor name='imu' type='imu'/><sensor type='imu'/>")),
           {.strict = true});
  EXPECT_THAT(device_names(model), testing::ElementsAre("imu"));
  const std::string report = to_string(model.report);
  EXPECT_THAT(report, HasSubstr("warning: sensor 'laser' is left out: <min_angle> contains '', not a number"));
  EXPECT_THAT(report, HasSubstr("warning: a sensor is left out: <sensor> has no name"));
}

TEST(LenientUrdf, CountsIgnoredElementsOfAllSensors) {
  const std::string noisy = "' type='imu'><noise/></sensor>";
  const Model model = load(robot(two_feet + block("base", "<sensor name='a" + noisy + "<sensor name='b" + noisy)));
  EXPECT_THAT(to_string(model.report), HasSubstr("note: <sensor><noise> is ignored, here and in 1 other places"));
}

TEST(LenientUrdf, SuggestsALinkForASensorOnAnUnknownOne) {
  const Model model = load(robot(two_feet + block("lef_foot", "<sensor name='skin' type='imu'/>")));
  EXPECT_TRUE(model.devices.empty());
  EXPECT_THAT(to_string(model.report), HasSubstr("warning: sensor 'skin' is left out: it is on 'lef_foot', which is "
                                                 "not a link (did you mean 'left_foot'"));
}

TEST(LenientUrdf, SuggestsALinkForAJointsUnknownEnd) {
  const std::string text = refusal(robot(two_feet + joint("hand", "fixed", "bose", "left_foot")));
  EXPECT_THAT(text, HasSubstr("joint 'hand' has the parent 'bose', which is not a link (did you mean 'base'?)"));
}

TEST(LenientUrdf, NamesSensorsOfOneNameAfterTheirLinks) {
  const std::string skin = "<sensor name='skin' type='contact'/>";
  const Model model = load(robot(two_feet + block("left_foot", skin) + block("right_foot", skin)));
  EXPECT_THAT(device_names(model), testing::ElementsAre("skin", "right_foot_skin"));
  EXPECT_EQ(model.devices[1].link, model.find_link("right_foot"));
}

TEST(LenientUrdf, NeverGivesANameThatIsTaken) {
  const Model model = load(robot(two_feet + block("base",
                                                  "<sensor name='eye' type='imu'/>"
                                                  "<sensor name='base_eye' type='imu'/>"
                                                  "<sensor name='eye' type='gyro'/>")));
  EXPECT_THAT(device_names(model), testing::ElementsAre("eye", "base_eye"));
  EXPECT_THAT(to_string(model.report), HasSubstr("of the same name at the same place"));
}

TEST(LenientUrdf, TakesASensorForTwoReadersOnceWhereverTheyPutIt) {
  const Model model = load(robot(two_feet + "<sensor name='imu' type='imu'><parent link='left_foot'/></sensor>" +
                                 block("base", "<sensor name='imu' type='imu'/>")));
  ASSERT_EQ(model.devices.size(), 1u);
  EXPECT_EQ(model.devices[0].link, model.find_link("left_foot"));
  EXPECT_THAT(to_string(model.report), HasSubstr("note: a sensor's second description"));
}

TEST(LenientUrdf, PassesOverASecondDescriptionThatItCannotRead) {
  const std::string camera =
      "<sensor name='eye' type='camera'><camera><vertical_fov>0.7</vertical_fov></camera></sensor>";
  const std::string unread = "<sensor name='eye' type='camera'><parent link='base'/></sensor>";
  const Model model = load(robot(two_feet + block("base", camera) + unread));
  EXPECT_THAT(device_names(model), testing::ElementsAre("eye"));
  EXPECT_THAT(to_string(model.report), testing::Not(HasSubstr("left out")));
  EXPECT_THAT(to_string(model.report), HasSubstr("note: a sensor's second description"));

  const Model other =
      load(robot(two_feet + block("base", camera) + "<sensor name='ear' type='camera'><parent link='base'/></sensor>"));
  EXPECT_THAT(to_string(other.report), HasSubstr("warning: sensor 'ear' is left out"));
}

/// An arm on a hinge with that <inertial> and shapes.
Model arm_with(const std::string& inertial, const std::string& shapes, const UrdfOptions& options = {}) {
  return load(robot(link("world", "") + link("arm", "<inertial>" + inertial + "</inertial>" + shapes) +
                    joint("hinge", "continuous", "world", "arm")),
              options);
}

const std::string two_kilograms = "<origin xyz='0 0 0.5'/><mass value='2'/>";

Eigen::Vector3d moments_of(const Model& model) { return model.links.at(1).inertial.inertia.diagonal(); }

TEST(LenientUrdf, GivesALinkWithoutInertiaThatOfItsShape) {
  const std::string turned = "<collision><origin rpy='0 1.5707963267948966 0'/><geometry>";
  const Model model = arm_with(two_kilograms, turned +
                                                  "<cylinder radius='0.1' length='1.2'/></geometry></collision>"
                                                  "<visual><geometry><box size='9 9 9'/></geometry></visual>");
  // A cylinder of 2 kg along x: m r² / 2 about x, m (3 r² + l²) / 12 across.
  EXPECT_TRUE(moments_of(model).isApprox(Eigen::Vector3d(0.01, 0.245, 0.245), 1e-12)) << moments_of(model);
  EXPECT_EQ(model.links[1].inertial.center, Eigen::Vector3d(0, 0, 0.5));
  EXPECT_THAT(
      to_string(model.report),
      HasSubstr("repair: moving link 'arm' has mass but no inertia; it gets the inertia of 2 kg spread over its "
                "shape"));
}

TEST(LenientUrdf, GivesALinkOfSeveralShapesTheInertiaOfTheBoxAroundThem) {
  const std::string ball = "<geometry><sphere radius='0.5'/></geometry></collision>";
  const Model model = arm_with(two_kilograms + "<inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/>",
                               "<collision>" + ball + "<collision><origin xyz='1 0 0'/>" + ball);
  // A box of 2 x 1 x 1 m: m (b² + c²) / 12.
  EXPECT_TRUE(moments_of(model).isApprox(Eigen::Vector3d(2.0, 5.0, 5.0) / 6.0, 1e-12)) << moments_of(model);
}

TEST(LenientUrdf, RepairsAnInertiaToTheNearestThatIsPositiveDefinite) {
  // Principal moments -0.02, 0.06 and 0.05, the first two along the diagonals of x and y.
  const Model model =
      arm_with(two_kilograms + "<inertia ixx='0.02' ixy='0.04' ixz='0' iyy='0.02' iyz='0' izz='0.05'/>", "");
  Eigen::Matrix3d nearest;  // the moment of -0.02 becomes a thousandth of the largest
  const double least = 6e-5;
  nearest << 0.03 + least / 2, 0.03 - least / 2, 0, 0.03 - least / 2, 0.03 + least / 2, 0, 0, 0, 0.05;
  EXPECT_TRUE(model.links[1].inertial.inertia.isApprox(nearest, 1e-12)) << model.links[1].inertial.inertia;
}

TEST(LenientUrdf, TakesRoundingErrorsForNoInertia) {
  for (const char* inertia : {"<inertia ixx='0' ixy='2e-35' ixz='0' iyy='0' iyz='0' izz='0'/>",
                              "<inertia ixx='3e-20' ixy='0' ixz='0' iyy='5e-20' iyz='0' izz='1e-20'/>"}) {
    const Model model = arm_with(two_kilograms + inertia, "<visual><geometry><box size='1 1 1'/></geometry></visual>");
    EXPECT_TRUE(moments_of(model).isApprox(Eigen::Vector3d::Constant(1.0 / 3.0), 1e-12)) << moments_of(model);
  }
}

TEST(LenientUrdf, LeavesTheInertiaOfAPointThatIsFixedToABody) {
  const std::string point = "<inertial><mass value='1'/></inertial>";
  const Model model = load(robot(link("base") + link("point", point) + joint("weld", "fixed", "base", "point")));
  EXPECT_TRUE(model.links[1].inertial.inertia.isZero(0.0));
  EXPECT_THAT(to_string(model.report), testing::Not(HasSubstr("repair")));
}

TEST(LenientUrdf, TakesEachShapeOfAGeometry) {
  const std::string geometry =
      "<origin xyz='0 0 1'/><geometry><box size='1 1 1'/><!-- and --><sphere radius='1'/>"
      "<sphere radius='0'/><cylinder radius='1' length='2'/></geometry>";
  const Model model =
      load(still("<visual name='paint'>" + geometry + "<material name='m'><color rgba='1 0 0 1'/></material></visual>" +
                 "<collision>" + geometry + "</collision>"));
  const Link& world = model.links[0];
  ASSERT_EQ(world.visuals.size(), 3u);
  ASSERT_EQ(world.collisions.size(), 3u);
  EXPECT_TRUE(std::holds_alternative<Cylinder>(world.collisions[2].geometry));
  for (const Shape& shape : world.visuals) {
    EXPECT_EQ(shape.name, "paint");
    EXPECT_EQ(shape.color, Color(1, 0, 0, 1));
    EXPECT_EQ(shape.pose.translation(), Eigen::Vector3d(0, 0, 1));
  }
}

TEST(LenientUrdf, PassesOverXacroThatMakesNoPartOfTheRobot) {
  const Model model =
      load(robot("<xacro:property name='width' value='2'/><xacro:arg name='ns' default=''/>"
                 "<xacro:macro name='leg'><link name='${prefix}_leg'/></xacro:macro>" +
                 two_feet + "<transmission name='${name}'/><ros2_control name='$(arg ns)'/>" +
                 block("base",
                       "<plugin filename='$(find somewhere)/plugin.so'/>"
                       "<sensor name='imu' type='imu'><update_rate>${rate}</update_rate></sensor>"
                       "<sensor name='laser' type='ray'><update_rate>${rate}</update_rate>"
                       "</sensor>")));
  EXPECT_EQ(model.links.size(), 3u);
  EXPECT_THAT(device_names(model), testing::ElementsAre("imu"));
  EXPECT_THAT(to_string(model.report), HasSubstr("note: <robot><xacro:property> is ignored"));
}

TEST(LenientUrdf, PassesOverXacroForSensorsAndColours) {
  const Model model =
      load(robot(two_feet + "<xacro:if value='${x == 1}'>" + block("base", "<plugin/>") + "</xacro:if>" +
                 link("nose", "<visual><geometry><sphere radius='1'/></geometry><xacro:grey/></visual>") +
                 joint("face", "fixed", "base", "nose")));
  EXPECT_EQ(model.links.size(), 4u);
  const std::string report = to_string(model.report);
  EXPECT_THAT(report, HasSubstr("note: <robot><xacro:if> is ignored"));
  EXPECT_THAT(report, HasSubstr("note: <visual><xacro:grey> is ignored"));
}

TEST(LenientUrdf, RefusesXacroThatMakesAPartOfTheRobot) {
  for (const std::string part :
       {"<xacro:leg prefix='left'/>", "<xacro:if value='1'><link name='leg'/></xacro:if>",
        "<xacro:include filename='leg.xacro'/>", "<xacro:if value='1'/>", "<link name='${prefix}_leg'/>"}) {
    EXPECT_THAT(refusal(robot(two_feet + part)), HasSubstr("hasn't been expanded")) << part;
  }
  EXPECT_THAT(refusal(still("<visual><geometry><mesh filename='$(find arm)/arm.stl'/></geometry></visual>")),
              HasSubstr("hasn't been expanded"));
}

TEST(LenientUrdf, NamesARobotWithoutANameAfterItsFile) {
  for (const char* tag : {"<robot>", "<robot name=''>"}) {
    const Result<Model> model = parse_urdf(tag + link("world", "") + "</robot>", "models/six_axis.urdf");
    ASSERT_TRUE(model) << to_string(model.errors());
    EXPECT_EQ(model->name, "six_axis");
  }
}

}  // namespace
}  // namespace rehearse
