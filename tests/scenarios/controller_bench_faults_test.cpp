// Faults of a ControllerBench: what the controller reads, and what is left of its commands.
#include <rehearse/gtest.h>

#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "session/runs.h"

namespace {

using rehearse::BenchOptions;
using rehearse::ControllerBench;
using rehearse::Faults;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FaultyBench : public rehearse::RunTest {
 protected:
  /// The efforts of HingePd, -50 q, if SHOULDER is at 0.1 rad, 0.2 rad and so on, a tick each.
  std::vector<double> efforts(const Faults& faults, int ticks = 5) const {
    BenchOptions options;
    options.faults = faults;
    ControllerBench bench("HingePd", path("rig.urdf").string(), options);
    std::vector<double> found;
    for (int i = 1; i <= ticks; ++i) {
      bench.joint("SHOULDER").q = 0.1 * i;
      bench.tick();
      found.push_back(std::round(1e9 * bench.joint("SHOULDER").u) / 1e9);
    }
    return found;
  }
  std::string refusal(const Faults& faults) const {
    try {
      efforts(faults);
    } catch (const std::invalid_argument& exception) {
      return exception.what();
    }
    return "nothing";
  }
};

TEST_F(FaultyBench, HasNoFaultsByDefault) { EXPECT_THAT(efforts({}), ElementsAre(-5, -10, -15, -20, -25)); }

TEST_F(FaultyBench, EncodersAreStuckLostDelayedAndOff) {
  EXPECT_THAT(efforts(Faults().encoder("SHOULDER").stuck({0.001, 0.003})), ElementsAre(-5, -5, -5, -20, -25));
  EXPECT_THAT(efforts(Faults().encoder("SHOULDER").lost({0.002})), ElementsAre(-5, -10, -10, -10, -10));
  EXPECT_THAT(efforts(Faults().encoder("*").delayed(0.002)), ElementsAre(-5, -5, -5, -10, -15));
  EXPECT_THAT(efforts(Faults().encoder("SHOULDER").offset("displacement", 1.0, {0.001, 0.002})),
              ElementsAre(-5, -60, -15, -20, -25));
}

TEST_F(FaultyBench, ActuatorsAreDeadWeakAndReversed) {
  EXPECT_THAT(efforts(Faults().actuator("SHOULDER").dead({0.001, 0.003})), ElementsAre(-5, 0, 0, -20, -25));
  EXPECT_THAT(efforts(Faults().actuator("SHOULDER").weak(0.4, {0.003})), ElementsAre(-5, -10, -15, -8, -10));
  EXPECT_THAT(efforts(Faults().actuator("SHOULDER").reversed().actuator("SHOULDER").weak(0.5)),
              ElementsAre(2.5, 5, 7.5, 10, 12.5));
}

TEST_F(FaultyBench, LeavesInputsThatTheControllerDoesNotCommand) {
  BenchOptions options;
  options.faults.actuator("*").weak(0.5);
  ControllerBench bench("HingePd", path("rig.urdf").string(), options);
  bench.joint("RAIL").u = 8.0;
  bench.joint("RAIL").q_target = 3.0;
  bench.tick();
  bench.tick();
  EXPECT_EQ(bench.joint("RAIL").u, 8.0);
  EXPECT_EQ(bench.joint("RAIL").q_target, 3.0);
}

TEST_F(FaultyBench, SensorsAreOffAndTheTestsOwnNumbersStay) {
  BenchOptions options;
  options.options = "sense";
  options.faults.sensor("Imu").offset("acceleration", {0.0, 0.0, 0.25}, {0.001});
  ControllerBench bench("Behaviours", path("rig.urdf").string(), options);
  bench.device("Imu").values = {0, 0, 0, 0, 0, 9.5};
  bench.device("Accelerometer").values = {0, 0, 9.5};
  bench.tick();
  bench.tick();
  EXPECT_THAT(bench.messages(), Contains(HasSubstr("tick 0 accelerometer 9.5 imu 9.5")));
  EXPECT_THAT(bench.messages(), Contains(HasSubstr("tick 1 accelerometer 9.5 imu 9.75")));
  EXPECT_EQ(bench.device("Imu").values[5], 9.5);
}

TEST_F(FaultyBench, AreTheFaultsOfAScenario) {
  EXPECT_THAT(Faults().sensor("A b").stuck({0.1, 0.2}).encoder("*").offset("effort", {1, 2, 3}).entries(),
              ElementsAre("{sensor: \"A b\", fault: stuck, from: 0.1, until: 0.2}",
                          "{encoder: \"*\", fault: offset, quantity: effort, by: [1, 2, 3], from: 0}"));
}

TEST_F(FaultyBench, RefusesPartsAndNumbersThatCannotBe) {
  EXPECT_THAT(refusal(Faults().encoder("ELBOW").stuck()), HasSubstr("Rig has no encoder 'ELBOW'"));
  EXPECT_THAT(refusal(Faults().sensor("Nose").lost()), HasSubstr("Rig has no sensor 'Nose'"));
  EXPECT_THAT(refusal(Faults().actuator("SHOULDER").weak(1.5)), HasSubstr("effort"));
  EXPECT_THAT(refusal(Faults().sensor("Imu").offset("force", 1.0)), HasSubstr("it doesn't measure 'force'"));
  EXPECT_THAT(refusal(Faults().encoder("SHOULDER").delayed(-0.1)), HasSubstr("by"));
}

}  // namespace
