// Bodies: models, shapes, initial joints, controllers.
#include "scenario_files.h"

#include <gmock/gmock.h>

#include <numbers>

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// A slider between two masses: one prismatic joint, 0 to 0.5 m, then a fixed one.
const char* const slider = R"(<?xml version="1.0"?>
<robot name="slider">
  <link name="RAIL"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="CART"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="TOP"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="SLIDE" type="prismatic">
    <parent link="RAIL"/><child link="CART"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.5" effort="10" velocity="1"/>
  </joint>
  <joint name="BOLT" type="fixed"><parent link="CART"/><child link="TOP"/></joint>
</robot>
)";

Result<Scenario> load_slider(const std::string& keys) {
  write_file("slider.urdf", slider);
  return load_text("rehearse: 1\nduration: 1\nbodies:\n  - name: S\n    model: slider.urdf\n" + keys);
}

ScenarioBody only_body(const std::string& keys) {
  const Scenario scenario = loaded("rehearse: 1\nduration: 1\nbodies:\n  - {name: Thing, " + keys + "}\n");
  return scenario.bodies.empty() ? ScenarioBody{} : scenario.bodies[0];
}

TEST(ScenarioBodies, MakesAModelOfABox) {
  const ScenarioBody body = only_body("box: {size: [1, 2, 3], color: [1, 0.5, 0]}, mass: 4, position: [1, 2, 3]");
  ASSERT_NE(body.model, nullptr);
  EXPECT_EQ(body.model->name, "Thing");
  EXPECT_EQ(body.model->mass(), 4.0);
  EXPECT_EQ(std::get<Box>(body.model->links[0].collisions[0].geometry).size, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(body.model->links[0].visuals[0].color, Color(1.0f, 0.5f, 0.0f, 1.0f));
  EXPECT_EQ(body.position, Eigen::Vector3d(1, 2, 3));
}

// A cart at 2 m with an arm that hangs at 30 deg; its wheels are of rubber.
const char* const cart = R"(format: ChoreonoidBody
format_version: 2.0
links:
  - { name: CART, joint_type: free, translation: [ 2, 0, 0.5 ], rotation: [ 0, 0, 1, 90 ], mass: 5, material: Rubber }
  - { name: WHEEL, parent: CART, joint_type: revolute, mass: 1 }
  - { name: ARM, parent: CART, joint_type: revolute, joint_id: 0, joint_angle: 30, joint_range: [ 10, 90 ], mass: 1 }
)";

TEST(ScenarioBodies, StartsABodyOfChoreonoidWhereItsFileSays) {
  write_file("cart.body", cart);
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n"
      "  - {name: A, model: cart.body}\n"
      "  - {name: B, model: cart.body, position: [0, 1, 0], rotation: [0, 0, 0], joints: {ARM: 45 deg}}\n"
      "materials: {A: Wood, B/ARM: Wood}\n"
      "pairs:\n  - {between: [Rubber, Wood], friction: 0.7}\n");
  ASSERT_EQ(scenario.bodies.size(), 2u);
  const ScenarioBody &a = scenario.bodies[0], &b = scenario.bodies[1];
  EXPECT_EQ(a.position, Eigen::Vector3d(2, 0, 0.5));
  EXPECT_NEAR(a.rotation.angularDistance(
                  Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ()))),
              0.0, 1e-12);
  ASSERT_EQ(a.joints.size(), 2u);  // the arm has the id 0, the wheel none
  EXPECT_NEAR(a.joints[0], std::numbers::pi / 6.0, 1e-12);
  EXPECT_EQ(a.joints[1], 0.0);
  EXPECT_THAT(a.materials, ::testing::ElementsAre("Rubber", "Wood", "Wood"));
  EXPECT_EQ(b.position, Eigen::Vector3d(0, 1, 0));
  EXPECT_NEAR(b.joints[0], std::numbers::pi / 4.0, 1e-12);
  EXPECT_THAT(b.materials, ::testing::ElementsAre("Rubber", "", "Wood"));
}

