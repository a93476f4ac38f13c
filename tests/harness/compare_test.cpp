#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/compare.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "compare_fixture.h"

namespace rehearse {
namespace {

using testing::Compare;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::nan_value;
using testing::SmallTick;
using testing::SmallTrace;
using ::testing::StartsWith;
using testing::TemporaryFolder;

constexpr double infinite = std::numeric_limits<double>::infinity();

TEST_F(Compare, FindsACopyEqual) {
  const Comparison comparison = compared();
  EXPECT_TRUE(comparison.equal);
  EXPECT_TRUE(comparison.within);
  EXPECT_FALSE(comparison.first);
  EXPECT_EQ(comparison.ticks, 3);
  EXPECT_EQ(comparison.pictures, 6);
  EXPECT_TRUE(comparison.channels.empty());
  EXPECT_EQ(table(comparison), "");
  EXPECT_THAT(verdict(comparison), HasSubstr("equal bit for bit: 3 ticks"));
}

TEST_F(Compare, TellsWhereAndByHowMuchACommandDiffers) {
  actual_.ticks[1].u = 12.5;
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.equal);
  EXPECT_FALSE(comparison.within);
  ASSERT_TRUE(comparison.first);
  EXPECT_EQ(comparison.first->tick, 1);
  EXPECT_EQ(comparison.first->time, 0.001);
  EXPECT_EQ(comparison.first->channel, "/Robot/Pd/output/joints");
  EXPECT_EQ(comparison.first->element, "KNEE/u");
  EXPECT_EQ(comparison.first->expected, 12.0);
  EXPECT_EQ(comparison.first->actual, 12.5);
  EXPECT_EQ(comparison.first->difference, 0.5);
  EXPECT_EQ(comparison.first->ulps, std::uint64_t{1} << 48);
  EXPECT_EQ(comparison.first->unit, "N·m");
  EXPECT_EQ(comparison.first->stage, Stage::controller);
  EXPECT_EQ(comparison.beyond, 1);
  EXPECT_EQ(
      verdict(comparison),
      "differs: Robot/Pd/output/KNEE/u is beyond ±0.001 N·m from tick 1 (0.001 s) on, worst 0.5 N·m (500 times) at "
      "tick 1");
}

TEST_F(Compare, BlamesTheStateBeforeTheInputsAndTheInputsBeforeTheCommandsOfATick) {
  actual_.ticks[2].q = actual_.ticks[2].input_q = 0.6;
  actual_.ticks[2].u = 13.0;
  EXPECT_EQ(compared().first->stage, Stage::physics);
  actual_.ticks[2].q = 0.5;
  EXPECT_EQ(compared().first->stage, Stage::inputs);
}

TEST_F(Compare, BlamesACommandOfAnEarlierTickBeforeTheStateThatFollowsFromIt) {
  actual_.ticks[1].u = 13.0;
  actual_.ticks[2].q = 0.6;
  EXPECT_EQ(compared().first->stage, Stage::controller);
  EXPECT_EQ(compared().first->tick, 1);
}

TEST_F(Compare, CallsADifferenceBelowTheUnitsToleranceWithin) {
  actual_.ticks[1].q = std::nextafter(0.5, 1.0);
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.equal);
  EXPECT_TRUE(comparison.within);
  ASSERT_TRUE(comparison.first_bit);
  EXPECT_EQ(comparison.first_bit->ulps, 1u);
  EXPECT_EQ(comparison.differing, 1);
  EXPECT_EQ(comparison.beyond, 0);
  EXPECT_THAT(verdict(comparison), HasSubstr("within tolerance: 1 of"));
  EXPECT_THAT(table(comparison),
              HasSubstr("\n  first: tick 1 (0.001 s): /Robot/joints KNEE/q is 0.5 rad, expected 0.5 rad: "
                        "off by 1.11022e-16 rad (relative 2.22e-16, 1 ULP, "));
}

TEST_F(Compare, ObeysTheRulesOfTheScenario) {
  actual_.ticks[1].force = 653.0;
  ToleranceRule loose = rule("Robot/*/force/*");
  loose.atol = 4.0;
  EXPECT_TRUE(compared({loose}).within);
  loose.atol = 2.0;
  EXPECT_FALSE(compared({loose}).within);
}

