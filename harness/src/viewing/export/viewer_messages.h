// Messages that only exports for viewers have, with the names and fields of ROS 2.
#pragma once

#include <rehearse/messages.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::msg {

struct String {
  static constexpr std::string_view type_name = "std_msgs/msg/String";
  std::string data;
  REHEARSE_FIELDS(data)
};

struct Log {
  static constexpr std::string_view type_name = "rcl_interfaces/msg/Log";
  static constexpr std::uint8_t info = 20, warn = 30, error = 40;
  Time stamp;
  std::uint8_t level = info;
  std::string name;
  std::string msg;
  std::string file;
  std::string function;
  std::uint32_t line = 0;
  REHEARSE_FIELDS(stamp, level, name, msg, file, function, line)
};

struct Duration {
  static constexpr std::string_view type_name = "builtin_interfaces/msg/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  REHEARSE_FIELDS(sec, nanosec)
};

struct ColorRGBA {
  static constexpr std::string_view type_name = "std_msgs/msg/ColorRGBA";
  float r = 0.0F, g = 0.0F, b = 0.0F, a = 1.0F;
  REHEARSE_FIELDS(r, g, b, a)
};

struct UVCoordinate {
  static constexpr std::string_view type_name = "visualization_msgs/msg/UVCoordinate";
  float u = 0.0F, v = 0.0F;
  REHEARSE_FIELDS(u, v)
};

struct MeshFile {
  static constexpr std::string_view type_name = "visualization_msgs/msg/MeshFile";
  std::string filename;
  std::vector<std::uint8_t> data;
  REHEARSE_FIELDS(filename, data)
};

struct Marker {
  static constexpr std::string_view type_name = "visualization_msgs/msg/Marker";
  static constexpr std::int32_t arrow = 0, delete_all = 3;
  Header header;
  std::string ns;
  std::int32_t id = 0;
  std::int32_t type = arrow;
  std::int32_t action = 0;
  Pose pose;
  Vector3 scale;
  ColorRGBA color;
  Duration lifetime;
  bool frame_locked = false;
  std::vector<Point> points;
  std::vector<ColorRGBA> colors;
  std::string texture_resource;
  CompressedImage texture;
  std::vector<UVCoordinate> uv_coordinates;
  std::string text;
  std::string mesh_resource;
  MeshFile mesh_file;
  bool mesh_use_embedded_materials = false;
  REHEARSE_FIELDS(header, ns, id, type, action, pose, scale, color, lifetime, frame_locked, points, colors,
                  texture_resource, texture, uv_coordinates, text, mesh_resource, mesh_file,
                  mesh_use_embedded_materials)
};

struct MarkerArray {
  static constexpr std::string_view type_name = "visualization_msgs/msg/MarkerArray";
  std::vector<Marker> markers;
  REHEARSE_FIELDS(markers)
};

}  // namespace rehearse::msg
