// The command in a folder that can't be written to: each error names the remedy.
#include <gmock/gmock.h>
#include <unistd.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;

class ReadOnly : public Command {
 protected:
  /// Runs the command as a user who may read the test's folder; root may write everywhere.
  Outcome as_reader(const std::vector<std::string>& arguments) const {
    const auto all = fs::perms::owner_read | fs::perms::owner_exec | fs::perms::group_read | fs::perms::group_exec |
                     fs::perms::others_read | fs::perms::others_exec;
    fs::permissions(folder(), all);
    const std::string other = geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups" : "";
    const Outcome outcome = run(command, arguments, "REHEARSE_CALL_STACK=never HOME=/nonexistent " + other);
    fs::permissions(folder(), all | fs::perms::owner_write);
    return outcome;
  }
  void expect_remedy(const std::vector<std::string>& arguments, const std::string& remedy) const {
    const Outcome outcome = as_reader(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, ContainsRegex(remedy));
  }
};

TEST_F(ReadOnly, EachVerbThatWritesAFileNamesTheRemedy) {
  done({"record", box_scenario.string(), "-o", "run.mcap", "--duration", "0.1"});
  const std::string here = "\\(make the folder (\\.|/.*) writable, or name another ";  // the place may be absolute
  expect_remedy({"record", box_scenario.string()}, here + "file with -o\\)");
  expect_remedy({"record", box_scenario.string(), "-o", "nowhere/run.mcap"}, here + "file with -o\\)");
  expect_remedy({"render", box_scenario.string(), "-o", "box.png"}, here + "file with -o\\)");
  expect_remedy({"export", "run.mcap", "-o", "tables"}, here + "folder with -o\\)");
  expect_remedy({"filter", "run.mcap", "-o", "part.mcap"}, here + "file with -o\\)");
  expect_remedy({"report", "run.mcap", "-o", "run.html"}, here + "file with -o\\)");
  expect_remedy({"new", "mine"}, here + "folder\\)");
  expect_remedy({"check", box_scenario.string(), "--golden", "run.mcap"}, here + "folder with REHEARSE_PENDING\\)");
}

TEST_F(ReadOnly, AGoldenNamesTheRemedy) {
  write("box.yaml", read_file(box_scenario) + "golden: Box.Falls\n");
  fs::create_directory(folder() / "golden");
  fs::create_directory(folder() / "build");
  write("CMakeLists.txt", "");
  EXPECT_EQ(rehearse({"check", "box.yaml"}).status, 1);
  expect_remedy({"golden", "accept", "--all"},
                "\\(make the folder golden writable, or name another folder with REHEARSE_GOLDEN_DIR\\)");
}

TEST_F(ReadOnly, AFolderThatIsMissingIsNamed) {
  EXPECT_THAT(rehearse({"record", box_scenario.string(), "-o", "nowhere/run.mcap"}).err,
              ContainsRegex("\\(make the folder .*nowhere first, or name another file with -o\\)"));
}

}  // namespace
}  // namespace rehearse::test
