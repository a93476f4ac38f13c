// Colours, textures and texture coordinates of meshes.
#include "mesh_files.h"

#include <gmock/gmock.h>
#include <png.h>

namespace rehearse {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* painted_triangle =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl paint\nf 1/1 2/2 3/3\n";

/// A PNG of one pixel of red, green, blue, opacity.
std::string pixel(std::array<std::uint8_t, 4> rgba) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = image.height = 1;
  image.format = PNG_FORMAT_RGBA;
  std::string bytes(1000, '\0');
  png_alloc_size_t size = bytes.size();
  EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, rgba.data(), 0, nullptr));
  bytes.resize(size);
  return bytes;
}

MeshReading painted(const test::TemporaryFolder& folder, const std::string& material) {
  folder.write("a.mtl", "newmtl paint\n" + material);
  return reading_of(folder.write("a.obj", std::string("mtllib a.mtl\n") + painted_triangle));
}

TEST(MeshLooks, AreTheColoursOfTheParts) {
  const Eigen::Vector4f orange(0.93f, 0.42f, 0.1f, 1), dark(0.18f, 0.19f, 0.21f, 1), steel(0.6f, 0.62f, 0.66f, 1);
  const MeshData arm = mesh_of(arm_meshes / "upper_arm.obj");
  EXPECT_EQ(arm.parts.at(0).color, orange);
  EXPECT_EQ(arm.parts.at(1).color, dark);
  const MeshData base = mesh_of(arm_meshes / "base.dae");
  EXPECT_EQ(base.parts.at(0).color, dark);
  EXPECT_EQ(base.parts.at(1).color, orange);
  EXPECT_LT((*mesh_of(arm_meshes / "bracket.glb").parts.at(0).color - steel).norm(), 1e-5);  // from linear to sRGB
}

TEST(MeshLooks, ColourIsOnlyWhatTheFileStates) {
  test::TemporaryFolder folder;
  EXPECT_FALSE(mesh_of(folder.write("b.obj", square_obj)).parts.at(0).color);
  EXPECT_FALSE(painted(folder, "Ns 10\n").data.parts.at(0).color);
  EXPECT_EQ(painted(folder, "Kd 0.6 0.6 0.6\nd 0.5\n").data.parts.at(0).color, Eigen::Vector4f(0.6f, 0.6f, 0.6f, 0.5f));
  const std::string node = "<node><instance_geometry url='#tri'/></node>";
  EXPECT_FALSE(mesh_of(folder.write("a.dae", collada("", node))).parts.at(0).color);
}

TEST(MeshLooks, AreADefaultInGreyUnderANameThatProgramsGive) {
  test::TemporaryFolder folder;
  const auto is_default = [&folder](const std::string& name, const std::string& color) {
    folder.write("a.mtl", "newmtl " + name + "\nKd " + color + "\n");
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl " + name + "\nf 1 2 3\n";
    const MeshData data = mesh_of(folder.write("a.obj", "mtllib a.mtl\n" + triangle));
    EXPECT_TRUE(data.parts.at(0).color.has_value()) << name;
    return data.parts.at(0).has_default_color;
  };
  for (const char* name : {"Material", "Material.001", "material_0", "None", "Default", "lambert1", "Material-effect"})
    EXPECT_TRUE(is_default(name, "0.8 0.8 0.8")) << name;
  EXPECT_FALSE(is_default("Material", "0.8 0.1 0.1")) << "a colour that somebody chose";
  EXPECT_FALSE(is_default("steel", "0.8 0.8 0.8")) << "a name that somebody chose";
}

TEST(MeshLooks, WithoutAnyOpacityAreOpaque) {
  test::TemporaryFolder folder;
  const MeshReading reading = painted(folder, "Kd 1 0 0\nd 0\n");
  EXPECT_EQ(reading.data.parts.at(0).color, Eigen::Vector4f(1, 0, 0, 1));
  EXPECT_THAT(reading.warnings, ElementsAre("material 'paint' is fully transparent; it is taken for opaque"));
}

TEST(MeshLooks, PictureLiesBesideTheFile) {
  test::TemporaryFolder folder;
  folder.write("pictures/a b.png", pixel({200, 100, 50, 25}));
  const MeshReading reading = painted(folder, "map_Kd pictures\\a b.png\n");
  ASSERT_THAT(reading.warnings, ElementsAre());
  const MeshPart& part = reading.data.parts.at(0);
  ASSERT_NE(part.texture, nullptr);
  EXPECT_THAT(part.texture->rgba, ElementsAre(200, 100, 50, 25));
  EXPECT_EQ(part.color, Eigen::Vector4f::Ones());  // the factor of the texture
  EXPECT_EQ(part.texture_coordinates.at(2), Eigen::Vector2f(0, 1));
}

TEST(MeshLooks, PictureIsMultipliedWithAColourThatIsNotBlack) {
  test::TemporaryFolder folder;
  folder.write("a.png", pixel({200, 100, 50, 255}));
  EXPECT_EQ(painted(folder, "Kd 0.5 0.5 0.5\nmap_Kd a.png\n").data.parts.at(0).color,
            Eigen::Vector4f(0.5f, 0.5f, 0.5f, 1));
  EXPECT_EQ(painted(folder, "Kd 0 0 0\nmap_Kd a.png\n").data.parts.at(0).color, Eigen::Vector4f::Ones());
}

TEST(MeshLooks, WithoutThePictureAreTheShapes) {
  test::TemporaryFolder folder;
  const MeshReading absent = painted(folder, "map_Kd a.png\n");
  EXPECT_THAT(absent.warnings, ElementsAre("its texture 'a.png' can't be used: it isn't there, beside the mesh"));
  EXPECT_EQ(absent.data.parts.at(0).texture, nullptr);
  EXPECT_FALSE(absent.data.parts.at(0).color);
  folder.write("a.png", "GIF89a");
  EXPECT_THAT(painted(folder, "map_Kd a.png\n").warnings,
              ElementsAre(HasSubstr("it is neither PNG nor JPEG (save it as one of them)")));
}

TEST(MeshLooks, PictureMayBeWithinTheFileAndIsTheRightWayUp) {
  const MeshData wrist = mesh_of(arm_meshes / "wrist.glb");
  ASSERT_EQ(wrist.parts.size(), 1u);
  const MeshPart& part = wrist.parts[0];
  ASSERT_NE(part.texture, nullptr);
  ASSERT_EQ(part.texture->width, 32);
  ASSERT_EQ(part.texture->height, 32);
  const auto texel = [&](int x, int y) { return part.texture->rgba[static_cast<std::size_t>(4 * (32 * y + x))]; };
  EXPECT_EQ(texel(4, 26), 245);  // the white square is at the lower left
  EXPECT_LT(texel(4, 4), 245);
  ASSERT_EQ(part.texture_coordinates.size(), part.vertices.size());
  for (std::size_t i = 0; i < part.vertices.size(); ++i) {  // the script lays v along the wrist, upwards
    EXPECT_NEAR(part.texture_coordinates[i].y(), part.vertices[i].x(), 1e-6);
  }
}

TEST(MeshLooks, ChangeTheDigest) {
  test::TemporaryFolder folder;
  const std::string red = painted(folder, "Kd 1 0 0\n").data.digest;
  EXPECT_EQ(painted(folder, "Kd 1 0 0\n").data.digest, red);
  EXPECT_NE(painted(folder, "Kd 1 0 1\n").data.digest, red);
}

}  // namespace
}  // namespace rehearse