/// -45 rad are seven turns: the unit was forgotten.
TEST(ScenarioBodies, SuggestDegreesForAnAngleBeyondATurnWithoutAUnit) {
  write_file("cart.body", cart);
  const auto remarks = [](const std::string& keys) {
    return to_string(
        loaded("rehearse: 1\nduration: 1\nbodies:\n  - {name: A, model: cart.body, " + keys + "}\n").warnings);
  };
  EXPECT_THAT(
      remarks("joints: {ARM: -45}"),
      HasSubstr(":4:47: warning: ARM has no unit, so it is -45 rad, 7.2 turns (in degrees: -45 deg; if radians are "
                "meant: -45 rad)"));
  EXPECT_THAT(remarks("joints: [7, 0]"), HasSubstr("warning: ARM has no unit, so it is 7 rad, 1.1 turns"));
  EXPECT_THAT(remarks("rotation: [0, 0, 90]"), HasSubstr("warning: rotation[2] has no unit, so it is 90 rad"));
  EXPECT_THAT(remarks("rotation: {axis: [0, 0, 1], angle: 90}"), HasSubstr("warning: angle has no unit"));
  for (const char* right :
       {"joints: {ARM: 45 deg}", "joints: {ARM: 6.28}", "joints: {ARM: 45 rad}", "rotation: [0, 0, 90 deg]"})
    EXPECT_THAT(remarks(right), Not(HasSubstr("has no unit"))) << right;
}

TEST(ScenarioBodies, MakesAModelOfACylinder) {
  const ScenarioBody body = only_body("cylinder: {radius: 0.1, length: 0.4, color: [0, 0, 0, 0.5]}, mass: 1");
  ASSERT_NE(body.model, nullptr);
  const auto cylinder = std::get<Cylinder>(body.model->links[0].collisions[0].geometry);
  EXPECT_EQ(cylinder.radius, 0.1);
  EXPECT_EQ(cylinder.length, 0.4);
  EXPECT_EQ(body.model->links[0].visuals[0].color, Color(0.0f, 0.0f, 0.0f, 0.5f));
}

TEST(ScenarioBodies, LaysACheckerOnWhatIsSeenOfAShape) {
  const ScenarioBody body = only_body("sphere: {radius: 1, checker: {color: [0, 1, 0.5], size: 0.2}}, mass: 1");
  ASSERT_NE(body.model, nullptr);
  const std::optional<Checker>& checker = body.model->links[0].visuals[0].checker;
  ASSERT_TRUE(checker);
  EXPECT_EQ(checker->color, Color(0.0f, 1.0f, 0.5f, 1.0f));
  EXPECT_EQ(checker->size, 0.2);
  EXPECT_FALSE(body.model->links[0].collisions[0].checker);
  EXPECT_EQ(only_body("box: {size: [1, 1, 1], checker: {color: [1, 1, 1]}}, mass: 1")
                .model->links[0]
                .visuals[0]
                .checker->size,
            1.0);
}

TEST(ScenarioBodies, NeedsNoMassOfAFixedShape) {
  const ScenarioBody body = only_body("sphere: {radius: 1}, fixed: true");
  ASSERT_NE(body.model, nullptr);
  EXPECT_TRUE(body.fixed);
}

TEST(ScenarioBodies, LoadsAModelOnceForAllWhoHaveIt) {
  const std::string model = (fixtures / "models/sr1.urdf").string();
  const Scenario scenario =
      loaded("rehearse: 1\nduration: 1\nbodies: [{name: A, model: " + model + "}, {name: B, model: " + model + "}]\n");
  ASSERT_EQ(scenario.bodies.size(), 2u);
  EXPECT_EQ(scenario.bodies[0].model, scenario.bodies[1].model);
}

