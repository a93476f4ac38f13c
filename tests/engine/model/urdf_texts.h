// Small URDF texts for the loader's tests.
#pragma once

#include <rehearse/urdf.h>

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace rehearse {

inline constexpr const char* some_inertial =
    "<inertial><mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1.5'/></inertial>";

inline std::string robot(const std::string& content) { return "<robot name='test'>" + content + "</robot>"; }

/// One link, fixed to the world.
inline std::string still(const std::string& content) { return robot("<link name='world'>" + content + "</link>"); }

inline std::string link(const std::string& name, const std::string& content = some_inertial) {
  return "<link name='" + name + "'>" + content + "</link>";
}

inline std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                         const std::string& child, const std::string& content = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child + "'/>" +
         content + "</joint>";
}

inline std::string block(const std::string& reference, const std::string& content) {
  return "<gazebo reference='" + reference + "'>" + content + "</gazebo>";
}

/// The model; throws, and so fails the test, if it can't be loaded.
inline Model load(const std::string& text, const UrdfOptions& options = {}) {
  Result<Model> result = parse_urdf(text, "test.urdf", options);
  if (!result) throw std::runtime_error(to_string(result.errors()));
  return std::move(*result);
}

/// The messages of a text that must be refused.
inline std::string refusal(const std::string& text) {
  const Result<Model> result = parse_urdf(text, "test.urdf");
  if (result) {
    ADD_FAILURE() << "it was accepted";
    return {};
  }
  return to_string(result.errors());
}

}  // namespace rehearse