TEST_F(Compare, ScalesTheToleranceOfAVectorByItsNorm) {
  actual_.ticks[1].position[1] = 0.05;  // y is 0 in the golden; the vector is 10 m long
  ToleranceRule relative = rule("*/position/*");
  relative.rtol = 0.01;
  EXPECT_TRUE(compared({relative}).within);
  relative.rtol = 0.001;
  EXPECT_FALSE(compared({relative}).within);
}

TEST_F(Compare, TakesThePassingPartOfMaxNotOfTheSum) {
  actual_.ticks[1].force = 650.0 + 10.0;
  ToleranceRule both = rule("*");
  both.atol = 6.0;
  both.rtol = 0.01;  // 6.5 N
  EXPECT_FALSE(compared({both}).within);
}

TEST_F(Compare, NamesTheWorstByTimesItsTolerance) {
  actual_.ticks[0].force = 660.0;  // 1e5 times 1e-4
  actual_.ticks[1].q = 0.51;       // 1e7 times 1e-9
  const Comparison comparison = compared();
  EXPECT_EQ(comparison.first->channel, "/Robot/Foot/wrench");
  EXPECT_EQ(comparison.worst->channel, "/Robot/joints");
}

TEST_F(Compare, TakesNanForNanOfTheSameTickOnly) {
  golden_.ticks[1].u = actual_.ticks[1].u = nan_value;
  EXPECT_TRUE(compared().equal);
  actual_.ticks[2].u = nan_value;
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->tick, 2);
  EXPECT_EQ(comparison.worst->tick, 2);
}

TEST_F(Compare, TakesANanOfOtherBitsForOtherBitsOnly) {
  golden_.ticks[1].u = nan_value;
  actual_.ticks[1].u = -nan_value;
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.equal);
  EXPECT_TRUE(comparison.within);
}

TEST_F(Compare, TellsMinusZeroFromZeroButFailsNothing) {
  golden_.ticks[1].u = 0.0;
  actual_.ticks[1].u = -0.0;
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.equal);
  EXPECT_TRUE(comparison.within);
  EXPECT_EQ(comparison.first_bit->tick, 1);
}

TEST_F(Compare, TakesInfinityForInfinityOfTheSameSignOnly) {
  golden_.ticks[1].u = actual_.ticks[1].u = infinite;
  EXPECT_TRUE(compared().equal);
  actual_.ticks[1].u = -infinite;
  EXPECT_FALSE(compared().within);
}

TEST_F(Compare, TellsTheFirstTickOfAnotherStateByItsHashAndFailsNothing) {
  actual_.ticks[1].state_hash = 2;
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.equal);
  EXPECT_TRUE(comparison.within);
  EXPECT_EQ(comparison.first_bit->tick, 1);
  EXPECT_EQ(comparison.first_bit->element, "state_hash");
  EXPECT_EQ(comparison.first_bit->stage, Stage::physics);
}

TEST_F(Compare, MeasuresOrientationsByTheirAngle) {
  const double angle = 0.02;
  actual_.ticks[1].rotation = {std::sin(angle / 2), 0.0, 0.0, std::cos(angle / 2)};
  const Comparison comparison = compared();
  ASSERT_TRUE(comparison.first);
  EXPECT_NEAR(comparison.first->difference, angle, 1e-15);
  EXPECT_EQ(comparison.first->element, "orientation/x");
  EXPECT_EQ(comparison.first->unit, "rad");
  EXPECT_EQ(comparison.beyond, 1);
}

TEST_F(Compare, TakesAQuaternionForItsNegative) {
  actual_.ticks[1].rotation = {-0.0, -0.0, -0.0, -1.0};
  EXPECT_TRUE(compared().within);
  EXPECT_FALSE(compared().equal);
}

TEST_F(Compare, SeesAnglesFarBelowWhatAnArcCosineCouldSee) {
  actual_.ticks[1].rotation = {5e-9, 0.0, 0.0, 1.0};  // 1e-8 rad; cos of it is 1
  EXPECT_FALSE(compared().within);
}

