// Bodies in VRML with OpenHRP's PROTOs, and body files that are named .yaml.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/body.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string hopper = FIXTURES_DIR "/models/hopper.wrl";

Model loaded(const std::string& file, const UrdfOptions& options = {}) {
  auto model = load_model(file, options);
  EXPECT_TRUE(model.ok()) << to_string(model.errors());
  return model ? *std::move(model) : Model();
}

std::vector<std::string> names_of(const Model& model) {
  std::vector<std::string> names;
  for (const Link& link : model.links) names.push_back(link.name);
  return names;
}

TEST(VrmlBody, HasALinkForEachJoint) {
  const Model model = loaded(hopper);
  EXPECT_EQ(model.name, "Hopper");
  ASSERT_THAT(names_of(model), ElementsAre("TRUNK", "HIP", "FOOT"));
  const Joint &root = model.links[0].joint, &hip = model.links[1].joint, &foot = model.links[2].joint;
  EXPECT_EQ(root.type, JointType::free);
  EXPECT_EQ(root.origin.translation().z(), 0.6);
  EXPECT_EQ(hip.type, JointType::revolute);
  EXPECT_EQ(hip.controller_id, 0);
  EXPECT_EQ(hip.axis, Eigen::Vector3d::UnitY());
  EXPECT_EQ(hip.lower, -1.5);
  EXPECT_EQ(hip.upper, 0.5);
  EXPECT_EQ(hip.velocity, 6.0);
  EXPECT_EQ(hip.gear_ratio, 50.0);
  EXPECT_EQ(hip.rotor_inertia, 0.00002);
  EXPECT_NEAR(hip.armature, 0.05, 1e-15);
  EXPECT_EQ(foot.type, JointType::prismatic);
  EXPECT_EQ(foot.controller_id, 1);
  EXPECT_EQ(foot.lower, -unlimited);
  EXPECT_EQ(foot.origin.translation().z(), -0.3);
}

TEST(VrmlBody, HasTheMassesOfItsSegments) {
  const Model model = loaded(hopper);
  EXPECT_EQ(model.links[0].inertial.mass, 4.0);
  EXPECT_EQ(model.links[0].inertial.center.z(), 0.05);
  EXPECT_EQ(model.links[0].inertial.inertia(2, 2), 0.02);
  EXPECT_EQ(model.links[1].inertial.mass, 1.0);
  EXPECT_EQ(model.mass(), 5.5);
}

/// A Box stays a box for contacts; faces become a mesh, and an Inline file is one.
TEST(VrmlBody, HasTheShapesOfItsSegments) {
  const Model model = loaded(hopper);
  ASSERT_EQ(model.links[0].collisions.size(), 1u);
  const auto* box = std::get_if<Box>(&model.links[0].collisions[0].geometry);
  ASSERT_NE(box, nullptr);
  EXPECT_EQ(box->size, Eigen::Vector3d(0.2, 0.1, 0.1));
  EXPECT_EQ(model.links[0].collisions[0].pose.translation().z(), 0.05);
  EXPECT_NEAR((*model.links[0].visuals[0].color)[2], 0.6f, 1e-6f);
  ASSERT_EQ(model.links[1].visuals.size(), 1u);
  EXPECT_EQ(std::get<Mesh>(model.links[1].visuals[0].geometry).data->triangle_count(), 4u);
  ASSERT_EQ(model.links[2].visuals.size(), 1u);
  const Mesh& wheel = std::get<Mesh>(model.links[2].visuals[0].geometry);
  EXPECT_EQ(wheel.file, "meshes/wheel.wrl");
  EXPECT_EQ(wheel.scale, Eigen::Vector3d(0.2, 0.2, 0.2));
}

TEST(VrmlBody, HasItsSensorsAsDevices) {
  const Model model = loaded(hopper);
  std::vector<std::string> devices;
  for (const Device& device : model.devices) devices.push_back(std::string(type_name(device)) + " " + device.name);
  EXPECT_THAT(devices, ElementsAre("RateGyroSensor GYRO", "RangeCamera EYE", "ForceSensor SOLE"));
  EXPECT_EQ(model.devices[0].pose.translation().z(), 0.1);
  const Camera& eye = std::get<Camera>(model.devices[1].kind);
  EXPECT_EQ(eye.width, 64);
  EXPECT_TRUE(eye.depth);
  EXPECT_EQ(eye.field_of_view, 1.2);
  EXPECT_THAT(to_string(model.report), HasSubstr("note: the optional element 'PressureSensor' isn't known"));
}

/// A recording has the text of the file, without its Inline files.
TEST(VrmlBody, IsTheSameFromTheTextOfARecording) {
  for (const std::string& file : {hopper, std::string(FIXTURES_DIR "/models/hopper.yaml")}) {
    const Model model = loaded(file);
    const auto again = parse_model(model.source_text, std::filesystem::path(file).filename().string(),
                                   {.meshes = UrdfOptions::Meshes::skip});
    ASSERT_TRUE(again.ok()) << to_string(again.errors());
    EXPECT_EQ(names_of(*again), names_of(model));
    EXPECT_EQ(again->mass(), model.mass());
    EXPECT_EQ(again->apart, model.apart);
    EXPECT_EQ(again->links[2].visuals.size(), 1u);
  }
}

