// Writes the log of a tank: joints and IMU at 500 Hz, JPEG pictures of 640 x 480 at 30 Hz, scans of 1080 beams at 40
// Hz; and, if it is asked for, the commands of TankController.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/controller_bench.h>
#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "../jpeg_file.h"

namespace rehearse::test {

/// A picture with edges and noise, as of a room; its size as a JPEG is about 60 kB.
inline std::vector<std::uint8_t> jpeg_picture(int number) {
  constexpr unsigned width = 640, height = 480;
  std::vector<std::uint8_t> pixels;
  std::uint32_t noise = static_cast<std::uint32_t>(number) * 2654435761u + 1;
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x) {
      noise = noise * 1664525u + 1013904223u;
      const unsigned wall = (x + static_cast<unsigned>(number)) / 40 % 2 * 90 + y / 4;
      for (unsigned c = 0; c < 3; ++c) pixels.push_back(static_cast<std::uint8_t>(wall + (noise >> 29) + c * 10));
    }
  return jpeg_file(width, height, pixels, 85);
}

inline BenchOptions bench_options(const msg::JointState& joints) {
  BenchOptions options;
  options.time_step = 0.002;
  for (std::size_t i = 0; i < joints.name.size(); ++i) options.joints[joints.name[i]] = joints.position[i];
  return options;
}

/// The controller's command for these inputs.
inline msg::JointState command_of(ControllerBench& bench, const msg::JointState& joints) {
  msg::JointState command;
  command.name = joints.name;
  for (std::size_t i = 0; i < joints.name.size(); ++i) {
    bench.joint(joints.name[i]).q = joints.position[i];
    bench.joint(joints.name[i]).dq = joints.velocity[i];
  }
  bench.tick();
  for (const std::string& joint : joints.name) {
    command.velocity.push_back(bench.joint(joint).dq_target);
    command.effort.push_back(bench.joint(joint).u);
  }
  return command;
}

/// Writes `log.mcap`, `map.yaml` and `robot.urdf` into a folder. `tank`: the URDF of the tank, which gets an IMU, a
/// laser and a camera. `with_commands`: the log also has those of TankController, and the map names them.
inline void write_long_log(const std::filesystem::path& folder, const std::filesystem::path& tank, double seconds,
                           bool with_commands = false) {
  std::ifstream stream(tank);
  std::string urdf{std::istreambuf_iterator<char>(stream), {}};
  urdf.replace(urdf.rfind("</robot>"), std::string::npos, R"(  <gazebo reference="CHASSIS">
    <sensor name="Imu" type="imu"/>
    <sensor name="Front" type="camera">
      <update_rate>30</update_rate><camera><image><width>640</width><height>480</height></image></camera>
    </sensor>
    <sensor name="Laser" type="ray">
      <update_rate>40</update_rate>
      <ray>
        <scan><horizontal><samples>1080</samples><min_angle>-2.3</min_angle><max_angle>2.3</max_angle></horizontal></scan>
        <range><min>0.1</min><max>30</max></range>
      </ray>
    </sensor>
  </gazebo>
</robot>
)");
  std::ofstream(folder / "robot.urdf") << urdf;
  std::ofstream(folder / "map.yaml")
      << "rehearse_map: 1\ntime_step: 0.002\ntick: /joint_states\njoints: /joint_states\n"
         "imus: {topic: /imu, device: Imu}\nranges: {topic: /scan, device: Laser}\n"
         "cameras: {topic: /camera/compressed, device: Front}\njoystick: /joy\n"
      << (with_commands ? "commands: /joint_commands\nstart: first\nbegins: controller\n" : "");
  const auto writer = mcap::Writer::create(folder / "log.mcap");
  REHEARSE_ASSERT(writer.ok(), "the log can be written");
  CdrWriter cdr;
  const auto channel = [&]<class T>(const T&, const char* topic, mcap::ChunkGroup group = mcap::numbers) {
    const auto schema = (*writer)->add_schema(T::type_name, "ros2msg", msg::schema_text<T>());
    return (*writer)->add_channel(schema, topic, "cdr", {}, group);
  };
  msg::JointState joints;
  joints.name = {"TRACK_L", "TRACK_R", "TURRET_Y", "TURRET_P"};
  msg::Imu imu;
  msg::LaserScan scan;
  scan.angle_min = -2.3f;
  scan.angle_increment = 4.6f / 1079;
  scan.range_min = 0.1f;
  scan.range_max = 30.0f;
  scan.ranges.resize(1080);
  msg::CompressedImage image;
  image.format = "jpeg";
  std::vector<std::vector<std::uint8_t>> pictures;
  for (int i = 0; i < 60; ++i) pictures.push_back(jpeg_picture(i));
  msg::Joy joy;
  joy.axes.resize(8);
  joy.buttons.resize(11);
  const auto of_joints = channel(joints, "/joint_states"), of_imu = channel(imu, "/imu"),
             of_scan = channel(scan, "/scan"), of_image = channel(image, "/camera/compressed", mcap::pictures),
             of_joy = channel(joy, "/joy");
  const auto of_commands = with_commands ? channel(joints, "/joint_commands") : of_joints;
  const auto put = [&](std::uint16_t id, auto& message, std::int64_t time) {
    message.header.stamp = msg::Time::from_ns(static_cast<std::uint64_t>(time));
    cdr.reset();
    msg::encode(message, cdr);
    const auto written =
        (*writer)->write(id, static_cast<std::uint64_t>(time), static_cast<std::uint64_t>(time), cdr.bytes());
    REHEARSE_ASSERT(written.ok(), "the log can be written");
  };
  constexpr std::int64_t latency = 500'000;  // [ns]
  std::optional<ControllerBench> bench;
  constexpr std::int64_t start = 1'763'640'000'000'000'000, step = 2'000'000;  // [ns]
  const auto ticks = static_cast<std::int64_t>(seconds * 500.0);
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const double t = static_cast<double>(tick) * 0.002;
    const std::int64_t time = start + tick * step;
    joints.position = {t, 1.1 * t, std::sin(t), 0.1 * std::cos(3 * t)};
    joints.velocity = {1.0, 1.1, std::cos(t), -0.3 * std::sin(3 * t)};
    joints.effort = {std::sin(7 * t), std::cos(5 * t), 0.1 * std::sin(11 * t), 0.0};
    put(of_joints, joints, time);
    if (with_commands) {
      if (!bench) bench.emplace("TankController", (folder / "robot.urdf").string(), bench_options(joints));
      msg::JointState commands = command_of(*bench, joints);
      put(of_commands, commands, time + latency);
    }
    imu.angular_velocity = {0.01 * std::sin(17 * t), 0.01 * std::cos(13 * t), 0.1};
    imu.linear_acceleration = {std::sin(19 * t), std::cos(23 * t), 9.8};
    put(of_imu, imu, time);
    if (tick * 30 / 500 != (tick - 1) * 30 / 500) {
      image.data = pictures[static_cast<std::size_t>(tick * 30 / 500) % pictures.size()];
      put(of_image, image, time);
    }
    if (tick * 40 / 500 != (tick - 1) * 40 / 500) {
      for (std::size_t i = 0; i < scan.ranges.size(); ++i)
        scan.ranges[i] = 5.0f + static_cast<float>(std::sin(t + 0.01 * static_cast<double>(i)));
      put(of_scan, scan, time);
    }
    if (tick % 10 == 0) put(of_joy, joy, time);
  }
  REHEARSE_ASSERT((*writer)->close().ok(), "the log can be written");
}

}  // namespace rehearse::test
