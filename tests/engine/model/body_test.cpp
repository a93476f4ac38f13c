// What the loader of .body files makes of links, joints, masses, shapes and devices.
#include <rehearse/body.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <variant>

#include "support/temporary_folder.h"

namespace rehearse {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double degree = std::numbers::pi / 180.0;

Model model_of(const std::string& links, const std::string& head = "format_version: 2.0\n") {
  auto model = parse_body("format: ChoreonoidBody\n" + head + links, FIXTURES_DIR "/models/test.body");
  EXPECT_TRUE(model.ok()) << to_string(model.errors());
  return model ? *std::move(model) : Model();
}

std::vector<std::string> names_of(const std::vector<Link>& links) {
  std::vector<std::string> names;
  for (const Link& link : links) names.push_back(link.name);
  return names;
}

void expect_near(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1e-9) << "got\n" << a << "\nexpected\n" << b;
}

TEST(Body, TakesDegreesOfSensorsWhereRadiansAreImpossible) {
  const std::string links = R"(links:
  - name: BASE
    elements:
      - { type: RangeSensor, name: SCAN, yaw_range: 270, yaw_step: 1, max_distance: 10 }
      - { type: Camera, name: EYE, format: COLOR, field_of_view: 62 }
      - { type: RangeSensor, name: RADIANS, yaw_range: 3, yaw_step: 0.5, max_distance: 10 }
      - { type: Camera, name: WIDE, format: COLOR, field_of_view: 2 }
)";
  const Model model = model_of(links, "formatVersion: 1.0\nangleUnit: radian\n");
  const auto& scan = std::get<RangeSensor>(model.devices.at(0).kind);
  EXPECT_EQ(scan.yaw.samples, 271);
  EXPECT_NEAR(scan.yaw.upper, 135.0 * degree, 1e-12);
  EXPECT_NEAR(std::get<Camera>(model.devices.at(1).kind).field_of_view, 62.0 * degree, 1e-12);
  const auto& in_radians = std::get<RangeSensor>(model.devices.at(2).kind);
  EXPECT_EQ(in_radians.yaw.samples, 7);
  EXPECT_EQ(in_radians.yaw.upper, 1.5);
  EXPECT_EQ(std::get<Camera>(model.devices.at(3).kind).field_of_view, 2.0);
  EXPECT_THAT(to_string(model.report),
              AllOf(HasSubstr("the yaw of a range sensor can't be 270 rad: 270 degrees are taken"),
                    HasSubstr("the field of view of Camera 'EYE' can't be 62 rad: 62 degrees are taken"),
                    Not(HasSubstr("2 rad: 2 degrees"))));
}

TEST(Body, HasItsLinksDepthFirstAndItsJointsByTheirIds) {
  const Model model = model_of(R"(links:
  - { name: BASE, joint_type: free, translation: [ 0, 0, 0.5 ] }
  - { name: LEFT, parent: BASE, joint_type: revolute, joint_id: 1, mass: 1 }
  - { name: RIGHT, parent: BASE, joint_type: revolute, joint_id: 0, mass: 1 }
  - { name: WHEEL, parent: LEFT, joint_type: revolute, mass: 1 }
  - { name: BELT, parent: BASE, joint_type: pseudo_continuous_track, mass: 1 }
  - { name: COVER, parent: BASE, joint_id: 2, mass: 1 }
)");
  EXPECT_THAT(names_of(model.links), ElementsAre("BASE", "LEFT", "WHEEL", "RIGHT", "BELT", "COVER"));
  std::vector<std::string> joints;
  for (const int link : model.joints) joints.push_back(model.links[static_cast<std::size_t>(link)].name);
  EXPECT_THAT(joints, ElementsAre("RIGHT", "LEFT", "WHEEL", "BELT"));
  for (std::size_t id = 0; id < model.joints.size(); ++id)
    EXPECT_EQ(model.links[static_cast<std::size_t>(model.joints[id])].joint.id, static_cast<int>(id));
  EXPECT_EQ(model.links[2].joint.controller_id, -1);
  EXPECT_EQ(model.links[5].joint.controller_id, 2);
  EXPECT_EQ(model.links[5].joint.type, JointType::fixed);
  EXPECT_EQ(model.links[0].joint.type, JointType::free);
  expect_near(model.links[0].joint.origin.translation(), Eigen::Vector3d(0, 0, 0.5));
}

