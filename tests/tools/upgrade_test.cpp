// Recordings of released versions, in tests/upgrades/VERSION: this version reads and replays them, and the changelog
// names those whose bits have changed.
#include <gmock/gmock.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

const fs::path sources = fixtures.parent_path();

class Upgrade : public Command {
 protected:
  /// The recordings of all versions; at least one for each.
  static std::vector<fs::path> recordings() {
    std::vector<fs::path> found;
    for (const auto& version : fs::directory_iterator(sources / "tests/upgrades")) {
      const std::size_t before = found.size();
      for (const auto& file : fs::directory_iterator(version))
        if (file.path().extension() == ".mcap") found.push_back(file);
      EXPECT_GT(found.size(), before) << version.path();
    }
    return found;
  }
};

TEST_F(Upgrade, ReadsAndReplaysRecordingsOfEarlierVersions) {
  for (const fs::path& recording : recordings()) {
    done({"doctor", recording.string()});
    EXPECT_GT(done({"info", "--json", recording.string()}).json()["ticks"], 0) << recording;
    const nlohmann::json replayed = done({"replay", "--json", recording.string()}).json();
    EXPECT_EQ(replayed["within"], true) << recording << replayed["verdict"];
    EXPECT_EQ(replayed["ticks_different"], 0) << recording;
  }
}

TEST_F(Upgrade, ChangesNoBitsThatTheChangelogDoesNotName) {
  const std::string changelog = read_file(sources / "CHANGELOG.md");
  const std::size_t section = changelog.find("### Goldens");
  const std::string named =
      section == std::string::npos ? "" : changelog.substr(section, changelog.find("\n## ", section) - section);
  for (const fs::path& recording : recordings()) {
    const fs::path golden = sources / "golden" / recording.filename();
    ASSERT_TRUE(fs::exists(golden)) << golden << ": a renamed golden is renamed in tests/upgrades, too";
    const Outcome outcome = rehearse({"diff", "--json", recording.string(), golden.string()});
    const nlohmann::json compared = outcome.json();
    if (compared["equal"] == true) continue;
    EXPECT_THAT(named, HasSubstr(recording.stem().string())) << recording << ": " << compared["verdict"];
  }
}

/// Their worlds were moved by an earlier step: the controllers are judged, and nothing else is blamed for a difference.
TEST_F(Upgrade, JudgesTheControllersOfRecordingsOfAnEarlierStep) {
  std::size_t moved = 0;
  for (const fs::path& recording : recordings()) {
    const std::string golden = recording.stem().string();
    const Outcome outcome =
        rehearse({"check", "--json", golden, "--golden", recording.string()},
                 "cd " + quoted(sources.string()) + " && REHEARSE_PENDING=" + quoted((folder() / "pending").string()));
    const nlohmann::json checked = outcome.json();
    EXPECT_EQ(checked["levels"]["controller"], "equal") << golden;
    if (checked["within"] == true) continue;
    ++moved;
    EXPECT_EQ(outcome.status, 1) << golden;
    EXPECT_EQ(checked["code"], "physics.changed") << golden;
    EXPECT_EQ(checked["levels"]["plant"], "not compared") << golden;
    EXPECT_EQ(checked["levels"]["closed"], "not compared") << golden;
    for (const auto& code : checked["codes"])
      EXPECT_TRUE(code == "physics.changed" || code == "expectations.hold") << golden << ": " << code;
  }
  EXPECT_GE(moved, 2u);
}

TEST_F(Upgrade, BranchesOffRecordingsOfAnEarlierStep) {
  for (const fs::path& recording : recordings()) {
    const Outcome outcome =
        rehearse({"record", "--from-checkpoint", recording.string() + "@0.5s", "-o", "branch.mcap"});
    EXPECT_EQ(outcome.status, 0) << recording << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("repeat their commands bit for bit")) << recording;
  }
}

}  // namespace
}  // namespace rehearse::test
