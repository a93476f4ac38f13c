// Exit statuses, by which scripts judge a verb.
#include "command.h"

#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

class ExitStatus : public Command {
 protected:
  ExitStatus() { fs::create_directory(folder() / "golden"); }

  /// The pendulum under a controller that does nothing, released at this angle, with its golden.
  std::string scenario(const std::string& angle, const std::string& more = "") const {
    std::string text = read_file(pendulum(MISBEHAVING, "nothing 0"));
    text.replace(text.find("20 deg"), 6, angle);
    return write("p.yaml", text + "golden: P.one\n" + more).string();
  }
};

TEST_F(ExitStatus, OfACheckThatReplacesItsGoldenIsZero) {
  EXPECT_EQ(rehearse({"check", scenario("20 deg")}, "REHEARSE_GOLDEN=new").status, 0);
  scenario("25 deg");
  EXPECT_EQ(rehearse({"check", "p.yaml"}).status, 1);
  const Outcome replaced = rehearse({"check", "p.yaml"}, "REHEARSE_GOLDEN=accept");
  EXPECT_EQ(replaced.status, 0) << replaced.out << replaced.err;
  EXPECT_THAT(replaced.out, HasSubstr("replaced golden/P.one.mcap"));
  EXPECT_EQ(rehearse({"check", "p.yaml"}).status, 0);
}

TEST_F(ExitStatus, OfAListWithAGoldenThatCanNotBeUsedIsOne) {
  EXPECT_EQ(rehearse({"check", scenario("20 deg")}, "REHEARSE_GOLDEN=new").status, 0);
  EXPECT_EQ(rehearse({"golden", "list"}).status, 0);
  write("golden/P.one.mcap", "broken");
  EXPECT_EQ(rehearse({"golden", "list"}).status, 1);
  EXPECT_EQ(rehearse({"golden", "list", "--json"}).status, 1);
}

TEST_F(ExitStatus, OfARecordWithAMisspeltExpectationIsTwo) {
  scenario("20 deg", "expect:\n  - {channel: Pendulum/hnge/q, below: 90 deg}\n");
  const Outcome recorded = rehearse({"record", "p.yaml", "-o", "run.mcap"});
  EXPECT_EQ(recorded.status, 2);
  EXPECT_THAT(recorded.err, HasSubstr(": error: "));
  EXPECT_EQ(rehearse({"doctor", "run.mcap"}).status, 0) << "the recording stays";
  scenario("20 deg", "expect:\n  - {channel: Pendulum/hinge/q, below: -90 deg}\n");
  EXPECT_EQ(rehearse({"record", "p.yaml", "-o", "run.mcap"}).status, 0);
}

/// Each file that a check keeps, of all caches: the hashes of programs, the hulls of meshes, the certificates.
TEST_F(ExitStatus, OfAVerbIsTheSameWithAFolderInThePlaceOfACacheFile) {
  write("p.yaml", "rehearse: 1\nduration: 0.02\nbodies:\n  - name: Arm\n    model: " +
                      (fixtures / "models/mesh_arm/mesh_arm.urdf").string() + "\ngolden: P.one\n");
  const std::string caches = "REHEARSE_CACHE=" + (folder() / "cache").string();
  EXPECT_EQ(rehearse({"check", "p.yaml"}, caches + " REHEARSE_GOLDEN=new").status, 0);
  EXPECT_EQ(rehearse({"check", "p.yaml"}, caches).status, 0);
  std::vector<fs::path> files;
  for (const char* place : {"cache", "rehearse-pending"}) {
    if (!exists(place)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(folder() / place))
      if (entry.is_regular_file()) files.push_back(entry.path());
  }
  ASSERT_GE(files.size(), 4u);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    fs::remove(file);
    fs::create_directory(file);
    const Outcome checked = rehearse({"check", "p.yaml", "--simulate"}, caches);
    EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
    EXPECT_EQ(rehearse({"check", "p.yaml"}, caches).status, 0);
    EXPECT_TRUE(fs::is_directory(file)) << "it is left alone";
    fs::remove(file);
  }
  for (const fs::path& file : files) {
    fs::remove(file);
    fs::create_directory(file);
  }
  const Outcome checked = rehearse({"check", "p.yaml"}, caches);
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  for (const fs::path& file : files)
    EXPECT_THAT(checked.out + checked.err, HasSubstr(file.filename().string())) << "it is named";
}

}  // namespace
}  // namespace rehearse::test
