// The files that SourceWatch tells: those whose content is another, and no others.
#include "viewing/ui/source_watch.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace rehearse::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

class SourceWatching : public testing::Test {
 protected:
  SourceWatching() {
    for (const char* name : {"scenarios", "build/lib", ".git", "src/deep"})
      fs::create_directories(folder_.path() / name);
    write("src/hold.cpp", "gain 1");
    auto watch = SourceWatch::open(folder_.path(), {folder_.path() / "left_out"});
    EXPECT_TRUE(watch) << to_string(watch.errors());
    watch_.emplace(*std::move(watch));
  }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_.path() / name) << text; }
  /// The changed files, from the folder on.
  std::vector<std::string> changed() {
    std::vector<std::string> names;
    for (const fs::path& file : watch_->changed()) names.push_back(file.lexically_relative(folder_.path()).string());
    return names;
  }

  TemporaryFolder folder_;
  std::optional<SourceWatch> watch_;
};

TEST_F(SourceWatching, AWrittenFileIsToldOnce) {
  write("src/hold.cpp", "gain 2");
  EXPECT_THAT(changed(), ElementsAre("src/hold.cpp"));
  EXPECT_THAT(changed(), IsEmpty());
}

TEST_F(SourceWatching, AFileThatIsWrittenAgainWithItsContentIsntTold) {
  write("src/hold.cpp", "gain 2");
  EXPECT_THAT(changed(), ElementsAre("src/hold.cpp"));
  write("src/hold.cpp", "gain 2");
  EXPECT_THAT(changed(), IsEmpty());
  write("src/hold.cpp", "gain 1");
  EXPECT_THAT(changed(), ElementsAre("src/hold.cpp"));
}

TEST_F(SourceWatching, AnEditorMayReplaceTheFileByAnother) {
  write("src/hold.cpp.new", "gain 2");
  fs::rename(folder_.path() / "src/hold.cpp.new", folder_.path() / "src/hold.cpp");
  EXPECT_THAT(changed(), ElementsAre("src/hold.cpp"));
}

TEST_F(SourceWatching, BuildsHiddenFilesTemporaryOnesAndFoldersLeftOutArentTold) {
  fs::create_directories(folder_.path() / "left_out");
  changed();
  for (const char* name :
       {"build/lib/Hold.so", ".git/index", "src/.hold.cpp.swp", "src/hold.cpp~", "left_out/run.mcap"})
    write(name, "new");
  write("src/object.o.tmp", "new");
  fs::remove(folder_.path() / "src/object.o.tmp");
  EXPECT_THAT(changed(), IsEmpty());
}

TEST_F(SourceWatching, ARemovedFileAndFilesInNewFoldersAreTold) {
  fs::remove(folder_.path() / "src/hold.cpp");
  EXPECT_THAT(changed(), ElementsAre("src/hold.cpp"));
  fs::create_directories(folder_.path() / "scenarios/more");
  EXPECT_THAT(changed(), ElementsAre("scenarios/more"));
  write("scenarios/more/walk.yaml", "rehearse: 1");
  EXPECT_THAT(changed(), ElementsAre("scenarios/more/walk.yaml"));
}

}  // namespace
}  // namespace rehearse::test
