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

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("data", self.data);
  }
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

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("stamp", self.stamp);
    visit("level", self.level);
    visit("name", self.name);
    visit("msg", self.msg);
    visit("file", self.file);
    visit("function", self.function);
    visit("line", self.line);
  }
};

struct Duration {
  static constexpr std::string_view type_name = "builtin_interfaces/msg/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("sec", self.sec);
    visit("nanosec", self.nanosec);
  }
};

struct ColorRGBA {
  static constexpr std::string_view type_name = "std_msgs/msg/ColorRGBA";
  float r = 0.0F, g = 0.0F, b = 0.0F, a = 1.0F;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("r", self.r);
    visit("g", self.g);
    visit("b", self.b);
    visit("a", self.a);
  }
};

struct UVCoordinate {
  static constexpr std::string_view type_name = "visualization_msgs/msg/UVCoordinate";
  float u = 0.0F, v = 0.0F;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("u", self.u);
    visit("v", self.v);
  }
};

struct MeshFile {
  static constexpr std::string_view type_name = "visualization_msgs/msg/MeshFile";
  std::string filename;
  std::vector<std::uint8_t> data;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("filename", self.filename);
    visit("data", self.data);
  }
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

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("ns", self.ns);
    visit("id", self.id);
    visit("type", self.type);
    visit("action", self.action);
    visit("pose", self.pose);
    visit("scale", self.scale);
    visit("color", self.color);
    visit("lifetime", self.lifetime);
    visit("frame_locked", self.frame_locked);
    visit("points", self.points);
    visit("colors", self.colors);
    visit("texture_resource", self.texture_resource);
    visit("texture", self.texture);
    visit("uv_coordinates", self.uv_coordinates);
    visit("text", self.text);
    visit("mesh_resource", self.mesh_resource);
    visit("mesh_file", self.mesh_file);
    visit("mesh_use_embedded_materials", self.mesh_use_embedded_materials);
  }
};

struct MarkerArray {
  static constexpr std::string_view type_name = "visualization_msgs/msg/MarkerArray";
  std::vector<Marker> markers;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("markers", self.markers);
  }
};

}  // namespace rehearse::msg
