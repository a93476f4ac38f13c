// Parts that are missing in one of two traces: one finding, with its place.
#include "compare_fixture.h"

namespace rehearse {
namespace {

using testing::Compare;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::nan_value;
using testing::SmallTick;
using testing::SmallTrace;

TEST_F(Compare, CallsAMissingTickAFindingWithItsPlace) {
  actual_.ticks.erase(actual_.ticks.begin() + 1);
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->tick, 1);
  EXPECT_THAT(comparison.first->note, HasSubstr("missing"));
}

TEST_F(Compare, CallsAnExtraTickAFindingWithItsPlace) {
  golden_.ticks.erase(golden_.ticks.begin() + 1);
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->tick, 1);
  EXPECT_THAT(comparison.first->note, HasSubstr("not in the golden"));
}

TEST_F(Compare, SaysOnceThatARunEndedEarlyAndWhy) {
  actual_.ticks.pop_back();
  actual_.outcome["failure"] = "controller 'Robot/Pd' threw in control() at tick 1";
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 1u);
  EXPECT_EQ(comparison.first->tick, 1);
  EXPECT_EQ(comparison.first->stage, Stage::controller);
  EXPECT_THAT(comparison.first->note, HasSubstr("threw in control()"));
  EXPECT_THAT(comparison.first->note, HasSubstr("goes on to tick 2"));
}

TEST_F(Compare, PutsADifferenceBeforeTheEarlyEndThatFollowsFromIt) {
  actual_.ticks.pop_back();
  actual_.ticks[0].u = 1e9;
  EXPECT_EQ(compared().first->element, "KNEE/u");
}

TEST_F(Compare, CallsAMissingChannelAFinding) {
  actual_.left_out = {"/Robot/Foot/wrench"};
  const Comparison comparison = compared();
  EXPECT_EQ(comparison.first->channel, "/Robot/Foot/wrench");
  EXPECT_EQ(comparison.first->stage, Stage::sensors);
  EXPECT_EQ(comparison.first->note, "the channel is missing");
}

TEST_F(Compare, CallsAnExtraChannelAFinding) {
  golden_.left_out = {"/Robot/Foot/wrench"};
  EXPECT_THAT(compared().first->note, HasSubstr("not in the golden"));
}

TEST_F(Compare, CallsAJointOfAnotherNameMissingAndExtra) {
  actual_.joint_names[0] = "ELBOW";
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->element, "KNEE/q");
  EXPECT_EQ(comparison.first->note, "is missing");
}

/// A controller may read more or less and command the same.
TEST_F(Compare, RemarksThatAControllerReadsOtherJoints) {
  actual_.joints_read = {"WHEEL", "KNEE"};
  const Comparison more = compared();
  EXPECT_TRUE(more.equal) << verdict(more);
  EXPECT_THAT(more.other_inputs, ElementsAre("+ WHEEL/q of Robot/Pd"));
  EXPECT_EQ(table(more), "  note: the controller reads other inputs: + WHEEL/q of Robot/Pd\n");
  std::swap(golden_, actual_);
  EXPECT_TRUE(compared().equal);
  EXPECT_THAT(compared().other_inputs, ElementsAre("- WHEEL/q of Robot/Pd"));
  for (SmallTick& tick : actual_.ticks) tick.input_q = 0.6;
  EXPECT_EQ(compared().first->element, "KNEE/q") << "both runs have this joint";
}

TEST_F(Compare, RemarksThatAControllerReadsAnotherQuantityOfAJoint) {
  for (SmallTrace* trace : {&golden_, &actual_}) trace->joints_read = {"KNEE", "WHEEL"};
  for (SmallTick& tick : actual_.ticks) tick.input_dq = {nan_value, 2.0};
  EXPECT_TRUE(compared().equal) << verdict(compared());
  EXPECT_THAT(compared().other_inputs, ElementsAre("+ WHEEL/dq of Robot/Pd")) << "the knee's isn't read";
  for (SmallTick& tick : golden_.ticks) tick.input_dq = {1.0, 2.0};
  EXPECT_TRUE(compared().equal) << verdict(compared());
  EXPECT_THAT(compared().other_inputs, ElementsAre("- KNEE/dq of Robot/Pd"));
}

TEST_F(Compare, CallsAnInputThatIsNoNumberInOneTickADifference) {
  for (SmallTrace* trace : {&golden_, &actual_})
    for (SmallTick& tick : trace->ticks) tick.input_dq = {1.0};
  actual_.ticks[1].input_dq = {nan_value};
  EXPECT_EQ(compared().first->tick, 1);
  EXPECT_EQ(compared().first->element, "KNEE/dq");
  EXPECT_THAT(compared().other_inputs, ElementsAre());
}

TEST_F(Compare, MatchesJointsByNameNotByOrder) {
  std::swap(actual_.joint_names[0], actual_.joint_names[1]);
  for (auto& tick : actual_.ticks) std::swap(tick.q, tick.wheel);
  EXPECT_TRUE(compared().within) << verdict(compared());
  EXPECT_FALSE(compared().equal) << "the bytes aren't the same";
}

