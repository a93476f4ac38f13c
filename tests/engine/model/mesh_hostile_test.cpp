// Files with a wrong type or incomplete content: each gives an error, and never a partial mesh.
#include "mesh_files.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <random>

namespace rehearse {
namespace {

using testing::HasSubstr;

TEST(HostileMesh, IsRefusedInOneLineWithItsName) {
  test::TemporaryFolder folder;
  const auto refused = [&](const char* name, const std::string& content) {
    const std::filesystem::path file = folder.write(name, content);
    const std::string message = mesh_refusal(file);
    EXPECT_THAT(message, testing::StartsWith(file.string()));
    EXPECT_EQ(std::ranges::count(message, '\n'), 1) << message;
    return message;
  };
  EXPECT_THAT(refused("a.stl", ""), HasSubstr("it is empty"));
  EXPECT_THAT(refused("a.dae", "version https://git-lfs.github.com/spec/v1\n"), HasSubstr("run: git lfs pull"));
  EXPECT_THAT(refused("a.step", "x"), HasSubstr(".step isn't a format that is read (convert it; .stl, .dae, .obj,"));
  EXPECT_THAT(refused("mesh", "x"), HasSubstr("no extension"));
  EXPECT_THAT(refused("a.stl", "x"), HasSubstr("it is truncated: 1 bytes"));
  EXPECT_THAT(refused("a.stl", stl("", {0, 0, 1}, 0)), HasSubstr("it has no triangles"));
  EXPECT_THAT(refused("a.glb", "x"), HasSubstr("it doesn't begin with glTF"));
  EXPECT_THAT(refused("a.obj", "v 0 0 0\nv 1 0\n"), HasSubstr("a.obj:2: error: a vertex has fewer than three numbers"));
  EXPECT_THAT(refused("a.obj", "v 0 0 0\nf 1 1 x\n"), HasSubstr("a.obj:2: error: a face has the corner 'x'"));
  EXPECT_THAT(refused("a.obj", "v 0 0 0\nf 1 1 -2\n"), HasSubstr("a face refers to vertex -2, and there are 1"));
  EXPECT_THAT(refused("a.obj", "v 0 0 0\nf 1//1 1//1 1//1\n"), HasSubstr("normal 1, and there are 0"));
  EXPECT_THAT(refused("a.obj", "v 0 0 0\nf 1 1 1 # x\n"), HasSubstr("a face has the corner '#'"));
  std::string endless = collada("", "");  // for assimp
  endless.replace(endless.find("0 1 2</p>"), 5, "0 x 2");
  EXPECT_THAT(refused("a.dae", endless), HasSubstr(":10: error: a list of indices <p> contains something else"));
  EXPECT_THAT(refused("a.gltf", "{}"), HasSubstr("assimp reports: "));
  EXPECT_THAT(refused("a.dae", "<html/>"), HasSubstr("error: "));
  EXPECT_THAT(refused("a.dae", collada("", "")), HasSubstr("error: "));
}

TEST(HostileMesh, IsNotReadFromWhatIsNoFile) {
  test::TemporaryFolder folder;
  EXPECT_THAT(mesh_refusal(folder.path() / "a.stl"), HasSubstr("there is no 'a.stl' in "));
  std::filesystem::create_directory(folder.path() / "b.stl");
  EXPECT_THAT(mesh_refusal(folder.path() / "b.stl"), HasSubstr("it is a directory"));
  ASSERT_EQ(mkfifo((folder.path() / "c.stl").c_str(), 0600), 0);  // reading it would wait for ever
  EXPECT_THAT(mesh_refusal(folder.path() / "c.stl"), HasSubstr("it is not a file that can be read"));
  ASSERT_EQ(mkfifo((folder.path() / "a.mtl").c_str(), 0600), 0);
  EXPECT_EQ(reading_of(folder.write("a.obj", std::string("mtllib a.mtl\n") + square_obj)).warnings.size(), 1u);
}

TEST(HostileMesh, HasBoundedSize) {
  test::TemporaryFolder folder;
  const std::filesystem::path large = folder.write("a.obj", "");
  std::filesystem::resize_file(large, (std::uintmax_t{512} << 20) + 1);  // sparse
  EXPECT_THAT(mesh_refusal(large), HasSubstr("more than 512 MiB"));
  std::string head(80, ' ');
  put(head, std::uint32_t{10'000'001});
  const std::filesystem::path many = folder.write("a.stl", head);
  std::filesystem::resize_file(many, 84 + 50ull * 10'000'001);
  EXPECT_THAT(mesh_refusal(many), HasSubstr("it has 10000001 triangles, more than 10000000"));
}

TEST(HostileMesh, ThatIsNotFiniteIsRefused) {
  test::TemporaryFolder folder;
  for (const char* number : {"nan", "inf", "-inf", "1e39"}) {
    const std::string text = std::string("v 0 0 ") + number + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    EXPECT_THAT(mesh_refusal(folder.write("a.obj", text)), HasSubstr("error: ")) << number;
  }
  const Result<MeshReading> scaled = read_mesh(folder.write("a.stl", stl("", {0, 0, 1})), {1e300, 1, 1});
  ASSERT_FALSE(scaled);
  EXPECT_THAT(to_string(scaled.errors()), HasSubstr("a vertex of it isn't finite"));
}

TEST(HostileMesh, ThatIsTruncatedIsRefused) {
  test::TemporaryFolder folder;
  for (const char* name : {"bracket.stl", "bracket.dae", "bracket.glb"}) {
    const std::string whole = read_file(arm_meshes / name);
    const std::size_t end = whole.find_last_not_of(" \n") + 1;
    for (std::size_t length = 0; length < end; length += 97) {
      mesh_refusal(folder.write(name, whole.substr(0, length)));
      EXPECT_FALSE(HasFailure()) << name << " of " << length << " bytes";
    }
  }
}

TEST(HostileMesh, ThatIsATruncatedObjIsRefusedUnlessItEndsBetweenFaces) {
  test::TemporaryFolder folder;
  const std::string whole = read_file(arm_meshes / "bracket.obj");
  const std::size_t faces = whole.find("\nf ") + 1;
  int accepted = 0;
  for (std::size_t length = 0; length < whole.size() - 1; length += 7) {
    const auto reading = read_mesh(folder.write("bracket.obj", whole.substr(0, length)), {1, 1, 1});
    if (!reading) continue;
    ++accepted;
    const std::string last_line = whole.substr(whole.rfind('\n', length - 1) + 1, length);
    EXPECT_GT(length, faces);
    EXPECT_EQ(reading->data.triangle_count(),
              static_cast<std::size_t>(std::count(whole.begin() + static_cast<std::ptrdiff_t>(faces),
                                                  whole.begin() + static_cast<std::ptrdiff_t>(length), '\n')) +
                  (whole[length - 1] == '\n' ? 0 : 1));  // all that the file holds, and no more
  }
  EXPECT_GT(accepted, 0);
}

// Not of DAE: assimp 5.2 reads through a null pointer where an attribute of <float_array> is missing.
TEST(HostileMesh, WithFlippedBytesNeverCrashes) {
  test::TemporaryFolder folder;
  std::mt19937 generator(7);
  int refused = 0;
  for (const char* name : {"bracket.stl", "bracket.obj"}) {
    const std::string whole = read_file(arm_meshes / name);
    for (int i = 0; i < 200; ++i) {
      std::string bytes = whole;
      bytes[generator() % bytes.size()] = static_cast<char>(generator() % 256);
      const auto reading = read_mesh(folder.write(name, bytes), {1, 1, 1});
      refused += reading ? 0 : 1;
      if (!reading) continue;
      for (const Corner& corner : corners_of(reading->data)) EXPECT_TRUE(corner.position.allFinite());
    }
  }
  EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace rehearse
