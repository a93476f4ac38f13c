#include "mesh/mesh_paths.h"

#include "support/temporary_folder.h"

#include <gmock/gmock.h>

#include <cstdlib>

namespace rehearse {
namespace {

using testing::HasSubstr;

class MeshPathsTest : public testing::Test {
 protected:
  void SetUp() override {
    unset_paths();
    std::filesystem::create_directories(folder.path() / "ws/robot/urdf");
  }
  void TearDown() override { unset_paths(); }

  static void unset_paths() {
    for (const char* variable : {"ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"}) unsetenv(variable);
  }

  /// The file below the folder to which the path in ws/robot/urdf/arm.urdf refers.
  std::string find(const std::string& written, const MeshPaths::Packages& packages = {}) {
    MeshPaths paths(folder.path() / "ws/robot/urdf/arm.urdf", packages);
    const Result<MeshPlace> place = paths.find(written);
    warning = place ? place->warning : "";
    return place ? place->file.lexically_normal().lexically_relative(folder.path()).string()
                 : to_string(place.errors());
  }
  void make(const std::string& file) { folder.write(file, "x"); }

  test::TemporaryFolder folder;
  std::string warning;
};

TEST_F(MeshPathsTest, RelativeOnesAreRelativeToTheModel) {
  make("ws/robot/meshes/a b.stl");
  EXPECT_EQ(find("../meshes/a b.stl"), "ws/robot/meshes/a b.stl");
  EXPECT_EQ(find("../meshes/a%20b.stl"), "ws/robot/meshes/a b.stl");
  EXPECT_EQ(warning, "");
}

TEST_F(MeshPathsTest, APercentSignIsFirstTakenAsWritten) {
  make("ws/robot/urdf/a%20b.stl");
  make("ws/robot/urdf/a b.stl");
  EXPECT_EQ(find("a%20b.stl"), "ws/robot/urdf/a%20b.stl");
}

TEST_F(MeshPathsTest, AbsoluteOnesAreWhereTheySay) {
  make("else where/a.stl");
  EXPECT_EQ(find("file://" + (folder.path() / "else%20where/a.stl").string()), "else where/a.stl");
  EXPECT_EQ(find((folder.path() / "else where/a.stl").string()), "else where/a.stl");
}

TEST_F(MeshPathsTest, APackageIsADirectoryOfThatNameAboveTheModel) {
  make("ws/robot/meshes/a.stl");
  for (const char* uri : {"package://robot/meshes/a.stl", "model://robot/meshes/a.stl"}) {
    EXPECT_EQ(find(uri), "ws/robot/meshes/a.stl");
  }
}

TEST_F(MeshPathsTest, APackageWithoutANameIsTheModelsFolder) {
  make("ws/robot/urdf/a.stl");
  make("ws/shapes/meshes/b.stl");
  EXPECT_EQ(find("package:///a.stl"), "ws/robot/urdf/a.stl");
  EXPECT_EQ(find("package:///shapes/meshes/b.stl"), "ws/shapes/meshes/b.stl");
  EXPECT_THAT(find("package:///shapes/c.stl"), HasSubstr("there is no 'shapes' in "));
}

TEST_F(MeshPathsTest, APackageMayLieBesideAnAncestor) {
  make("ws/shapes/meshes/a.stl");
  EXPECT_EQ(find("package://shapes/meshes/a.stl"), "ws/shapes/meshes/a.stl");
}

TEST_F(MeshPathsTest, APackageIsKnownByItsPackageXml) {
  folder.write("ws/vendor/stuff/package.xml", "<package format='3'><name> shapes </name></package>");
  folder.write("ws/vendor/broken/package.xml", "<package><name>shapes");
  make("ws/vendor/stuff/meshes/a.stl");
  EXPECT_EQ(find("package://shapes/meshes/a.stl"), "ws/vendor/stuff/meshes/a.stl");
  EXPECT_EQ(warning, "");
}

TEST_F(MeshPathsTest, TheEnvironmentComesAfterWhatIsNear) {
  make("ros/shapes/a.stl");
  make("prefix/share/shapes/b.stl");
  folder.write("other/deep/down/package.xml", "<package><name>shapes</name></package>");
  make("other/deep/down/c.stl");
  setenv("ROS_PACKAGE_PATH",
         ("::" + (folder.path() / "other").string() + ":" + (folder.path() / "ros").string()).c_str(), 1);
  setenv("AMENT_PREFIX_PATH", (folder.path() / "prefix").c_str(), 1);
  EXPECT_EQ(find("package://shapes/a.stl"), "ros/shapes/a.stl");
  EXPECT_EQ(find("package://shapes/b.stl"), "prefix/share/shapes/b.stl");
  EXPECT_EQ(find("package://shapes/c.stl"), "other/deep/down/c.stl");
  make("ws/shapes/a.stl");
  EXPECT_EQ(find("package://shapes/a.stl"), "ws/shapes/a.stl");
}

TEST_F(MeshPathsTest, WhatTheUserSaysComesFirstAndIsFinal) {
  make("ws/robot/meshes/a.stl");
  make("mine/meshes/a.stl");
  const MeshPaths::Packages mine{{"robot", folder.path() / "mine"}};
  EXPECT_EQ(find("package://robot/meshes/a.stl", mine), "mine/meshes/a.stl");
  make("ws/robot/meshes/b.stl");
  EXPECT_THAT(find("package://robot/meshes/b.stl", mine), HasSubstr("there is no 'b.stl' in "));
}

TEST_F(MeshPathsTest, WithoutItsPackageAFileAboveIsAGuess) {
  make("ws/meshes/a.stl");
  EXPECT_EQ(find("package://gone/meshes/a.stl"), "ws/meshes/a.stl");
  EXPECT_EQ(warning, "package 'gone' doesn't contain the file; it is taken from ../../meshes/a.stl, a guess");
  EXPECT_EQ(find("meshes/a.stl"), "ws/meshes/a.stl");
  EXPECT_EQ(warning, "it is taken from ../../meshes/a.stl, a guess");
}

TEST_F(MeshPathsTest, ADirectoryOfThatNameElsewhereIsAHint) {
  make("ws/vendor/shapes/meshes/a.stl");
  const std::string message = find("package://shapes/meshes/a.stl");
  EXPECT_THAT(message, HasSubstr("there is no package 'shapes' (say where the package is: --package shapes="));
  EXPECT_THAT(message, HasSubstr("/ws/vendor/shapes,"));
}

TEST_F(MeshPathsTest, TellsACaseThatDiffers) {
  make("ws/robot/Meshes/A.STL");
  EXPECT_THAT(find("package://robot/meshes/a.stl"), HasSubstr("there is no 'meshes' in"));
  EXPECT_THAT(find("package://robot/meshes/a.stl"), HasSubstr("; there is 'Meshes'"));
  EXPECT_THAT(find("../Meshes/a.stl"), HasSubstr("; there is 'A.STL'"));
}

TEST_F(MeshPathsTest, TellsWhatIsNoPath) {
  EXPECT_THAT(find(""), HasSubstr("empty"));
  EXPECT_THAT(find("package://a"), HasSubstr("package:// is not followed by a name and a path"));
  EXPECT_THAT(find("package:///"), HasSubstr("package:// is not followed by a name and a path"));
  EXPECT_THAT(find("file://a.stl"), HasSubstr("file:// is not followed by an absolute path"));
  EXPECT_THAT(find("http://x/a.stl"), HasSubstr("nothing is read from http://"));
  EXPECT_THAT(find("meshes\\a.stl"), HasSubstr("write / instead of \\"));
}

TEST_F(MeshPathsTest, SearchesNeitherHiddenNorLinkedDirectories) {
  folder.write("ws/.cache/package.xml", "<package><name>shapes</name></package>");
  make("ws/.cache/a.stl");
  EXPECT_THAT(find("package://shapes/a.stl"), HasSubstr("there is no package"));
  std::filesystem::create_directory(folder.path() / "ws/loop");
  std::filesystem::create_directory_symlink(folder.path() / "ws", folder.path() / "ws/loop/back");
  EXPECT_THAT(find("package://shapes/a.stl"), HasSubstr("there is no package"));
}

TEST_F(MeshPathsTest, SearchesNotBelowTheHomeDirectoryItself) {
  const std::string home = std::getenv("HOME") == nullptr ? "" : std::getenv("HOME");
  folder.write("ws/stuff/package.xml", "<package><name>shapes</name></package>");
  make("ws/stuff/a.stl");
  EXPECT_EQ(find("package://shapes/a.stl"), "ws/stuff/a.stl");
  setenv("HOME", (folder.path() / "ws").c_str(), 1);
  const std::string message = find("package://shapes/a.stl");
  home.empty() ? unsetenv("HOME") : setenv("HOME", home.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("there is no package"));
}

TEST_F(MeshPathsTest, SearchEndsInAHugeDirectory) {
  const std::filesystem::path huge = folder.path() / "ws/huge";
  std::filesystem::create_directories(huge);
  for (int i = 0; i <= PackageSearch::most_entries; ++i) std::filesystem::create_symlink("x", huge / std::to_string(i));
  EXPECT_THAT(find("package://shapes/a.stl"), HasSubstr("the search for it ended after 20000 directory entries"));
}

TEST(PercentEncoding, IsDecodedWhereItIsSound) {
  EXPECT_EQ(percent_decoded("a%20b%2Fc%2f"), "a b/c/");
  EXPECT_EQ(percent_decoded("100%"), "100%");
  EXPECT_EQ(percent_decoded("%2"), "%2");
  EXPECT_EQ(percent_decoded("%zz%-1"), "%zz%-1");
}

}  // namespace
}  // namespace rehearse
