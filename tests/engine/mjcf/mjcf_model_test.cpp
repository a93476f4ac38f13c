// MuJoCo's models as models of Rehearse: roots, links between joints, shapes, devices, rules, postures, included files
// and the text of a recording. Numbers that MuJoCo computes, too, are compared in mjcf_interop_test.cpp.
#include <rehearse/body.h>
#include <rehearse/mjcf.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "support/temporary_folder.h"

namespace rehearse {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class MjcfModel : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  Model model(const std::string& inside, const UrdfOptions& options = {}) const {
    auto read = load_model(write("robot.xml", "<mujoco>" + inside + "</mujoco>"), options);
    if (read) return *std::move(read);
    ADD_FAILURE() << to_string(read.errors());
    return single_shape_model("none", Sphere{1.0}, 1.0, std::nullopt);
  }

  static std::vector<std::string> names(const Model& model) {
    std::vector<std::string> all;
    for (const Link& link : model.links) all.push_back(link.name);
    return all;
  }

  static const Link& link(const Model& model, const char* name) {
    return model.links.at(static_cast<std::size_t>(model.find_link(name)));
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
};

TEST_F(MjcfModel, IsToldByItsRootElement) {
  const std::string text =
      "<?xml version='1.0'?>\n<!-- a --> <mujoco model='m'><worldbody><body name='b'><freejoint/>"
      "<geom size='0.1'/></body></worldbody></mujoco>";
  const auto as_urdf = load_model(write("robot.urdf", text));
  ASSERT_TRUE(as_urdf) << to_string(as_urdf.errors());
  EXPECT_EQ(as_urdf->name, "m");
  EXPECT_TRUE(is_model_file(write("robot.xml", text)));
  EXPECT_FALSE(is_model_file(write("other.xml", "<mujocoinclude/>")));
  EXPECT_TRUE(load_model(write("plain.xml", "<robot name='r'><link name='l'/></robot>")));
}

TEST_F(MjcfModel, TheRootIsFreeFixedOrTheWorld) {
  const Model free = model(R"(<worldbody><geom type="plane" size="1 1 1"/><body name="b" pos="0 0 2"><freejoint/>
    <geom size="0.1"/></body></worldbody>)");
  EXPECT_THAT(names(free), ElementsAre("b"));
  EXPECT_EQ(free.links[0].joint.type, JointType::free);
  EXPECT_EQ(free.links[0].joint.origin.translation().z(), 2.0);
  EXPECT_THAT(to_string(free.report),
              HasSubstr("a <geom> of <worldbody>, which a body of the scenario replaces, is ignored"));

  const Model fixed = model(R"(<worldbody><body name="b"><geom size="0.1"/></body></worldbody>)");
  EXPECT_THAT(names(fixed), ElementsAre("b"));
  EXPECT_EQ(fixed.links[0].joint.type, JointType::fixed);

  const Model hinged = model(R"(<worldbody><geom size="0.5"/><body name="b"><joint name="j"/><geom size="0.1"/></body>
    <body name="c"><freejoint/><geom size="0.1"/></body></worldbody>)");
  EXPECT_THAT(names(hinged), ElementsAre("world", "b", "c"));
  EXPECT_EQ(hinged.links[0].joint.type, JointType::fixed);
  EXPECT_EQ(hinged.links[0].collisions.size(), 1u);
  EXPECT_EQ(hinged.links[2].joint.type, JointType::free);
}

TEST_F(MjcfModel, ABodyWithSeveralJointsHasLinksOfHardlyAnyMass) {
  const Model read = model(R"(<compiler angle="radian"/><worldbody><body name="cart" pos="0 0 1">
    <joint name="x" type="slide" axis="1 0 0"/><joint name="y" axis="0 1 0" pos="0 0 0.5"/><joint name="z"/>
    <geom size="0.1" mass="2" pos="0.3 0 0"/></body></worldbody>)");
  EXPECT_THAT(names(read), ElementsAre("world", "cart_x", "cart_y", "cart"));
  EXPECT_EQ(link(read, "cart").inertial.mass, 2.0);
  EXPECT_NEAR(read.mass(), 2.0, 1e-8);
  EXPECT_GT(link(read, "cart_x").inertial.mass, 0.0);
  const auto poses = forward_kinematics(read, Eigen::Isometry3d::Identity(), {0.2, M_PI / 2.0, 0.0});
  const Eigen::Vector3d center = poses[3] * read.links[3].inertial.center;
  // the slide moves by 0.2; about y the centre, 0.3 ahead of and 0.5 below the anchor, turns by 90 degrees
  EXPECT_NEAR((center - Eigen::Vector3d(0.2 - 0.5, 0.0, 1.5 - 0.3)).norm(), 0.0, 1e-12);
}

TEST_F(MjcfModel, ShapesAreSeenOrTouchedAsTheirGroupsAndMasksSay) {
  const Model read = model(R"(<asset><material name="red" rgba="1 0 0 1"/></asset><worldbody><body name="b">
    <geom size="0.1" material="red"/><geom size="0.2" contype="0" conaffinity="0"/><geom size="0.3" group="3"/>
    <geom type="ellipsoid" size="0.1 0.2 0.3"/></body></worldbody>)");
  EXPECT_EQ(read.links[0].visuals.size(), 3u);
  EXPECT_EQ(read.links[0].collisions.size(), 3u);
  EXPECT_EQ(read.links[0].visuals[0].color, Color(1.0f, 0.0f, 0.0f, 1.0f));
  const auto& egg = std::get<Mesh>(read.links[0].collisions[2].geometry);
  ASSERT_TRUE(egg.hulls);
  EXPECT_NEAR(egg.data->upper.z(), 0.3, 1e-6);
}

TEST_F(MjcfModel, MasksAndExclusionsDecideWhatTouchesInTheBody) {
  const std::string bodies = R"(<worldbody><body name="a"><freejoint/><geom size="0.1" contype="1" conaffinity="2"/>
    <body name="b"><joint name="jb"/><geom size="0.1" contype="2" conaffinity="1"/></body>
    <body name="c"><joint name="jc"/><geom size="0.1" contype="2" conaffinity="1"/></body>
    <body name="d"><joint name="jd"/><geom size="0.1" contype="4" conaffinity="0"/></body></body></worldbody>)";
  const Model read = model(bodies + R"(<contact><exclude body1="c" body2="a"/></contact>)");
  EXPECT_TRUE(link(read, "a").collides_with_own);
  EXPECT_TRUE(link(read, "b").collides_with_own);
  EXPECT_FALSE(link(read, "d").collides_with_own);
  EXPECT_THAT(read.apart, ElementsAre(std::array<int, 2>{0, 2}, std::array<int, 2>{1, 2}));
}

