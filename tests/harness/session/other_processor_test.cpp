// Checks of goldens that a processor of another architecture recorded: compared within tolerance, and a difference is
// blamed on no part that the processor explains as well.
#include <rehearse/check.h>

#include "mutilate.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class OtherProcessor : public RunTest {
 protected:
  static std::string scenario(const std::string& options) {
    return "rehearse: 1\nduration: 0.06\ncameras: none\ntolerances: [{channel: \"*\", atol: 1.0e-3}]\n"
           "bodies:\n  - name: Rig\n    model: rig.urdf\n    controllers: [" +
           behaviour("C", options) + "]\n";
  }

  /// The golden states this architecture; empty: none, as recordings of x86-64.
  void make_golden(const std::string& architecture) {
    record_run(scenario("step 0.1 20"), "golden.mcap");
    if (architecture.empty()) return;
    const auto done = testing::mutilate(path("golden.mcap"), testing::untouched, {}, {{"architecture", architecture}});
    ASSERT_TRUE(done) << to_string(done.errors());
  }

  /// The check of the controller with these options.
  CheckReport checked(const std::string& options) {
    auto report =
        check_scenario(load(scenario(options)), path("golden.mcap"), path("actual.mcap"), {}, {record, run_plant});
    EXPECT_TRUE(report) << to_string(report.errors());
    return report ? *std::move(report) : CheckReport();
  }
};

TEST_F(OtherProcessor, IsNamedWhereOnlyTolerancesWereDemanded) {
  make_golden("arm64");
  const CheckReport report = checked("step 0.1000001 20");
  EXPECT_TRUE(report.within()) << report.verdict.text();
  EXPECT_EQ(report.controller, LevelState::within);
  EXPECT_THAT(report.verdict.codes(), ElementsAre(VerdictCode::within_tolerance));
  EXPECT_THAT(report.verdict.text(), HasSubstr("within tolerance: "));
  EXPECT_THAT(report.verdict.text(),
              HasSubstr("; the golden is of arm64 and this run of x86-64, so only tolerances were demanded"));
  EXPECT_THAT(report.comparison->remarks, ::testing::Contains(HasSubstr("the processor architecture was \"arm64\" and "
                                                                        "is \"x86-64\"")));
}

TEST_F(OtherProcessor, ExplainsADifferenceAsWellAsAChangeDoes) {
  make_golden("arm64");
  const CheckReport report = checked("step 0.2 20");
  EXPECT_FALSE(report.within());
  EXPECT_THAT(report.verdict.codes(), ElementsAre(VerdictCode::processor_other));
  EXPECT_THAT(report.verdict.text(),
              HasSubstr("the golden is of arm64 and this run of x86-64, which rounds differently: that "
                        "explains the difference as well as a change does; fed with the golden's "
                        "inputs, SHOULDER/u"));
  EXPECT_THAT(report.verdict.text(), HasSubstr("from tick 20 (0.02 s) on"));
  EXPECT_THAT(report.verdict.text(), Not(HasSubstr("controller changed")));
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->tick, 20);
}

TEST_F(OtherProcessor, IsNoneWhereTheGoldenStatesNone) {
  make_golden("");
  const CheckReport within = checked("step 0.1000001 20"), beyond = checked("step 0.2 20");
  EXPECT_EQ(within.controller, LevelState::differs) << "equal bits are demanded of one architecture";
  EXPECT_THAT(beyond.verdict.codes(), ElementsAre(VerdictCode::controller_changed));
  EXPECT_THAT(beyond.verdict.text(), HasSubstr("the controller changed"));
}

TEST_F(OtherProcessor, IsNotMentionedIfAllBitsAreEqual) {
  make_golden("arm64");
  const CheckReport report = checked("step 0.1 20");
  EXPECT_TRUE(report.equal()) << report.verdict.text();
  EXPECT_THAT(report.verdict.codes(), ElementsAre(VerdictCode::same));
  EXPECT_THAT(report.verdict.text(), Not(HasSubstr("arm64")));
}

TEST_F(OtherProcessor, IsTheReasonWhereItRecordsNoCosts) {
  make_golden("arm64");
  const auto counted = load("realtime: counts\n" + scenario("step 0.1 20"));
  const auto report = check_scenario(counted, path("golden.mcap"), path("actual.mcap"), {}, {record, run_plant});
  ASSERT_TRUE(report) << to_string(report.errors());
  EXPECT_TRUE(report->equal()) << report->verdict.text();
  EXPECT_THAT(report->verdict.codes(), ElementsAre(VerdictCode::same));
  EXPECT_THAT(
      report->comparison->remarks,
      ::testing::Contains("the golden is of arm64, a processor on which the costs of control() aren't recorded: "
                          "/Rig/C/cost is not compared"));
  record_run("realtime: counts\n" + scenario("step 0.1 20"), "counted.mcap");
  const auto compared = compare(path("counted.mcap"), path("golden.mcap"), {});
  ASSERT_TRUE(compared) << to_string(compared.errors());
  EXPECT_TRUE(compared->within) << verdict(*compared);
  EXPECT_THAT(compared->remarks,
              ::testing::Contains("the run is of arm64, a processor on which the costs of control() aren't recorded: "
                                  "/Rig/C/cost is not compared"));
}

TEST_F(OtherProcessor, ExplainsNoCrash) {
  make_golden("arm64");
  const CheckReport report = checked("fail throw control 7");
  EXPECT_TRUE(report.failed());
  EXPECT_THAT(report.verdict.codes(), ::testing::Contains(VerdictCode::controller_changed));
  EXPECT_THAT(report.verdict.text(), Not(HasSubstr("rounds differently")));
}

}  // namespace
}  // namespace rehearse
