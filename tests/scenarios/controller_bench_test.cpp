#include <rehearse/gtest.h>

#include <gmock/gmock.h>

#include <stdexcept>

namespace {

using rehearse::ControllerBench;
using ::testing::HasSubstr;

std::string sr1() { return std::string(FIXTURES_DIR) + "/models/sr1.urdf"; }

/// What a piece of code throws.
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

}  // namespace
