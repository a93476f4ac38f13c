// The options of a guest: what of the robot is which topic, parameters, and what happens when.
#pragma once

#include <yaml-cpp/yaml.h>

#include <list>
#include <string>
#include <utility>
#include <vector>

#include "message_values.h"

namespace rehearse::ros2 {

/// A topic that is a part of the robot.
struct TopicBinding {
  enum class Part { joint_states, imu, efforts, velocities, positions };
  std::string topic;
  Part part = Part::joint_states;
  std::vector<std::string> names;  // of joints or devices; empty: all joints
  YAML::Node place;
};

/// Names and values, as texts of YAML.
using ParameterTexts = std::vector<std::pair<std::string, std::string>>;

struct GuestEvent {
  enum class Deed { publish, call, goal, set_parameters, transition, switch_controllers };
  double at = 0.0;  // [s]
  Deed deed = Deed::publish;
  std::string target;  // the topic, the service, the action or the transition
  YAML::Node content;  // the fields of the message or the request; null: none
  ParameterTexts parameters;
  std::vector<std::string> activate, deactivate;  // controllers
  bool is_strict = true;                          // all or nothing of these
  YAML::Node place;
};

struct GuestOptions {
  std::vector<std::string> arguments;  // of the node, as on its command line
  ParameterTexts parameters;
  std::vector<std::string> parameter_files;
  std::string description;               // of a robot's controllers: a file of URDF
  std::vector<std::string> controllers;  // that are active from the beginning
  YAML::Node place_of_controllers;       // null: a node needs none
  std::vector<TopicBinding> topics;
  /// By time. A list, because its sort() assigns no nodes of YAML: an assignment changes what other nodes refer to.
  std::list<GuestEvent> events;
  bool configures = true, activates = true;  // a lifecycle node, when the run begins
};

/// Throws OptionsError.
GuestOptions read_guest_options(const std::string& text);

}  // namespace rehearse::ros2
