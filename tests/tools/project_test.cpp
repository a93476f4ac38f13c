// A project's scenarios, goldens and controllers are found without an argument and without the environment.
#include <gmock/gmock.h>

#include <sys/inotify.h>
#include <unistd.h>

#include <array>

#include "base/file_descriptor.h"
#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A project in the layout of `rehearse new`; its controller is built, or copied to the place of a built one.
class Project : public Command {
 protected:
  Project() {
    write("CMakeLists.txt", "");
    fs::create_directories(folder() / "scenarios");
    std::string text = read_file(pendulum("Swing"));
    fs::remove(folder() / "pendulum.yaml");
    write("scenarios/swing.yaml", "golden: Swing.Swings\n" + text);
  }
  void build(const std::string& name, const fs::path& controller) const {
    const fs::path where = folder() / name / "lib/rehearse/controllers";
    fs::create_directories(where);
    fs::copy_file(controller, where / "Swing.so", fs::copy_options::overwrite_existing);
  }
};

TEST_F(Project, CheckWithoutArgumentsMakesTheFirstGoldenAndThenPasses) {
  build("build", MISBEHAVING);
  EXPECT_EQ(rehearse({"check"}).status, 1);
  EXPECT_EQ(rehearse({"check"}, "REHEARSE_GOLDEN=new").status, 0);
  EXPECT_TRUE(exists("golden/Swing.Swings.mcap"));
  const Outcome again = rehearse({"check"});
  EXPECT_EQ(again.status, 0) << again.out << again.err;
  EXPECT_THAT(again.out, HasSubstr("swing: equal"));
}

TEST_F(Project, ItsFoldersAreFoundFromBelow) {
  build("build", MISBEHAVING);
  EXPECT_EQ(rehearse({"check"}, "cd scenarios &&").status, 1);
  EXPECT_EQ(rehearse({"check"}, "cd scenarios && REHEARSE_GOLDEN=new").status, 0);
  EXPECT_TRUE(exists("golden/Swing.Swings.mcap"));
}

TEST_F(Project, OfTwoBuildsTheNewerLibraryIsTaken) {
  build("build", NOT_A_CONTROLLER);
  build("build-debug", MISBEHAVING);
  fs::last_write_time(folder() / "build/lib/rehearse/controllers/Swing.so",
                      fs::file_time_type::clock::now() - std::chrono::hours(1));
  write("build-debug/CMakeCache.txt", "CMAKE_BUILD_TYPE:STRING=Debug\n");
  const Outcome recorded = rehearse({"record", "scenarios/swing.yaml"});
  EXPECT_EQ(recorded.status, 0);
  EXPECT_EQ(recorded.err, "note: Swing.so is taken from build-debug (Debug), where it is newest; also in: build\n");
  const Outcome stated = rehearse({"record", "scenarios/swing.yaml"},
                                  "REHEARSE_CONTROLLER_PATH=\"$PWD/build-debug/lib/rehearse/controllers\"");
  EXPECT_EQ(stated.err, "") << "the user chose";
}

