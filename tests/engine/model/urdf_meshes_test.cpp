// <mesh> in a URDF.
#include "mesh/convex_parts.h"
#include "mesh/mesh_cache.h"
#include "picture/picture.h"
#include "support/files.h"
#include "support/temporary_folder.h"
#include "urdf_texts.h"

#include <gmock/gmock.h>

#include <fstream>

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
  for (const Diagnostic& finding : model.report) EXPECT_EQ(finding.severity, Severity::note) << to_string(model.report);
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
  const std::string text = test::read_file(arm_file);
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
  test::TemporaryFolder folder;
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
  ASSERT_EQ(model->report.size(), 1u) << to_string(model->report);
  EXPECT_EQ(model->report[0].line, 1);
  EXPECT_NE(model->report[0].message.find("photo.png"), std::string::npos);
}

/// A link with a bracket, an angle with rounded legs, for its collision.
std::string bracket(const std::string& of_collision = "", const std::string& in_mesh = "") {
  return some_inertial + ("<collision " + of_collision) +
         "><geometry><mesh filename='" FIXTURES_DIR "/models/mesh_arm/meshes/bracket.stl'>" + in_mesh +
         "</mesh></geometry></collision>";
}

/// The number of hulls for contact; 0: its triangles.
std::size_t hulls(const std::string& text, const UrdfOptions& options = {}) {
  const Model model = load(text, options);
  const Mesh& mesh = mesh_in(model.links[0].collisions.at(0));
  return mesh.hulls ? mesh.hulls->size() : 0;
}

TEST(UrdfMesh, ThatMovesIsTakenForItsConvexParts) {
  const std::size_t parts = hulls(robot(link("a", bracket())));
  EXPECT_GE(parts, 2u);
  EXPECT_LE(parts, 8u);
  EXPECT_EQ(hulls(robot(link("a", bracket())), {.contact = MeshContact::hull}), 1u);
  EXPECT_EQ(hulls(robot(link("a", bracket("concave='yes'")))), parts);  // a mesh that moves has no triangles
  EXPECT_EQ(hulls(robot(link("a", bracket("", "<drake:declare_convex/>")))), 1u);
}

TEST(UrdfMesh, ThatNeverMovesIsTakenForItsTrianglesUnlessItIsConvex) {
  EXPECT_EQ(hulls(still(bracket())), 0u);
  EXPECT_EQ(hulls(robot(link("a", bracket())), {.fixed_root = true}), 0u);
  EXPECT_GE(hulls(still(bracket()), {.contact = MeshContact::parts}), 2u);
  EXPECT_EQ(hulls(still(bracket("", "<drake:declare_convex/>"))), 1u);
  EXPECT_EQ(hulls(still(bracket("", "<drake:declare_convex/>")), {.contact = MeshContact::triangles}), 0u);
  const std::string cube = "<collision><geometry><mesh filename='" FIXTURES_DIR
                           "/models/mesh_arm/meshes/finger.stl'/></geometry></collision>";
  const Mesh finger = mesh_in(load(still(cube)).links[0].collisions.at(0));
  EXPECT_EQ(finger.hulls != nullptr, is_convex(*finger.data, 1e-3));
}

TEST(UrdfMesh, IsReportedWithWhatItsHullFillsTooMuch) {
  const Model parts = load(robot(link("a", bracket())));
  ASSERT_EQ(parts.report.size(), 1u) << to_string(parts.report);
  EXPECT_EQ(parts.report[0].severity, Severity::note);
  EXPECT_THAT(parts.report[0].message, ::testing::ContainsRegex("has a convex hull that fills [0-9.]+ % more than its "
                                                                "volume: contact takes [0-9]+ convex parts"));
  const Model hull = load(robot(link("a", bracket())), {.contact = MeshContact::hull});
  ASSERT_EQ(hull.report.size(), 1u);
  EXPECT_THAT(hull.report[0].message, ::testing::ContainsRegex("has a convex hull that fills [0-9.]+ % more"));
  EXPECT_TRUE(load(still(bracket())).report.empty());  // triangles fill nothing too much
}

/// A folder with a square of texture coordinates, and a picture: red to the left, green to the right.
struct PaintedSquare : test::TemporaryFolder {
  PaintedSquare() {
    std::ofstream(path() / "square.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                            "f 1/1 2/2 3/3 4/4\n";
    Image picture{2, 1, {255, 0, 0, 0, 255, 0}};
    const std::vector<std::uint8_t> bytes = encode_png(picture);
    std::ofstream(path() / "paint.png", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  Model load(const std::string& content) const {
    Result<Model> model = parse_urdf(still(content), (path() / "a.urdf").string());
    if (!model) throw std::runtime_error(to_string(model.errors()));
    return *std::move(model);
  }
};

TEST(UrdfTexture, IsThatOfTheMaterialOnMeshesWithTextureCoordinates) {
  const std::string material = "<material name='m'><color rgba='0 0 1 1'/><texture filename='paint.png'/></material>";
  const Model model = PaintedSquare().load("<visual><geometry><mesh filename='square.obj'/></geometry>" + material +
                                           "</visual><visual><geometry><mesh filename='square.obj'/></geometry>"
                                           "<material name='m'/></visual>");
  for (const Diagnostic& finding : model.report) EXPECT_EQ(finding.severity, Severity::note) << to_string(model.report);
  ASSERT_EQ(model.links[0].visuals.size(), 2u);
  for (const Shape& shape : model.links[0].visuals) {
    ASSERT_NE(shape.texture, nullptr);
    EXPECT_EQ(shape.texture->width, 2);
    EXPECT_EQ(shape.texture->digest.size(), 16u);
    const MeshPart& part = mesh_in(shape).data->parts.at(0);
    EXPECT_EQ(texture_of(part, shape), shape.texture.get());
    EXPECT_EQ(color_of(part, shape, Color::Zero()), Color(Color::Ones()));  // not the material's blue
  }
}

TEST(UrdfTexture, ThatNoShapeShowsIsWarnedOf) {
  const std::string material = "<material name='m'><texture filename='paint.png'/></material>";
  const PaintedSquare folder;
  const Model box = folder.load("<visual><geometry><box size='1 1 1'/></geometry>" + material + "</visual>");
  EXPECT_THAT(to_string(box.report), HasSubstr("warning: the <texture> 'paint.png' isn't drawn on this shape"));
  const Model gone = folder.load(
      "<visual><geometry><mesh filename='square.obj'/></geometry><material name='m'>"
      "<texture filename='gone.png'/></material></visual>");
  EXPECT_THAT(to_string(gone.report),
              HasSubstr("warning: the <texture> 'gone.png' of a material isn't drawn: it isn't there"));
}

}  // namespace
}  // namespace rehearse