TEST(Body, ReadsAnglesInDegreesUnlessAnOldFileSaysRadian) {
  const std::string links = R"(links:
  - { name: BASE }
  - { name: ARM, parent: BASE, jointType: revolute, jointRange: 0.5, jointAngle: 0.25, maxJointVelocity: 2, mass: 1,
      rotation: [ 0, 0, 2, 0.3 ] }
)";
  const Model degrees = model_of(links, "formatVersion: 1.0\n");
  const Model radians = model_of(links, "formatVersion: 1.0\nangleUnit: radian\n");
  const Joint &in_degrees = degrees.links[1].joint, &in_radians = radians.links[1].joint;
  EXPECT_DOUBLE_EQ(in_degrees.upper, 0.5 * degree);
  EXPECT_DOUBLE_EQ(in_degrees.lower, -0.5 * degree);
  EXPECT_DOUBLE_EQ(in_degrees.start, 0.25 * degree);
  EXPECT_DOUBLE_EQ(in_degrees.velocity, 2.0 * degree);
  EXPECT_DOUBLE_EQ(in_radians.upper, 0.5);
  EXPECT_DOUBLE_EQ(in_radians.start, 0.25);
  EXPECT_DOUBLE_EQ(in_radians.velocity, 2.0);
  expect_near(in_radians.origin.linear(), Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  expect_near(in_degrees.origin.linear(), Eigen::AngleAxisd(0.3 * degree, Eigen::Vector3d::UnitZ()).toRotationMatrix());
}

TEST(Body, MeansTheSameInBothSpellings) {
  const Model camel = model_of(R"(links:
  - { name: BASE }
  - { name: ARM, parent: BASE, jointType: slide, jointAxis: -x, jointRange: [ -0.1, unlimited ], jointId: 0, mass: 2,
      centerOfMass: [ 0.1, 0, 0 ], rotorInertia: 0.01, gearRatio: 10, jointVelocityRange: [ -3, 3 ] }
)",
                               "formatVersion: 1.0\n");
  const Model snake = model_of(R"(links:
  - { name: BASE }
  - { name: ARM, parent: BASE, joint_type: prismatic, joint_axis: [ -1, 0, 0 ], joint_range: [ -0.1, unlimited ],
      joint_id: 0, mass: 2, center_of_mass: [ 0.1, 0, 0 ], rotor_inertia: 0.01, gear_ratio: 10,
      joint_velocity_range: 3 }
)");
  for (const Model* model : {&camel, &snake}) {
    const Link& arm = model->links[1];
    EXPECT_EQ(arm.joint.type, JointType::prismatic);
    expect_near(arm.joint.axis, -Eigen::Vector3d::UnitX());
    EXPECT_DOUBLE_EQ(arm.joint.lower, -0.1);
    EXPECT_EQ(arm.joint.upper, unlimited);
    EXPECT_DOUBLE_EQ(arm.joint.velocity, 3.0);
    EXPECT_NEAR(arm.joint.armature, 1.0, 1e-12);
    expect_near(arm.inertial.center, Eigen::Vector3d(0.1, 0, 0));
  }
}

TEST(Body, MergesTheRigidBodiesOfALinkWithItsOwnMass) {
  const Model model = model_of(R"(links:
  - name: BASE
    joint_type: free
    mass: 1
    elements:
      - type: RigidBody
        translation: [ 0, 0, 2 ]
        rotation: [ 1, 0, 0, 90 ]
        mass: 3
        center_of_mass: [ 0, 1, 0 ]
        inertia: [ 1, 0, 0, 0, 2, 0, 0, 0, 3 ]
        elements:
          Camera: { format: COLOR, name: EYE, elements: { RigidBody: { mass: 4 } } }
)");
  const Inertial& all = model.links[0].inertial;
  EXPECT_DOUBLE_EQ(all.mass, 8.0);
  expect_near(all.center, Eigen::Vector3d(0, 0, (3.0 * 3.0 + 4.0 * 2.0) / 8.0));
  const double c = all.center.z(), spread = c * c + 3.0 * (3.0 - c) * (3.0 - c) + 4.0 * (2.0 - c) * (2.0 - c);
  expect_near(all.inertia, Eigen::Vector3d(1.0 + spread, 3.0 + spread, 2.0).asDiagonal());  // y and z change places
}