TEST_F(MjcfModel, SensorsAreDevicesAtTheirSites) {
  const Model read = model(R"(<worldbody><body name="b"><freejoint/><geom size="0.1"/><site name="s" pos="0 0 0.1"/>
    <camera name="eye" fovy="60" resolution="64 32"/></body></worldbody>
    <sensor><gyro name="g" site="s"/><accelerometer site="s"/><force name="f" site="s"/><torque name="t" site="s"/>
    <touch name="skin" site="s"/><rangefinder name="beam" site="s" cutoff="3"/><framequat objtype="body" objname="b"/></sensor>)");
  std::vector<std::string> found;
  for (const Device& device : read.devices) found.push_back(device.name + " " + std::string(type_name(device)));
  EXPECT_THAT(found, ElementsAre("eye Camera", "g RateGyroSensor", "s_accelerometer AccelerationSensor",
                                 "f ForceSensor", "skin ContactSensor", "beam RangeSensor"));
  EXPECT_EQ(read.devices[1].pose.translation().z(), 0.1);
  EXPECT_NEAR(std::get<Camera>(read.devices[0].kind).field_of_view, 60.0 * M_PI / 180.0, 1e-12);
  const auto& beam = std::get<RangeSensor>(read.devices[5].kind);
  EXPECT_EQ(beam.max_distance, 3.0);
  const Eigen::Vector3d ahead = read.devices[5].pose.linear() * beam_directions(beam)[0];
  EXPECT_NEAR(ahead.z(), 1.0, 1e-12) << "a site's beam is along z";
  EXPECT_THAT(to_string(read.report), HasSubstr("a framequat sensor is ignored"));
}

