// Checks of goldens whose world another physics engine or an earlier solver moved: the controllers are judged, and a
// difference of the world is blamed on nothing else.
#include <rehearse/cdr.h>
#include <rehearse/check.h>
#include <rehearse/messages.h>

#include <filesystem>

#include "mutilate.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class OtherPhysics : public RunTest {
 protected:
  static std::string scenario(const std::string& options, const std::string& more = "") {
    return "rehearse: 1\nduration: 0.06\ncameras: none\n" + more + "bodies:\n  - name: Rig\n    model: rig.urdf\n" +
           "    controllers: [" + behaviour("C", options) + "]\n";
  }

  /// From tick 30 on, the golden's state isn't that of the present world.
  static std::optional<std::vector<std::byte>> moved(const mcap::Message& message) {
    if (message.channel->topic != "/Rig/joints" || message.log_time < 30'000'000) return testing::untouched(message);
    msg::JointState state;
    CdrReader reader(message.data);
    EXPECT_TRUE(msg::decode(reader, state));
    for (double& angle : state.position) angle += 0.01;
    CdrWriter writer;
    msg::encode(state, writer);
    return std::vector<std::byte>(writer.bytes().begin(), writer.bytes().end());
  }

  /// Empty: the golden states the present engine.
  void make_golden(const std::string& engine, const testing::Mutilation& change = moved) {
    record_run(scenario("step 0.1 20"), "golden.mcap");
    const mcap::StringMap facts = engine.empty() ? mcap::StringMap() : mcap::StringMap{{"physics", engine}};
    const auto done = testing::mutilate(path("golden.mcap"), change, {}, facts);
    ASSERT_TRUE(done) << to_string(done.errors());
  }

  CheckReport checked(const std::string& text, const CheckOptions& options = {}) {
    auto report = check_scenario(load(text), path("golden.mcap"), path("actual.mcap"), options, {record, run_plant});
    EXPECT_TRUE(report) << to_string(report.errors());
    return report ? *std::move(report) : CheckReport();
  }
};

TEST_F(OtherPhysics, IsTheOnlyCauseOfAnotherWorld) {
  make_golden("ODE 0.15");
  CheckOptions closed;
  closed.controller = closed.plant = false;
  for (const CheckOptions& levels : {CheckOptions(), closed}) {
    const CheckReport report = checked(scenario("step 0.1 20"), levels);
    EXPECT_FALSE(report.within());
    EXPECT_THAT(report.verdict.codes(), ElementsAre(VerdictCode::physics_changed));
    EXPECT_THAT(
        report.verdict.text(),
        ::testing::MatchesRegex("physics changed: the golden's world was moved by ODE 0.15, and this one by ODE "
                                ".*, so the worlds are not compared; the controller repeats 60 recorded ticks "
                                "bit for bit"));
    EXPECT_EQ(report.controller, LevelState::equal);
    EXPECT_EQ(report.plant, LevelState::not_compared);
    EXPECT_EQ(report.closed, LevelState::not_compared);
    EXPECT_EQ(tables_text(report), "");
    EXPECT_TRUE(std::filesystem::exists(path("actual.mcap"))) << "the run can be accepted";
  }
}

TEST_F(OtherPhysics, HidesNoChangeOfTheController) {
  make_golden("ODE 0.15");
  const CheckReport report = checked(scenario("step 0.2 20"));
  EXPECT_EQ(report.controller, LevelState::differs);
  EXPECT_THAT(report.verdict.codes(), ElementsAre(VerdictCode::controller_changed, VerdictCode::physics_changed));
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->tick, 20);
}

TEST_F(OtherPhysics, NamesChangedKeysThatItCannotJudge) {
  make_golden("ODE 0.15");
  const CheckReport report = checked(scenario("step 0.1 20", "gravity: [0, 0, -9.0]\n"));
  EXPECT_THAT(report.verdict.codes(), ElementsAre(VerdictCode::physics_changed));
  EXPECT_THAT(report.verdict.text(), HasSubstr("; changed since the golden was recorded, too: scenario.yaml:4"));
}

TEST_F(OtherPhysics, IsJudgedByItsExpectations) {
  make_golden("ODE 0.15");
  const std::string holds = "expect: [{always: \"abs(Rig/SHOULDER/q) < 3\"}]\n";
  const std::string violated = "expect: [{always: \"abs(Rig/SHOULDER/q) > 3\"}]\n";
  EXPECT_THAT(checked(scenario("step 0.1 20", holds)).verdict.codes(),
              ElementsAre(VerdictCode::physics_changed, VerdictCode::expectations_hold));
  EXPECT_THAT(checked(scenario("step 0.1 20", violated)).verdict.codes(),
              ElementsAre(VerdictCode::expectations_violated, VerdictCode::physics_changed));
}

TEST_F(OtherPhysics, IsNotMentionedIfTheWorldAgrees) {
  make_golden("ODE 0.15", testing::untouched);
  const CheckReport report = checked(scenario("step 0.1 20"));
  EXPECT_TRUE(report.equal()) << report.verdict.text();
  EXPECT_THAT(report.verdict.codes(), ElementsAre(VerdictCode::same));
}

TEST_F(OtherPhysics, IsNoneIfTheGoldenStatesThePresentEngine) {
  make_golden("");
  const CheckReport report = checked(scenario("step 0.1 20"));
  EXPECT_EQ(report.plant, LevelState::differs);
  EXPECT_THAT(report.verdict.codes(), ElementsAre(VerdictCode::physics_changed));
  EXPECT_THAT(report.verdict.text(), Not(HasSubstr("was moved by")));
}

}  // namespace
}  // namespace rehearse