TEST_F(Project, ALibraryWithASanitizerIsRefusedInOneSentence) {
  write("swing.cpp", "extern \"C\" int given(int* numbers, int i) { return numbers[i]; }\n");
  fs::create_directories(folder() / "build/lib/rehearse/controllers");
  const Outcome compiled = run(CXX_COMPILER, {"-fsanitize=address", "-shared", "-fPIC", "-o",
                                              "build/lib/rehearse/controllers/Swing.so", "swing.cpp"});
  if (compiled.status != 0) GTEST_SKIP() << "the compiler has no AddressSanitizer: " << compiled.err;
  const Outcome refused = rehearse({"record", "scenarios/swing.yaml"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("controller library 'Swing.so' is built with AddressSanitizer, whose runtime must be "
                        "loaded before this program (build it without -fsanitize=address, or preload"));
}

TEST_F(Project, ABuildOfAnyNameIsFoundByItsCache) {
  for (const char* name : {"out", "cmake-build-debug", "out/build/release"}) {
    build(name, MISBEHAVING);
    write(std::string(name) + "/CMakeCache.txt", "");
    EXPECT_EQ(rehearse({"record", "scenarios/swing.yaml"}).status, 0) << name;
    fs::remove_all(folder() / name);
  }
  build("notes", MISBEHAVING);
  EXPECT_EQ(rehearse({"record", "scenarios/swing.yaml"}).status, 2) << "a folder without a cache";
}

TEST_F(Project, AScenarioIsFoundByItsNameItsGoldenAndItsFolder) {
  build("build", MISBEHAVING);
  EXPECT_EQ(rehearse({"check"}, "REHEARSE_GOLDEN=new").status, 0);
  for (const char* word : {"swing", "swing.yaml", "Swing.Swings", "scenarios", ".", "scenarios/swing.yaml"})
    EXPECT_EQ(done({"check", "--json", word}).json()["file"], "scenarios/swing.yaml") << word;
  EXPECT_EQ(rehearse({"check", "--json", "swing"}, "cd scenarios &&").json()["scenario"], "swing");
  EXPECT_EQ(rehearse({"record", "swing"}).status, 0);
  const Outcome misspelt = rehearse({"check", "swin"});
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_EQ(misspelt.err, "error: there is no file, scenario or golden 'swin' (did you mean 'swing'?)\n");
  write("swing.cpp", "");
  EXPECT_THAT(rehearse({"check", "swing.cpp"}).err, HasSubstr("not a scenario (its scenario: scenarios/swing.yaml)"));
  fs::create_directories(folder() / "models");
  EXPECT_THAT(rehearse({"check", "models"}).err, HasSubstr("no *.yaml below models names a golden"));
}

TEST_F(Project, ACheckTakesAnotherValueOfTheScenario) {
  build("build", MISBEHAVING);
  EXPECT_EQ(rehearse({"check"}, "REHEARSE_GOLDEN=new").status, 0);
  const std::string golden = read_file(folder() / "golden/Swing.Swings.mcap");
  const Outcome changed = rehearse({"check", "swing", "--with", "bodies.Pendulum.joints.hinge=25 deg"});
  EXPECT_EQ(changed.status, 1) << changed.err;
  EXPECT_THAT(changed.out, HasSubstr("(bodies/Pendulum/joints/hinge is 25 deg, was 20 deg)"));
  rehearse({"golden", "accept", "--all"});
  EXPECT_EQ(read_file(folder() / "golden/Swing.Swings.mcap"), golden) << "the scenario doesn't make this run";
  const Outcome accepting = rehearse({"check", "swing", "--with", "duration=0.04"}, "REHEARSE_GOLDEN=accept");
  EXPECT_EQ(accepting.status, 2);
  EXPECT_THAT(accepting.err, HasSubstr("--with changes the scenario, so no run of it becomes a golden"));
  EXPECT_EQ(done({"check"}).status, 0);
  const Outcome set = rehearse({"record", "swing", "--set", "duration=0.04"});
  EXPECT_EQ(set.status, 2);
  EXPECT_THAT(set.err, HasSubstr("another value in the scenario: --with duration=0.04"));
}

TEST_F(Project, OfTheScenarioKeepsItsRunsFromWhereverItIsChecked) {
  build("build", MISBEHAVING);
  fs::create_directories(folder() / "elsewhere");
  fs::create_directories(folder() / "mine");
  for (const char* part : {"CMakeLists.txt", "scenarios", "build"})
    fs::rename(folder() / part, folder() / "mine" / part);
  const Outcome outcome = rehearse({"check", "../mine/scenarios/swing.yaml"}, "cd elsewhere &&");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_TRUE(fs::exists(folder() / "mine/rehearse-pending/Swing.Swings.mcap"));
  EXPECT_TRUE(fs::is_empty(folder() / "elsewhere"));
  EXPECT_THAT(outcome.out, HasSubstr("if it is right: cd ../mine && rehearse golden accept Swing.Swings\n"));
  EXPECT_EQ(rehearse({"golden", "accept", "Swing.Swings"}, "cd elsewhere && cd ../mine &&").status, 0);
  EXPECT_EQ(rehearse({"check", "../mine/scenarios/swing.yaml"}, "cd elsewhere &&").status, 0);
}

TEST_F(Project, AForgottenBuildIsAdvised) {
  const Outcome outcome = rehearse({"record", "scenarios/swing.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("controller library 'Swing' not found"));
  EXPECT_THAT(outcome.err, HasSubstr("build it first: cmake -S "));
}

TEST_F(Project, ALibraryThatIsOlderThanItsSourceIsToldFirst) {
  const std::string source =
      "#include <cnoid/SimpleController>\n"
      "class Swing : public cnoid::SimpleController {\n"
      " public:\n"
      "  bool initialize(cnoid::SimpleControllerIO*) override { return true; }\n"
      "  bool control() override { return true; }\n"
      "};\n"
      "CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Swing)\n";
  write("swing.cpp", source);
  fs::create_directories(folder() / "build/lib/rehearse/controllers");
  write("build/CMakeCache.txt", "");
  const std::string library = "build/lib/rehearse/controllers/Swing.so";
  const Outcome compiled = run(
      CXX_COMPILER, {"-std=c++17", "-O0", "-g1", "-shared", "-fPIC", "-DEIGEN_MAX_ALIGN_BYTES=16", "-I" CNOID_INCLUDE,
                     "-isystem" EIGEN_INCLUDE, "-o", library, (folder() / "swing.cpp").string()});
  ASSERT_EQ(compiled.status, 0) << compiled.err;
  EXPECT_EQ(rehearse({"check"}, "REHEARSE_GOLDEN=new").status, 0);
  EXPECT_EQ(rehearse({"check"}).err, "");
  write("swing.cpp", source + "// edited\n");
  const std::string note =
      "note: swing.cpp is newer than Swing.so: built before your last change; cmake --build build\n";
  const Outcome checked = rehearse({"check"});
  EXPECT_EQ(checked.status, 0) << "the library is judged as it is";
  EXPECT_EQ(checked.err, note);
  EXPECT_EQ(rehearse({"replay", "golden/Swing.Swings.mcap"}).err, note);
  EXPECT_EQ(rehearse({"record", "scenarios/swing.yaml"}).err, note);
  EXPECT_EQ(rehearse({"check", "scenarios/swing.yaml", "scenarios/swing.yaml"}).err, note) << "once";
  const std::string sentence = note.substr(6, note.size() - 7);
  const auto expect_in_remarks = [&](const std::vector<std::string>& words) {
    const nlohmann::json remarks = rehearse(words).json()["remarks"];
    ASSERT_EQ(remarks.size(), 1u) << words[0];
    EXPECT_EQ(remarks[0].is_string() ? remarks[0] : remarks[0]["message"], sentence) << words[0];
  };
  expect_in_remarks({"check", "--json"});
  expect_in_remarks({"replay", "golden/Swing.Swings.mcap", "--json"});
  expect_in_remarks({"record", "scenarios/swing.yaml", "--json"});
  const std::string scenario = read_file(folder() / "scenarios/swing.yaml");
  write("scenarios/swing.yaml", scenario + "expect:\n  - {channel: Pendulum/hinge/q, below: -90 deg, at: end}\n");
  EXPECT_EQ(rehearse({"check"}).status, 1);
  EXPECT_THAT(read_file(folder() / "build/goldens/pending/Swing.Swings.html"), HasSubstr(sentence));
  write("scenarios/swing.yaml", scenario);
  write("scenarios/fall.yaml", read_file(folder() / "scenarios/swing.yaml"));
  const Outcome tested = run(OWNING_TESTS, {"--gtest_filter=Macro.Falls"},
                             "REHEARSE_FIXTURES=scenarios REHEARSE_GOLDEN_DIR=golden REHEARSE_PENDING=pending "
                             "REHEARSE_REPORT=always");
  EXPECT_THAT(tested.err, HasSubstr(note)) << tested.out;
  EXPECT_THAT(read_file(folder() / "traces/Macro.Falls.html"), HasSubstr(sentence));
  fs::remove(folder() / "scenarios/fall.yaml");
  const std::vector<std::string> of_ctest{"--gtest_list_tests", "--rehearse_notes_on", library};
  const Outcome asked = run(OWNING_TESTS, of_ctest);
  EXPECT_EQ(asked.err, note) << "ctest prints it before the tests";
  EXPECT_EQ(asked.out, "");
  write("swing.cpp", source);
  EXPECT_EQ(run(OWNING_TESTS, of_ctest).err, "");
  EXPECT_EQ(rehearse({"check"}).err, "") << "the edit was undone";
}

/// No tick was judged: the cause is the only sentence.
TEST_F(Project, AControllerThatRefusedIsReportedWithoutExpectations) {
  build("build", MISBEHAVING);
  const std::string scenario = read_file(folder() / "scenarios/swing.yaml") +
                               "expect:\n  - {channel: Pendulum/hinge/q, below: 90 deg, at: end}\n";
  write("scenarios/swing.yaml", scenario);
  EXPECT_EQ(rehearse({"check"}, "REHEARSE_GOLDEN=new").status, 0);
  const std::string options = "options: \"\"";
  write("scenarios/swing.yaml",
        std::string(scenario).replace(scenario.find(options), options.size(), "options: say-and-refuse"));
  const Outcome outcome = rehearse({"check"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out, HasSubstr("it wrote: the robot has no joint KNEE"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("expected Pendulum/hinge/q below 90 deg")));
}

TEST_F(Project, OfPythonHasItsFirstGoldenMadeByCheck) {
  build("build", MISBEHAVING);
  fs::remove(folder() / "CMakeLists.txt");
  for (const char* file : {"pytest.ini", "pyproject.toml"}) {
    write(file, "");
    const Outcome first = rehearse({"check"}, "cd scenarios &&");
    EXPECT_EQ(first.status, 1) << file;
    EXPECT_THAT(first.out, HasSubstr("there is no golden ../golden/Swing.Swings.mcap")) << file;
    fs::remove_all(folder() / "rehearse-pending");
    fs::remove(folder() / file);
  }
  write("pytest.ini", "");
  EXPECT_EQ(rehearse({"check"}, "REHEARSE_GOLDEN=new").status, 0);
  EXPECT_TRUE(exists("golden/Swing.Swings.mcap"));
}

TEST_F(Project, AScenarioThatIsALinkIsCheckedInTheFolderOfItsFile) {
  build("build", MISBEHAVING);
  fs::create_directories(folder() / "robots/arm");
  fs::rename(folder() / "scenarios/swing.yaml", folder() / "robots/arm/swing.yaml");
  fs::create_symlink("../robots/arm/swing.yaml", folder() / "scenarios/swing.yaml");
  const Outcome outcome = rehearse({"check", "--json"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_EQ(outcome.json()["file"], "robots/arm/swing.yaml");
}

/// The number of folders that the command makes in a folder.
class MadeFolders {
 public:
  explicit MadeFolders(const fs::path& folder) : events_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    EXPECT_GE(::inotify_add_watch(events_, folder.c_str(), IN_CREATE), 0) << folder;
  }
  int count() const {
    int folders = 0;
    alignas(inotify_event) std::array<char, 1 << 16> block;
    for (ssize_t size = 0; (size = ::read(events_, block.data(), block.size())) > 0;)
      for (ssize_t at = 0; at < size;) {
        const auto* event = reinterpret_cast<const inotify_event*>(block.data() + at);
        folders += (event->mask & IN_ISDIR) != 0;
        at += static_cast<ssize_t>(sizeof *event) + event->len;
      }
    return folders;
  }

 private:
  const FileDescriptor events_;
};

TEST_F(Project, OfManyProvedScenariosIsCheckedInOneFolderForEachProcess) {
  build("build", MISBEHAVING);
  const std::string text = read_file(folder() / "scenarios/swing.yaml");
  for (const char* name : {"A", "B", "C", "D"})
    write(std::string("scenarios/") + name + ".yaml",
          std::string("golden: Swing.") + name + text.substr(text.find('\n')));
  fs::remove(folder() / "scenarios/swing.yaml");
  EXPECT_EQ(rehearse({"check"}, "REHEARSE_GOLDEN=new").status, 0);
  done({"check"});
  for (const int jobs : {1, 2}) {
    const MadeFolders made(folder() / "rehearse-pending");
    const Outcome outcome = done({"check", "-j", std::to_string(jobs)});
    for (const char* name : {"A", "B", "C", "D"})
      EXPECT_THAT(outcome.out, HasSubstr(std::string(name) + ": proved without simulating"));
    EXPECT_EQ(made.count(), jobs);
  }
  for (const auto& entry : fs::directory_iterator(folder() / "rehearse-pending"))
    EXPECT_EQ(entry.path().filename(), "proofs") << "nothing else is left";
}

TEST_F(Project, OutsideOfOneCheckSaysTheRule) {
  fs::remove(folder() / "CMakeLists.txt");
  const Outcome outcome = rehearse({"check"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(
      outcome.err,
      HasSubstr("no folder above it has a folder 'golden', a CMakeLists.txt, a pyproject.toml or a pytest.ini"));
}

}  // namespace
}  // namespace rehearse::test
