// rehearse golden prune with test programs: a golden belongs to its test, however the test's name was made.
#include <gmock/gmock.h>

#include <sstream>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

const std::vector<std::string> owned{"All-Fall.Ends-0", "Macro.Falls", "Typed-0.Falls"};

/// A repository with a box that falls, three tests of it and their goldens.
class GoldenOwners : public Command {
 protected:
  GoldenOwners() {
    fs::create_directories(folder() / "golden");
    write("fall.yaml",
          "rehearse: 1\nname: fall\nduration: 0.01\nbodies:\n  - name: Box\n    box: {size: [0.2, 0.2, 0.2]}\n"
          "    mass: 1\n    position: [0, 0, 0.5]\n");
    const Outcome made = run(OWNING_TESTS, {}, "REHEARSE_GOLDEN=new REHEARSE_PENDING=rehearse-pending " + folders());
    EXPECT_EQ(made.status, 0) << made.out;
    for (const std::string& name : owned) EXPECT_TRUE(exists("golden/" + name + ".mcap")) << name;
    for (const char* ending : {".mcap", ".txt"})
      fs::copy_file(folder() / ("golden/Macro.Falls" + std::string(ending)),
                    folder() / ("golden/Old.Falls" + std::string(ending)));
  }
  static std::string folders() { return "REHEARSE_FIXTURES=. REHEARSE_GOLDEN_DIR=golden"; }
  void make_repository() const {
    const std::string identity = "git -c user.name=t -c user.email=t@t ";
    const Outcome made =
        run("/bin/sh", {"-c", "git init -q . && git add golden && " + identity + "commit -qm goldens"});
    EXPECT_EQ(made.status, 0) << made.err;
  }
};

TEST_F(GoldenOwners, ListKnowsTheTestsThatRan) {
  const nlohmann::json goldens = done({"golden", "list", "--json"}).json()["goldens"];
  ASSERT_EQ(goldens.size(), 4u);
  EXPECT_THAT(goldens[0]["owners"][0].get<std::string>(), HasSubstr("All-Fall.Ends-0 of "));
  EXPECT_EQ(goldens[2]["name"], "Old.Falls");
  EXPECT_TRUE(goldens[2]["orphan"]);
}

/// REHEARSE_HISTORY: a line for each comparison, with the code that a check of all levels would have.
TEST_F(GoldenOwners, TestsAppendToAHistory) {
  const auto tested = [this](const std::string& date) {
    return run(OWNING_TESTS, {"--gtest_filter=Macro.Falls"},
               "REHEARSE_HISTORY=history.jsonl REHEARSE_HISTORY_COMMIT=v1 REHEARSE_HISTORY_DATE=" + date +
                   " REHEARSE_PENDING=rehearse-pending " + folders());
  };
  EXPECT_EQ(tested("2026-11-27").status, 0);
  std::string text = read_file(folder() / "fall.yaml");
  write("fall.yaml", text.replace(text.find("0, 0, 0.5"), 9, "0, 0, 0.6"));
  EXPECT_EQ(tested("2026-11-28").status, 1);
  std::istringstream stream(read_file(folder() / "history.jsonl"));
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["scenario"], "Macro.Falls");
  EXPECT_EQ(lines[0]["code"], "same");
  EXPECT_EQ(lines[0]["commit"], "v1");
  EXPECT_EQ(lines[0]["date"], "2026-11-27");
  EXPECT_EQ(lines[1]["code"], "scenario.changed");
  EXPECT_EQ(lines[1]["first"]["tick"], 0);
  const Outcome refused = tested("now");
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.out, HasSubstr("the date of a history is 'now'"));
}

TEST_F(GoldenOwners, ATestOfTheSameNameInAnotherProgramIsRefused) {
  const std::string environment = "REHEARSE_PENDING=rehearse-pending " + folders();
  const auto run_both = [&](const std::string& mode) {
    const Outcome second = run(SECOND_OWNER, {}, mode + environment);
    const Outcome first = run(OWNING_TESTS, {"--gtest_filter=Macro.Falls"}, mode + environment);
    EXPECT_EQ(second.status, first.status);
    return second.status == 0 ? "" : second.out + first.out;
  };
  fs::create_directories(folder() / "tests/tools");
  for (const char* source : {"owning_tests.cpp", "second_owner.cpp"})
    write("tests/tools/" + std::string(source), "TEST(Macro, Falls) {}\n");
  const std::string golden = read_file(folder() / "golden/Macro.Falls.mcap");
  const std::string sources =
      "2 sources have a test of its name: tests/tools/owning_tests.cpp, "
      "tests/tools/second_owner.cpp";
  for (const char* mode : {"", "REHEARSE_GOLDEN=accept "})
    EXPECT_THAT(run_both(mode), HasSubstr("error: the golden 'Macro.Falls' isn't this test's alone: " + sources +
                                          " (give each test a name of its own)"));
  EXPECT_TRUE(read_file(folder() / "golden/Macro.Falls.mcap") == golden);
  EXPECT_THAT(done({"golden", "list"}).out, HasSubstr(sources));
  write("tests/tools/second_owner.cpp", "TEST(Macro, FallsElsewhere) {}\n");
  EXPECT_EQ(run_both(""), "") << "the second was renamed, though not built yet";
}