TEST_F(Compare, WrapsAJointWhoseChannelSaysSo) {
  actual_.ticks[1].wheel = 3.0 - 2.0 * M_PI;
  EXPECT_TRUE(compared().within);
  actual_.ticks[1].wheel = 3.1 - 2.0 * M_PI;
  EXPECT_NEAR(compared().first->difference, 0.1, 1e-12);
}

TEST_F(Compare, DoesNotWrapAJointOfWhichNobodySaysSo) {
  actual_.ticks[1].q = 0.5 + 2.0 * M_PI;
  EXPECT_FALSE(compared().within);
}

TEST_F(Compare, LeavesOutWhatOtherPartsOfTheLoopMake) {
  actual_.ticks[1].u = 12.5;
  actual_.ticks[1].output_hash = 2;
  actual_.ticks[1].result = false;
  actual_.ticks[2].force = 651.0;
  CompareOptions options;
  options.stages = {Stage::physics, Stage::sensors, Stage::renderer};
  const Comparison comparison = compared({}, options);
  ASSERT_TRUE(comparison.first);
  EXPECT_EQ(comparison.first->channel, "/Robot/Foot/wrench");
  EXPECT_EQ(comparison.first_bit->channel, "/Robot/Foot/wrench") << "the hash of the outputs isn't looked at";
  options.stages = {Stage::renderer};
  EXPECT_TRUE(compared({}, options).equal);
  options.stages = {Stage::controller};
  EXPECT_EQ(compared({}, options).first->channel, "/Robot/Pd/output/joints");
}

TEST_F(Compare, LooksAtTheHashOfTheStateWhereverPhysicsIsCompared) {
  actual_.ticks[1].state_hash = 2;
  CompareOptions options;
  options.stages = {Stage::physics};
  EXPECT_EQ(compared({}, options).first_bit->element, "state_hash");
  options.stages = {Stage::sensors};
  EXPECT_TRUE(compared({}, options).equal);
}

TEST_F(Compare, ComparesUpToATimeInclusive) {
  actual_.ticks[2].q = 0.75;
  CompareOptions options;
  options.until = 0.001;
  EXPECT_TRUE(compared({}, options).equal);
  options.until = 0.002;
  EXPECT_EQ(compared({}, options).first->tick, 2);
}

TEST_F(Compare, DoesNotMindAnEndAfterTheTimeItComparesTo) {
  actual_.ticks.pop_back();
  CompareOptions options;
  options.until = 0.0005;
  EXPECT_TRUE(compared({}, options).equal);
  options.until = 0.002;
  EXPECT_FALSE(compared({}, options).within);
}

TEST_F(Compare, TellsInWhichTickALinkHasFewerOrMoreContacts) {
  const auto contact = [](double force) { return msg::Contact{{}, {}, {0, 0, force}, {}, 0.001}; };
  for (SmallTrace* trace : {&golden_, &actual_})
    for (auto& tick : trace->ticks) tick.contacts = {contact(10)};
  golden_.ticks[1].contacts = {contact(5), contact(5)};
  for (const bool fewer : {true, false}) {  // only one of the recordings has the second point
    const Comparison comparison = compared();
    ASSERT_TRUE(comparison.first);
    EXPECT_EQ(comparison.first->tick, 1);
    EXPECT_EQ(comparison.first->channel, "/Robot/Pd/input/FOOT/contacts");
    EXPECT_EQ(comparison.first->element, "contacts/count");
    EXPECT_EQ(comparison.first->expected, fewer ? 2.0 : 1.0);
    EXPECT_EQ(comparison.first->actual, fewer ? 1.0 : 2.0);
    EXPECT_EQ(comparison.first->stage, Stage::inputs);
    std::swap(golden_, actual_);
  }
}

TEST_F(Compare, AllowsTheForceOfAContactTheTolerance) {
  golden_.ticks[1].contacts = actual_.ticks[1].contacts = {msg::Contact{{}, {}, {0, 0, 10}, {}, 0.001}};
  actual_.ticks[1].contacts->front().force.z += 1e-5;
  EXPECT_TRUE(compared().within);
  EXPECT_FALSE(compared().equal);
  actual_.ticks[1].contacts->front().force.z += 1e-3;
  EXPECT_EQ(compared().first->element, "contacts/0/force/z");
}

