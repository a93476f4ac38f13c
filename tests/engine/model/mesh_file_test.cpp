// Triangles of meshes: their positions, their winding, and their frame.
#include "mesh/mesh_file.h"

#include "mesh_files.h"

#include <gmock/gmock.h>

#include <numbers>

namespace rehearse {
namespace {

using testing::HasSubstr;

TEST(Mesh, IsTheSameInAllFourFormats) {
  const std::vector<Corner> expected = corners_of(mesh_of(arm_meshes / "bracket.stl"));
  ASSERT_EQ(expected.size(), 84u * 3);
  for (const char* name : {"bracket.dae", "bracket.obj", "bracket.glb"}) {
    SCOPED_TRACE(name);
    const std::vector<Corner> corners = corners_of(mesh_of(arm_meshes / name));
    ASSERT_EQ(corners.size(), expected.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      EXPECT_LT((corners[i].position - expected[i].position).norm(), 1e-6);
      EXPECT_GT(corners[i].normal.dot(expected[i].normal), 0.9999);
    }
  }
}

TEST(Mesh, HasTheMeasuresOfThePart) {
  // a quarter of a ring of 0.012 x 0.04 about a circle of radius 0.09, in 10 straight steps
  const MeshData bracket = mesh_of(arm_meshes / "bracket.dae");
  EXPECT_LT((bracket.lower - Eigen::Vector3d(-0.006, -0.02, 0)).norm(), 1e-7);
  EXPECT_LT((bracket.upper - Eigen::Vector3d(0.09, 0.02, 0.096)).norm(), 1e-7);
  const double step = std::numbers::pi / 20;
  // area of one step of the ring, seen from the side
  const double wedge = (0.096 * 0.096 - 0.084 * 0.084) * std::sin(step) / 2;
  EXPECT_NEAR(volume_of(bracket), 10 * wedge * 0.04, 1e-10);
}

TEST(Mesh, OfEachPartOfTheArmIsClosedByItsOutside) {
  for (const char* name : {"base.dae", "shoulder.stl", "upper_arm.obj", "wrist.glb", "finger.stl"}) {
    SCOPED_TRACE(name);
    const MeshData mesh = mesh_of(arm_meshes / name);
    EXPECT_GT(volume_of(mesh), 1e-5);
    expect_normals_outside(mesh);
  }
}

TEST(Mesh, KeepsItsOutsideWhereAScaleMirrorsIt) {
  for (const char* name : {"bracket.stl", "base.dae", "upper_arm.obj", "wrist.glb"}) {
    SCOPED_TRACE(name);
    const double volume = volume_of(mesh_of(arm_meshes / name));
    const MeshData mirrored = mesh_of(arm_meshes / name, {1, -2, 0.5});
    EXPECT_NEAR(volume_of(mirrored), volume, 1e-6 * volume);
    expect_normals_outside(mirrored);
  }
}

TEST(Mesh, ScalesAlongTheAxesOfTheShapesFrame) {
  const MeshData wrist = mesh_of(arm_meshes / "wrist.glb", {10, 1, 1});  // along x when z is up
  EXPECT_NEAR(wrist.upper.x(), 0.6, 1e-6);
  EXPECT_NEAR(wrist.upper.z(), 0.028, 1e-6);
}

TEST(Mesh, KeepsTheBitsOfTheFilesFloats) {
  test::TemporaryFolder folder;
  const MeshData mesh = mesh_of(folder.write("a.obj", "v 0.1 1e-20 3.3333333\nv 1 0 0\nv 0 7.7 0\nf 1 2 3\n"));
  EXPECT_EQ(mesh.parts.at(0).vertices.at(0), Eigen::Vector3f(0.1f, 1e-20f, 3.3333333f));
  EXPECT_EQ(mesh.parts.at(0).vertices.at(2), Eigen::Vector3f(0.0f, 7.7f, 0.0f));
}

TEST(StlMesh, IsBinaryByItsSizeAndNotByItsFirstWord) {
  test::TemporaryFolder folder;
  for (const char* head : {"solid part", "part", "COLOR=\x10\x20\x30\xff"}) {
    const MeshData mesh = mesh_of(folder.write("a.stl", stl(head, {0, 0, 1}, 2)));
    EXPECT_EQ(mesh.triangle_count(), 2u);
    EXPECT_FALSE(mesh.parts[0].color);
  }
}

TEST(StlMesh, EndsAfterItsLastTriangle) {
  test::TemporaryFolder folder;
  for (const char* head : {"solid part", "part"}) {
    EXPECT_EQ(mesh_of(folder.write("a.stl", stl(head, {0, 0, 1}) + "made by a scanner")).triangle_count(), 1u);
  }
}

TEST(StlMesh, HasTheNormalsOfItsWinding) {
  test::TemporaryFolder folder;
  for (const Eigen::Vector3f& wrong : {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(0, 0, -1), Eigen::Vector3f(5, 0, 0)}) {
    const MeshData mesh = mesh_of(folder.write("a.stl", stl("", wrong)));
    for (const Eigen::Vector3f& normal : mesh.parts.at(0).normals) EXPECT_EQ(normal, Eigen::Vector3f::UnitZ());
  }
}

/// The bytes of the floats, which differ where 0 has another sign.
std::string bytes_of(const std::vector<Eigen::Vector3f>& vectors) {
  return {reinterpret_cast<const char*>(vectors.data()), vectors.size() * sizeof vectors[0]};
}

/// A selection of nodes is assimp's, so a file without such a node is read by it.
TEST(StlMesh, HasTheBitsOfAssimp) {
  const MeshSelection by_assimp{.without = {"no such node"}};
  test::TemporaryFolder folder;
  std::string odd = stl("odd", {0, 0, 1}, 3);
  const float signed_zero = -0.0f, tiny = 1e-42f, huge = 1e38f;
  std::memcpy(odd.data() + 84 + 12, &signed_zero, sizeof(float));
  std::memcpy(odd.data() + 84 + 50 + 28, &tiny, sizeof(float));
  std::memcpy(odd.data() + 84 + 100 + 40, &huge, sizeof(float));
  for (const std::filesystem::path& file :
       {arm_meshes / "bracket.stl", arm_meshes / "finger.stl", arm_meshes / "shoulder.stl", folder.write("a.stl", odd)})
    for (const Eigen::Vector3d& scale :
         {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(0.001, 0.3, 1), Eigen::Vector3d(1, -2, 0.5),
          Eigen::Vector3d(-1, -1, 1), Eigen::Vector3d(1, 0, 1)}) {
      SCOPED_TRACE(file.filename().string());
      const MeshReading own = reading_of(file, scale);
      const auto other = read_mesh(file, scale, by_assimp);
      ASSERT_TRUE(other.ok()) << to_string(other.errors());
      EXPECT_EQ(own.warnings, other->warnings);
      EXPECT_EQ(own.data.digest, other->data.digest);
      ASSERT_EQ(own.data.parts.size(), other->data.parts.size());
      const MeshPart &here = own.data.parts[0], &there = other->data.parts[0];
      EXPECT_EQ(bytes_of(here.vertices), bytes_of(there.vertices));
      EXPECT_EQ(bytes_of(here.normals), bytes_of(there.normals));
      EXPECT_EQ(here.triangles, there.triangles);
      EXPECT_EQ(here.object, there.object);
      EXPECT_EQ(here.color, there.color);
      EXPECT_EQ(here.has_default_color, there.has_default_color);
    }
}

TEST(StlMesh, MayBeTextOfSeveralSolids) {
  test::TemporaryFolder folder;
  const std::string solid =
      "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 2 0\n  endloop\n"
      " endfacet\nendsolid a\n";
  const MeshData mesh = mesh_of(folder.write("a.STL", solid + solid));
  EXPECT_EQ(mesh.triangle_count(), 2u);
  EXPECT_EQ(mesh.parts.back().object, 0);
  EXPECT_EQ(mesh.upper, Eigen::Vector3d(1, 2, 0));
}

TEST(ColladaMesh, IsNotTurnedByItsUpAxis) {
  test::TemporaryFolder folder;
  for (const char* axis : {"X_UP", "Y_UP", "Z_UP"}) {
    const std::string asset = std::string("<up_axis>") + axis + "</up_axis>";
    const MeshData mesh =
        mesh_of(folder.write("a.dae", collada(asset, "<node><instance_geometry url='#tri'/></node>")));
    EXPECT_EQ(mesh.upper, Eigen::Vector3d(1, 1, 0)) << axis;
    EXPECT_EQ(mesh.triangle_count(), 1u);  // the line, the camera and the light are none
  }
}

TEST(ColladaMesh, IsInMetresByItsUnit) {
  test::TemporaryFolder folder;
  const MeshData mesh = mesh_of(folder.write(
      "a.dae", collada("<unit name='inch' meter='0.0254'/>", "<node><instance_geometry url='#tri'/></node>")));
  EXPECT_LT((mesh.upper - Eigen::Vector3d(0.0254, 0.0254, 0)).norm(), 1e-9);
}

TEST(ColladaMesh, StandsWhereItsNodesPutIt) {
  test::TemporaryFolder folder;
  const MeshData mesh = mesh_of(folder.write(
      "a.dae", collada("",
                       "<node><translate>10 0 0</translate><rotate>0 0 1 90</rotate><node><scale>2 1 1</scale>"
                       "<instance_geometry url='#tri'/></node></node>")));
  const std::vector<Corner> corners = corners_of(mesh);
  ASSERT_EQ(corners.size(), 3u);
  EXPECT_LT((corners[1].position - Eigen::Vector3d(10, 2, 0)).norm(), 1e-6);
  EXPECT_LT((corners[2].position - Eigen::Vector3d(9, 0, 0)).norm(), 1e-6);
}

TEST(ColladaMesh, TurnsTheWindingOfAMirroredNode) {
  test::TemporaryFolder folder;
  const std::string text = collada("", "<node><scale>-1 1 1</scale><instance_geometry url='#tri'/></node>");
  const MeshData mesh = mesh_of(folder.write("a.dae", text));
  EXPECT_EQ(corners_of(mesh).at(0).normal, Eigen::Vector3d::UnitZ());
  expect_normals_outside(mesh);
  EXPECT_EQ(mesh.lower.x(), -1.0);
}

TEST(ObjMesh, HasANumberForEachObject) {
  test::TemporaryFolder folder;
  const MeshData arm = mesh_of(arm_meshes / "upper_arm.obj");
  ASSERT_EQ(arm.parts.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(arm.parts[static_cast<std::size_t>(i)].object, i);
  const MeshData with_empty =
      mesh_of(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no first\nf 1 2 3\no nothing\no last\nf 3 2 1\n"));
  ASSERT_EQ(with_empty.parts.size(), 2u);
  EXPECT_EQ(with_empty.parts[1].object, 1);
}

TEST(ObjMesh, HasTrianglesInsteadOfPolygons) {
  test::TemporaryFolder folder;
  const MeshData mesh = mesh_of(folder.write("a.obj", square_obj));
  EXPECT_EQ(mesh.triangle_count(), 2u);
  double area = 0.0;
  const std::vector<Corner> corners = corners_of(mesh);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const Eigen::Vector3d a = corners[i].position;
    area += (corners[i + 1].position - a).cross(corners[i + 2].position - a).z() / 2;
  }
  EXPECT_NEAR(area, 1.0, 1e-6);
  expect_normals_outside(mesh);
}

TEST(ObjMesh, MayBeginWithAByteOrderMarkAndContinueItsLines) {
  test::TemporaryFolder folder;
  const std::string text =
      "\xEF\xBB\xBF"
      "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 \\\n 2 3\r\nf -1 -2 -3\r\n";
  EXPECT_EQ(mesh_of(folder.write("a.obj", text)).triangle_count(), 2u);
}

TEST(GltfMesh, ReadsItsBufferFromBesideIt) {
  test::TemporaryFolder folder;
  std::string buffer;
  for (const float number : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(buffer, number);
  folder.write("a b.bin", buffer);
  const std::filesystem::path file = folder.write("a.gltf", R"({"asset":{"version":"2.0"},"scene":0,
      "scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
      "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"a%20b.bin"}]})");
  const MeshData mesh = mesh_of(file);
  EXPECT_EQ(mesh.upper, Eigen::Vector3d(1, 0, 1));  // y is up in the file
  EXPECT_EQ(corners_of(mesh).at(0).normal, -Eigen::Vector3d::UnitY());
  EXPECT_FALSE(mesh.parts[0].color);  // without a material
  folder.write("a b.bin", buffer.substr(0, 20));
  EXPECT_THAT(mesh_refusal(file), HasSubstr("assimp reports: "));
  std::filesystem::remove(folder.path() / "a b.bin");
  EXPECT_THAT(mesh_refusal(file), HasSubstr("assimp reports: "));
}

}  // namespace
}  // namespace rehearse
