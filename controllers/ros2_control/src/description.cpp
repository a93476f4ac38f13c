#include "description.h"

#include <tinyxml2.h>

#include <cctype>
#include <stdexcept>

namespace rehearse_ros2_control {
namespace {

constexpr const char* kinds[] = {"actuator", "sensor", "system"};

std::runtime_error problem_at(const std::string& file, int line, const std::string& text) {
  return std::runtime_error(file + ", line " + std::to_string(line) + ": " + text);
}

/// The name of the component: of the kind "system" rehearse_ros2_control/System.
std::string component_of(const std::string& file, const tinyxml2::XMLElement& control) {
  const char* const type = control.Attribute("type");
  for (const char* kind : kinds) {
    if (type == nullptr || std::string(kind) != type) continue;
    std::string name = kind;
    name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    return "rehearse_ros2_control/" + name;
  }
  throw problem_at(file, control.GetLineNum(), "the type of <ros2_control> is actuator, sensor or system");
}

tinyxml2::XMLElement& child_of(tinyxml2::XMLElement& parent, const char* name) {
  if (tinyxml2::XMLElement* const child = parent.FirstChildElement(name)) return *child;
  return *parent.InsertNewChildElement(name);
}

}  // namespace

std::string read_description(const std::string& file) {
  if (file.empty()) throw std::runtime_error("the options have no 'description': a file of URDF with <ros2_control>");
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS)
    throw std::runtime_error("the description '" + file + "' can't be read: " + document.ErrorStr());
  tinyxml2::XMLElement* const robot = document.FirstChildElement("robot");
  tinyxml2::XMLElement* control = robot == nullptr ? nullptr : robot->FirstChildElement("ros2_control");
  if (control == nullptr) throw std::runtime_error("the description '" + file + "' has no <ros2_control>");
  for (; control != nullptr; control = control->NextSiblingElement("ros2_control"))
    child_of(child_of(*control, "hardware"), "plugin").SetText(component_of(file, *control).c_str());
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace rehearse_ros2_control