TEST(ScenarioBodies, TellsABrokenModelsMistakesOnce) {
  write_file("broken.urdf", "<robot name='r'></robot>");
  const auto result = load_text(
      "rehearse: 1\nduration: 1\nbodies:\n  - {name: A, model: broken.urdf}\n  - {name: B, model: broken.urdf}\n");
  ASSERT_FALSE(result.ok());
  ASSERT_GE(result.errors().size(), 2u);
  EXPECT_THAT(to_string(result.errors()[0]), HasSubstr("test.yaml:4:22: error: the model 'broken.urdf' can't be used"));
  EXPECT_THAT(result.errors()[1].file, HasSubstr("broken.urdf"));
  for (const Diagnostic& diagnostic : result.errors()) EXPECT_NE(diagnostic.line, 5) << mistakes(result);
}

TEST(ScenarioBodies, PassesAModelsRepairsOn) {
  std::string model = slider;
  model.replace(model.find("<limit"), model.find("velocity=\"1\"/>") + 14 - model.find("<limit"), "");
  write_file("repaired.urdf", model);
  const Scenario scenario = loaded("rehearse: 1\nduration: 1\nbodies: [{name: S, model: repaired.urdf}]\n");
  EXPECT_THAT(to_string(scenario.warnings), HasSubstr("repaired.urdf"));
  EXPECT_THAT(to_string(scenario.warnings), HasSubstr("repair: "));
}

TEST(ScenarioBodies, ReadsDisplacementsInMetresOfAPrismaticJoint) {
  const auto result = load_slider("    joints: [0.25]\n");
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_EQ(result.value().bodies[0].joints, std::vector<double>{0.25});
}

TEST(ScenarioBodies, RefusesAnAngleForAPrismaticJoint) {
  EXPECT_THAT(mistakes(load_slider("    joints: {SLIDE: 10 deg}\n")), HasSubstr(":6:21: error: SLIDE is '10 deg'"));
}

TEST(ScenarioBodies, RefusesADisplacementOfAFixedJoint) {
  EXPECT_THAT(mistakes(load_slider("    joints: {BOLT: 0}\n")), HasSubstr(":6:14: error: joint 'BOLT' of S is fixed"));
}

TEST(ScenarioBodies, WarnsOfAJointThatStartsOutsideItsLimits) {
  const auto result = load_slider("    joints: {SLIDE: 0.7}\n");
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_THAT(to_string(result.value().warnings),
              HasSubstr(":6:21: warning: SLIDE starts at 0.7, outside its limits (they are 0 to 0.5)"));
}

TEST(ScenarioBodies, ForgivesALimitThatWasRounded) {
  const auto result = load_slider("    joints: {SLIDE: 0.5000005}\n");
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_THAT(to_string(result.value().warnings), IsEmpty());
}

std::string slider_between(const std::string& lower, const std::string& upper) {
  std::string model = slider;
  model.replace(model.find("lower=\"0\" upper=\"0.5\""), 21, "lower=\"" + lower + "\" upper=\"" + upper + "\"");
  return model;
}

TEST(ScenarioBodies, StartsAJointThatCantBeAtZeroAtItsNearestLimit) {
  write_file("stretched.urdf", slider_between("0.1", "0.5"));
  write_file("drawn_in.urdf", slider_between("-0.5", "-0.25"));
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - {name: S, model: stretched.urdf}\n  - {name: D, model: drawn_in.urdf}\n");
  EXPECT_EQ(scenario.bodies.at(0).joints, std::vector<double>{0.1});
  EXPECT_EQ(scenario.bodies.at(1).joints, std::vector<double>{-0.25});
  EXPECT_THAT(
      to_string(scenario.warnings),
      HasSubstr(":4:5: warning: SLIDE starts at 0.1, its limit that is nearest to 0 (joints: states where it starts)"));
}

TEST(ScenarioBodies, StartsAJointWhereItIsToldEvenIfThatIsZeroOutsideItsLimits) {
  write_file("stretched.urdf", slider_between("0.1", "0.5"));
  const Scenario scenario =
      loaded("rehearse: 1\nduration: 1\nbodies: [{name: S, model: stretched.urdf, joints: {SLIDE: 0}}]\n");
  EXPECT_EQ(scenario.bodies.at(0).joints, std::vector<double>{0.0});
  EXPECT_THAT(to_string(scenario.warnings), HasSubstr("warning: SLIDE starts at 0, outside its limits"));
}

