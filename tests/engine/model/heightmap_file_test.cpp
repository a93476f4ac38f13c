// Heightmaps from grey pictures and from grids of numbers.
#include "mesh/heightmap_file.h"

#include <gmock/gmock.h>
#include <png.h>

#include <cmath>

namespace rehearse {
namespace {

using ::testing::HasSubstr;

/// A PNG of samples in the machine's order; 16 bits if the samples are of 16 bits.
template <class Sample>
std::string png_of(int width, int height, const std::vector<Sample>& samples, png_uint_32 format) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  png_alloc_size_t size = 0;
  EXPECT_TRUE(png_image_write_to_memory(&image, nullptr, &size, 0, samples.data(), 0, nullptr));
  std::string bytes(size, '\0');
  EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, samples.data(), 0, nullptr));
  bytes.resize(size);
  return bytes;
}

std::string refusal_of_file(const std::string& bytes, const std::string& name) {
  const auto mesh = read_heightmap(bytes, name, {{1, 1}});
  return mesh ? "" : to_string(mesh.errors());
}

TEST(HeightmapFile, ReadsAGreyPictureOf8Bits) {
  const std::vector<std::uint8_t> samples{0, 51, 255, 102, 0, 204};
  const auto mesh = read_heightmap(png_of(3, 2, samples, PNG_FORMAT_GRAY), "a.png", {{4, 3}, 2.0});
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.errors());
  const Heightmap& map = *mesh->heightmap;
  EXPECT_EQ(map.columns, 3);
  EXPECT_EQ(map.rows, 2);
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_DOUBLE_EQ(map.heights[i], 2.0 * samples[i] / 255.0) << i;
  EXPECT_EQ(map.point(1, 0), Eigen::Vector3d(0, 1.5, map.heights[1]));  // the top row has the largest y
  EXPECT_EQ(map.point(2, 1), Eigen::Vector3d(2, -1.5, map.heights[5]));
}

TEST(HeightmapFile, ReadsAGreyPictureOf16Bits) {
  std::vector<std::uint16_t> samples;
  for (int i = 0; i < 20; ++i) samples.push_back(static_cast<std::uint16_t>(3000 * i + 7));
  const auto mesh = read_heightmap(png_of(5, 4, samples, PNG_FORMAT_LINEAR_Y), "a.png", {{1, 1}, 65.535});
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.errors());
  for (std::size_t i = 0; i < samples.size(); ++i)
    EXPECT_NEAR(mesh->heightmap->heights[i], 1e-3 * samples[i], 1e-12) << i;
}

TEST(HeightmapFile, ReadsAGridOfNumbers) {
  const auto mesh = read_heightmap("# heights\n 1, 2.5 -3e-1\r\n\n4\t5 6 # last\n", "a.csv", {{2, 1}, 10.0});
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.errors());
  EXPECT_EQ(mesh->heightmap->heights, (std::vector<double>{10, 25, -3, 40, 50, 60}));
  EXPECT_EQ(mesh->data->triangle_count(), 4u);
  EXPECT_EQ(mesh->data->lower, Eigen::Vector3d(-1, -0.5, -3));
  EXPECT_EQ(mesh->data->upper, Eigen::Vector3d(1, 0.5, 60));
}

TEST(HeightmapFile, FacesUpwards) {
  const auto mesh = read_heightmap("0 0 1\n0 2 0\n0 0 0\n", "a.txt", {{2, 2}});
  ASSERT_TRUE(mesh.ok());
  const MeshPart& part = mesh->data->parts[0];
  for (const auto& [a, b, c] : part.triangles)
    EXPECT_GT((part.vertices[b] - part.vertices[a]).cross(part.vertices[c] - part.vertices[a]).z(), 0.0f);
  for (const Eigen::Vector3f& normal : part.normals) EXPECT_GT(normal.z(), 0.0f);
}

TEST(HeightmapFile, RefusesWhatIsNoHeightmapAtItsPlace) {
  EXPECT_THAT(refusal_of_file("not a picture", "a.png"), HasSubstr("a.png: error: the heightmap isn't a PNG"));
  EXPECT_THAT(refusal_of_file("", "a.png"), HasSubstr("the heightmap isn't a PNG: it ends too early"));
  EXPECT_THAT(refusal_of_file("0 0\n0 nan\n", "a.txt"), HasSubstr("a.txt:2:3: error: 'nan' is no height"));
  EXPECT_THAT(refusal_of_file("0 0\n0 1e999\n", "a.txt"), HasSubstr("a.txt:2:3: error: '1e999' is no height"));
  EXPECT_THAT(refusal_of_file("0 0\n\n1 hill\n", "a.txt"), HasSubstr("a.txt:3:3: error: 'hill' is no height"));
  EXPECT_THAT(refusal_of_file("0 0 0\n0 0\n", "a.txt"),
              HasSubstr("a.txt:2: error: the line has 2 heights, and the first has 3"));
  EXPECT_THAT(refusal_of_file("", "a.txt"), HasSubstr("the heightmap has 0 x 0 points"));
  EXPECT_THAT(refusal_of_file("1 2 3\n", "a.txt"), HasSubstr("the heightmap has 3 x 1 points"));
  const std::vector<std::uint8_t> colors{255, 0, 0, 0, 255, 0, 0, 0, 255, 9, 9, 9};
  EXPECT_THAT(refusal_of_file(png_of(2, 2, colors, PNG_FORMAT_RGB), "a.png"), HasSubstr("a picture in colour"));
  const std::string whole = png_of(2, 2, std::vector<std::uint8_t>{1, 2, 3, 4}, PNG_FORMAT_GRAY);
  for (std::size_t size = 8; size + 12 < whole.size(); ++size)
    EXPECT_NE(refusal_of_file(whole.substr(0, size), "a.png"), "") << size;
}

}  // namespace
}  // namespace rehearse
