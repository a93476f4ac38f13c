// Parts of DAE, OBJ and STL files that are selected by their names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/body.h>

#include <fstream>

#include "mesh_files.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path parts_dae = FIXTURES_DIR "/models/meshes/parts.dae";

Result<MeshReading> part_of(const std::filesystem::path& file, const MeshSelection& selection,
                            const Eigen::Vector3d& scale = {1, 1, 1}) {
  return read_mesh(file, scale, selection);
}

std::vector<Eigen::Vector3d> positions_of(const Result<MeshReading>& reading) {
  std::vector<Eigen::Vector3d> positions;
  EXPECT_TRUE(reading.ok()) << to_string(reading.errors());
  if (reading)
    for (const Corner& corner : corners_of(reading->data)) positions.push_back(corner.position);
  return positions;
}

void expect_positions(const Result<MeshReading>& reading, const std::vector<Eigen::Vector3d>& expected) {
  const auto found = positions_of(reading);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_TRUE(found[i].isApprox(expected[i], 1e-6) || (found[i] - expected[i]).norm() < 1e-7)
        << i << ": " << found[i].transpose() << ", not " << expected[i].transpose();
}

/// The unit, the turn of the node and what is below it remain; the translations of the node and above it don't.
TEST(MeshNodes, OfADaeHaveTheirTurnsButNotTheirPlaces) {
  const std::vector<Eigen::Vector3d> handle{{0, 0, 0},   {0, 0.1, 0},   {-0.1, 0, 0},
                                            {0, 0, 0.3}, {0, 0.1, 0.3}, {-0.1, 0, 0.3}};
  expect_positions(part_of(parts_dae, {"HANDLE", {}}), handle);
}

TEST(MeshNodes, OfADaeAreFoundByTheirIdsToo) {
  expect_positions(part_of(parts_dae, {"ID3", {}}), {{0, 0, 0}, {0, 0.1, 0}, {-0.1, 0, 0}});
}

TEST(MeshNodes, AreScaledInTheFrameOfTheShape) {
  expect_positions(part_of(parts_dae, {"GRIP", {}}, {1, 2, 1}), {{0, 0, 0}, {0, 0.2, 0}, {-0.1, 0, 0}});
}

TEST(MeshNodes, ThatAreTakenOutAreNoLongerInTheOthers) {
  EXPECT_EQ(positions_of(part_of(parts_dae, {})).size(), 9u);
  EXPECT_EQ(positions_of(part_of(parts_dae, {"", {"HANDLE"}})).size(), 9u);  // a whole file has ids
  EXPECT_EQ(positions_of(part_of(parts_dae, {"", {"ID2"}})).size(), 3u);
  EXPECT_EQ(positions_of(part_of(parts_dae, {"PLATE", {"HANDLE"}})).size(), 3u);
  EXPECT_EQ(positions_of(part_of(parts_dae, {"HANDLE", {"GRIP"}})).size(), 3u);
}

TEST(MeshNodes, OfAnObjAreItsObjects) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "two.obj";
  std::ofstream(file) << "o LEFT\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no RIGHT\nv 0 0 5\nv 1 0 5\nv 0 1 5\nf 4 5 6\n";
  expect_positions(part_of(file, {"RIGHT", {}}), {{0, 0, 5}, {1, 0, 5}, {0, 1, 5}});
  expect_positions(part_of(file, {"", {"RIGHT"}}), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}

TEST(MeshNodes, OfAnStlAreItsSolids) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "two.stl";
  const auto solid = [](const std::string& name, const std::string& z) {
    return "solid " + name + "\nfacet normal 0 0 1\nouter loop\nvertex 0 0 " + z + "\nvertex 1 0 " + z +
           "\nvertex 0 1 " + z + "\nendloop\nendfacet\nendsolid " + name + "\n";
  };
  std::ofstream(file) << solid("LEFT", "0") << solid("RIGHT", "5");
  expect_positions(part_of(file, {"RIGHT", {}}), {{0, 0, 5}, {1, 0, 5}, {0, 1, 5}});
}

TEST(MeshNodes, ThatAreUnknownAreRefusedWithTheNamesThereAre) {
  const auto reading = part_of(parts_dae, {"HANDEL", {}});
  ASSERT_FALSE(reading.ok());
  EXPECT_THAT(to_string(reading.errors()), HasSubstr("parts.dae: error: it has no node 'HANDEL' (its nodes: "));
  EXPECT_THAT(to_string(reading.errors()), HasSubstr("ID1, ID2, ID3"));
  const auto vrml = part_of(FIXTURES_DIR "/models/meshes/wheel.wrl", {"RIM_OF_ANOTHER", {}});
  EXPECT_THAT(to_string(vrml.errors()), HasSubstr("its nodes: "));
  EXPECT_THAT(to_string(vrml.errors()), HasSubstr("HUB"));
}

/// Of a .body: one shape for each part, and the plate without the handle.
TEST(MeshNodes, AreShapesOfABody) {
  const auto model = parse_body(R"(format: ChoreonoidBody
format_version: 2.0
name: pan
links:
  - name: PAN
    joint_type: fixed
    elements:
      - { type: Resource, uri: meshes/parts.dae, node: PLATE }
      - { type: Resource, uri: meshes/parts.dae, node: HANDLE, translation: [ 0, 0, 1 ] }
)",
                                FIXTURES_DIR "/models/pan.body");
  ASSERT_TRUE(model.ok()) << to_string(model.errors());
  ASSERT_EQ(model->links[0].visuals.size(), 2u);
  const auto triangles = [&](std::size_t i) {
    return std::get<Mesh>(model->links[0].visuals[i].geometry).data->triangle_count();
  };
  EXPECT_EQ(triangles(0), 1u);
  EXPECT_EQ(triangles(1), 2u);
  EXPECT_EQ(model->links[0].visuals[1].pose.translation().z(), 1.0);
}

}  // namespace
}  // namespace rehearse
