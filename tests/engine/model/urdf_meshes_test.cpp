// <mesh> in a URDF.
#include "mesh/mesh_cache.h"
#include "test_folder.h"
#include "urdf_texts.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace rehearse {
namespace {

using testing::HasSubstr;

const std::filesystem::path arm_file = FIXTURES_DIR "/models/mesh_arm/mesh_arm.urdf";

Model arm(const UrdfOptions& options = {}) {
  Result<Model> model = load_urdf(arm_file, options);
  if (!model) throw std::runtime_error(to_string(model.errors()));
  return *std::move(model);
}

const Mesh& mesh_in(const Shape& shape) { return std::get<Mesh>(shape.geometry); }

std::string triangle(const std::string& attributes) {
  return "<visual><geometry><mesh " + attributes + "/></geometry></visual>";
}

TEST(UrdfMesh, IsLoadedForVisualsAndCollisions) {
  const Model model = arm();
  EXPECT_TRUE(model.report.empty()) << to_string(model.report);
  const Link& upper_arm = model.links.at(static_cast<std::size_t>(model.find_link("upper_arm")));
  EXPECT_EQ(mesh_in(upper_arm.visuals.at(0)).data->triangle_count(), 44u + 2 * 192);
  EXPECT_EQ(mesh_in(upper_arm.visuals[0]).data, mesh_in(upper_arm.collisions.at(0)).data);
  EXPECT_EQ(mesh_in(upper_arm.visuals[0]).file, "package://mesh_arm/meshes/upper_arm.obj");
  EXPECT_EQ(mesh_in(upper_arm.visuals[0]).scale, Eigen::Vector3d::Ones());
}

TEST(UrdfMesh, IsMirroredByANegativeScale) {
  const Model model = arm();
  const Link& left = model.links.at(static_cast<std::size_t>(model.find_link("left_finger")));
  const Link& right = model.links.at(static_cast<std::size_t>(model.find_link("right_finger")));
  EXPECT_EQ(mesh_in(right.visuals[0]).scale, Eigen::Vector3d(1, -1, 1));
  EXPECT_EQ(mesh_in(right.visuals[0]).data->lower.y(), -mesh_in(left.visuals[0]).data->upper.y());
}

TEST(UrdfMesh, IsNotReadAgainForASecondModel) {
  const Model first = arm();
  const std::uint64_t before = meshes_read();
  const Model second = arm();
  EXPECT_EQ(meshes_read(), before);
  EXPECT_EQ(mesh_in(first.links[1].visuals[0]).data, mesh_in(second.links[1].visuals[0]).data);
}

TEST(UrdfMesh, IsNotReadFromFilesIfItIsSkipped) {
  std::ifstream stream(arm_file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const std::uint64_t before = meshes_read();
  const Result<Model> model = parse_urdf(text, "gone/mesh_arm.urdf", {.meshes = UrdfOptions::Meshes::skip});
  ASSERT_TRUE(model) << to_string(model.errors());
  EXPECT_EQ(meshes_read(), before);
  EXPECT_TRUE(model->report.empty()) << to_string(model->report);
  const Link& finger = model->links.at(static_cast<std::size_t>(model->find_link("left_finger")));
  EXPECT_EQ(mesh_in(finger.collisions.at(0)).data, nullptr);  // the shape exists, so that indices of shapes are valid
}

TEST(UrdfMesh, IsRelativeToTheFileThatATextStandsFor) {
  const std::string text = still(triangle("filename='triangle.stl'"));
  EXPECT_TRUE(parse_urdf(text, FIXTURES_DIR "/broken/meshes/any.urdf").ok());
  EXPECT_FALSE(parse_urdf(text, FIXTURES_DIR "/any.urdf").ok());
}

TEST(UrdfMesh, IsInThePackageThatTheUserNames) {
  const std::string text = still(triangle("filename='package://things/triangle.stl'"));
  EXPECT_THAT(refusal(text), HasSubstr("test.urdf:1: error: the mesh 'package://things/triangle.stl' can't be used: "
                                       "there is no package 'things' (say where the package is: --package things="));
  EXPECT_EQ(load(text, {.packages = {{"things", FIXTURES_DIR "/broken/meshes"}}}).links[0].visuals.size(), 1u);
}

TEST(UrdfMesh, ThatIsMissingIsToldInEachLine) {
  const std::string shape = "<geometry><mesh filename='gone.stl'/></geometry>";
  const std::string message = refusal(still("\n<visual>" + shape + "</visual>\n<collision>" + shape + "</collision>"));
  EXPECT_THAT(message, HasSubstr("test.urdf:2: error: the mesh 'gone.stl' can't be used: there is no 'gone.stl' in "));
  EXPECT_THAT(message, HasSubstr("test.urdf:3: error: the mesh 'gone.stl' can't be used: there is no 'gone.stl' in "));
}

TEST(UrdfMesh, ThatIsMissingMayBeLeftOut) {
  const std::string text = still(triangle("filename='gone.stl'") +
                                 "<visual><geometry><sphere radius='1'/></geometry></visual>"
                                 "<collision><geometry><sphere radius='1'/></geometry></collision>" +
                                 triangle("filename='" FIXTURES_DIR "/broken/meshes/pointer.stl'"));
  const Model model = load(text, {.strict = true, .allow_missing_meshes = true});
  ASSERT_EQ(model.links[0].visuals.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Sphere>(model.links[0].visuals[0].geometry));
  ASSERT_EQ(model.report.size(), 2u) << to_string(model.report);
  EXPECT_EQ(model.report[0].severity, Severity::warning);
  EXPECT_EQ(model.report[0].message, "the mesh 'gone.stl' can't be used: it isn't there; its shape is left out");
  EXPECT_THAT(model.report[1].message, HasSubstr("can't be used: it is a git-lfs pointer"));
}

TEST(UrdfMesh, OfABadScaleIsAnErrorEvenIfMissingOnesAreAllowed) {
  const std::string text = still(triangle("filename='gone.stl' scale='0 0 0'"));
  EXPECT_FALSE(parse_urdf(text, "test.urdf", {.allow_missing_meshes = true}).ok());
}

TEST(UrdfMesh, OfOneScaleIsScaledAlike) {
  const std::string text = still(triangle("filename='" FIXTURES_DIR "/broken/meshes/triangle.stl' scale=' 0.25 '"));
  const Model model = load(text);
  EXPECT_EQ(mesh_in(model.links[0].visuals[0]).scale, Eigen::Vector3d::Constant(0.25));
  EXPECT_EQ(mesh_in(model.links[0].visuals[0]).data->upper, Eigen::Vector3d(0.25, 0.25, 0));
}

TEST(UrdfMesh, MayHaveBlanksInItsName) {
  TestFolder folder;
  std::filesystem::copy_file(FIXTURES_DIR "/broken/meshes/triangle.stl", folder.path() / "a  part.stl");
  const Result<Model> model =
      parse_urdf(still(triangle("filename='a  part.stl'")), (folder.path() / "a.urdf").string());
  EXPECT_TRUE(model) << to_string(model.errors());
}

TEST(UrdfMesh, WithoutItsPictureIsWarnedOfForVisualsOnly) {
  const std::string shape = "<geometry><mesh filename='textured.obj'/></geometry>";
  const std::string text = still("<visual>" + shape + "</visual>\n<collision>" + shape + "</collision>");
  const Result<Model> model = parse_urdf(text, FIXTURES_DIR "/broken/meshes/any.urdf");
  ASSERT_TRUE(model) << to_string(model.errors());
  ASSERT_EQ(model->report.size(), 2u) << to_string(model->report);
  EXPECT_EQ(model->report[0].line, 1);
  EXPECT_NE(model->report[0].message.find("photo.png"), std::string::npos);
  EXPECT_EQ(model->report[1].line, 2) << "contact takes the flat one to be a sheet";
  EXPECT_EQ(model->report[1].message.find("photo.png"), std::string::npos);
}

}  // namespace
}  // namespace rehearse
