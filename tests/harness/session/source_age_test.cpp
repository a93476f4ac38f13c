// Libraries that are older than their sources. Each test compiles a library in a project of its own.
#include "core/host/source_age.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/shell.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class SourceAge : public ::testing::Test {
 protected:
  SourceAge() {
    write("CMakeLists.txt", "");
    write("build/CMakeCache.txt", "");
    write("gait.h", "static int phase(int tick) { return tick % 2; }\n");
    write("walk.cpp", "#include \"gait.h\"\nint walk(int tick) { return phase(tick); }\n");
  }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  /// Makes Walk.so with the compiler's option, two hours ago; its sources are older.
  void build(const std::string& option = "-g1", const std::string& source = "walk.cpp") const {
    const std::string line = test::quoted(CXX_COMPILER) + " -O0 -shared -fPIC " + option + " -o " +
                             test::quoted(library().string()) + " " + test::quoted((folder_ / source).string());
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
    set_age(library(), 2);
    for (const char* file : {"gait.h", "walk.cpp"}) set_age(folder_ / file, 3);
  }
  static void set_age(const fs::path& file, int hours) {
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(hours));
  }
  fs::path library() const { return folder_ / "build/Walk.so"; }
  std::string note() const { return note_on_old_library(library()); }

  test::TemporaryFolder folder_;
};

TEST_F(SourceAge, OfAnEditedSourceIsTold) {
  build();
  EXPECT_EQ(note(), "");
  write("walk.cpp", "int walk(int) { return 7; }\n");
  EXPECT_THAT(note(), AllOf(HasSubstr("walk.cpp is newer than Walk.so: built before your last change; cmake --build "),
                            EndsWith("/build")));
  build();
  EXPECT_EQ(note(), "") << "it was built again";
}

TEST_F(SourceAge, OfAnEditedHeaderIsTold) {
  build();
  write("gait.h", "static int phase(int) { return 1; }\n");
  EXPECT_THAT(note(), HasSubstr("gait.h is newer than Walk.so"));
  write("walk.cpp", "#include \"gait.h\"\nint walk(int tick) { return -phase(tick); }\n");
  EXPECT_THAT(note(), HasSubstr("gait.h and 1 more are newer than Walk.so"));
}

TEST_F(SourceAge, OfASourceWithEqualContentIsNotTold) {
  build();
  EXPECT_EQ(note(), "");
  set_age(folder_ / "walk.cpp", 0);
  EXPECT_EQ(note(), "") << "it was touched";
  write("walk.cpp", "int walk(int) { return 7; }\n");
  EXPECT_NE(note(), "");
  write("walk.cpp", "#include \"gait.h\"\nint walk(int tick) { return phase(tick); }\n");
  EXPECT_EQ(note(), "") << "the edit was undone";
}

TEST_F(SourceAge, OfASourceWhoseContentWasNeverSeenIsTold) {
  build();
  set_age(folder_ / "walk.cpp", 0);
  EXPECT_THAT(note(), HasSubstr("walk.cpp is newer than Walk.so"));
}

TEST_F(SourceAge, IsUnknownWithoutLineInformation) {
  build("-g0");
  write("walk.cpp", "int walk(int) { return 7; }\n");
  EXPECT_EQ(note(), "");
}

TEST_F(SourceAge, OfFilesThatTheBuildMakesAndOfOtherProjectsIsNotTold) {
  const test::TemporaryFolder elsewhere;
  std::ofstream(elsewhere / "other.h") << "static int other() { return 1; }\n";
  write("build/made.cpp",
        "#include \"" + (elsewhere / "other.h").string() + "\"\nint walk(int tick) { return tick + other(); }\n");
  build("-g1", "build/made.cpp");
  set_age(folder_ / "build/made.cpp", 0);
  set_age(elsewhere / "other.h", 0);
  EXPECT_EQ(note(), "");
}

TEST_F(SourceAge, OfALibraryThatIsMissingIsUnknown) { EXPECT_EQ(note(), ""); }

}  // namespace
}  // namespace rehearse
