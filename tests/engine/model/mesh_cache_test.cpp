#define XXH_INLINE_ALL
#include "mesh/mesh_cache.h"

#include "mesh_files.h"

#include <xxhash.h>

#include <thread>

namespace rehearse {
namespace {

SharedMesh shared(const std::filesystem::path& file, const Eigen::Vector3d& scale = {1, 1, 1}) {
  Result<SharedMesh> mesh = shared_mesh(file, scale);
  if (!mesh) throw std::runtime_error(to_string(mesh.errors()));
  return *std::move(mesh);
}

TEST(MeshCache, ReadsAMeshOnceForAllWhoHoldIt) {
  test::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("a/b.stl", stl("", {0, 0, 1}));
  std::filesystem::create_symlink(file, folder.path() / "link.stl");
  const std::uint64_t before = meshes_read();
  const SharedMesh first = shared(file);
  const SharedMesh again = shared(folder.path() / "a/../a/b.stl");
  const SharedMesh linked = shared(folder.path() / "link.stl");
  EXPECT_EQ(first.data, again.data);
  EXPECT_EQ(first.data, linked.data);
  EXPECT_EQ(meshes_read(), before + 1);
}

TEST(MeshCache, KeepsScalesAndFilesOfOneNameApart) {
  test::TemporaryFolder folder;
  const std::filesystem::path one = folder.write("left/a.stl", stl("", {0, 0, 1}));
  const std::filesystem::path other = folder.write("right/a.stl", stl("", {0, 0, 1}, 2));
  const SharedMesh first = shared(one), second = shared(other), third = shared(one, {2, 1, 1});
  EXPECT_EQ(first.data->triangle_count(), 1u);
  EXPECT_EQ(second.data->triangle_count(), 2u);
  EXPECT_EQ(third.data->upper.x(), 2.0);
}

TEST(MeshCache, ForgetsWhatNobodyHolds) {
  test::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("a.stl", stl("", {0, 0, 1}));
  const std::uint64_t before = meshes_read();
  shared(file);
  shared(file);
  EXPECT_EQ(meshes_read(), before + 2);
}

TEST(MeshCache, SeesThatAFileHasChanged) {
  test::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("a.stl", stl("", {0, 0, 1}));
  const SharedMesh old = shared(file);
  folder.write("a.stl", stl("", {0, 0, 1}, 3));
  EXPECT_EQ(shared(file).data->triangle_count(), 3u);
  EXPECT_EQ(old.data->triangle_count(), 1u);
}

TEST(MeshCache, TellsTheWarningsToEachWhoAsks) {
  test::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("a.obj", std::string("mtllib none.mtl\n") + square_obj);
  const SharedMesh first = shared(file), second = shared(file);
  EXPECT_EQ(first.warnings.size(), 1u);
  EXPECT_EQ(second.warnings, first.warnings);
}

TEST(MeshCache, MayBeAskedByThreads) {
  const std::uint64_t before = meshes_read();
  const SharedMesh held = shared(arm_meshes / "base.dae");
  std::vector<std::thread> threads;
  std::array<SharedMesh, 4> found;
  for (SharedMesh& mesh : found) threads.emplace_back([&mesh] { mesh = shared(arm_meshes / "base.dae"); });
  for (std::thread& thread : threads) thread.join();
  for (const SharedMesh& mesh : found) EXPECT_EQ(mesh.data, held.data);
  EXPECT_EQ(meshes_read(), before + 1);
}

TEST(MeshDigest, IsTheHashOfTheFilesBytes) {
  const std::string bytes = read_file(arm_meshes / "finger.stl");
  char expected[17];
  std::snprintf(expected, sizeof expected, "%016llx",
                static_cast<unsigned long long>(XXH3_64bits(bytes.data(), bytes.size())));
  EXPECT_EQ(mesh_of(arm_meshes / "finger.stl").digest, expected);
}

}  // namespace
}  // namespace rehearse
