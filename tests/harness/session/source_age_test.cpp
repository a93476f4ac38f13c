// Libraries that are older than their sources. Each test compiles a library in a project of its own.
#include "core/host/source_age.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "base/file_identity.h"
#include "support/bytes_read.h"
#include "support/shell.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

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
  /// The bytes that a new process reads to look at the library.
  std::int64_t bytes_read_for_note() const {
    const std::string counted = in_a_process([this] {
      const std::int64_t before = test::bytes_read();
      EXPECT_TRUE(notes_on_old_library(library()).empty());
      return std::to_string(test::bytes_read() - before);
    });
    return std::stoll(counted);
  }
  /// The library is looked at in a new process, as by each command. Several notes are separated by line ends.
  std::string note() const {
    return in_a_process([this] {
      std::string text;
      for (const std::string& note : notes_on_old_library(library())) text += (text.empty() ? "" : "\n") + note;
      return text;
    });
  }
  static std::string in_a_process(const std::function<std::string()>& work) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    if (::fork() == 0) {
      const std::string text = work();
      _exit(::write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? 0 : 1);
    }
    ::close(ends[1]);
    std::string text(4096, ' ');
    const ssize_t size = ::read(ends[0], text.data(), text.size());
    ::close(ends[0]);
    int status = 0;
    EXPECT_TRUE(::wait(&status) > 0 && status == 0);
    text.resize(static_cast<std::size_t>(size));
    return text;
  }

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

TEST_F(SourceAge, OfALibraryThatNobodyChangesIsLookedUpWithoutReadingIt) {
  constexpr std::int64_t size = 4 << 20;
  write("walk.cpp", "extern const char data[" + std::to_string(size) + "];\nconst char data[" + std::to_string(size) +
                        "] = {1};\nint walk(int tick) { return data[tick]; }\n");
  build();
  EXPECT_GT(bytes_read_for_note(), size);
  while (!FileIdentity::of(library())->is_older_than(std::chrono::seconds(2))) usleep(10'000);
  EXPECT_GT(bytes_read_for_note(), size) << "it had just been built";
  EXPECT_LT(bytes_read_for_note(), size / 100);
  write("walk.cpp", "int walk(int) { return 7; }\n");
  EXPECT_THAT(note(), HasSubstr("walk.cpp is newer than Walk.so"));
  build();
  EXPECT_EQ(note(), "") << "it was built again";
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

/// The second library states the folder of another checkout, as one of a compiler cache that several checkouts share.
TEST_F(SourceAge, OfASourceWithARelativeNameIsTold) {
  for (const std::string& option :
       {std::string("-g"), "-g -fdebug-prefix-map=" + folder_.path().string() + "=/another/checkout"}) {
    write("walk.cpp", "#include \"gait.h\"\nint walk(int tick) { return phase(tick); }\n");
    const std::string line = "cd " + test::quoted((folder_ / "build").string()) + " && " + test::quoted(CXX_COMPILER) +
                             " -shared -fPIC " + option + " -o Walk.so ../walk.cpp";
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
    set_age(library(), 2);
    write("walk.cpp", "int walk(int) { return 7; }\n");
    EXPECT_THAT(note(), HasSubstr("gait.h and 1 more are newer than Walk.so")) << option;
  }
}

TEST_F(SourceAge, IsFoundOutAnewForAnotherProject) {
  build();
  fs::create_directories(folder_ / "build/golden");
  EXPECT_EQ(note(), "") << "the sources are outside the project";
  fs::rename(folder_ / "build/golden", folder_ / "golden");
  write("walk.cpp", "int walk(int) { return 7; }\n");
  EXPECT_THAT(note(), HasSubstr("walk.cpp is newer than Walk.so"));
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

/// Walk.so links libgait.so, which links libclock.so; each is found by the search of the library that links it.
TEST_F(SourceAge, OfALinkedLibraryOfTheProjectIsTold) {
  const auto compile = [this](const std::string& output, const std::string& source, const std::string& link) {
    fs::create_directories((folder_ / output).parent_path());
    const std::string line = test::quoted(CXX_COMPILER) + " -O0 -shared -fPIC -g1 -o " +
                             test::quoted((folder_ / output).string()) + " " +
                             test::quoted((folder_ / source).string()) + " " + link;
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
    set_age(folder_ / output, 2);
    set_age(folder_ / source, 3);
  };
  write("clock.cpp", "int now() { return 1; }\n");
  write("gait.cpp", "int now();\nint step() { return now(); }\n");
  write("stride.cpp", "int step();\nint stride() { return step(); }\n");
  const std::string libraries = " -L" + test::quoted((folder_ / "build/lib").string());
  compile("build/lib/libclock.so", "clock.cpp", "");
  compile("build/lib/libgait.so", "gait.cpp", libraries + " -Wl,--no-as-needed -lclock '-Wl,-rpath,$ORIGIN'");
  compile("build/Walk.so", "stride.cpp", libraries + " -Wl,--no-as-needed -lgait '-Wl,-rpath,$ORIGIN/lib'");
  EXPECT_EQ(note(), "");
  write("gait.cpp", "int step() { return 7; }\n");
  EXPECT_THAT(note(), AllOf(HasSubstr("gait.cpp is newer than libgait.so: built before your last change"),
                            Not(HasSubstr("Walk.so")), Not(HasSubstr("clock"))));
  write("clock.cpp", "int now() { return 7; }\n");
  write("stride.cpp", "int stride() { return 7; }\n");
  EXPECT_THAT(note(),
              AllOf(HasSubstr("gait.cpp is newer than libgait.so"), HasSubstr("clock.cpp is newer than libclock.so"),
                    StartsWith((fs::proximate(folder_ / "stride.cpp")).string() + " is newer than Walk.so")));
}

TEST_F(SourceAge, OfALinkedLibraryOfAnotherProjectIsNotTold) {
  const test::TemporaryFolder elsewhere;
  std::ofstream(elsewhere / "CMakeLists.txt");
  std::ofstream(elsewhere / "gait.cpp") << "int step() { return 1; }\n";
  const std::string other = (elsewhere / "libgait.so").string();
  const auto compile = [](const std::string& arguments) {
    const std::string line = test::quoted(CXX_COMPILER) + " -O0 -shared -fPIC -g1 " + arguments;
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
  };
  compile("-o " + test::quoted(other) + " " + test::quoted((elsewhere / "gait.cpp").string()));
  compile("-o " + test::quoted(library().string()) + " " + test::quoted((folder_ / "walk.cpp").string()) + " -L" +
          test::quoted(elsewhere.path().string()) + " -Wl,--no-as-needed -lgait -Wl,-rpath," +
          test::quoted(elsewhere.path().string()));
  set_age(folder_ / "walk.cpp", 3);
  set_age(folder_ / "gait.h", 3);
  set_age(elsewhere / "gait.cpp", -1);
  EXPECT_EQ(note(), "");
}

TEST_F(SourceAge, OfALibraryThatIsMissingIsUnknown) { EXPECT_EQ(note(), ""); }

}  // namespace
}  // namespace rehearse
