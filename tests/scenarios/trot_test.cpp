// A quadruped that stands up and trots.
#include <rehearse/gtest.h>

#include <cmath>
#include <string>

namespace {

using rehearse::BenchContact;
using rehearse::ControllerBench;
using rehearse::Trace;

TEST(Trot, StandsUpAndWalksAhead) {
  const Trace trace = rehearse::record("scenarios/quadruped.yaml");
  EXPECT_NEAR(trace.at("Quadruped/TRUNK/position/z", 0.8), 0.35, 0.02);  // [m], up
  EXPECT_GT(trace.last("Quadruped/TRUNK/position/x"), 0.12);
  EXPECT_GT(trace.min("Quadruped/TRUNK/position/z"), 0.2) << "it never falls";
  EXPECT_LT(std::abs(trace.last("Quadruped/TRUNK/position/y")), 0.05);
  for (const std::string foot : {"FL", "FR", "RL", "RR"}) {
    EXPECT_EQ(trace.min("Quadruped/" + foot + "_Touch/count"), 0.0) << "each foot is in the air at times";
    EXPECT_GT(trace.max("Quadruped/" + foot + "_Touch/force/z"), 40.0) << "and carries at others";  // [N]
  }
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(Trot, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Trot.StandsUpAndWalksAhead"); }

TEST(Trot, DoesNotStepBeforeAllFeetFeelTheGround) {
  rehearse::BenchOptions options;
  options.time_step = 0.01;
  ControllerBench bench("TrotController", "models/quadruped.urdf", options);
  for (const char* foot : {"FL_FOOT", "FR_FOOT", "RL_FOOT"}) bench.link(foot).contacts = {BenchContact{}};
  for (int i = 0; i < 200; ++i) bench.tick();
  const double standing = bench.joint("FL_KNEE").u;
  for (int i = 0; i < 40; ++i) bench.tick();
  EXPECT_EQ(bench.joint("FL_KNEE").u, standing);
  bench.link("RR_FOOT").contacts = {BenchContact{}};
  for (int i = 0; i < 30; ++i) bench.tick();  // three quarters of a step: this leg is in the air
  EXPECT_NE(bench.joint("FL_KNEE").u, standing);
}

TEST(Trot, LiftsTheSideThatLeans) {
  ControllerBench bench("TrotController", "models/quadruped.urdf");
  bench.device("Imu").values = {1.0, 0.0, 0.0, 0.0, 0.0, 9.8};  // it rolls to the right
  for (int i = 0; i < 100; ++i) bench.tick();
  EXPECT_GT(bench.joint("FR_KNEE").u, bench.joint("FL_KNEE").u) << "the right knees stretch";
}

}  // namespace
