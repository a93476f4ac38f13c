// Meshes in VRML97 files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "mesh/mesh_file.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

using testing::HasSubstr;

const std::string wheel = FIXTURES_DIR "/models/meshes/wheel.wrl";

class Vrml : public testing::Test {
 protected:
  Result<MeshReading> read(const std::string& text, const MeshSelection& selection = {}) {
    std::ofstream(folder_.path() / "mesh.wrl") << text;
    return read_mesh(folder_.path() / "mesh.wrl", Eigen::Vector3d::Ones(), selection);
  }

  std::string refusal(const std::string& text) {
    const auto reading = read(text);
    return reading ? "" : to_string(reading.errors());
  }

  test::TemporaryFolder folder_;
};

TEST_F(Vrml, HasAnObjectForEachShapeInItsPlaceAndColour) {
  const auto reading = read_mesh(wheel, Eigen::Vector3d::Ones());
  ASSERT_TRUE(reading.ok()) << to_string(reading.errors());
  const MeshData& mesh = reading->data;
  ASSERT_EQ(mesh.parts.size(), 2u);
  EXPECT_EQ(mesh.parts[1].object, 1);
  EXPECT_LE((*mesh.parts[0].color - Color(0.15f, 0.15f, 0.17f, 1.0f)).norm(), 1e-6f);
  EXPECT_EQ(mesh.parts[1].triangles.size(), 6u);
  EXPECT_NEAR(mesh.upper.z(), 0.3 + 0.1, 1e-6);
  EXPECT_NEAR(mesh.upper.y(), 0.03 + 0.03, 1e-6);
  EXPECT_NEAR(mesh.lower.y(), -0.025, 1e-6);
}

TEST_F(Vrml, GivesANodeWithoutTheTranslationsAboveIt) {
  const auto reading = read_mesh(wheel, Eigen::Vector3d::Ones(), {"HUB", {}});
  ASSERT_TRUE(reading.ok()) << to_string(reading.errors());
  EXPECT_EQ(reading->data.parts.size(), 1u);
  EXPECT_NEAR(reading->data.lower.y(), 0.0, 1e-6);
  EXPECT_NEAR(reading->data.upper.y(), 0.03, 1e-6);
  EXPECT_NEAR(reading->data.upper.z(), 0.03, 1e-6);
}

TEST_F(Vrml, LeavesOutNodesThatAreTakenOut) {
  const auto reading = read_mesh(wheel, Eigen::Vector3d::Ones(), {"WHEEL", {"HUB"}});
  ASSERT_TRUE(reading.ok()) << to_string(reading.errors());
  EXPECT_EQ(reading->data.parts.size(), 1u);
}

TEST_F(Vrml, FacesOutwardsUnderAMirror) {
  const std::string box = "#VRML V2.0 utf8\nTransform { scale -1 1 1 children Shape { geometry Box { size 1 2 3 } } }";
  const auto reading = read(box);
  ASSERT_TRUE(reading.ok()) << to_string(reading.errors());
  const MeshPart& part = reading->data.parts[0];
  EXPECT_EQ(part.triangles.size(), 12u);
  for (const auto& [a, b, c] : part.triangles) {
    const Eigen::Vector3f normal = (part.vertices[b] - part.vertices[a]).cross(part.vertices[c] - part.vertices[a]);
    EXPECT_GT(normal.dot(part.vertices[a]), 0.0f);
    EXPECT_GT(normal.dot(part.normals[a]), 0.0f);
  }
}

/// The signed volume inside the triangles of all parts [m³].
double volume(const MeshData& mesh) {
  double sum = 0.0;
  for (const MeshPart& part : mesh.parts)
    for (const auto& [a, b, c] : part.triangles)
      sum +=
          part.vertices[a].cast<double>().dot(part.vertices[b].cast<double>().cross(part.vertices[c].cast<double>())) /
          6.0;
  return sum;
}

