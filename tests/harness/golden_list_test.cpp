#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <rehearse/golden.h>
#include <fstream>

#include "golden_folder.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::SmallTrace;
using ::testing::StartsWith;
using testing::write;
namespace fs = std::filesystem;

class GoldenList : public testing::GoldenFolder {
 protected:
  GoldenEntry entry(const mcap::StringMap& present = {}) const {
    const auto listed = list_goldens(store_, {folder_.path()}, present);
    EXPECT_TRUE(listed);
    EXPECT_EQ(listed->size(), 1u);
    return listed->at(0);
  }
};

TEST_F(GoldenList, KnowsOwnersOrphansAndWhatWaits) {
  name_ = "Walker.Walks";
  place_golden(SmallTrace());
  name_ = "Walker.Stops";
  place_golden(SmallTrace());
  name_ = "Walker.Forgotten";
  place_golden(SmallTrace());
  write(folder_ / "golden/Walker.Lost.txt", "digest");
  fs::create_directories(folder_ / "pending");
  write(store_.pending_file("Walker.Stops"), "waits");
  write(folder_ / "walk.yaml", "rehearse: 1\ngolden: Walker.Walks   # the golden\n");
  write(folder_ / "stop_test.cpp", "TEST(Walker, Forgotten) { EXPECT_MATCHES_GOLDEN(trace); }\n");  // never ran
  report_golden_owner(store_, "Walker.Stops", "All/Walker.Stops/0");
  report_golden_owner(store_, "Walker.Stops", "All/Walker.Stops/0");

  const auto listed = list_goldens(store_, {folder_.path()});
  ASSERT_TRUE(listed);
  ASSERT_EQ(listed->size(), 4u);
  const GoldenEntry &forgotten = (*listed)[0], &lost = (*listed)[1], &stops = (*listed)[2], &walks = (*listed)[3];
  EXPECT_EQ(forgotten.name, "Walker.Forgotten");
  EXPECT_TRUE(forgotten.orphan());
  EXPECT_EQ(forgotten.problem, "");
  EXPECT_EQ(forgotten.recorded_by, "rehearse 0.1.0");
  EXPECT_EQ(lost.problem, "there is a digest, but no recording");
  EXPECT_THAT(stops.owners, ElementsAre(StartsWith("All/Walker.Stops/0 of ")));
  EXPECT_TRUE(stops.pending);
  EXPECT_THAT(walks.owners, ElementsAre((folder_ / "walk.yaml").string()));
  EXPECT_FALSE(walks.pending);
  EXPECT_EQ(walks.bytes, fs::file_size(store_.trace_file("Walker.Walks")));
}

TEST_F(GoldenList, FindsTheNameInEachFormOfAScenario) {
  for (const char* scenario :
       {"golden: Walker.Walks\n", "golden: 'Walker.Walks'   # {name: A.B}\n", "\"golden\": {name: Walker.Walks}\n",
        "golden: {state: 100 Hz, name: \"Walker.Walks\"}\n",
        "golden:   # two lines\n  state: 100 Hz\n  name: Walker.Walks\n"}) {
    name_ = "Walker.Walks";
    place_golden(SmallTrace());
    write(folder_ / "walk.yaml", scenario);
    const auto listed = list_goldens(store_, {folder_.path()});
    ASSERT_TRUE(listed);
    EXPECT_THAT((*listed)[0].owners, ElementsAre((folder_ / "walk.yaml").string())) << scenario;
  }
  write(folder_ / "walk.yaml", "golden: {state: 100 Hz}\nname: Walker.Walks\n");
  EXPECT_TRUE((*list_goldens(store_, {folder_.path()}))[0].orphan());
}

TEST_F(GoldenList, SaysWhenAGoldenWasAcceptedAndHowOften) {
  place_golden(SmallTrace());
  EXPECT_EQ(entry().accepted, "2025-11-20");
  EXPECT_EQ(entry().acceptances, 1);
  setenv("SOURCE_DATE_EPOCH", "1763726400", 1);
  place_golden(changed());
  EXPECT_EQ(entry().accepted, "2025-11-21");
  EXPECT_EQ(entry().acceptances, 2);
}

