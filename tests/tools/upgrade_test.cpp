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

}  // namespace
}  // namespace rehearse::test
