// Lights in the closed loop: their state in controllers, their effect on cameras, and controllers' commands to them.

#include <rehearse/mcap.h>

#include "picture/picture.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;

/// A head (joint SHOULDER, at rest) with a camera and two lights before a grey wall.
constexpr const char* lamps_urdf = R"(<?xml version="1.0"?>
<robot name="Rig">
  <link name="world">
    <visual><origin xyz="1.1 0 1"/><geometry><box size="0.2 4 4"/></geometry>
      <material name="grey"><color rgba="0.4 0.4 0.4 1"/></material></visual>
  </link>
  <joint name="SHOULDER" type="continuous">
    <parent link="world"/><child link="HEAD"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
  </joint>
  <link name="HEAD">
    <inertial><mass value="1"/><inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.5"/></inertial>
  </link>
  <gazebo reference="HEAD">
    <sensor name="Camera" type="camera">
      <update_rate>200</update_rate>
      <camera><image><width>16</width><height>12</height></image></camera>
    </sensor>
    <light name="Bulb" type="point">
      <diffuse>1 0.5 0.25 1</diffuse><intensity>0.5</intensity>
      <attenuation><range>20</range><constant>0.75</constant><linear>0.125</linear><quadratic>0.125</quadratic></attenuation>
    </light>
    <light name="Beam" type="spot">
      <direction>1 0 0</direction>
      <spot><inner_angle>0.5</inner_angle><outer_angle>1</outer_angle><falloff>2</falloff></spot>
    </light>
  </gazebo>
</robot>
)";

class Lights : public RunTest {
 protected:
  Lights() { write("rig.urdf", lamps_urdf); }

  static std::string with(const std::string& controllers, const std::string& more = "") {
    return "rehearse: 1\nduration: 0.03\n" + more + "bodies:\n  - name: Rig\n    model: rig.urdf\n    controllers: [" +
           controllers + "]\n";
  }

  /// The colour in the middle of each frame that was recorded, red only, in order.
  std::vector<int> middles(const std::string& file = "run.mcap") const {
    std::vector<int> colors;
    auto reader = mcap::Reader::open(path(file));
    EXPECT_TRUE((*reader)->for_each_message([&](const mcap::Message& message) {
      if (message.channel->topic != "/Rig/Camera/image") return true;
      CdrReader payload(message.data);
      msg::CompressedImage image;
      EXPECT_TRUE(msg::decode(payload, image));
      colors.push_back(decode_png(image.data)->pixels[static_cast<std::size_t>(6 * 16 + 8) * 3]);
      return true;
    }));
    return colors;
  }
};

TEST_F(Lights, AreFoundByControllersWithTheirFigures) {
  EXPECT_THAT(
      said(record_run(with(behaviour("C", "lamp"), "cameras: none\n"))),
      ElementsAre("Rig/C: PointLight Bulb on color    1  0.5 0.25 intensity 0.5 fading 0.75 0.125 0.125",
                  "Rig/C: SpotLight Beam on color 1 1 1 intensity 1 fading 1 1 0 towards 1 0 0 within 0.25 to 0.5 "
                  "exponent 2"));
}

TEST_F(Lights, ShineIntoWhatCamerasSee) {
  record_run(with(behaviour("C", "push 0")));
  const int lit = middles().front();
  std::string dark = lamps_urdf;
  for (std::size_t at; (at = dark.find("<light")) != std::string::npos;)
    dark.erase(at, dark.find("</light>", at) + 8 - at);
  write("rig.urdf", dark);
  record_run(with(behaviour("C", "push 0")));
  EXPECT_GT(lit, middles().front() + 20);
}

TEST_F(Lights, PutOutInInitializeShineIntoNoPicture) {
  record_run(with(behaviour("C", "bulb -1")));
  const int dark = middles().front();
  record_run(with(behaviour("C", "push 0")));
  EXPECT_LT(dark, middles().front() - 5);
}

TEST_F(Lights, AreInTheirNewStateFromTheNextCaptureOn) {
  record_run(with(behaviour("C", "bulb 7")));  // the camera captures at ticks 0, 5, 10, ...
  const std::vector<int> red = middles();
  ASSERT_GE(red.size(), 4u);
  EXPECT_EQ(red[1], red[0]);
  EXPECT_LT(red[2], red[1] - 5);
  EXPECT_EQ(red[3], red[2]);
}