TEST(VrmlBody, MayBeTheModelOfAYamlFileWithRules) {
  const Model model = loaded(FIXTURES_DIR "/models/hopper.yaml");
  EXPECT_THAT(names_of(model), ElementsAre("TRUNK", "HIP", "FOOT"));
  using Pair = std::array<int, 2>;
  EXPECT_THAT(model.apart, ElementsAre(Pair{0, 1}, Pair{0, 2}, Pair{1, 2}));
  EXPECT_THAT(to_string(model.report), HasSubstr("footLinks, standardPose"));
}

TEST(BodyFiles, MayNameMeshesBelowTheHome) {
  const std::string before = std::getenv("HOME") == nullptr ? "" : std::getenv("HOME");
  setenv("HOME", FIXTURES_DIR "/models", 1);
  const auto model = parse_body(
      "format: ChoreonoidBody\nformat_version: 2.0\nlinks:\n  - name: A\n    joint_type: fixed\n    elements:\n"
      "      - { type: Resource, uri: \"${HOME}/meshes/wheel.wrl\" }\n",
      "/tmp/elsewhere.body");
  setenv("HOME", before.c_str(), 1);
  ASSERT_TRUE(model.ok()) << to_string(model.errors());
  EXPECT_EQ(model->links[0].visuals.size(), 1u);
}

TEST(BodyFiles, AreToldByTheirContent) {
  const test::TemporaryFolder folder;
  const auto holds = [&](const char* name, const char* text) {
    std::ofstream(folder.path() / name) << text;
    return is_model_file(folder.path() / name);
  };
  EXPECT_TRUE(is_model_file(hopper));
  EXPECT_TRUE(holds("a.yaml", "# a body\nformat: ChoreonoidBody\n"));
  EXPECT_TRUE(holds("b.yml", "model_file: a.yaml\n"));
  EXPECT_FALSE(holds("c.yaml", "rehearse: 1\nbodies: []\n"));
  EXPECT_FALSE(holds("d.yaml", "format: Something\n"));
  EXPECT_FALSE(holds("e.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }"));
  EXPECT_FALSE(is_model_file(folder.path() / "absent.yaml"));
}

class BrokenVrmlBody : public ::testing::Test {
 protected:
  std::string refusal(const std::string& from, const std::string& to) {
    std::string text = test::read_file(hopper);
    EXPECT_THAT(text, HasSubstr(from));
    text.replace(text.find(from), from.size(), to);
    const auto model = parse_body(text, FIXTURES_DIR "/models/broken.wrl");
    EXPECT_FALSE(model.ok());
    return model ? "" : to_string(model.errors().front());
  }
};

TEST_F(BrokenVrmlBody, IsRefusedWithItsLine) {
  EXPECT_THAT(refusal("DEF Hopper Humanoid {", "DEF Hopper Group {"),
              HasSubstr("broken.wrl:1: error: it has no Humanoid: it is a scene, not a body"));
  EXPECT_THAT(refusal("DEF Hopper Humanoid {", "Humanoid { }\nDEF Hopper Humanoid {"),
              HasSubstr(":62: error: a second Humanoid; a file describes one body"));
  EXPECT_THAT(refusal("DEF HIP Joint", "Joint"), HasSubstr(":84: error: a Joint has no name (DEF NAME Joint)"));
  EXPECT_THAT(refusal("\"rotate\"", "\"spin\""), HasSubstr(":84: error: the joint type 'spin' isn't known"));
  EXPECT_THAT(refusal("DEF HIP Joint {", "Transform { children DEF SPARE Joint { } }\nDEF HIP Joint {"),
              HasSubstr(":84: error: the Joint 'SPARE' is within a Transform (a Joint is a child of the Joint"));
  EXPECT_THAT(refusal("PROTO PressureSensor [", "PROTO Whisker [ ] { }\nDEF W Whisker { }\nPROTO PressureSensor ["),
              HasSubstr(":46: error: a node of the PROTO 'Whisker', which isn't one of OpenHRP's bodies"));
  EXPECT_THAT(refusal("[ 0.04 0 0 0 0.04 0 0 0 0.02 ]", "[ 0.04 0.04 ]"),
              HasSubstr("error: inertia isn't a list of 9 numbers"));
}

TEST_F(BrokenVrmlBody, NamesTheModelOfAYamlFileThatIsNone) {
  const auto model = parse_body("modelFile: robot.urdf\n", FIXTURES_DIR "/models/broken.yaml");
  ASSERT_FALSE(model.ok());
  EXPECT_THAT(to_string(model.errors().front()),
              HasSubstr("broken.yaml:1: error: modelFile names 'robot.urdf', which is no body file"));
}

}  // namespace
}  // namespace rehearse
