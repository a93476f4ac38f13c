// Parts of joints outside of <joint>: springs, rotors of transmissions, loops; and devices that act.

#include <gmock/gmock.h>

#include "urdf_texts.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

std::string hinged(const std::string& more) {
  return robot(link("base") + link("arm") + joint("HINGE", "continuous", "base", "arm") + more);
}

TEST(UrdfSprings, AreThoseOfGazebo) {
  const Model model =
      load(hinged(block("HINGE", "<springStiffness>12</springStiffness><springReference>0.3</springReference>")));
  EXPECT_EQ(model.links[1].joint.spring_stiffness, 12.0);
  EXPECT_EQ(model.links[1].joint.spring_reference, 0.3);
  EXPECT_EQ(to_string(model.report), "");
  EXPECT_EQ(load(hinged(block("HINGE", "<spring_stiffness>5</spring_stiffness>"))).links[1].joint.spring_stiffness,
            5.0);
}

TEST(UrdfTransmissions, AddTheInertiaOfARotorTimesItsRatioSquared) {
  const auto transmission = [](const std::string& actuator) {
    return "<transmission name='t'><joint name='HINGE'/><actuator name='m'>" + actuator + "</actuator></transmission>";
  };
  const Model model =
      load(hinged(transmission("<mechanicalReduction>50</mechanicalReduction><rotor_inertia>0.0004</rotor_inertia>")));
  EXPECT_DOUBLE_EQ(model.links[1].joint.armature, 1.0);
  EXPECT_THAT(to_string(model.report), HasSubstr("reduction 50\n"));
  const Model drake = load(hinged(transmission("<drake:rotor_inertia value='0.01'/><drake:gear_ratio value='3'/>")));
  EXPECT_DOUBLE_EQ(drake.links[1].joint.armature, 0.09);
}

TEST(UrdfLoops, HaveAPlaceInBothLinks) {
  const Model model = load(
      hinged("<loop_joint name='loop' type='revolute'><link1 link='base' xyz='1 0 0'/><link2 link='arm' xyz='0 2 0'/>"
             "<axis xyz='0 0 3'/></loop_joint>"));
  ASSERT_EQ(model.loops.size(), 1u);
  const LoopJoint& loop = model.loops[0];
  EXPECT_EQ(loop.name, "loop");
  EXPECT_EQ(loop.link, 0);
  EXPECT_EQ(loop.other_link, 1);
  EXPECT_EQ(loop.frame.translation(), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(loop.other_frame.translation(), Eigen::Vector3d(0, 2, 0));
  EXPECT_EQ(loop.axis, Eigen::Vector3d::UnitZ());
}

TEST(UrdfActuators, AreRotorsAndHolders) {
  const Model model = load(hinged(block(
      "arm",
      "<rotor name='R'><pose>0 0 1 0 0 0</pose><direction>0 0 -2</direction></rotor>"
      "<holder name='H'><condition>name</condition><target>Box</target><max_distance>0.3</max_distance></holder>")));
  ASSERT_EQ(model.devices.size(), 2u);
  EXPECT_EQ(type_name(model.devices[0]), "RotorDevice");
  EXPECT_EQ(model.devices[0].pose.translation().z(), 1.0);
  EXPECT_EQ(std::get<Rotor>(model.devices[0].kind).direction, -Eigen::Vector3d::UnitZ());
  const Holder& holder = std::get<Holder>(model.devices[1].kind);
  EXPECT_EQ(holder.condition, Holder::Condition::name);
  EXPECT_EQ(holder.target, "Box");
  EXPECT_EQ(holder.max_distance, 0.3);
}

}  // namespace
}  // namespace rehearse