TEST_F(Vrml, MakesClosedSolidsThatFaceOutwards) {
  const auto solid = [this](const std::string& geometry) {
    const auto reading = read("#VRML V2.0 utf8\nShape { geometry " + geometry + " }");
    EXPECT_TRUE(reading.ok()) << geometry << to_string(reading.errors());
    return reading ? volume(reading->data) : 0.0;
  };
  EXPECT_NEAR(solid("Box { size 1 2 3 }"), 6.0, 1e-6);
  EXPECT_NEAR(solid("Sphere { radius 1 }"), 4.19, 0.25);
  EXPECT_NEAR(solid("Cylinder { radius 1 height 2 }"), 6.28, 0.15);
  EXPECT_NEAR(solid("Cone { bottomRadius 1 height 3 }"), 3.14, 0.08);
  EXPECT_NEAR(solid("Extrusion { crossSection [ 1 1, 1 -1, -1 -1, -1 1, 1 1 ] spine [ 0 0 0, 0 3 0 ] }"), 12.0, 1e-5);
  // an L in the plane, cut at its ears: 3 of 4 squares, 2 m high
  EXPECT_NEAR(solid("Extrusion { crossSection [ 0 0, 0 2, 1 2, 1 1, 2 1, 2 0, 0 0 ] spine [ 0 0 0, 0 2 0 ] }"), 6.0,
              1e-5);
}

TEST_F(Vrml, ReadsInlineFilesAndUsesOfNodes) {
  std::ofstream(folder_.path() / "part.wrl") << "#VRML V2.0 utf8\nShape { geometry Box { } }";
  const auto reading = read(R"(#VRML V2.0 utf8
Group { children [
  DEF B Shape { geometry Box { size 1 1 1 } }
  Transform { translation 5 0 0 children [ USE B, Inline { url "part.wrl" } ] }
] })");
  ASSERT_TRUE(reading.ok()) << to_string(reading.errors());
  EXPECT_EQ(reading->data.parts.size(), 3u);
  EXPECT_NEAR(reading->data.upper.x(), 6.0, 1e-6);
}

TEST_F(Vrml, PaintsFacesInTheColoursOfTheirVertices) {
  const auto reading = read(R"(#VRML V2.0 utf8
Shape { geometry IndexedFaceSet {
  coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } coordIndex [ 0 1 2 -1 0 2 3 -1 ]
  colorPerVertex FALSE color Color { color [ 1 0 0, 0 0 1 ] } } })");
  ASSERT_TRUE(reading.ok()) << to_string(reading.errors());
  ASSERT_EQ(reading->data.parts.size(), 2u);
  EXPECT_GT((*reading->data.parts[0].color)[2], 0.9f);
  EXPECT_GT((*reading->data.parts[1].color)[0], 0.9f);
}

TEST_F(Vrml, IsRefusedWithTheLineAndTheReason) {
  EXPECT_THAT(refusal("#VRML V1.0 ascii\nCube { }"), HasSubstr("it is VRML 1.0"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\nShape {\n geometry Box {"),
              HasSubstr("mesh.wrl:3: error: the node 'Box' of line 3"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\n\nUSE NOTHING"), HasSubstr(":3: error: USE 'NOTHING' has no DEF"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\nPROTO Wheel [ ] { Group { } }\nWheel { }"),
              HasSubstr(":3: error: a node of the PROTO 'Wheel', which isn't one of OpenHRP's bodies"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\nPROTO Wheel [ colour 1 0 0 ] { }"),
              HasSubstr(":2: error: a field of a PROTO is expected"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\nPROTO Wheel [ ] { Group {"), HasSubstr("the PROTO 'Wheel' doesn't end"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\nEXTERNPROTO Wheel [ ] \"w.wrl\""), HasSubstr("EXTERNPROTO isn't read"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\nInline { url \"gone.wrl\" }"),
              HasSubstr("its Inline 'gone.wrl' can't be read"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\nGroup { }"), HasSubstr("it has no triangles"));
  EXPECT_THAT(refusal("#VRML V2.0 utf8\nWorldInfo { title \"endless"), HasSubstr("a text in quotes doesn't end"));
}

}  // namespace
}  // namespace rehearse