TEST_F(Compare, CountsThePixelsThatDiffer) {
  actual_.ticks[1].image.pixels[3] = 103;
  const Comparison comparison = compared();
  ASSERT_TRUE(comparison.first);
  EXPECT_EQ(comparison.first->stage, Stage::renderer);
  EXPECT_THAT(comparison.first->note,
              HasSubstr("1 of 8 pixels (12.5 %) differ beyond tolerance, by up to 3 of 255; allowed: 0.05 %"));
}

TEST_F(Compare, AllowsPixelsByDeltaAndByShare) {
  actual_.ticks[1].image.pixels[3] = 103;
  ToleranceRule pixels = rule("Robot/Eye/*");
  pixels.pixel_delta = 3.0;
  EXPECT_TRUE(compared({pixels}).within);
  EXPECT_FALSE(compared({pixels}).equal);
  pixels.pixel_delta = 2.0;
  EXPECT_FALSE(compared({pixels}).within);
  pixels.pixel_share = 0.125;
  EXPECT_TRUE(compared({pixels}).within);
  pixels.pixel_share = 0.124;
  EXPECT_FALSE(compared({pixels}).within);
}

/// Pictures of 64 x 48 pixels; in the second tick those of this run differ.
class ComparePictures : public Compare {
 protected:
  ComparePictures() {
    for (SmallTrace* trace : {&golden_, &actual_})
      for (SmallTick& tick : trace->ticks) tick.image = {64, 48, std::vector<std::uint8_t>(64 * 48 * 3, 100)};
    pixels_.pixel_share = 0.1;
    pixels_.pixel_delta = 2.0;
  }
  void change(int x, int y) { actual_.ticks[1].image.pixels[3 * (y * 64 + x) + 1] = 200; }

  ToleranceRule pixels_ = rule("Robot/Eye/*");
};

TEST_F(ComparePictures, TellAnObjectThatIsGoneFromSpeckle) {
  for (int i = 0; i < 200; ++i) change((7 * i) % 64, (11 * i) % 48);  // everywhere
  EXPECT_TRUE(compared({pixels_}).within);
  for (int y = 20; y < 30; ++y)
    for (int x = 37; x < 47; ++x) change(x, y);
  const Comparison comparison = compared({pixels_});
  EXPECT_FALSE(comparison.within) << "a tenth of the picture may differ, but not so near together";
  EXPECT_THAT(comparison.first->note, HasSubstr("of the 16 x 16 pixels at ("));
  EXPECT_THAT(comparison.first->note, HasSubstr("allowed: 25 %"));
  pixels_.pixel_window = 0.6;
  EXPECT_TRUE(compared({pixels_}).within);
}

TEST_F(ComparePictures, CountTheDensestSquareExactly) {
  for (int y = 20; y < 28; ++y)
    for (int x = 56; x < 64; ++x) change(x, y);  // 64 of the 256 pixels of any square around them
  pixels_.pixel_window = 0.25;
  EXPECT_TRUE(compared({pixels_}).within);
  change(55, 20);
  EXPECT_FALSE(compared({pixels_}).within);
  EXPECT_THAT(compared({pixels_}).first->note, HasSubstr("25.4 % of the 16 x 16 pixels at (48, 12)"));
}

TEST_F(ComparePictures, LookAtTheWholeOfAPictureSmallerThanASquare) {
  for (SmallTrace* trace : {&golden_, &actual_})
    for (SmallTick& tick : trace->ticks) tick.image = {4, 2, std::vector<std::uint8_t>(24, 100)};
  actual_.ticks[1].image.pixels[3] = 200;
  pixels_.pixel_share = 1.0;
  pixels_.pixel_window = 0.125;
  EXPECT_TRUE(compared({pixels_}).within);
  pixels_.pixel_window = 0.124;
  EXPECT_FALSE(compared({pixels_}).within);
}

