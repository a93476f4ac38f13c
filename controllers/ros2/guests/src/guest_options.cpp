#include "guest_options.h"

#include <algorithm>

namespace rehearse::ros2 {
namespace {

struct PartRow {
  const char* name;
  TopicBinding::Part part;
};
constexpr PartRow parts[] = {{"joint_states", TopicBinding::Part::joint_states},
                             {"imu", TopicBinding::Part::imu},
                             {"efforts", TopicBinding::Part::efforts},
                             {"velocities", TopicBinding::Part::velocities},
                             {"positions", TopicBinding::Part::positions}};

struct DeedRow {
  const char* name;
  GuestEvent::Deed deed;
  const char* content;  // the key of its content; null: it has none
};
constexpr DeedRow deeds[] = {{"publish", GuestEvent::Deed::publish, "message"},
                             {"call", GuestEvent::Deed::call, "request"},
                             {"goal", GuestEvent::Deed::goal, "message"},
                             {"set_parameters", GuestEvent::Deed::set_parameters, nullptr},
                             {"transition", GuestEvent::Deed::transition, nullptr},
                             {"activate", GuestEvent::Deed::switch_controllers, nullptr},
                             {"deactivate", GuestEvent::Deed::switch_controllers, nullptr}};

std::string text_of(const YAML::Node& node, const std::string& what) {
  if (!node.IsScalar()) throw mistake(node, what + " is a text");
  return node.Scalar();
}

std::vector<std::string> texts_of(const YAML::Node& node, const std::string& what) {
  std::vector<std::string> texts;
  if (!node.IsSequence()) throw mistake(node, what + " is a list");
  for (const YAML::Node& element : node) texts.push_back(text_of(element, "an element of " + what));
  return texts;
}

template <class Rows>
const auto& row_of(const Rows& rows, const YAML::Node& node, const std::string& name) {
  std::string all;
  for (const auto& row : rows) {
    if (name == row.name) return row;
    all += (all.empty() ? "" : ", ") + std::string(row.name);
  }
  throw mistake(node, "'" + name + "' isn't known here; expected " + all);
}

TopicBinding read_topic(const YAML::Node& topic, const YAML::Node& value) {
  TopicBinding binding;
  binding.topic = text_of(topic, "a topic");
  binding.place = topic;
  if (binding.topic.empty() || binding.topic[0] != '/')
    throw mistake(topic, "the topic '" + binding.topic + "' doesn't begin with '/'");
  if (value.IsScalar()) {
    binding.part = row_of(parts, value, value.Scalar()).part;
  } else if (value.IsMap() && value.size() == 1) {
    const auto entry = *value.begin();
    binding.part = row_of(parts, entry.first, entry.first.Scalar()).part;
    binding.names = texts_of(entry.second, "'" + entry.first.Scalar() + "'");
  } else {
    throw mistake(value, "expected a part of the robot, or PART: [NAME, ...]");
  }
  if (binding.part == TopicBinding::Part::imu && binding.names.empty())
    throw mistake(value, "expected the devices: {imu: [GYRO, ACCELEROMETER]}");
  return binding;
}

void add_parameters(const YAML::Node& map, const std::string& prefix, ParameterTexts& parameters) {
  if (!map.IsMap()) throw mistake(map, "parameters are a map of names and values");
  for (const auto& entry : map) {
    const std::string name = prefix + entry.first.Scalar();
    if (entry.second.IsMap()) {
      add_parameters(entry.second, name + ".", parameters);
      continue;
    }
    YAML::Emitter text;
    text << YAML::Flow << entry.second;
    parameters.emplace_back(name, text.c_str());
  }
}

constexpr const char* one_deed =
    "an event is one of publish, call, goal, set_parameters, transition, activate with deactivate";

bool is_content(const std::string& key) {
  return std::any_of(std::begin(deeds), std::end(deeds),
                     [&](const DeedRow& row) { return row.content != nullptr && key == row.content; });
}

GuestEvent read_event(const YAML::Node& node) {
  if (!node.IsMap() || !node["at"]) throw mistake(node, "expected an event with its time, as {at: 0.5, ...}");
  GuestEvent event;
  event.place = node;
  try {
    event.at = node["at"].as<double>();
  } catch (const YAML::Exception&) {
    throw mistake(node["at"], "'at' is a time in seconds");
  }
  const DeedRow* deed = nullptr;
  for (const auto& entry : node) {
    const std::string name = entry.first.Scalar();
    if (name == "at" || name == "strictness" || is_content(name)) continue;
    const DeedRow& row = row_of(deeds, entry.first, name);
    const bool is_switch = row.deed == GuestEvent::Deed::switch_controllers;
    if (deed != nullptr && !(is_switch && deed->deed == row.deed)) throw mistake(entry.first, one_deed);
    deed = &row;
    event.deed = deed->deed;
    if (is_switch)
      (name == "activate" ? event.activate : event.deactivate) = texts_of(entry.second, "'" + name + "'");
    else if (deed->deed == GuestEvent::Deed::set_parameters)
      add_parameters(entry.second, "", event.parameters);
    else
      event.target = text_of(entry.second, "'" + name + "'");
  }
  if (deed == nullptr) throw mistake(node, one_deed);
  for (const auto& entry : node) {
    const std::string name = entry.first.Scalar();
    if (!is_content(name)) continue;
    if (deed->content == nullptr || name != deed->content)
      throw mistake(entry.first, "'" + name + "' doesn't belong to '" + deed->name + "'");
    event.content = entry.second;
  }
  if (const YAML::Node strictness = node["strictness"]) {
    const std::string value = text_of(strictness, "'strictness'");
    if (event.deed != GuestEvent::Deed::switch_controllers)
      throw mistake(strictness, "'strictness' belongs to activate and deactivate");
    if (value != "strict" && value != "best_effort")
      throw mistake(strictness, "'" + value + "' isn't known here; expected best_effort, strict");
    event.is_strict = value == "strict";
  }
  return event;
}

}  // namespace

GuestOptions read_guest_options(const std::string& text) {
  GuestOptions options;
  YAML::Node root;
  try {
    // The host puts a space between the options of a run and these.
    root = YAML::Load(text.substr(std::min(text.find_first_not_of(' '), text.size())));
  } catch (const YAML::Exception& problem) {
    throw OptionsError("options, line " + std::to_string(problem.mark.line + 1) + ": " + problem.msg);
  }
  if (root.IsNull()) return options;
  if (!root.IsMap()) throw mistake(root, "expected keys, as topics: {/joint_states: joint_states}");
  for (const auto& entry : root) {
    const std::string key = entry.first.Scalar();
    const YAML::Node& value = entry.second;
    if (key == "arguments") {
      options.arguments = texts_of(value, "'arguments'");
    } else if (key == "parameters") {
      if (value.IsMap())
        add_parameters(value, "", options.parameters);
      else if (value.IsScalar())
        options.parameter_files.push_back(value.Scalar());
      else
        options.parameter_files = texts_of(value, "'parameters'");
    } else if (key == "description") {
      options.description = text_of(value, "'description'");
      options.place_of_controllers = entry.first;
    } else if (key == "controllers") {
      options.controllers = texts_of(value, "'controllers'");
      options.place_of_controllers = entry.first;
    } else if (key == "topics") {
      if (!value.IsMap()) throw mistake(value, "'topics' is a map of topics and parts of the robot");
      for (const auto& topic : value) options.topics.push_back(read_topic(topic.first, topic.second));
    } else if (key == "events") {
      if (!value.IsSequence()) throw mistake(value, "'events' is a list");
      for (const YAML::Node& event : value) options.events.push_back(read_event(event));
    } else if (key == "lifecycle") {
      const std::string state = text_of(value, "'lifecycle'");
      if (state != "active" && state != "inactive" && state != "unconfigured")
        throw mistake(value, "'" + state + "' isn't known here; expected active, inactive, unconfigured");
      options.configures = state != "unconfigured";
      options.activates = state == "active";
    } else {
      throw mistake(entry.first, "'" + key +
                                     "' isn't known here; expected arguments, controllers, description, events, "
                                     "lifecycle, parameters, topics");
    }
  }
  options.events.sort([](const GuestEvent& one, const GuestEvent& other) { return one.at < other.at; });
  return options;
}

}  // namespace rehearse::ros2