/// A slider none of whose links has mass.
std::string hollow_slider() {
  std::string model = slider;
  for (std::size_t at = model.find("<inertial>"); at != std::string::npos; at = model.find("<inertial>"))
    model.erase(at, model.find("</inertial>") + 11 - at);
  return model;
}

Result<Scenario> load_hollow(const std::string& keys) {
  write_file("hollow.urdf", hollow_slider());
  return load_text("rehearse: 1\nduration: 1\nbodies: [{name: S, model: hollow.urdf" + keys + "}]\n");
}

TEST(ScenarioBodies, BeginWithTheirVelocities) {
  const auto result =
      load_slider("    velocity: {linear: [1, 2, 3], angular: [0, 0, 0.5]}\n    joint_velocities: {SLIDE: -0.25}\n");
  ASSERT_TRUE(result.ok()) << mistakes(result);
  const ScenarioBody& body = result->bodies[0];
  EXPECT_EQ(body.linear_velocity, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(body.angular_velocity, Eigen::Vector3d(0, 0, 0.5));
  EXPECT_EQ(body.joint_velocities, std::vector<double>{-0.25});
  EXPECT_EQ(load_slider("")->bodies[0].joint_velocities, std::vector<double>{0.0});
}

TEST(ScenarioBodies, GivesAFollowerTheVelocityOfWhatItFollows) {
  const std::string file = (fixtures / "models/gripper.urdf").string();
  const Scenario scenario =
      loaded("rehearse: 1\nduration: 1\nbodies:\n  - {name: G, model: " + file + ", joint_velocities: {LEFT: 0.01}}\n");
  const Model& model = *scenario.bodies.at(0).model;
  const auto id_of = [&model](const char* joint) {
    return static_cast<std::size_t>(model.links.at(static_cast<std::size_t>(model.find_joint(joint))).joint.id);
  };
  EXPECT_EQ(scenario.bodies[0].joint_velocities.at(id_of("LEFT")), 0.01);
  EXPECT_EQ(scenario.bodies[0].joint_velocities.at(id_of("RIGHT")), -0.01);
}

TEST(ScenarioBodies, GivesAShapeItsSurface) {
  const std::string box = "box: {size: [1, 1, 1]}, mass: 1";
  const Surface surface = only_body(box + ", friction: 0.2, restitution: 0.5").model->links[0].surface;
  EXPECT_EQ(surface.friction, 0.2);
  EXPECT_EQ(surface.restitution, 0.5);
  EXPECT_FALSE(surface.second_friction);
  const Surface across = only_body(box + ", mu2: 0.1").model->links[0].surface;
  EXPECT_EQ(across.second_friction, 0.1);
  EXPECT_EQ(across.friction_direction, Eigen::Vector3d::UnitX());
  EXPECT_EQ(only_body(box + ", mu2: 0.1, fdir1: [0, 2, 0]").model->links[0].surface.friction_direction,
            Eigen::Vector3d::UnitY());
}

TEST(ScenarioBodies, GivesLinksOtherMassesAndSurfaces) {
  const auto changed = load_slider("    links: {CART: {mass: 3}, TOP: {friction: 0.2, restitution: 0.1}}\n");
  ASSERT_TRUE(changed) << to_string(changed.errors());
  const Model& model = *changed->bodies[0].model;
  const Link& cart = model.links[static_cast<std::size_t>(model.find_link("CART"))];
  EXPECT_EQ(cart.inertial.mass, 3.0);
  EXPECT_EQ(cart.inertial.inertia, Eigen::Matrix3d(3.0 * Eigen::Matrix3d::Identity())) << "of the same shape";
  EXPECT_EQ(model.links[0].inertial.mass, 1.0);
  const Surface& top = model.links[static_cast<std::size_t>(model.find_link("TOP"))].surface;
  EXPECT_EQ(top.friction, 0.2);
  EXPECT_EQ(top.restitution, 0.1);
  EXPECT_FALSE(cart.surface.friction);
}

/// The materials of a model that can't be used are unknown: a pair of them is no second mistake.
TEST(ScenarioMaterials, AreNotMissedIfAModelCantBeUsed) {
  const std::string text =
      "rehearse: 1\nduration: 1\nbodies:\n  - {name: Cart, model: absent.body}\n"
      "pairs:\n  - {between: [Rubber, Rubber], friction: 0.5}\n";
  const std::string found = mistakes(load_text(text));
  EXPECT_THAT(found, HasSubstr("absent.body"));
  EXPECT_THAT(found, Not(HasSubstr("no link has the material")));
}

TEST(ScenarioMaterials, AreOfBodiesAndOfLinks) {
  write_file("slider.urdf", slider);
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - {name: S, model: slider.urdf}\n  - {name: T, model: slider.urdf}\n"
      "materials: {S/CART: rubber, S: steel}\n"
      "pairs:\n  - {between: [steel, rubber], friction: 0.7}\n  - {between: [steel, steel], restitution: 0.9}\n");
  EXPECT_THAT(scenario.bodies.at(0).materials, ::testing::ElementsAre("steel", "rubber", "steel"));
  EXPECT_THAT(scenario.bodies.at(1).materials, IsEmpty());
  ASSERT_EQ(scenario.pairs.size(), 2u);
  EXPECT_THAT(scenario.pairs[0].materials, ::testing::ElementsAre("rubber", "steel"));
  EXPECT_EQ(scenario.pairs[0].friction, 0.7);
  EXPECT_FALSE(scenario.pairs[0].restitution);
  EXPECT_EQ(scenario.pairs[1].restitution, 0.9);
}