TEST_F(GoldenOwners, CheckStrictFailsForAGoldenWithoutOwnerAndForOneThatCantBeUsed) {
  write("run.yaml", read_file(folder() / "fall.yaml") + "golden: Runs.Equal\n");
  EXPECT_EQ(rehearse({"check", "run.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  EXPECT_EQ(rehearse({"check", "run.yaml"}).status, 0) << "only --strict looks at the other goldens";
  const Outcome orphan = rehearse({"check", "--strict", "run.yaml"});
  EXPECT_EQ(orphan.status, 1);
  EXPECT_THAT(orphan.err, HasSubstr("golden/Old.Falls.mcap: error: no test that ran here and no scenario names this "
                                    "golden (rehearse golden prune removes it; --strict comes after the tests)\n"));
  EXPECT_THAT(orphan.err, ::testing::Not(HasSubstr("Macro.Falls")));
  for (const char* ending : {".mcap", ".txt"}) fs::remove(folder() / ("golden/Old.Falls" + std::string(ending)));
  const Outcome whole = rehearse({"check", "--strict", "run.yaml"});
  EXPECT_EQ(whole.status, 0) << whole.err;
  fs::remove(folder() / "golden/Macro.Falls.txt");
  const Outcome torn = rehearse({"check", "--strict", "run.yaml"});
  EXPECT_EQ(torn.status, 1);
  EXPECT_THAT(torn.err, HasSubstr("golden/Macro.Falls.mcap: error: this golden can't be used"));
}

TEST_F(GoldenOwners, PruneAsksForARunOfTheTests) {
  const Outcome refused = rehearse({"golden", "prune", "--yes"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("only a run of the tests shows the goldens that they name"));
  EXPECT_THAT(refused.err, HasSubstr("--tests PROGRAM"));
  EXPECT_EQ(rehearse({"golden", "prune", "--yes", "--tests", "/bin/true"}).status, 2);
  EXPECT_EQ(rehearse({"golden", "prune", "--yes", "--tests", "no-such-program"}).status, 2);
  EXPECT_TRUE(exists("golden/Old.Falls.mcap"));
}

TEST_F(GoldenOwners, PruneRemovesNothingIfATestProgramDoesNotRunToItsEnd) {
  const fs::path program =
      write("ends", "#!/bin/sh\ntest \"$1\" = --gtest_list_tests && exec '" OWNING_TESTS "' \"$1\"\nkill -SEGV $$\n");
  fs::permissions(program, fs::perms::owner_all);
  const Outcome refused = rehearse({"golden", "prune", "--yes", "--tests", program.string()}, folders());
  EXPECT_EQ(refused.status, 2) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("before all its tests had run"));
  EXPECT_THAT(refused.err, HasSubstr("the goldens of its tests are unknown"));
  EXPECT_TRUE(exists("golden/Old.Falls.mcap"));
}

TEST_F(GoldenOwners, PruneKeepsGoldensOfTestsWhoseNamesNoSourceHolds) {
  const nlohmann::json done =
      rehearse({"golden", "prune", "--yes", "--json", "--tests", OWNING_TESTS}, folders()).json();
  EXPECT_THAT(done["orphans"].get<std::vector<std::string>>(), UnorderedElementsAre("Old.Falls"));
  for (const std::string& name : owned) EXPECT_TRUE(exists("golden/" + name + ".mcap")) << name;
  EXPECT_FALSE(exists("golden/Old.Falls.mcap"));
}

TEST_F(GoldenOwners, PruneMovesWhatGitDoesNotHave) {
  const nlohmann::json done =
      rehearse({"golden", "prune", "--yes", "--json", "--tests", OWNING_TESTS}, folders()).json();
  EXPECT_EQ(done["moved"][0], "Old.Falls");
  EXPECT_TRUE(done["removed"].empty());
  EXPECT_TRUE(fs::exists(folder() / done["folder"].get<std::string>() / "Old.Falls.mcap"));
  EXPECT_TRUE(fs::exists(folder() / done["folder"].get<std::string>() / "Old.Falls.txt"));
}

TEST_F(GoldenOwners, PruneRemovesWhatGitHas) {
  make_repository();
  const nlohmann::json done =
      rehearse({"golden", "prune", "--yes", "--json", "--tests", OWNING_TESTS}, folders()).json();
  EXPECT_EQ(done["removed"][0], "Old.Falls");
  EXPECT_TRUE(done["moved"].empty());
  EXPECT_EQ(run("/bin/sh", {"-c", "git checkout -q golden"}).status, 0);
  EXPECT_TRUE(exists("golden/Old.Falls.mcap"));
}

}  // namespace
}  // namespace rehearse::test