TEST_F(Compare, TellsBetweenWhichTicksOneIsMissingAndNothingElseOfIt) {
  lengthen(6);
  actual_.ticks.erase(actual_.ticks.begin() + 3);
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 1u);
  EXPECT_EQ(comparison.first->channel, "/tick");
  EXPECT_EQ(comparison.first->tick, 3);
  EXPECT_EQ(comparison.first->note, "this tick is missing (after tick 2, before tick 4)");
  EXPECT_EQ(comparison.first->stage, Stage::physics);
  EXPECT_EQ(comparison.ticks, 3) << "the outcome tells of three";
}

TEST_F(Compare, TellsOfARowOfMissingTicksOnceAndOfTheOthersByNumber) {
  lengthen(10);
  actual_.ticks.erase(actual_.ticks.begin() + 8);
  actual_.ticks.erase(actual_.ticks.begin() + 2, actual_.ticks.begin() + 5);
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 1u);
  EXPECT_EQ(comparison.channels[0].missing, 4);
  EXPECT_EQ(comparison.first->note,
            "ticks 2 to 4 are missing (after tick 1, before tick 5); with later ticks 4 in all");
}

TEST_F(Compare, NamesATickByItsNumberWhereBothHaveAGap) {
  lengthen(10);
  for (SmallTrace* trace : {&golden_, &actual_}) trace->ticks.erase(trace->ticks.begin() + 3);
  actual_.ticks[6].u = 99.0;
  EXPECT_EQ(compared().first->tick, 7);
}

TEST_F(Compare, NamesATickByItsNumberWhereBothBeginLater) {
  lengthen(10);
  for (SmallTrace* trace : {&golden_, &actual_}) trace->ticks.erase(trace->ticks.begin());
  actual_.ticks[6].u = 99.0;
  EXPECT_EQ(compared().first->tick, 7);
}

TEST_F(Compare, TellsThatTheFirstTickIsMissing) {
  actual_.ticks.erase(actual_.ticks.begin());
  EXPECT_EQ(compared().first->note, "this tick is missing (the first, before tick 1)");
}

TEST_F(Compare, ComparesNothingByTickWhereTheTimeStepIsAnotherOne) {
  golden_.provenance["time_step"] = "0.001";
  actual_.provenance["time_step"] = "0.002";
  for (std::size_t i = 0; i < actual_.ticks.size(); ++i) actual_.ticks[i].tick = 2 * static_cast<std::int64_t>(i);
  const Comparison comparison = compared();
  EXPECT_THAT(comparison.first->note, HasSubstr("the run's time step is 0.002 s, expected 0.001 s"));
  EXPECT_EQ(comparison.beyond, 0);
}

TEST_F(Compare, CallsAMissingControllerOneFinding) {
  golden_.has_helper = true;
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 2u);  // and its result in /tick
  EXPECT_EQ(comparison.first->note, "controller 'Robot/Helper' is missing (its 2 channels)");
  EXPECT_EQ(comparison.channels[0].channels, 2);
  EXPECT_THAT(table(comparison), HasSubstr("/Robot/Helper/... (2)"));
}

TEST_F(Compare, CallsAnExtraControllerOneFinding) {
  actual_.has_helper = true;
  EXPECT_EQ(compared().first->note, "controller 'Robot/Helper' is not in the golden (its 2 channels)");
}

TEST_F(Compare, CallsAMissingDeviceOneFinding) {
  actual_.left_out = {"/Robot/Eye/image", "/Robot/Eye/depth"};
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 1u);
  EXPECT_EQ(comparison.first->note, "device 'Robot/Eye' is missing (its 2 channels)");
  EXPECT_EQ(comparison.first->stage, Stage::renderer);
}

TEST_F(Compare, CallsAMissingBodyOneFinding) {
  actual_.left_out = {"/Robot/joints",    "/Robot/BASE/pose", "/Robot/Foot/wrench",     "/Robot/Laser/scan",
                      "/Robot/Eye/image", "/Robot/Eye/depth", "/Robot/Pd/input/joints", "/Robot/Pd/output/joints"};
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 1u);
  EXPECT_EQ(comparison.first->note, "body 'Robot' is missing (its 8 channels)");
}

TEST_F(Compare, CountsTheElementsThatAreMissingInOneFinding) {
  actual_.joint_names = {"ELBOW", "WRIST"};
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 1u);
  EXPECT_EQ(comparison.first->element, "KNEE/q");
  EXPECT_EQ(comparison.first->note, "is missing; 2 elements in all, WHEEL/q");
}

TEST_F(Compare, CallsAMessageThatIsMissingInATickThatIsThereAFinding) {
  for (SmallTrace* trace : {&golden_, &actual_})
    for (SmallTick& tick : trace->ticks) tick.contacts.emplace();
  actual_.ticks[1].contacts.reset();
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 1u);
  EXPECT_EQ(comparison.first->channel, "/Robot/Pd/input/FOOT/contacts");
  EXPECT_EQ(comparison.first->tick, 1);
  EXPECT_EQ(comparison.first->note, "this message is missing");
}

TEST_F(Compare, SaysNothingOfTheLastStateWhereTheOtherRunGoesOn) {
  lengthen(6);
  actual_.ticks.resize(4);
  actual_.left_out = {};
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.channels.size(), 1u);
  EXPECT_EQ(comparison.first->note, "the run ends here, the golden goes on to tick 5");
}

}  // namespace
}  // namespace rehearse