TEST(ScenarioBodies, GivesWhatMovesWithoutMassTheDefaultMass) {
  EXPECT_THAT(mistakes(load_hollow("")), HasSubstr("error: link 'CART' moves but has no mass"));
  const auto result = load_hollow(", default_mass: 2");
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_EQ(result->bodies[0].model->links[1].inertial.mass, 2.0);
  EXPECT_TRUE(result->bodies[0].fixed);
  EXPECT_THAT(to_string(result->warnings), HasSubstr("repair: root link 'RAIL' has no mass; it is fixed to the world"));
  EXPECT_THAT(to_string(result->warnings), HasSubstr("repair: link 'CART' moves but has no mass"));
}

TEST(ScenarioBodies, OfAFixedRootIsntToldThatItWasFixed) {
  const auto result = load_hollow(", default_mass: 2, fixed: true");
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_TRUE(result->bodies[0].fixed);
  EXPECT_THAT(to_string(result->warnings), ::testing::Not(HasSubstr("RAIL")));
}

TEST(ScenarioBodies, SaysWhyAMasslessRootCantBeFree) {
  const auto result = load_hollow(", default_mass: 2, fixed: false");
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_TRUE(result->bodies[0].fixed);
  EXPECT_THAT(to_string(result->warnings), HasSubstr("so it stays fixed (give it an <inertial> to set it free)"));
}

TEST(ScenarioBodies, NeedsNoMassesOfAKinematicModel) {
  const auto result = load_hollow(", dynamics: kinematic");
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_FALSE(result->bodies[0].fixed);
  EXPECT_THAT(to_string(result->warnings), IsEmpty());
}

TEST(ScenarioBodies, LeavesOutMissingMeshesWhereThatIsAllowed) {
  write_file("arm.urdf",
             "<robot name='arm'><link name='world'><visual><geometry><mesh filename='absent.stl'/></geometry></visual>"
             "</link></robot>");
  const std::string body = "rehearse: 1\nduration: 1\nbodies: [{name: A, model: arm.urdf";
  EXPECT_THAT(mistakes(load_text(body + "}]\n")), HasSubstr("the mesh 'absent.stl' can't be used"));
  const Scenario scenario = loaded(body + ", allow_missing_meshes: true}]\n");
  EXPECT_TRUE(scenario.bodies.at(0).model->links.at(0).visuals.empty());
  EXPECT_THAT(to_string(scenario.warnings), HasSubstr("warning: the mesh 'absent.stl' can't be used: it isn't there; "
                                                      "its shape is left out"));
}