TEST_F(MjcfModel, AnEqualityIsAMimic) {
  const Model read = model(R"(<compiler angle="radian"/><worldbody><body name="a"><geom size="0.1"/>
    <body name="b"><joint name="jb" ref="0.5"/><geom size="0.1"/></body><body name="c"><joint name="jc" ref="0.2"/>
    <geom size="0.1"/></body></body></worldbody><equality><joint joint1="jc" joint2="jb" polycoef="0.1 -2 0 0 0"/></equality>)");
  const auto& mimic = link(read, "c").joint.mimic;
  ASSERT_TRUE(mimic);
  EXPECT_EQ(mimic->leader, 0);
  EXPECT_EQ(mimic->multiplier, -2.0);
  EXPECT_NEAR(mimic->offset, 0.2 + 0.1 + 2.0 * 0.5, 1e-15);
}

TEST_F(MjcfModel, KeyframesArePostures) {
  const auto read = load_model(FIXTURES_DIR "/models/quadruped.xml");
  ASSERT_TRUE(read) << to_string(read.errors());
  ASSERT_EQ(read->postures.size(), 1u);
  EXPECT_EQ(read->postures[0].name, "kneeling");
  EXPECT_EQ(read->postures[0].q[2], -2.149);
  ASSERT_TRUE(read->postures[0].root);
  EXPECT_EQ(read->postures[0].root->translation().z(), 0.221);
}

TEST_F(MjcfModel, EffortsComeFromActuators) {
  const Model read = model(R"(<worldbody><body name="a"><geom size="0.1"/><body name="b"><joint name="j"/>
    <geom size="0.1"/></body></body></worldbody><actuator><motor joint="j" gear="3" ctrlrange="-2 2"/></actuator>)");
  EXPECT_EQ(link(read, "b").joint.effort, 6.0);
}

TEST_F(MjcfModel, IncludesWithinABodyAreReadAndRecorded) {
  write("hand.xml", R"(<mujoco><body name="hand"><joint name="wrist"/><geom size="0.1"/></body></mujoco>)");
  write("classes.xml", R"(<mujocoinclude><default><geom density="2000"/></default></mujocoinclude>)");
  const Model read =
      model(R"(<include file="classes.xml"/><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
    <worldbody><body name="arm"><geom type="mesh" mesh="m"/><include file="hand.xml"/></body></worldbody>)");
  EXPECT_THAT(names(read), ElementsAre("arm", "hand"));
  EXPECT_EQ(link(read, "hand").line, 0) << "it is in another file";
  EXPECT_NEAR(link(read, "arm").inertial.mass, 2000.0 / 6.0, 1e-9);

  const auto again = parse_model(read.source_text, "elsewhere/robot.xml", {.meshes = UrdfOptions::Meshes::skip});
  ASSERT_TRUE(again) << to_string(again.errors());
  EXPECT_THAT(names(*again), ElementsAre("arm", "hand"));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again->links[i].inertial.mass, read.links[i].inertial.mass) << "also of the mesh, which isn't there";
    EXPECT_EQ(again->links[i].inertial.inertia, read.links[i].inertial.inertia);
  }
  EXPECT_EQ(again->source_text, read.source_text);
}

TEST_F(MjcfModel, AMistakeInAnIncludedFileHasItsPlace) {
  const auto part =
      write("hand.xml", "<mujoco>\n<body name=\"hand\"><joint range=\"2 1\"/><geom size=\"0.1\"/></body></mujoco>");
  const auto read = load_model(write(
      "robot.xml",
      R"(<mujoco><worldbody><body name="arm"><geom size="0.1"/><include file="hand.xml"/></body></worldbody></mujoco>)"));
  ASSERT_FALSE(read);
  EXPECT_EQ(read.errors()[0].file, part.string());
  EXPECT_EQ(read.errors()[0].line, 2);
}

}  // namespace
}  // namespace rehearse
