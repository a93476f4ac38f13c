#include <gtest/gtest.h>
#include <cnoid/ExecutablePath>
#include <cnoid/FileUtil>

#include <filesystem>
#include <optional>
#include <string>

#include "share_variable.h"

namespace {

namespace fs = std::filesystem;

using rehearse::test::ShareVariable;

TEST(ExecutablePath, FindsTheShareFolderThatTheEnvironmentNames) {
  const ShareVariable variable("/opt/choreonoid/share");
  EXPECT_EQ(cnoid::shareDirPath(), "/opt/choreonoid/share");
  EXPECT_EQ(cnoid::shareDir(), "/opt/choreonoid/share");
}

TEST(ExecutablePath, ElseLooksBesideTheLibrary) {
  const ShareVariable variable(nullptr);
  EXPECT_TRUE(fs::exists(cnoid::pluginDirPath() / "librehearse_cnoid.so")) << cnoid::pluginDir();
  EXPECT_EQ(cnoid::shareDirPath(), cnoid::pluginDirPath().parent_path() / "share" / "choreonoid");
  EXPECT_EQ(cnoid::shareDir(), cnoid::shareDirPath().string());
}

TEST(ExecutablePath, TakesAnEmptyVariableForNone) {
  const ShareVariable variable("");
  EXPECT_EQ(cnoid::shareDirPath().filename(), "choreonoid");
}

TEST(ExecutablePath, KnowsTheProgram) {
  EXPECT_EQ(cnoid::executableBasename(), "controllers_test");
  EXPECT_EQ(fs::path(cnoid::executableFile()), fs::path(cnoid::executableDir()) / cnoid::executableBasename());
  EXPECT_EQ(fs::path(cnoid::executableTopDir()), fs::path(cnoid::executableDir()).parent_path());
}

TEST(FileUtil, GivesPathsAsSeenFromAFolder) {
  EXPECT_EQ(cnoid::getRelativePath("/a/b/c", "/a"), fs::path("b/c"));
  EXPECT_EQ(cnoid::getRelativePath("b", "/a"), std::nullopt);
  EXPECT_TRUE(cnoid::checkIfSubFilePath("/a/b/../c", "/a"));
  EXPECT_FALSE(cnoid::checkIfSubFilePath("/a/../c", "/a"));
  EXPECT_FALSE(cnoid::checkIfSubFilePath("/a", "/a"));
}

TEST(FileUtil, HasItsOldNamesForWhatTheStandardLibraryDoes) {
  EXPECT_EQ(cnoid::getExtension("walk.seq"), "seq");
  EXPECT_EQ(cnoid::getExtension("walk"), "");
  EXPECT_EQ(cnoid::getFilename("/a/walk.seq"), "walk.seq");
  EXPECT_EQ(cnoid::getBasename("/a/walk.seq"), "walk");
  EXPECT_EQ(cnoid::getCompactPath("/a/./b"), "/a/b");
  EXPECT_TRUE(cnoid::checkAbsolute("/a"));
  EXPECT_TRUE(cnoid::getAbsolutePath("a").is_absolute());
}

}  // namespace