TEST(ScenarioBodies, BeginsInAKeyframeOfAMujocoModel) {
  write_file("dog.xml",
             "<mujoco><worldbody><body name='a'><freejoint/><geom size='0.1'/><body name='b'><joint name='j'/>"
             "<geom size='0.1'/></body><body name='c'><joint name='k'/><geom size='0.1'/></body></body></worldbody>"
             "<keyframe><key name='up' qpos='1 2 3 0 0 0 1 0.4 0.5'/></keyframe></mujoco>");
  const std::string body = "rehearse: 1\nduration: 1\nbodies: [{name: A, model: dog.xml, posture: ";
  const Scenario up = loaded(body + "up, joints: {k: -0.2}}]\n");
  EXPECT_EQ(up.bodies.at(0).position, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(up.bodies.at(0).rotation.z(), 1.0, 1e-15);
  EXPECT_THAT(up.bodies.at(0).joints, testing::ElementsAre(0.4, -0.2));
  EXPECT_EQ(loaded(body + "up, position: [0, 0, 1]}]\n").bodies.at(0).position, Eigen::Vector3d(0, 0, 1));
  EXPECT_THAT(mistakes(load_text(body + "down}]\n")), HasSubstr("the model has no posture 'down'"));
}

TEST(ScenarioBodies, LeavesOutWhatIsUnsupportedWhereThatIsAllowed) {
  write_file("string.xml",
             "<mujoco><worldbody><body name='a'><freejoint/><geom size='0.1'/></body></worldbody>"
             "<tendon><fixed name='string'/></tendon></mujoco>");
  const std::string body = "rehearse: 1\nduration: 1\nbodies: [{name: A, model: string.xml";
  EXPECT_THAT(mistakes(load_text(body + "}]\n")), HasSubstr("<tendon> isn't supported"));
  EXPECT_EQ(loaded(body + ", allow_unsupported: true}]\n").bodies.size(), 1u);
}

TEST(ScenarioBodies, LoadsAModelAsEachBodyWantsIt) {
  write_file("hollow.urdf", hollow_slider());
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - {name: A, model: hollow.urdf, default_mass: 1}\n"
      "  - {name: B, model: hollow.urdf, default_mass: 2}\n  - {name: C, model: hollow.urdf, default_mass: 1}\n");
  EXPECT_EQ(scenario.bodies.at(0).model->mass(), 1.0);
  EXPECT_EQ(scenario.bodies.at(1).model->mass(), 2.0);
  EXPECT_EQ(scenario.bodies.at(2).model, scenario.bodies.at(0).model);
}

TEST(ScenarioBodies, WarnsOfSensorsFasterThanTheSteps) {
  const std::string model = (fixtures / "broken/scenario_model_camera_faster_than_steps.urdf").string();
  const std::string text = "rehearse: 1\nduration: 1\nbodies: [{name: S, model: " + model + "}]\n";
  EXPECT_EQ(
      to_string(loaded(text).warnings).substr(to_string(loaded(text).warnings).find(":3:10")),
      ":3:10: warning: S/Eye is to measure at 2000 Hz, but there are 1000 steps in a second: it measures in each of "
      "them (its update_rate is in the model)\n");
  EXPECT_THAT(to_string(loaded(text + "cameras: [S/Slow]\n").warnings), IsEmpty());
  EXPECT_THAT(to_string(loaded(text + "time_step: 0.0005\n").warnings), IsEmpty());
}

TEST(ScenarioBodies, StaysFixedWhereItsModelFixesIt) {
  std::string model = slider;
  model.replace(model.find("<link name=\"RAIL\""), 0, "<link name=\"world\"/>");
  model.replace(model.find("</robot>"), 0,
                "<joint name=\"FLOOR\" type=\"fixed\"><parent link=\"world\"/><child link=\"RAIL\"/></joint>");
  write_file("bolted.urdf", model);
  const Scenario silent = loaded("rehearse: 1\nduration: 1\nbodies: [{name: S, model: bolted.urdf}]\n");
  EXPECT_TRUE(silent.bodies.at(0).fixed);
  EXPECT_THAT(silent.warnings, IsEmpty());
  const Scenario freed = loaded("rehearse: 1\nduration: 1\nbodies: [{name: S, model: bolted.urdf, fixed: false}]\n");
  EXPECT_TRUE(freed.bodies.at(0).fixed);
  EXPECT_THAT(to_string(freed.warnings), HasSubstr("warning: the model fixes its root link 'world' to the world"));
}