TEST_F(Compare, SaysThatAPictureHasAnotherSize) {
  actual_.ticks[1].image = {2, 4, std::vector<std::uint8_t>(24, 100)};
  EXPECT_THAT(compared().first->note, HasSubstr("the picture has 2 x 4 pixels, expected 4 x 2"));
}

TEST_F(Compare, JudgesDepthByPixelRelativeToItsDistance) {
  actual_.ticks[1].depth[3] = 4.01F;
  EXPECT_FALSE(compared().within);
  ToleranceRule depth = rule("Robot/Eye/depth");
  depth.rtol = 0.01;
  EXPECT_TRUE(compared({depth}).within);
}

TEST_F(Compare, CallsNothingHitAgainstSomethingHitBeyondAnyTolerance) {
  actual_.ticks[1].depth[3] = std::numeric_limits<float>::infinity();
  ToleranceRule depth = rule("*");
  depth.atol = 1e9;
  EXPECT_FALSE(compared({depth}).within);
}

TEST_F(Compare, JudgesDistancesInMetresAndNothingByBeingNothing) {
  actual_.ticks[1].ranges[2] = 2.001F;
  const Comparison comparison = compared();
  ASSERT_TRUE(comparison.first);
  EXPECT_EQ(comparison.first->element, "ranges/2");
  EXPECT_EQ(comparison.first->unit, "m");
  EXPECT_EQ(comparison.first->stage, Stage::sensors);
  ToleranceRule centimetres = rule("Robot/Laser/ranges/*");
  centimetres.atol = 0.01;
  EXPECT_TRUE(compared({centimetres}).within);  // the beam that met nothing met nothing again
  actual_.ticks[1].ranges[1] = 9.0F;
  EXPECT_FALSE(compared({centimetres}).within);
}

TEST_F(Compare, KeepsTheTableToSixteenLines) {
  for (auto& tick : actual_.ticks) {
    tick = {tick.tick, 2, 2, false, 1.0, 1.0, {0, 0, 0}, {1, 0, 0, 0}, 1.0, 1.0, 1.0, tick.image, {0, 0, 0, 0}};
    tick.image.pixels.assign(24, 0);
  }
  actual_.provenance = {{"a", "1"}};
  const std::string text = table(compared());
  EXPECT_LE(std::ranges::count(text, '\n'), 16) << text;
  EXPECT_THAT(text, HasSubstr("physics"));
}

TEST_F(Compare, WritesJsonWithInfinitiesAndNanAsStrings) {
  actual_.ticks[1].u = nan_value;
  const auto json = nlohmann::json::parse(to_json(compared()));
  EXPECT_EQ(json["equal"], false);
  EXPECT_EQ(json["within"], false);
  EXPECT_EQ(json["agreement"], "beyond");
  const auto& first = json["first"];
  EXPECT_EQ(first["tick"], 1);
  EXPECT_EQ(first["time"], 0.001);
  EXPECT_EQ(first["channel"], "/Robot/Pd/output/joints");
  EXPECT_EQ(first["element"], "KNEE/u");
  EXPECT_EQ(first["expected"], 12.0);
  EXPECT_EQ(first["actual"], "NaN");
  EXPECT_EQ(first["difference"], "NaN");
  EXPECT_EQ(first["relative"], nullptr);
  EXPECT_EQ(first["ulps"], nullptr);
  EXPECT_EQ(first["tolerance"], 1e-3);
  EXPECT_EQ(first["unit"], "N·m");
  EXPECT_EQ(first["stage"], "controller");
}

TEST_F(Compare, WritesJsonWithoutAFirstIfThereIsNone) {
  EXPECT_THAT(to_json(compared()), StartsWith("{\n  \"verdict\": "));
  EXPECT_THAT(to_json(compared()), HasSubstr("\"within\": true,\n  \"agreement\": \"equal\",\n  \"first\": null,\n"));
}

