// A tank that a person drives by joystick.
#include <rehearse/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace {

using rehearse::BenchOptions;
using rehearse::ControllerBench;
using rehearse::Trace;

const Trace& drive() {
  static const Trace trace = rehearse::record("scenarios/tank.yaml");
  return trace;
}

/// About z [rad].
double heading(double time) {
  const auto q = [&](const char* element) {
    return drive().at(std::string("Tank/CHASSIS/orientation/") + element, time);
  };
  return 2.0 * std::atan2(q("z"), q("w"));
}

TEST(Tank, IsDrivenByJoystick) {
  const double way = 0.8 * (2.3 - 0.5 - 0.3);  // at 0.8 m/s, less half of each ramp of the stick [m]
  EXPECT_NEAR(drive().at("Tank/CHASSIS/position/x", 2.4), way, 0.05);
  EXPECT_NEAR(drive().at("Tank/CHASSIS/position/y", 2.4), 0.0, 0.02);
  EXPECT_NEAR(heading(2.4), 0.0, 0.02);
  EXPECT_GT(heading(3.5), 0.3);  // to the left; how far depends on how much the tracks slip
  EXPECT_MATCHES_GOLDEN(drive());
}

TEST(Tank, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Tank.IsDrivenByJoystick"); }

TEST(Tank, AimsWithItsTurretAndGun) {
  EXPECT_NEAR(drive().last("Tank/TURRET_Y/q"), -0.5 * 0.8, 0.03);  // half the rate for 0.8 s [rad]
  EXPECT_NEAR(drive().last("Tank/TURRET_P/q"), -0.2 * 0.8, 0.05);
}

TEST(Tank, HasItsLightOnOnlyWhenItWasSwitchedOn) {
  const std::vector<double> on = drive().values("Tank/Headlight/values/0");
  ASSERT_FALSE(on.empty());
  EXPECT_EQ(on.front(), 0.0);
  EXPECT_EQ(on.back(), 1.0);
  EXPECT_NEAR(drive().last("Tank/Headlight/values/11"), 0.4 - 0.4 * 0.6, 0.005);  // the beam's width [rad]
}

TEST(Tank, SwitchesItsLightByDeviceOutput) {
  ControllerBench bench("TankController", "models/tank.urdf");
  bench.tick();
  EXPECT_FALSE(bench.device("Headlight").on);  // initialize() put it out
  bench.button("A") = true;
  for (int i = 0; i < 3; ++i) bench.tick();
  EXPECT_TRUE(bench.device("Headlight").on);  // once, however long the button is held
  bench.button("A") = false;
  bench.tick();
  bench.button("A") = true;
  bench.tick();
  EXPECT_FALSE(bench.device("Headlight").on);
}

TEST(Tank, DrivesItsTurretByTorqueOrByPosition) {
  for (const std::string way : {"torque", "position"}) {
    BenchOptions options;
    options.options = way;
    ControllerBench bench("TankController", "models/tank.urdf", options);
    bench.axis("R_STICK_H") = -1.0;  // to the left
    for (int i = 0; i < 100; ++i) bench.tick();
    if (way == "position")
      EXPECT_NEAR(bench.joint("TURRET_Y").q_target, 0.1, 1e-9);  // [rad], in 0.1 s
    else
      EXPECT_NEAR(bench.joint("TURRET_Y").u, 60.0 * 0.1, 1e-9);  // [N·m]
  }
}

TEST(Tank, StaysWhereItIsWithoutAJoystick) {
  BenchOptions options;
  options.joystick = false;
  ControllerBench bench("TankController", "models/tank.urdf", options);
  bench.tick();
  EXPECT_EQ(bench.joint("TRACK_L").dq_target, 0.0);
}

}  // namespace