TEST(Body, GivesALinkWithoutMassOneKilogram) {
  const Model model = model_of("links:\n  - { name: BASE, joint_type: free }\n");
  EXPECT_EQ(model.mass(), 1.0);
  EXPECT_EQ(model.links[0].inertial.inertia, Eigen::Matrix3d::Identity());
  EXPECT_THAT(to_string(model.report), HasSubstr("link 'BASE' has no mass: it gets 1 kg"));
}

TEST(Body, TurnsAndScalesItsShapes) {
  const Model model = model_of(R"(links:
  - name: BASE
    elements:
      Transform:
        translation: [ 1, 0, 0 ]
        scale: [ 2, 3, 2 ]
        elements:
          - { type: Shape, geometry: { type: Cylinder, radius: 0.1, height: 1 } }
          - { type: Shape, geometry: { type: Box, size: [ 1, 1, 1 ] } }
          - { type: Shape, geometry: { type: Sphere, radius: 1 } }
)");
  const std::vector<Shape>& shapes = model.links[0].collisions;
  ASSERT_EQ(shapes.size(), 3u);
  const auto& cylinder = std::get<Cylinder>(shapes[0].geometry);
  EXPECT_NEAR(cylinder.radius, 0.2, 1e-12);
  EXPECT_NEAR(cylinder.length, 3.0, 1e-12);
  expect_near(shapes[0].pose * Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 1, 0));  // its axis is y
  expect_near(std::get<Box>(shapes[1].geometry).size, Eigen::Vector3d(2, 3, 2));
  const auto& ellipsoid = std::get<Mesh>(shapes[2].geometry);
  expect_near(ellipsoid.data->upper, Eigen::Vector3d(2, 3, 2));
  EXPECT_EQ(ellipsoid.hulls->size(), 1u);
}

TEST(Body, SeparatesWhatIsSeenFromWhatIsTouched) {
  const Model model = model_of(R"(links:
  - name: BASE
    elements:
      - type: Visual
        shape: { geometry: { type: Sphere, radius: 1 }, appearance: { material: { diffuse: [ 1, 0, 0 ] } } }
      - { type: Collision, elements: { Shape: { geometry: { type: Box, size: [ 1, 1, 1 ] } } } }
      - { type: Shape, geometry: { type: Cone, radius: 1, height: 2 } }
)");
  const Link& link = model.links[0];
  ASSERT_EQ(link.visuals.size(), 2u);
  ASSERT_EQ(link.collisions.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<Sphere>(link.visuals[0].geometry));
  EXPECT_EQ(link.visuals[0].color, Color(1, 0, 0, 1));
  EXPECT_TRUE(std::holds_alternative<Box>(link.collisions[0].geometry));
  const auto& cone = std::get<Mesh>(link.collisions[1].geometry);
  EXPECT_FLOAT_EQ(static_cast<float>(cone.data->upper.y()), 1.0f);
  EXPECT_FLOAT_EQ(static_cast<float>(cone.data->lower.y()), -1.0f);
}

TEST(Body, VisitsAMappingOfElementsByTheAlphabet) {
  const Model model = model_of(R"(links:
  - name: BASE
    elements:
      Visual: { shape: { geometry: { type: Sphere, radius: 1 } } }
      Shape: { geometry: { type: Box } }
)");
  ASSERT_EQ(model.links[0].visuals.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<Box>(model.links[0].visuals[0].geometry));
}

TEST(Body, MergesMappingsAndFollowsAliases) {
  const Model model = model_of(R"(defaults: &D { mass: 5, joint_type: prismatic }
links:
  - { name: BASE, elements: &E [ { type: Shape, geometry: { type: Box } } ] }
  - { <<: *D, name: ARM, parent: BASE, joint_type: revolute, elements: *E }
)");
  EXPECT_EQ(model.links[1].inertial.mass, 5.0);
  EXPECT_EQ(model.links[1].joint.type, JointType::continuous);
  EXPECT_EQ(model.links[1].visuals.size(), 1u);
}

