// An arm of meshes that holds a block between its fingers by friction.
#include <rehearse/gtest.h>
#include <rehearse/messages.h>

#include <algorithm>

namespace {

using rehearse::ControllerBench;
using rehearse::Trace;

TEST(Grasp, CarriesABlockAside) {
  const Trace trace = rehearse::record("scenarios/mesh_arm.yaml");
  EXPECT_NEAR(trace.at("Block/Block/position/z", 1.0), 0.03, 1e-3) << "it stands until it is grasped";
  EXPECT_GT(trace.min("Block/Block/position/z"), 0.029);
  EXPECT_GT(trace.last("Block/Block/position/z"), 0.1);
  EXPECT_GT(trace.last("Block/Block/position/y"), 0.15) << "it was carried to the left";
  EXPECT_NEAR(trace.last("Block/Block/linear/x"), 0.0, 0.02);
  EXPECT_TRUE(std::ranges::any_of(
      trace.events(), [](const rehearse::msg::Event& event) { return event.text == "both fingers touch the block"; }));
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(Grasp, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Grasp.CarriesABlockAside"); }

TEST(Grasp, SaysIfItHoldsNothing) {
  rehearse::BenchOptions options;
  options.time_step = 0.01;
  ControllerBench bench("GraspController", "models/mesh_arm/mesh_arm.urdf", options);
  for (int i = 0; i < 155; ++i) bench.tick();
  EXPECT_NEAR(bench.joint("LIFT").q_target, 1.29, 0.02);
  EXPECT_EQ(bench.joint("GRIP").q_target, 0.0);
  const auto& said = bench.messages();
  EXPECT_TRUE(std::ranges::any_of(said, [](const std::string& text) {
    return text.find("there is nothing between the fingers") != std::string::npos;
  }));
}

}  // namespace
