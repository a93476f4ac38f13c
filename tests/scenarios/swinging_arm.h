// Writes a scenario of an arm that a controller holds: SHOULDER begins at 0.3 rad.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace rehearse::testing {

/// Writes `swing.yaml` and `arm.urdf`. `library`: the controller's; `lines`: more lines of the scenario.
inline void write_swinging_arm(const std::filesystem::path& folder, const std::string& library,
                               const std::string& lines = "") {
  std::ofstream(folder / "arm.urdf")
      << R"(<robot name="arm"><link name="world"/><link name="UPPER"><inertial><origin xyz="0 0 -0.2"/><mass value="1"/>
<inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="SHOULDER" type="continuous"><parent link="world"/><child link="UPPER"/><axis xyz="0 1 0"/></joint></robot>)";
  std::ofstream(folder / "swing.yaml")
      << "rehearse: 1\nduration: 0.5\nbodies:\n  - name: Arm\n    model: arm.urdf\n    joints: {SHOULDER: 0.3}\n"
         "    controllers: [{name: C, library: "
      << library << "}]\n"
      << lines;
}

}  // namespace rehearse::testing
