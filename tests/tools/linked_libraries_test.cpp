// The meaning of "without physics": the replaying program links neither physics nor renderer, even indirectly. And the
// libraries and programs that a verb doesn't load.
#include "command.h"

#include <gmock/gmock.h>

#include <set>

namespace rehearse::test {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class LinkedLibraries : public Command {
 protected:
  /// The libraries that the file's own dynamic section names.
  std::set<std::string> needed_by(const fs::path& file) const {
    const Outcome section = run("readelf", {"--dynamic", "--wide", file.string()});
    EXPECT_EQ(section.status, 0) << section.err;
    return found_between("Shared library: [", "]", section.out);
  }
  /// The files that the dynamic linker would load, libraries of libraries included.
  std::set<std::string> loaded_for(const fs::path& file) const {
    const Outcome list = run("ldd", {file.string()});
    EXPECT_EQ(list.status, 0) << list.err;
    EXPECT_THAT(list.out, HasSubstr("libc.so"));
    EXPECT_THAT(list.out, Not(HasSubstr("not found")));
    return found_between("=> ", " (", list.out);
  }
  /// All of both: every name in the dynamic section of the program and of each library it loads.
  std::string everything(const fs::path& program) const {
    std::string names;
    for (const std::string& name : needed_by(program)) names += name + "\n";
    for (const std::string& library : loaded_for(program)) {
      names += library + "\n";
      for (const std::string& name : needed_by(library)) names += name + "\n";
    }
    return names;
  }

  static int count_of(const std::string& word, const std::string& text) {
    int count = 0;
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++count;
    return count;
  }

 private:
  static std::set<std::string> found_between(const std::string& before, const std::string& after,
                                             const std::string& text) {
    std::set<std::string> found;
    for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
      at += before.size();
      found.insert(text.substr(at, text.find(after, at) - at));
    }
    return found;
  }
};

TEST_F(LinkedLibraries, OfTheCommandAreThoseOfC) {
  for (const std::string& library : needed_by(command))
    EXPECT_THAT(library, AnyOf(StartsWith("libc.so"), StartsWith("libm.so"), StartsWith("ld-linux"),
                               StartsWith("libasan"), StartsWith("libubsan"), StartsWith("libclang_rt")));
}

TEST_F(LinkedLibraries, OfTheReaderHaveNeitherPhysicsNorRenderer) {
  const std::string names = everything(REHEARSE_READ);
  EXPECT_THAT(names, HasSubstr("librehearse_harness"));
  for (const char* absent : {"libode", "libOSMesa", "libGL", "libLLVM", "libassimp", "librehearse_simulation"})
    EXPECT_THAT(names, Not(HasSubstr(absent)));
}

TEST_F(LinkedLibraries, OfTheAuditHaveNeitherAndThoseOfTheReaderHaveNoDisassembler) {
  const std::string audit = everything(command.parent_path() / "../libexec/rehearse/rehearse-audit");
  for (const char* absent : {"libode", "libOSMesa", "librehearse_simulation"})
    EXPECT_THAT(audit, Not(HasSubstr(absent)));
  for (const char* own : {"libcapstone", "libdw"}) {
    EXPECT_THAT(audit, HasSubstr(own));
    EXPECT_THAT(everything(REHEARSE_READ), Not(HasSubstr(own)));
  }
}

TEST_F(LinkedLibraries, OfTheSimulatorHavePhysics) {  // so that the test above can fail
  const std::string names = everything(REHEARSE_SIMULATE);
  EXPECT_THAT(names, HasSubstr("libode"));
  EXPECT_THAT(names, Not(HasSubstr("libOSMesa")));  // it would take longer to load than all other libraries
  EXPECT_THAT(names, Not(HasSubstr("libassimp")));  // it has more relocations than all other libraries
}

TEST_F(LinkedLibraries, LoadedWhileItRecordsHaveARendererOnlyIfACameraRuns) {
  const auto loaded = [this](const fs::path& scenario) {
    const Outcome outcome = rehearse({"record", scenario.string(), "-o", "run.mcap"}, "LD_DEBUG=files");
    EXPECT_EQ(outcome.status, 0);
    return outcome.err;
  };
  EXPECT_THAT(loaded(sr1_without_cameras()), Not(HasSubstr("libOSMesa")));
  EXPECT_THAT(loaded(fixtures / "scenarios/tank.yaml"), HasSubstr("libOSMesa"));
}

TEST_F(LinkedLibraries, LoadedWhileItRecordsHaveAReaderOfMeshesOnlyIfAModelHasAMeshFile) {
  const auto loaded = [this](const fs::path& scenario) {
    const Outcome outcome =
        rehearse({"record", scenario.string(), "--duration", "0.1", "-o", "run.mcap"}, "LD_DEBUG=files");
    EXPECT_EQ(outcome.status, 0);
    return outcome.err;
  };
  EXPECT_THAT(loaded(sr1_without_cameras()), Not(HasSubstr("libassimp")));
  const std::string files = loaded(fixtures / "scenarios/mesh_arm.yaml");
  EXPECT_THAT(files, HasSubstr("librehearse_assimp"));
  EXPECT_THAT(files, HasSubstr("libassimp"));
}

/// `rehearse` and the program of the verb, which is pinned when it begins.
TEST_F(LinkedLibraries, AreLoadedForTwoPrograms) {
  done({"record", sr1_without_cameras().string(), "-o", "run.mcap"});
  for (const std::vector<std::string>& words : {std::vector<std::string>{"record", "sr1.yaml", "-o", "again.mcap"},
                                                {"replay", "run.mcap"},
                                                {"info", "run.mcap"},
                                                {"--version"},
                                                {"help", "check"}}) {
    const Outcome outcome = rehearse(words, "env -u GLIBC_TUNABLES -u REHEARSE_PIN LD_DEBUG=files");
    EXPECT_EQ(outcome.status, 0) << words[0] << outcome.out;
    EXPECT_EQ(count_of("initialize program: ", outcome.err), 2) << words[0];
  }
}

TEST_F(LinkedLibraries, LoadedWhileItReplaysHaveNeitherPhysicsNorRenderer) {
  done({"record", sr1_without_cameras().string(), "-o", "sr1.mcap"});
  const Outcome outcome = rehearse({"replay", "sr1.mcap"}, "LD_DEBUG=files");  // on stderr, dlopen included
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("SR1MinimumController.so"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("libode")));
  EXPECT_THAT(outcome.err, Not(HasSubstr("libOSMesa")));
  EXPECT_THAT(outcome.err, Not(HasSubstr("libGL")));
}

}  // namespace
}  // namespace rehearse::test