TEST_F(Lights, ThatAreChangedWithoutAWordStayAsTheyAre) {
  record_run(with(behaviour("C", "bulb 7 silent")));
  for (const int red : middles()) EXPECT_EQ(red, middles().front());
}

TEST_F(Lights, AreHeardByOthersInTheNextTickAndNotByTheirWriter) {
  for (const std::string delay : {"", ", delay: false"}) {
    const Trace trace =
        record_run(with(behaviour("A", "bulb 7", delay) + ", " + behaviour("B", "overhear"), "cameras: none\n"));
    EXPECT_THAT(said_by_controllers(trace), ElementsAre("Rig/B: tick 8 bulb off red 0.5"));
    EXPECT_THAT(trace.values("Rig/A/output/SHOULDER/u"), ::testing::Each(0.0));  // the changes that A received
    const auto report = replay_run();
    ASSERT_TRUE(report.ok()) << to_string(report.errors());
    EXPECT_TRUE(report->equal());
  }
}

TEST_F(Lights, SeveralWordsInOneTickAreTheLastOne) {
  const Trace trace =
      record_run(with(behaviour("A", "bulb 7 TWICE") + ", " + behaviour("B", "overhear"), "cameras: none\n"));
  EXPECT_THAT(said_by_controllers(trace), ElementsAre("Rig/B: tick 8 bulb off red 0.5"));
  EXPECT_EQ(trace.find_channel("/Rig/A/output/Bulb/state")->messages(), 1u);
  EXPECT_EQ(trace.find_channel("/Rig/Bulb/state")->messages(), 1u);
}

TEST_F(Lights, AWordInInitializeIsHeardOnce) {
  const Trace trace =
      record_run(with(behaviour("A", "bulb -1") + ", " + behaviour("B", "overhear"), "cameras: none\n"));
  EXPECT_THAT(said_by_controllers(trace), ElementsAre("Rig/B: tick 0 bulb off red 0.5"));
  EXPECT_EQ(trace.find_channel("/Rig/A/output/Bulb/state")->messages(), 1u);
  EXPECT_TRUE(replay_run()->equal());
}

TEST_F(Lights, AnExceptionInASlotEndsTheRunAndNotTheProcess) {
  record_run(with(behaviour("A", "bulb 7") + ", " + behaviour("B", "overhear throw"), "cameras: none\n"));
  ASSERT_TRUE(summary_.failure.has_value());
  EXPECT_EQ(summary_.failure->message,
            "controller 'Rig/B' threw std::runtime_error: too dark in a slot of sigStateChanged() at tick 8 (0.008 s)");
}

TEST_F(Lights, AStateThatIsNotFiniteIsNotPassedOn) {
  const Trace trace =
      record_run(with(behaviour("A", "bulb 7 nan") + ", " + behaviour("B", "overhear"), "cameras: none\n"));
  EXPECT_THAT(said_by_controllers(trace),
              ElementsAre("Rig/A: gave device 'Bulb' a state that isn't finite at tick 7; it was recorded, but "
                          "the device keeps the one before it"));
}

TEST_F(Lights, AnInfoReachesTheOthersAsACopyAndTheRecord) {
  const Trace trace =
      record_run(with(behaviour("A", "expose 7 0.25") + ", " + behaviour("B", "overhear"), "cameras: none\n"));
  EXPECT_THAT(said_by_controllers(trace),
              ElementsAre("Rig/A: info of device 'Camera': {exposure: 0.25}", "Rig/B: tick 8 exposure 0.25"));
}

/// Commands to devices act after the step in either mode, so a replay in the other mode differs in nothing.
TEST_F(Lights, AreCommandedAtTheSameTimeInNoDelayMode) {
  const Trace late = record_run(with(behaviour("C", "blink 7")));
  const Trace at_once = record_run(with(behaviour("C", "blink 7", ", delay: false")), "at_once.mcap");
  const Comparison compared = compare(late, at_once, {}, {});
  EXPECT_TRUE(compared.equal) << verdict(compared);
  ReplayOptions no_delay;
  no_delay.controllers["Rig/C"] = {"Behaviours", "blink 7", false, false, {}};
  const auto replayed = replay_run(no_delay);
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_TRUE(replayed->equal());
  EXPECT_EQ(replayed->first, std::nullopt);
}

}  // namespace
}  // namespace rehearse
