// Rotors and holders under controllers. Each run is also repeated from its recorded commands (record_run).

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

constexpr const char* drone_urdf = R"(<?xml version="1.0"?>
<robot name="Drone">
  <link name="HULL">
    <inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <gazebo reference="HULL">
    <rotor name="R"/>
    <holder name="H"><max_distance>0.5</max_distance></holder>
  </gazebo>
</robot>
)";

class ActingDevices : public RunTest {
 protected:
  ActingDevices() { write("drone.urdf", drone_urdf); }

  static std::string drone(const std::string& controllers, const std::string& more = "") {
    return "rehearse: 1\nduration: 0.2\nbodies:\n  - {name: Drone, model: drone.urdf, position: [0, 0, 2], "
           "controllers: [" +
           controllers + "]}\n" + more;
  }
};

TEST_F(ActingDevices, ARotorOfThrustMgHoversThenClimbs) {
  const Trace trace = record_run(drone(behaviour("C", "fly R 19.6133 99 21.6133", ", delay: false")));
  // the command acts from the tick after the first on: a fall of one step
  EXPECT_NEAR(trace.values("Drone/HULL/linear/z")[100], -0.0098, 1e-4);
  EXPECT_NEAR(trace.last("Drone/HULL/linear/z"), -0.0098 + 0.1, 2e-3);  // 1 m/s² for 0.1 s
  const auto replayed = replay_run();
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_EQ(replayed->values_different, 0);
}

TEST_F(ActingDevices, AHolderTakesWhatIsNearAndIsAnEvent) {
  const Trace trace =
      record_run(drone(behaviour("C", "hold H 10 150") + ", " + behaviour("D", "fly R 29.41995 500 0"),
                       "  - {name: Box, box: {size: [0.1, 0.1, 0.1]}, mass: 1, position: [0, 0, 1.7]}\n"));
  const std::vector<double> drone_z = trace.values("Drone/HULL/position/z"), box_z = trace.values("Box/Box/position/z");
  EXPECT_NEAR(drone_z[140] - box_z[140], drone_z[20] - box_z[20], 1e-4);
  EXPECT_GT(drone_z[200] - box_z[200], drone_z[140] - box_z[140] + 0.005);
  EXPECT_THAT(said(trace), ::testing::Contains(HasSubstr("world: holder 'Drone/H' took hold of 'Box/Box'")));
  EXPECT_THAT(said(trace), ::testing::Contains(HasSubstr("world: holder 'Drone/H' let go of 'Box/Box'")));
  EXPECT_TRUE(summary_.remarks.empty());
}

}  // namespace
}  // namespace rehearse