TEST_F(GoldenList, SaysWhatAGoldenIsOlderThan) {
  SmallTrace run;
  run.provenance["physics"] = "ODE 0.16.2";
  run.provenance["libc"] = "glibc 2.36";
  place_golden(run);
  EXPECT_THAT(
      entry({{"rehearse", "0.1.0"}, {"physics", "ODE 0.17"}, {"libc", "glibc 2.36"}, {"renderer", "Mesa"}}).notes,
      ElementsAre("recorded with ODE 0.16.2; this is ODE 0.17", HasSubstr("no checkpoints")));
  EXPECT_THAT(entry({{"rehearse", "0.2.0"}}).notes,
              ElementsAre("recorded with Rehearse 0.1.0; this is Rehearse 0.2.0", HasSubstr("no checkpoints")));
}

TEST_F(GoldenList, SaysIfTwoScenariosNameOneGolden) {
  place_golden(SmallTrace());
  write(folder_ / "a.yaml", "golden: " + name_ + "\n");
  report_golden_owner(store_, name_, name_);
  EXPECT_EQ(entry().problem, "");  // a test and the scenario that it records
  write(folder_ / "b.yaml", "\"golden\": '" + name_ + "'  # quoted\n");
  EXPECT_EQ(entry().problem,
            "2 scenarios name it: " + (folder_ / "a.yaml").string() + ", " + (folder_ / "b.yaml").string());
}

TEST_F(GoldenList, SaysIfTwoSourcesHaveTheTestOfItsName) {
  place_golden(SmallTrace());
  const std::string suite = name_.substr(0, name_.find('.')), test = name_.substr(suite.size() + 1);
  const std::string macro = "TEST_F(" + suite + ",\n       " + test + ") {}\n";
  write(folder_ / "a_test.cpp", macro);
  write(folder_ / "b_test.cpp", macro);
  const auto note = [&](const std::string& program, const std::string& source) {
    std::ofstream(store_.where_runs_wait() / ".owners" / name_, std::ios::app)
        << name_ << '\t' << program << '\t' << source << '\n';
  };
  report_golden_owner(store_, name_, "EXPECT_REPLAYS");
  report_golden_owner(store_, name_, name_, folder_ / "a_test.cpp");
  report_golden_owner(store_, name_, name_, folder_ / "a_test.cpp");
  EXPECT_THAT(entry().owners, ElementsAre(StartsWith("EXPECT_REPLAYS and " + name_ + " of ")))
      << "each program is named once";
  note("other_build/judging_test", "a_test.cpp");
  note("renamed_test", "a_test.cpp");
  EXPECT_EQ(entry().problem, "") << "one source, in whatever program";
  note("b_test", "b_test.cpp");
  EXPECT_EQ(entry().problem, "2 sources have a test of its name: a_test.cpp, b_test.cpp");
  write(folder_ / "b_test.cpp", "TEST_F(" + suite + "s, " + test + ") {} TEST_F(" + suite + ", " + test + "2) {}\n");
  EXPECT_EQ(entry().problem, "") << "it was renamed";
  write(folder_ / "b_test.cpp", macro);
  note("b_test", "c_test.cpp");
  EXPECT_EQ(entry().problem, "") << "it was moved to a file that is gone";
}

TEST_F(GoldenList, ScenariosOfAnotherProjectBelowAreNotItsOwners) {
  place_golden(SmallTrace());
  fs::create_directories(folder_ / "other/golden");
  write(folder_ / "other/b.yaml", "golden: " + name_ + "\n");
  EXPECT_TRUE(entry().orphan());
  write(folder_ / "a.yaml", "golden: " + name_ + "\n");
  EXPECT_THAT(entry().owners, ElementsAre((folder_ / "a.yaml").string()));
  EXPECT_EQ(entry().problem, "");
}

TEST_F(GoldenList, SaysOfADamagedGoldenWhatIsWrongAndNoMore) {
  place_golden(SmallTrace());
  fs::resize_file(store_.trace_file(name_), 3000);
  EXPECT_THAT(entry().problem, HasSubstr("truncated at byte 3000"));
  EXPECT_THAT(entry().notes, IsEmpty());
}

TEST_F(GoldenList, PendingRunsAreThoseThatAreNamedLikeGoldens) {
  EXPECT_THAT(store_.pending(), IsEmpty());
  place_pending(SmallTrace());
  write(folder_ / "pending/sr1_minimum.mcap", "of a scenario that was checked against a trace");
  write(store_.pending_file(name_).string() + ".candidate", "");
  EXPECT_THAT(store_.pending(), ElementsAre(name_));
}

}  // namespace
}  // namespace rehearse
