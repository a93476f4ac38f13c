// The comparison with urdfdom: if its robot differs from that of Rehearse's reader, the load fails. In these tests the
// result of Rehearse's reader is wrong on purpose.
#include "urdf/urdf_draft.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

namespace rehearse::urdf {
namespace {

using testing::HasSubstr;

constexpr const char* arm = R"(<robot name="arm">
  <link name="world"/>
  <link name="arm">
    <inertial>
      <mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>
    <visual><geometry><box size="1 2 3"/></geometry></visual>
    <collision><geometry><cylinder radius="1" length="2"/></geometry></collision>
  </link>
  <joint name="hinge" type="revolute">
    <origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>
    <parent link="world"/>
    <child link="arm"/>
    <axis xyz="0 0 2"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>)";

/// The correct draft of `arm`.
Draft arm_draft() {
  Draft draft;
  draft.name = "arm";
  draft.links.resize(2);
  draft.links[0].link.name = "world";
  Link& link = draft.links[1].link;
  link.name = "arm";
  link.line = 3;
  draft.links[1].has_inertial = true;
  link.inertial.mass = 1.0;
  link.visuals.resize(1);
  link.visuals[0].geometry = Box{{1, 2, 3}};
  link.collisions.resize(1);
  link.collisions[0].geometry = Cylinder{1, 2};
  draft.joints.resize(1);
  Joint& joint = draft.joints[0].joint;
  joint.name = "hinge";
  joint.type = JointType::revolute;
  joint.line = 11;
  joint.axis = Eigen::Vector3d::UnitZ();
  joint.lower = -1;
  joint.upper = 1;
  joint.origin = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
                 Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX());
  draft.joints[0].parent = "world";
  draft.joints[0].child = "arm";
  return draft;
}

/// The errors of the comparison with urdfdom.
std::string verdict(const Draft& draft, const char* text = arm) {
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.Parse(text), tinyxml2::XML_SUCCESS);
  Findings findings("arm.urdf", false);
  compare_with_urdfdom(document, draft, findings);
  return to_string(findings.errors());
}

TEST(UrdfReferee, AgreesWithACorrectReading) { EXPECT_EQ(verdict(arm_draft()), ""); }

TEST(UrdfReferee, NamesTheLinkWhoseShapesDiffer) {
  Draft draft = arm_draft();
  draft.links[1].link.visuals.resize(2);
  EXPECT_EQ(verdict(draft), "arm.urdf:3: error: urdfdom reads link 'arm' differently: its visuals (1, we read 2)\n");
  draft = arm_draft();
  draft.links[1].link.collisions.clear();
  EXPECT_EQ(verdict(draft), "arm.urdf:3: error: urdfdom reads link 'arm' differently: its collisions (1, we read 0)\n");
}

TEST(UrdfReferee, SeesOneWrongMeasure) {
  Draft draft = arm_draft();
  draft.links[1].link.visuals[0].geometry = Box{{1, 2, 3.0000001}};
  EXPECT_THAT(verdict(draft), HasSubstr("its visuals"));
  draft = arm_draft();
  draft.links[1].link.collisions[0].pose.translation().x() = 1e-9;
  EXPECT_THAT(verdict(draft), HasSubstr("its collisions"));
  draft = arm_draft();
  draft.links[1].link.inertial.mass = 2;
  EXPECT_THAT(verdict(draft), HasSubstr("its <inertial>"));
}

TEST(UrdfReferee, SeesADifferentJoint) {
  const auto with = [](const auto& change) {
    Draft draft = arm_draft();
    change(draft.joints[0]);
    return verdict(draft);
  };
  const std::string differs = "arm.urdf:11: error: urdfdom reads joint 'hinge' differently: ";
  EXPECT_EQ(with([](JointDraft& j) { j.joint.type = JointType::prismatic; }), differs + "its type\n");
  EXPECT_EQ(with([](JointDraft& j) { j.parent = "arm"; }), differs + "its links\n");
  EXPECT_EQ(with([](JointDraft& j) { j.joint.origin.translation().z() = 0; }), differs + "its origin\n");
  EXPECT_EQ(with([](JointDraft& j) { j.joint.axis = Eigen::Vector3d::UnitX(); }), differs + "its axis\n");
  EXPECT_EQ(with([](JointDraft& j) { j.joint.upper = 2; }), differs + "its limits\n");
}

TEST(UrdfReferee, CountsLinksAndJoints) {
  Draft draft = arm_draft();
  draft.links.pop_back();
  draft.joints.clear();
  EXPECT_EQ(verdict(draft),
            "arm.urdf: error: urdfdom finds 2 links and we find 1\n"
            "arm.urdf: error: urdfdom finds 1 joints and we find 0\n");
}

TEST(UrdfReferee, PassesOnWhatUrdfdomComplainsOf) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const std::string said =
      verdict(Draft{}, "<robot name='r'><link name='a'><inertial><mass/></inertial></link></robot>");
  EXPECT_THAT(said, HasSubstr("error: urdfdom reports: "));
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");  // and prints nothing
}

}  // namespace
}  // namespace rehearse::urdf