TEST_F(Compare, WritesJsonWithAllThatTheTableTells) {
  actual_.ticks[1].u = 13.5;
  actual_.ticks[2].q = std::nextafter(0.5, 1.0);
  actual_.scenario = "rehearse: 1\nseed: 2\n";
  const auto json = nlohmann::json::parse(to_json(compared({rule("Nobody/*")})));
  EXPECT_EQ(json["first"]["difference"], 1.5);
  EXPECT_EQ(json["first"]["relative"], 0.125);
  EXPECT_EQ(json["first"]["times_tolerance"], 1.5 / 1e-3);
  EXPECT_EQ(json["worst"], json["first"]);
  EXPECT_EQ(json["first_bit"], json["first"]);
  EXPECT_EQ(json["differing"], 2);
  EXPECT_EQ(json["beyond"], 1);
  ASSERT_EQ(json["channels"].size(), 2u);
  EXPECT_EQ(json["channels"][0]["channel"], "/Robot/Pd/output/joints");
  EXPECT_EQ(json["channels"][0]["beyond"], 1);
  EXPECT_EQ(json["channels"][1]["beyond"], 0);
  EXPECT_EQ(json["channels"][1]["worst"]["ulps"], 1);
  EXPECT_EQ(json["equal_channels"].size(), 7u);
  EXPECT_EQ(json["explanation"], "scenario.yaml");
  EXPECT_THAT(json["remarks"][0].get<std::string>(), HasSubstr("scenario.yaml has changed since"));
  EXPECT_THAT(json["warnings"][0].get<std::string>(), HasSubstr("'Nobody/*' applies to nothing"));
}

TEST_F(Compare, GroupsWhatIsAlikeAndNamesWhatIsBitEqual) {
  for (SmallTrace* trace : {&golden_, &actual_}) trace->has_helper = true;
  actual_.ticks[1].u = 13.0;
  const std::string text = table(compared());
  EXPECT_THAT(text,
              HasSubstr("controller /Robot/Pd/output/joints        1        3        1        1  KNEE/u 1 N·m @1"));
  EXPECT_THAT(text, HasSubstr("bit-equal: 10 channels (/tick, /Robot/joints, /Robot/BASE/pose, "));
  actual_.ticks[1].u = 12.0;
  actual_.ticks[1].image.pixels[3] = 103;
  actual_.ticks[2].depth[1] = 2.5F;
  EXPECT_THAT(table(compared()), HasSubstr("renderer   /Robot/Eye/image"));
}

TEST_F(Compare, RanksWhatHasNoToleranceBelowWhatIsBeyondOne) {
  actual_.ticks[0].image.pixels[3] = 103;
  actual_.ticks[1].u = 13.0;
  EXPECT_EQ(compared().worst->channel, "/Robot/Pd/output/joints");
}

TEST_F(Compare, FindsAQuaternionThatIsNoRotation) {
  actual_.ticks[1].rotation = {0.0, 0.0, 0.0, 1.1};
  const Comparison comparison = compared();
  ASSERT_TRUE(comparison.first);
  EXPECT_EQ(comparison.first->element, "orientation/norm");
  EXPECT_EQ(comparison.first->expected, 1.0);
  EXPECT_EQ(comparison.first->actual, 1.1);
}

TEST_F(Compare, CountsTurnsOfAJointOfWhichNothingSaysThatItWraps) {
  golden_.ticks[1].q = 7.0;
  actual_.ticks[1].q = 7.0 - 2.0 * M_PI;
  EXPECT_NEAR(compared().first->difference, 2.0 * M_PI, 1e-12);
}

TEST_F(Compare, TellsNoiseFromADifferenceWithinTolerance) {
  actual_.ticks[1].u = 12.0 + 1e-9;
  CompareOptions options;
  EXPECT_EQ(compared({}, options).agreement, Agreement::within);
  options.noise_floors["Robot/Pd/output/KNEE/u"] = 2e-9;
  EXPECT_EQ(compared({}, options).agreement, Agreement::in_noise);
  EXPECT_THAT(verdict(compared({}, options)), StartsWith("within the noise floor: 1 of"));
  actual_.ticks[2].u = 12.0 + 1e-8;
  EXPECT_EQ(compared({}, options).agreement, Agreement::within);
  EXPECT_EQ(compared({}, options).in_noise, 1);
  actual_.ticks[2].u = 13.0;
  EXPECT_EQ(compared({}, options).agreement, Agreement::beyond);
}

}  // namespace
}  // namespace rehearse
