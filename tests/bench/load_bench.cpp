// The time to load a robot from its file.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <rehearse/urdf.h>

#include <cstdlib>
#include <string>

namespace rehearse {
namespace {

constexpr int links = 100;

/// A chain of links with a mass, a shape to see and one to touch, friction and, every tenth, a sensor; no meshes.
std::string robot_text() {
  std::string text = R"(<robot name="chain"><material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>)";
  for (int i = 0; i < links; ++i) {
    text += fmt::format(R"(
  <link name="link_{0}">
    <inertial>
      <origin xyz="0 0 0.1" rpy="0 0.1 0"/>
      <mass value="1.5"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.004"/>
    </inertial>
    <visual>
      <origin xyz="0 0 0.1"/>
      <geometry><cylinder radius="0.05" length="0.2"/></geometry>
      <material name="grey"/>
    </visual>
    <collision>
      <origin xyz="0 0 0.1"/>
      <geometry><box size="0.1 0.1 0.2"/></geometry>
    </collision>
  </link>
  <gazebo reference="link_{0}"><mu1>0.8</mu1><mu2>0.8</mu2><kp>1e6</kp><kd>10</kd></gazebo>)",
                        i);
    if (i % 10 == 0)
      text += fmt::format(R"(
  <gazebo reference="link_{0}"><sensor name="imu_{0}" type="imu"><pose>0 0 0.1 0 0 0</pose></sensor></gazebo>)",
                          i);
    if (i > 0)
      text += fmt::format(R"(
  <joint name="joint_{0}" type="revolute">
    <origin xyz="0 0 0.2" rpy="0 0 0.1"/>
    <parent link="link_{1}"/>
    <child link="link_{0}"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="100" velocity="3"/>
    <dynamics damping="0.1"/>
  </joint>)",
                          i, i - 1);
  }
  return text + "\n</robot>\n";
}

/// Its budget is 20 ms.
void loading_100_links(benchmark::State& state) {
  const std::string text = robot_text();
  for (auto _ : state) {
    const Result<Model> model = parse_urdf(text, "chain.urdf", {.strict = true});
    if (!model || model->links.size() != links || !model->report.empty()) std::abort();
    benchmark::DoNotOptimize(model);
  }
}
BENCHMARK(loading_100_links)->MinTime(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
