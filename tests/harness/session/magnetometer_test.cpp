// A magnetometer in the closed loop: in the world, in a recording, in a controller and in a replay.
#include <cmath>

#include "log/robot_log.h"
#include "logs/robot_log/log_replay.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double north = 2e-5, down = -4.5e-5;  // [T]

class Magnetometer : public RunTest {
 protected:
  Magnetometer() {
    std::string model = rig_urdf;
    model.insert(model.find("<sensor name=\"Force\""), R"(<sensor name="Compass" type="magnetometer">
      <pose>0 0 0 0 0 1.5707963267948966</pose>
    </sensor>
    )");
    write("rig.urdf", model);
  }

  /// The wheel turns about y by its controller, and the field points north and down.
  static std::string with(const std::string& controller, const std::string& more = "") {
    return rig(controller, "cameras: none\nmagnetic_field: [2e-5, 0, -4.5e-5]\n" + more, "0.5");
  }
};

TEST_F(Magnetometer, MeasuresTheFieldInItsOwnFrame) {
  const Trace trace = record_run(with(behaviour("C", "push 3")));
  const std::vector<double> angle = trace.values("Rig/SHOULDER/q");
  const std::vector<double> x = trace.values("Rig/Compass/magnetic_field/x");
  const std::vector<double> y = trace.values("Rig/Compass/magnetic_field/y");
  const std::vector<double> z = trace.values("Rig/Compass/magnetic_field/z");
  ASSERT_EQ(x.size(), 500u);  // at every tick but the first, and in the state after the last
  ASSERT_GT(angle.back(), 0.5);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = angle[i + 1];
    // its y points against the wheel's x, which turns about y
    EXPECT_NEAR(x[i], 0.0, 1e-15);
    EXPECT_NEAR(y[i], -(std::cos(a) * north - std::sin(a) * down), 1e-12);
    EXPECT_NEAR(z[i], std::sin(a) * north + std::cos(a) * down, 1e-12);
  }
}

TEST_F(Magnetometer, MeasuresNothingWithoutAField) {
  const Trace trace = record_run(rig(behaviour("C", "push 3")));
  EXPECT_EQ(trace.last("Rig/Compass/magnetic_field/z"), 0.0);
}

TEST_F(Magnetometer, IsRecordedAsAStandardMessageWithItsUnit) {
  const Trace trace = record_run(with(behaviour("C", "push 3")));
  const TraceChannel* channel = trace.find_channel("/Rig/Compass/magnetic_field");
  ASSERT_NE(channel, nullptr);
  EXPECT_EQ(channel->type, "sensor_msgs/msg/MagneticField");
  EXPECT_EQ(channel->metadata.at("unit:magnetic_field"), "T");
}

TEST_F(Magnetometer, IsADeviceLikeAnyOtherForAControllerAndInAReplay) {
  const Trace trace = record_run(with(behaviour("C", "compass Compass"), "seed: 1\n") +
                                 "noise:\n  - {sensor: Rig/Compass, magnetic_field: {bias: [1e-6, 0, 0]}}\n");
  EXPECT_THAT(said(trace), Contains("Rig/C: Magnetometer Compass, 3 numbers"));
  EXPECT_NEAR(trace.last("Rig/C/output/SHOULDER/u"), 1.0, 1e-6);
  EXPECT_EQ(trace.last("Rig/C/output/SHOULDER/u"), 1e6 * trace.values("Rig/Compass/magnetic_field/x")[498]);
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal());
  EXPECT_EQ(report->values, 1000);  // commands, and results of control()
  ReplayOptions altered;
  altered.set = {"Rig/Compass/magnetic_field/x=5e-6@tick:100"};
  const auto other = replay_run(altered);
  ASSERT_TRUE(other.ok()) << to_string(other.errors());
  ASSERT_TRUE(other->first.has_value());
  EXPECT_EQ(other->first->tick, 100);
  EXPECT_EQ(other->first->actual, 5.0);
}

TEST_F(Magnetometer, OfALogIsFedAsTheRefusalSays) {
  record_run(with(behaviour("C", "compass Compass")));
  RobotLog robot;
  robot.topics = {{"/Rig/joints", "/joint_states"},
                  {"/Rig/Compass/magnetic_field", "/mag"},
                  {"/Rig/C/output/joints", "/joint_commands"}};
  write_log(path("run.mcap"), path("log.mcap"), robot);
  const std::string map =
      "rehearse_map: 1\ntime_step: 0.001\nstart: first\njoints: /joint_states\ncommands: /joint_commands\n"
      "controller: {name: C, options: compass Compass}\n";
  LogReplayOptions options;
  options.controller = "Behaviours";
  options.model = path("rig.urdf");
  options.map = path("map.yaml");
  const auto replayed = [&] { return replay_log(path("log.mcap"), path("replayed.mcap"), options); };
  write("map.yaml", map);
  const auto refused = replayed();
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(to_string(refused.errors()), HasSubstr("magnetometers: {topic: ..., device: Compass} would give it"));
  write("map.yaml", map + "magnetometers: {topic: /mag, device: Compass}\n");
  const auto report = replayed();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_GT(report->values, 400);
  EXPECT_TRUE(report->equal());
}

TEST_F(Magnetometer, RefusesAFieldThatIsNoVector) {
  std::string text = with(behaviour("C", "push 3"));
  text.replace(text.find("[2e-5, 0, -4.5e-5]"), 18, "strong");
  write("run.yaml", text);
  const auto scenario = Scenario::load(path("run.yaml"));
  ASSERT_FALSE(scenario.ok());
  EXPECT_THAT(to_string(scenario.errors()), HasSubstr("run.yaml:4:17: error: magnetic_field"));
}

}  // namespace
}  // namespace rehearse
