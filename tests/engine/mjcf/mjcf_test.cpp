// The drives of MuJoCo models: classes, gears, includes; and mistakes with their places.
#include <rehearse/mjcf.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/temporary_folder.h"

namespace rehearse {
namespace {

class Mjcf : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  std::vector<MjcfDrive> drives(const std::string& text) const {
    auto read = load_mjcf_drives(write("robot.xml", text));
    if (read) return *std::move(read);
    ADD_FAILURE() << to_string(read.errors());
    return {};
  }

  std::string mistake(const std::string& text) const {
    const auto read = load_mjcf_drives(write("robot.xml", text));
    if (read) return "none";
    const std::string line = to_string(read.errors()[0]);
    return line.substr(line.find("robot.xml"));
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
};

TEST_F(Mjcf, TakesWhatAJointStates) {
  const auto found = drives(R"(<mujoco><worldbody><body><joint name="knee" damping="0.5" frictionloss="0.2"
    armature="0.01" actuatorfrcrange="-23.7 20"/></body><body><freejoint name="f"/></body><body><joint name="b" type="ball"/>
    <joint name="hip" range="-1 1"/></body></worldbody></mujoco>)");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].joint, "knee");
  EXPECT_EQ(found[0].damping, 0.5);
  EXPECT_EQ(found[0].coulomb, 0.2);
  EXPECT_EQ(found[0].armature, 0.01);
  EXPECT_EQ(found[0].effort, 23.7);
  EXPECT_FALSE(found[0].position_gain);
  EXPECT_EQ(found[1].joint, "hip");
  EXPECT_FALSE(found[1].states_anything());
}

TEST_F(Mjcf, TakesTheRestFromClasses) {
  const auto found = drives(R"(<mujoco>
  <default><joint damping="1"/><motor ctrlrange="-5 5"/>
    <default class="leg"><joint armature="0.02"/>
      <default class="knee"><joint damping="2"/><motor ctrlrange="-7 7"/></default></default></default>
  <worldbody><body childclass="leg"><joint name="hip"/>
    <body><joint name="knee" class="knee"/><body childclass="knee"><joint name="toe" damping="0"/></body></body></body>
    <body><joint name="arm"/></body></worldbody>
  <actuator><motor joint="hip"/><motor joint="knee" class="knee"/></actuator></mujoco>)");
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0].damping, 1.0);
  EXPECT_EQ(found[0].armature, 0.02);
  EXPECT_EQ(found[0].effort, 5.0);
  EXPECT_EQ(found[1].damping, 2.0);
  EXPECT_EQ(found[1].armature, 0.02);
  EXPECT_EQ(found[1].effort, 7.0);
  EXPECT_FALSE(found[2].damping) << "it states 0";
  EXPECT_EQ(found[3].damping, 1.0);
  EXPECT_FALSE(found[3].armature);
}

TEST_F(Mjcf, PutsGainsAndForcesBehindTheGear) {
  const auto found =
      drives(R"(<mujoco><worldbody><body><joint name="a"/><joint name="b"/><joint name="c"/></body></worldbody>
  <actuator><position joint="a" kp="10" kv="0.5" forcerange="-3 3" gear="2 0 0 0 0 0"/><velocity joint="b" kv="4"/>
  <general joint="c" gainprm="60" biastype="affine" biasprm="0 -60 -2" forcerange="-30 30"/></actuator></mujoco>)");
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].position_gain, 40.0);
  EXPECT_EQ(found[0].velocity_gain, 2.0);
  EXPECT_EQ(found[0].effort, 6.0);
  EXPECT_FALSE(found[1].position_gain);
  EXPECT_EQ(found[1].velocity_gain, 4.0);
  EXPECT_EQ(found[2].position_gain, 60.0);
  EXPECT_EQ(found[2].velocity_gain, 2.0);
  EXPECT_EQ(found[2].effort, 30.0);
}

TEST_F(Mjcf, ReadsIncludedFiles) {
  write("defaults.xml", R"(<mujocoinclude><default><joint armature="0.3"/></default></mujocoinclude>)");
  const auto found =
      drives(R"(<mujoco><include file="defaults.xml"/><worldbody><body><joint name="a"/></body></worldbody></mujoco>)");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].armature, 0.3);
}

TEST_F(Mjcf, MistakesHaveTheirPlace) {
  EXPECT_THAT(mistake("<mujoco>\n<worldbody>"), ::testing::HasSubstr("isn't closed by its own end tag"));
  EXPECT_THAT(mistake("<robot/>"), ::testing::StartsWith("robot.xml:1: error: its root is <robot> (expected a MuJoCo"));
  EXPECT_THAT(mistake("<mujoco><worldbody><body>\n<joint name=\"a\" damping=\"x\"/></body></worldbody></mujoco>"),
              ::testing::StartsWith("robot.xml:2: error: damping of <joint> is 'x' (expected numbers)"));
  EXPECT_THAT(mistake("<mujoco><worldbody><body/></worldbody><actuator>\n<motor joint=\"k\"/></actuator></mujoco>"),
              ::testing::StartsWith("robot.xml:2: error: an actuator drives joint 'k', which the model lacks"));
  EXPECT_THAT(mistake("<mujoco><include file=\"none.xml\"/></mujoco>"), ::testing::Not("none"));
  EXPECT_THAT(mistake("<mujoco><include file=\"robot.xml\"/></mujoco>"),
              ::testing::HasSubstr("the file includes itself as 'robot.xml'"));
}

}  // namespace
}  // namespace rehearse