TEST(Body, PlacesDevicesByAllTransformsAboveThem) {
  const Model model = model_of(R"(links:
  - name: BASE
    elements:
      - type: Transform
        translation: [ 0, 0, 1 ]
        rotation: [ 0, 0, 1, 90 ]
        elements:
          - { type: Camera, name: EYE, id: 3, format: COLOR_DEPTH, translation: [ 1, 0, 0 ], field_of_view: 60,
              width: 320, height: 240, optical_frame: robotics }
          - { type: RangeSensor, name: LASER, yaw_range: 180, yaw_step: 1, max_distance: 5, scan_rate: 20 }
          - { type: SpotLight, name: LAMP, beam_width: 30, on: false }
  - { name: HAND, parent: BASE, mass: 1, elements: { ForceSensor: { name: FORCE, id: 0 } } }
)");
  ASSERT_EQ(model.devices.size(), 4u);
  const Device& eye = model.devices[0];
  EXPECT_EQ(eye.id, 3);
  expect_near(eye.pose.translation(), Eigen::Vector3d(0, 1, 1));
  expect_near(eye.pose.linear() * -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());  // it looks along its own x
  expect_near(eye.pose.linear() * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  const auto& camera = std::get<Camera>(eye.kind);
  EXPECT_TRUE(camera.depth);
  EXPECT_NEAR(camera.field_of_view, 60.0 * degree, 1e-12);
  const auto& laser = std::get<RangeSensor>(model.devices[1].kind);
  EXPECT_EQ(laser.yaw.samples, 181);
  EXPECT_NEAR(laser.yaw.lower, -std::numbers::pi / 2.0, 1e-12);
  EXPECT_EQ(laser.pitch.samples, 1);
  EXPECT_FALSE(std::get<Light>(model.devices[2].kind).on);
  EXPECT_EQ(model.devices[3].link, 1);
}

TEST(Body, KeepsRulesOfContactAndMaterials) {
  const Model model = model_of(R"(links:
  - { name: A, material: Ground, elements: { Shape: { geometry: { type: Box } } } }
  - { name: B, parent: A, elements: { Shape: { geometry: { type: Box } } } }
  - { name: C, parent: B, elements: { Shape: { geometry: { type: Box } } } }
  - { name: D, parent: C, elements: { Shape: { geometry: { type: Box } } } }
collision_detection_rules:
  - disabled_link_chain_level: 1
  - disabled_link_group: [ A, C ]
  - disabled_links: [ D ]
)");
  EXPECT_EQ(model.links[0].material, "Ground");
  EXPECT_THAT(model.apart, ElementsAre(std::array{0, 1}, std::array{0, 2}, std::array{1, 2}, std::array{2, 3}));
  EXPECT_FALSE(model.links[2].collisions.empty());
  EXPECT_TRUE(model.links[3].collisions.empty());
  EXPECT_FALSE(model.links[3].visuals.empty());
}

/// What the file says of the second link has no effect: the joint is there where it is when a run begins.
TEST(Body, ClosesLoopsByItsExtraJoints) {
  const auto model = parse_body(R"(format: ChoreonoidBody
format_version: 2.0
name: Loop
links:
  - { name: A, joint_type: free, mass: 1, inertia: [1, 0, 0, 0, 1, 0, 0, 0, 1] }
  - { name: B, parent: A, joint_type: revolute, mass: 1, inertia: [1, 0, 0, 0, 1, 0, 0, 0, 1] }
  - { name: C, parent: A, joint_type: revolute, mass: 1, inertia: [1, 0, 0, 0, 1, 0, 0, 0, 1] }
extra_joints:
  - { link1_name: B, link2_name: C, joint_type: hinge, axis: [0, 0, 2], translation_in_link1: [0.1, 0.2, 0],
      translation_in_link2: [9, 9, 9] }
  - { name: ball, link1_name: C, link2_name: A, joint_type: ball }
  - { link1_name: A, link2_name: C, joint_type: piston }
)",
                                "loop.body");
  ASSERT_TRUE(model.ok()) << to_string(model.errors());
  ASSERT_EQ(model->loops.size(), 2u);
  const LoopJoint& hinge = model->loops[0];
  EXPECT_EQ(hinge.name, "B-C");
  EXPECT_EQ(hinge.type, LoopJoint::Type::revolute);
  EXPECT_EQ(model->links[static_cast<std::size_t>(hinge.link)].name, "B");
  EXPECT_EQ(model->links[static_cast<std::size_t>(hinge.other_link)].name, "C");
  EXPECT_EQ(hinge.frame.translation(), Eigen::Vector3d(0.1, 0.2, 0));
  EXPECT_EQ(hinge.axis, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(hinge.has_other_frame);
  EXPECT_EQ(model->loops[1].type, LoopJoint::Type::spherical);
  EXPECT_EQ(model->loops[1].name, "ball");
  EXPECT_THAT(to_string(model->report), ::testing::HasSubstr("the piston that closes a loop"));
}

/// An angle with rounded legs: the number of hulls that contacts take; 0: its triangles.
std::size_t hulls_of_bracket(const std::string& joint_type, MeshContact contact) {
  const std::string text =
      "format: ChoreonoidBody\nformat_version: 2.0\nlinks:\n  - name: BRACKET\n    joint_type: " + joint_type +
      "\n    elements:\n      RigidBody:\n        mass: 1\n        inertia: [1, 0, 0, 0, 1, 0, 0, "
      "0, 1]\n        elements: {Resource: {uri: mesh_arm/meshes/bracket.stl}}\n";
  UrdfOptions options;
  options.contact = contact;
  const auto model = parse_body(text, FIXTURES_DIR "/models/test.body", options);
  EXPECT_TRUE(model.ok()) << to_string(model.errors());
  const auto& mesh = std::get<Mesh>(model->links.at(0).collisions.at(0).geometry);
  return mesh.hulls ? mesh.hulls->size() : 0;
}

TEST(Body, TouchesByTheTrianglesOfAMeshThatNeverMovesAndByConvexPartsIfTheyAreWanted) {
  EXPECT_EQ(hulls_of_bracket("free", MeshContact::automatic), 1u);
  EXPECT_GE(hulls_of_bracket("free", MeshContact::parts), 2u);
  EXPECT_EQ(hulls_of_bracket("fixed", MeshContact::automatic), 0u);
  EXPECT_EQ(hulls_of_bracket("fixed", MeshContact::triangles), 0u);
  EXPECT_EQ(hulls_of_bracket("fixed", MeshContact::hull), 1u);
  EXPECT_GE(hulls_of_bracket("fixed", MeshContact::parts), 2u);
}

TEST(Body, TheWagonOfTheFixturesStandsOnItsWheels) {
  const auto wagon = load_body(FIXTURES_DIR "/models/wagon.body", {.strict = true});
  ASSERT_TRUE(wagon.ok()) << to_string(wagon.errors());
  EXPECT_THAT(names_of(wagon->links),
              ElementsAre("CHASSIS", "STEERING", "FRONT_LEFT", "FRONT_RIGHT", "REAR_LEFT", "REAR_RIGHT"));
  EXPECT_NEAR(wagon->mass(), 12.5, 1e-12);
  EXPECT_EQ(wagon->joints.size(), 5u);
  EXPECT_EQ(wagon->links[2].joint.controller_id, -1);
  const auto poses = forward_kinematics(*wagon, wagon->links[0].joint.origin, std::vector<double>(5, 0.0));
  for (std::size_t i = 2; i < 6; ++i) {
    EXPECT_NEAR(poses[i].translation().z(), std::get<Cylinder>(wagon->links[i].collisions[0].geometry).radius, 1e-12);
    const Mesh& wheel = std::get<Mesh>(wagon->links[i].visuals[0].geometry);
    EXPECT_NEAR(wheel.data->upper.z(), 0.1, 1e-6);  // the file's translation is dropped
  }
  EXPECT_THAT(to_string(wagon->report), ::testing::Not(HasSubstr("warning")));
}

/// A body of three files: an arm that is used twice, and shapes in a file of their own.
class BodyOfFiles : public testing::Test {
 protected:
  BodyOfFiles() {
    write("arm.body", R"(format: ChoreonoidBody
format_version: 2.0
links:
  - { name: UPPER, translation: [ 9, 9, 9 ], joint_type: revolute, joint_id: 0, joint_range: 90, mass: 1,
      elements: { Resource: { uri: shapes.yaml, node: BAR } } }
  - { name: LOWER, parent: UPPER, joint_type: revolute, joint_id: 1, mass: 1,
      elements: { ForceSensor: { name: FORCE } } }
)");
    write("shapes.yaml", R"(BAR: &BAR
  Shape: { geometry: { type: Box, size: [ 0.1, 0.1, 1 ] } }
LENGTH: *WIDTH
)");
    write("robot.body", R"(format: ChoreonoidBody
format_version: 2.0
name: Robot
links:
  - { name: BODY, joint_type: free, mass: 10 }
  - { type: SubBody, uri: arm.body, parent: BODY, prefix: L_, translation: [ 0, 0.2, 0 ] }
  - { type: SubBody, uri: arm.body, parent: BODY, prefix: R_, translation: [ 0, -0.2, 0 ], joint_id_offset: 2,
      joint_type: fixed }
)");
  }
  void write(const char* name, const std::string& text) { std::ofstream(folder_.path() / name) << text; }

  test::TemporaryFolder folder_;
};

TEST_F(BodyOfFiles, JoinsItsSubBodies) {
  std::ofstream(folder_.path() / "shapes.yaml") << "BAR: &BAR\n  Shape: { geometry: { type: Box } }\n";
  const auto model = load_body(folder_.path() / "robot.body");
  ASSERT_TRUE(model.ok()) << to_string(model.errors());
  EXPECT_THAT(names_of(model->links), ElementsAre("BODY", "L_UPPER", "L_LOWER", "R_UPPER", "R_LOWER"));
  const Link& left = model->links[1];
  expect_near(left.joint.origin.translation(), Eigen::Vector3d(0, 0.2, 0));
  EXPECT_EQ(left.joint.type, JointType::continuous);  // its own range is forgotten
  EXPECT_EQ(left.joint.controller_id, 0);
  EXPECT_EQ(left.visuals.size(), 1u);
  EXPECT_EQ(model->links[3].joint.type, JointType::fixed);
  EXPECT_EQ(model->links[4].joint.controller_id, 3);
  ASSERT_EQ(model->devices.size(), 2u);
  EXPECT_EQ(model->devices[1].name, "R_FORCE");
}

TEST_F(BodyOfFiles, LendsItsAnchorsToItsResources) {
  std::ofstream(folder_.path() / "one.body") << R"(format: ChoreonoidBody
format_version: 2.0
width: &WIDTH 0.3
links:
  - { name: BODY, elements: { Resource: { uri: shapes.yaml, node: BAR } } }
)";
  const auto model = load_body(folder_.path() / "one.body");
  ASSERT_TRUE(model.ok()) << to_string(model.errors());
  EXPECT_EQ(model->links[0].visuals.size(), 1u);
}

TEST_F(BodyOfFiles, IsWholeInTheTextOfARecording) {
  std::ofstream(folder_.path() / "shapes.yaml") << "BAR: &BAR\n  Shape: { geometry: { type: Box } }\n";
  const auto model = load_body(folder_.path() / "robot.body");
  ASSERT_TRUE(model.ok()) << to_string(model.errors());
  const auto again = parse_model(model->source_text, "recorded.body", {.meshes = UrdfOptions::Meshes::skip});
  ASSERT_TRUE(again.ok()) << to_string(again.errors());
  EXPECT_EQ(names_of(again->links), names_of(model->links));
  EXPECT_EQ(again->source_text, model->source_text);
}

TEST_F(BodyOfFiles, NamesTheFileOfAMistake) {
  write("arm.body", "format: ChoreonoidBody\nformat_version: 2.0\nlinks:\n  - { name: UPPER, mass: much }\n");
  const auto model = load_body(folder_.path() / "robot.body");
  ASSERT_FALSE(model.ok());
  EXPECT_EQ(model.errors().front().file, (folder_.path() / "arm.body").string());
  EXPECT_EQ(model.errors().front().line, 4);
}

}  // namespace
}  // namespace rehearse