TEST(ScenarioBodies, NamesAControllerAfterItsLibrary) {
  const ScenarioBody body = only_body("sphere: {radius: 1}, mass: 1, controllers: [{library: build/lib/Hold.so}]");
  ASSERT_EQ(body.controllers.size(), 1u);
  EXPECT_EQ(body.controllers[0].name, "Hold");
  EXPECT_EQ(body.controllers[0].library, "build/lib/Hold.so");
  EXPECT_TRUE(body.controllers[0].delay);
  EXPECT_EQ(body.controllers[0].place.line, 4);
  EXPECT_EQ(body.controllers[0].place.column, 73);
}

TEST(ScenarioBodies, ReadsAControllerAndItsChildren) {
  const ScenarioBody body = only_body(
      "sphere: {radius: 1}, mass: 1, controllers: [{name: Top, library: Hold, options: 'a \"b c\"', delay: false, "
      "children: [{library: Lift, options: 3}]}]");
  ASSERT_EQ(body.controllers.size(), 1u);
  const ScenarioController& top = body.controllers[0];
  EXPECT_EQ(top.name, "Top");
  EXPECT_EQ(top.options, "a \"b c\"");
  EXPECT_FALSE(top.delay);
  ASSERT_EQ(top.children.size(), 1u);
  EXPECT_EQ(top.children[0].name, "Lift");
  EXPECT_EQ(top.children[0].options, "3");
}

TEST(ScenarioBodies, MayBeGroundOfAHeightmap) {
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n  - {name: Ground, position: [0, 0, 1], friction: 0.4, heightmap: {file: " +
      (fixtures / "terrain/hills.txt").string() + ", size: [4, 3], height: 2, color: [0, 1, 0]}}\n");
  ASSERT_EQ(scenario.bodies.size(), 1u);
  const ScenarioBody& body = scenario.bodies[0];
  EXPECT_TRUE(body.fixed);
  EXPECT_EQ(body.model->source_text, read_file(fixtures / "terrain/hills.txt"));
  const Link& link = body.model->links.at(0);
  EXPECT_EQ(link.surface.friction, 0.4);
  const Mesh& mesh = std::get<Mesh>(link.collisions.at(0).geometry);
  ASSERT_NE(mesh.heightmap, nullptr);
  EXPECT_EQ(mesh.heightmap->columns, 25);
  EXPECT_EQ(mesh.heightmap->size, Eigen::Vector2d(4, 3));
  EXPECT_NEAR(mesh.data->upper.z(), 2.0 * 0.25, 0.02);  // the file's hill is 0.25 high
  EXPECT_EQ(link.visuals.at(0).color, Color(0, 1, 0, 1));
}

TEST(ScenarioBodies, SayHowTheyAreTouched) {
  const auto body = [](const std::string& more) {
    const auto scenario =
        load_text("rehearse: 1\nduration: 1\nbodies: [{name: B, sphere: {radius: 1}, mass: 1" + more + "}]");
    EXPECT_TRUE(scenario.ok()) << to_string(scenario.errors());
    return scenario->bodies[0];
  };
  EXPECT_EQ(body("").contact.meshes, MeshContact::automatic);
  EXPECT_FALSE(body("").self_collision);
  EXPECT_EQ(body(", collision: hull").contact.meshes, MeshContact::hull);
  EXPECT_EQ(body(", collision: parts").contact.meshes, MeshContact::parts);
  EXPECT_EQ(body(", fixed: true, collision: triangles").contact.meshes, MeshContact::triangles);
  EXPECT_TRUE(body(", self_collision: true").self_collision);
}

}  // namespace
}  // namespace rehearse
