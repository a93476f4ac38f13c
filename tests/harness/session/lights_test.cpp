// Lights in the closed loop: what controllers find, what cameras see, and what comes of a controller's word to them.

#include <rehearse/mcap.h>
#include <rehearse/png.h>

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
    return "rehearse: 1\nduration: 0.03\n" + more +
           "bodies:\n  - name: Rig\n    model: rig.urdf\n    controllers: [" + controllers + "]\n";
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

}  // namespace
}  // namespace rehearse
