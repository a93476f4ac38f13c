#include <rehearse/gtest.h>

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "session/runs.h"

namespace {

using rehearse::ControllerBench;
using ::testing::Contains;
using ::testing::HasSubstr;

std::string sr1() { return std::string(FIXTURES_DIR) + "/models/sr1.urdf"; }

/// The message of the exception that a piece of code throws.
template <class Code>
std::string thrown_by(Code code) {
  try {
    code();
  } catch (const std::exception& exception) {
    return exception.what();
  }
  return "nothing";
}

TEST(ControllerBench, AdvancesTimeByOneStepATick) {
  rehearse::BenchOptions options;
  options.time_step = 0.002;
  ControllerBench bench("SR1MinimumController", sr1(), options);
  EXPECT_EQ(bench.time(), 0.0);
  EXPECT_TRUE(bench.tick());
  EXPECT_TRUE(bench.tick());
  EXPECT_EQ(bench.ticks(), 2);
  EXPECT_EQ(bench.time(), 0.004);
}

TEST(ControllerBench, NamesTheJointsThereAreToWhoeverAsksForAnother) {
  ControllerBench bench("SR1MinimumController", sr1());
  EXPECT_THAT(thrown_by([&] { bench.joint("KNEE"); }), HasSubstr("no joint \"KNEE\"; it has RLEG_HIP_R, RLEG_HIP_P"));
  EXPECT_THAT(thrown_by([&] { bench.link("HEAD"); }), HasSubstr("no link \"HEAD\"; it has WAIST"));
  EXPECT_THAT(thrown_by([&] { bench.device("Nose"); }), HasSubstr("no device \"Nose\""));
}

TEST(ControllerBench, SaysThatAControllerIsNotThere) {
  EXPECT_THAT(thrown_by([] { ControllerBench bench("NoSuchController", sr1()); }),
              HasSubstr("controller library 'NoSuchController' not found"));
}

TEST(ControllerBench, SaysWhatIsWrongWithAModel) {
  EXPECT_THAT(
      thrown_by([] { ControllerBench bench("SR1MinimumController", FIXTURES_DIR "/broken/urdf_two_roots.urdf"); }),
      HasSubstr("urdf_two_roots.urdf"));
}

TEST(ControllerBench, RefusesASensorReadingOfTheWrongSize) {
  ControllerBench bench("SR1MinimumController", sr1());
  bench.device("WaistGyro").values = {1.0, 2.0};
  EXPECT_THAT(thrown_by([&] { bench.tick(); }),
              HasSubstr("device \"WaistGyro\" has 2 values, but a RateGyroSensor has 3"));
}

TEST(ControllerBench, MovesLinksByTheJointsIfAsked) {
  ControllerBench bench("SR1MinimumController", sr1());
  const Eigen::Vector3d before = bench.link("RLEG_ANKLE_P").position;
  bench.joint("RLEG_KNEE").q = M_PI / 2;
  EXPECT_EQ(bench.link("RLEG_ANKLE_P").position, before);
  bench.update_links();
  const Eigen::Vector3d knee = bench.link("RLEG_KNEE").position;
  // the shank, 0.3 m long, points backwards now
  EXPECT_LT((bench.link("RLEG_ANKLE_P").position - (knee + Eigen::Vector3d(-0.3, 0.0, 0.0))).norm(), 1e-12);
}

class TouchedBench : public rehearse::RunTest {
 protected:
  /// A controller that commands SHOULDER the weighted sum of all numbers of ARM's contacts.
  std::unique_ptr<ControllerBench> touched() const {
    rehearse::BenchOptions options;
    options.options = "touch ARM";
    return std::make_unique<ControllerBench>("Behaviours", path("rig.urdf").string(), options);
  }
};

TEST_F(TouchedBench, GivesTheContactsThatATestSetsUntilItTakesThemAway) {
  const auto bench = touched();
  bench->tick();
  EXPECT_EQ(bench->joint("SHOULDER").u, 0.0);
  rehearse::BenchContact contact;
  contact.normal = Eigen::Vector3d::Zero();
  contact.position.x() = 2.0;
  contact.depth = 3.0;
  bench->link("ARM").contacts = {contact};
  bench->tick();
  EXPECT_NEAR(bench->joint("SHOULDER").u, 1e-3 * (2.0 * 1.01 + 3.0 * std::pow(1.01, 13)), 1e-12);
  bench->update_links();
  bench->joint("SHOULDER").u = 0.0;
  bench->tick();
  EXPECT_NEAR(bench->joint("SHOULDER").u, 1e-3 * (2.0 * 1.01 + 3.0 * std::pow(1.01, 13)), 1e-12);
  bench->link("ARM").contacts.clear();
  bench->tick();
  EXPECT_EQ(bench->joint("SHOULDER").u, 0.0);
  EXPECT_THAT(bench->messages(), Contains("tick 1: 1 points, free"));
}

using SpeakingBench = rehearse::RunTest;

TEST_F(SpeakingBench, TellsWhatTheControllerSaysOfItsInside) {
  rehearse::BenchOptions options;
  options.options = "variables 0.25";
  ControllerBench bench("Behaviours", path("rig.urdf").string(), options);
  EXPECT_EQ(bench.variable("gain"), 2.5);
  EXPECT_THAT(thrown_by([&] { bench.variable("phase"); }), HasSubstr("no variable \"phase\"; it has gain"));
  bench.tick();
  bench.tick();
  EXPECT_EQ(bench.variable("phase"), 0.25);
  EXPECT_EQ(bench.variable("even"), 0.0) << "as it was last set";
}

class SteeredBench : public rehearse::RunTest {
 protected:
  /// A controller that commands SHOULDER the position of L_STICK_V, 10 for button A, 100 times that of R_TRIGGER.
  std::unique_ptr<ControllerBench> steered(bool joystick = true) const {
    rehearse::BenchOptions options;
    options.options = "steer";
    options.joystick = joystick;
    return std::make_unique<ControllerBench>("Behaviours", path("rig.urdf").string(), options);
  }
};

TEST_F(SteeredBench, HasAJoystickThatNobodyTouches) {
  const auto bench = steered();
  EXPECT_THAT(bench->messages(), Contains("ready, 8 axes, 11 buttons"));
  bench->tick();
  EXPECT_EQ(bench->joint("SHOULDER").u, 0.0);
}

TEST_F(SteeredBench, HoldsWhatATestDoesWithTheJoystick) {
  const auto bench = steered();
  bench->axis("L_STICK_V") = -0.5;
  bench->button("A") = true;
  bench->tick();
  EXPECT_EQ(bench->joint("SHOULDER").u, 9.5);
  bench->tick();
  EXPECT_EQ(bench->joint("SHOULDER").u, 9.5);
  bench->button("A") = false;
  bench->axis("7") = 1.0;  // R_TRIGGER
  bench->tick();
  EXPECT_EQ(bench->joint("SHOULDER").u, 99.5);
}

TEST_F(SteeredBench, RoundsPositionsAsARecordingDoes) {
  const auto bench = steered();
  bench->axis("L_STICK_V") = 0.3;
  bench->tick();
  EXPECT_EQ(bench->joint("SHOULDER").u, static_cast<double>(0.3f));
}

TEST_F(SteeredBench, RefusesAnAxisWhereItCannotBe) {
  const auto bench = steered();
  bench->axis("L_STICK_V") = -1.5;
  EXPECT_THAT(thrown_by([&] { bench->tick(); }), HasSubstr("axis \"L_STICK_V\" is at -1.5, but it goes from -1 to 1"));
  bench->axis("L_STICK_V") = 0.0;
  bench->axis("L_TRIGGER") = -0.5;
  EXPECT_THAT(thrown_by([&] { bench->tick(); }), HasSubstr("axis \"L_TRIGGER\" is at -0.5, but it goes from 0 to 1"));
  bench->axis("L_TRIGGER") = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(bench->tick(), std::invalid_argument);
}

TEST_F(SteeredBench, NamesTheControlsThereAreToWhoeverAsksForAnother) {
  const auto bench = steered();
  EXPECT_THAT(thrown_by([&] { bench->axis("A"); }),
              HasSubstr("the joystick has no axis \"A\"; it has L_STICK_H, L_STI"));
  EXPECT_THAT(thrown_by([&] { bench->button("FIRE"); }),
              HasSubstr("the joystick has no button \"FIRE\"; it has A, B, X"));
}

TEST_F(SteeredBench, HasNoJoystickIfTheTestSaysSo) {
  const auto bench = steered(false);
  EXPECT_THAT(bench->messages(), Contains("not ready, 0 axes, 0 buttons"));
  EXPECT_THROW(bench->axis("L_STICK_V"), std::logic_error);
  EXPECT_THAT(thrown_by([&] { bench->button("A"); }), HasSubstr("the bench exclude a joystick"));
}

TEST_F(SteeredBench, KeepsItsJoystickToItselfBesideAnother) {
  const auto left = steered(), right = steered(), none = steered(false);
  left->axis("L_STICK_V") = -1.0;
  right->axis("L_STICK_V") = 1.0;
  for (int i = 0; i < 2; ++i)
    for (const auto* bench : {&left, &right, &none}) (*bench)->tick();
  EXPECT_EQ(left->joint("SHOULDER").u, -1.0);
  EXPECT_EQ(right->joint("SHOULDER").u, 1.0);
  EXPECT_EQ(none->joint("SHOULDER").u, 0.0);
}

}  // namespace
