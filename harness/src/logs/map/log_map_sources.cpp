// The sources of a map: joints, joystick, root link, and the commands to compare with; log_map_devices.cpp has those of
// devices.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/names.h"
#include "log_map_parts.h"
#include "map_forms.h"

namespace rehearse {
namespace {

using enum FieldContent;

std::vector<std::string> joint_names(const Model& model) {
  std::vector<std::string> names;
  for (const int link : model.joints) names.push_back(model.links[link].joint.name);
  return names;
}

/// The fields of the types that name joints: JointState, JointTrajectory, DynamicJointState and
/// JointTrajectoryControllerState in both of its versions.
std::vector<std::vector<std::pair<std::string, FieldContent>>> joint_messages() {
  return {{{"name/*", text}, {"position/*", number}},
          {{"name/*", text}, {"velocity/*", number}},
          {{"name/*", text}, {"effort/*", number}},
          {{"joint_names/*", text}, {"points/*/positions/*", number}},
          {{"joint_names/*", text}, {"interface_values/*/values/*", number}},
          {{"joint_names/*", text}, {"feedback/positions/*", number}},
          {{"joint_names/*", text}, {"actual/positions/*", number}}};
}

}  // namespace

const LogTopic* LogMapReader::find_topic(const YamlNode& node, std::string_view label, const std::vector<Needs>& needs,
                                         std::string_view what, LogSource& source) {
  const auto fits = [&needs](const LogTopic& topic) {
    return topic.problem.empty() && std::ranges::any_of(needs, [&topic](const Needs& all) {
             return std::ranges::all_of(all, [&](const auto& need) { return topic.has(need.first, need.second); });
           });
  };
  const auto name = read_text(findings_, node, label, name_of_topic);
  if (!name) return nullptr;
  source.topic = *name;
  source.place = {map_.file, node.line, node.column};
  std::vector<std::string> all, fitting;
  const LogTopic* found = nullptr;
  for (const LogTopic& topic : topics_) {
    if (topic.name == *name) found = &topic;
    all.push_back(topic.name);
    if (fits(topic)) fitting.push_back(fmt::format("{} ({})", topic.name, topic.type));
  }
  const std::string there_are = fitting.empty() ? fmt::format("the log has none with {}", what)
                                                : fmt::format("with {} there are: {}", what, fmt::join(fitting, ", "));
  if (found == nullptr) {
    findings_.error(node, fmt::format("the log has no topic '{}'", shortened(*name)),
                    near_names(*name, all).empty() ? there_are : name_hint(*name, all, "topics"));
    return nullptr;
  }
  if (!found->problem.empty()) {
    findings_.error(node, fmt::format("the messages on '{}' can't be read: {}", shortened(*name), found->problem),
                    there_are);
    return nullptr;
  }
  if (!fits(*found)) {
    findings_.error(node, fmt::format("'{}' is of type {}, which isn't {}", shortened(*name), found->type, what),
                    there_are);
    return nullptr;
  }
  check_clock(node, *found, source);
  return found;
}

void LogMapReader::check_clock(const YamlNode& node, const LogTopic& topic, const LogSource& source) {
  const bool has_stamp = topic.has("header/stamp/sec") && topic.has("header/stamp/nanosec");
  if (source.clock == LogClock::header_stamp && !has_stamp)
    findings_.error(node,
                    fmt::format("'{}' is of type {}, which has no header.stamp", shortened(topic.name), topic.type),
                    "expected clock: log_time, which every message has");
  const auto [first, is_new] = clocks_.emplace(topic.name, std::pair(source.clock, node.line));
  if (!is_new && first->second.first != source.clock)
    findings_.error(node, fmt::format("'{}' has a different clock here", shortened(topic.name)),
                    fmt::format("expected the clock of line {}", first->second.second));
}

std::optional<Keys> LogMapReader::keys_of(const YamlNode& node, const Form& form) {
  if (node.kind == YamlNode::Kind::scalar) return std::nullopt;
  return std::optional<Keys>(std::in_place, findings_, node, form);
}

std::optional<int> LogMapReader::read_joint(const YamlNode& node) {
  const auto name = read_text(findings_, node, "a joint", "the name of a joint of the model");
  if (!name) return std::nullopt;
  for (std::size_t id = 0; id < model_.joints.size(); ++id)
    if (model_.links[model_.joints[id]].joint.name == *name) return static_cast<int>(id);
  const int link = model_.find_joint(*name);
  if (link >= 0 && model_.links[link].joint.name == *name) {
    findings_.error(node, fmt::format("the joint '{}' doesn't move", shortened(*name)),
                    fmt::format("it is {} in the model", type_name(model_.links[link].joint.type)));
  } else {
    findings_.error(node, fmt::format("the model {} has no joint '{}'", model_.name, shortened(*name)),
                    name_hint(*name, joint_names(model_), "joints"));
  }
  return std::nullopt;
}

void LogMapReader::read_names(const YamlNode& node, std::map<std::string, JointRename>& names) {
  if (node.kind != YamlNode::Kind::map)
    return expected(findings_, node, "names", "a map from the log's names to the model's: {l_knee: LLEG_KNEE}");
  std::map<int, std::string> taken;  // by joint
  for (const NamedEntry& entry : read_entries(findings_, node)) {
    JointRename rename;
    std::optional<int> joint;
    if (entry.value->kind == YamlNode::Kind::map) {
      const Keys keys(findings_, *entry.value, joint_rename_form());
      bound_joint_rename_form().read(keys, rename);
      if (const YamlNode* scale = keys.find("scale"); scale != nullptr && rename.scale == 0.0)
        findings_.error(*scale, "scale is 0", "expected the model's displacement per unit of the log's, as -1");
      if (const YamlNode* offset = keys.find("offset"))
        rename.offset = read_angle(findings_, *offset, "offset").value_or(0.0);
      if (const YamlNode* name = keys.require("joint", "the name of a joint of the model")) joint = read_joint(*name);
    } else {
      joint = read_joint(*entry.value);
    }
    if (!joint) continue;
    rename.joint = *joint;
    rename.place = {map_.file, entry.key->line, entry.key->column};
    const auto [first, is_new] = taken.emplace(*joint, entry.name);
    if (!is_new)
      findings_.error(*entry.value,
                      fmt::format("'{}' and '{}' are the same joint", shortened(first->second), shortened(entry.name)),
                      "expected a joint of its own for each");
    names.emplace(entry.name, rename);
  }
}

void LogMapReader::read_joints(const YamlNode& node) {
  const std::optional<Keys> keys = keys_of(node, joint_source_form());
  if (keys && !keys->is_map()) return;
  JointSource source;
  read_source(bound_joint_source_form(), keys ? &*keys : nullptr, source, max_age_of_numbers);
  if (keys) {
    if (const YamlNode* names = keys->find("names")) read_names(*names, source.names);
  }
  const YamlNode* topic = keys ? keys->require("topic", name_of_topic) : &node;
  if (topic == nullptr) return;
  const LogTopic* found =
      find_topic(*topic, "joints", joint_messages(), "a JointState or another type with joints' names", source);
  if (found == nullptr) return;
  if (source.differentiate && found->has("name/*", text) && !found->has("position/*"))
    findings_.error(*topic, fmt::format("'{}' has no positions to differentiate", source.topic),
                    "expected velocity: message");
  if (!joint_topics_.insert(source.topic).second)
    findings_.error(*topic, fmt::format("'{}' is a source of joints twice", source.topic), "name it once");
  map_.joints.push_back(std::move(source));
}

void LogMapReader::read_root(const YamlNode& node) {
  const std::optional<Keys> keys = keys_of(node, root_source_form());
  if (keys && !keys->is_map()) return;
  RootSource source;
  read_source(bound_root_source_form(), keys ? &*keys : nullptr, source, max_age_of_numbers);
  const auto pose_at = [](const std::string& path) {
    Needs needs;
    for (const char* axis : {"x", "y", "z"}) needs.emplace_back(path + "/position/" + axis, number);
    for (const char* axis : {"x", "y", "z", "w"}) needs.emplace_back(path + "/orientation/" + axis, number);
    return needs;
  };
  const YamlNode* topic = keys ? keys->require("topic", name_of_topic) : &node;
  if (topic == nullptr) return;
  const Needs transforms{{"transforms/*/child_frame_id", text}, {"transforms/*/transform/rotation/w", number}};
  const LogTopic* found = find_topic(*topic, "root", {pose_at("pose"), pose_at("pose/pose"), transforms},
                                     "a PoseStamped, Odometry or TFMessage", source);
  if (found == nullptr) return;
  const YamlNode* frame = keys ? keys->find("frame") : nullptr;
  if (found->has("transforms/*/child_frame_id", text)) {
    source.frame = frame ? read_text(findings_, *frame, "frame", "the name of the root link's frame").value_or("")
                         : model_.links[0].name;
  } else if (frame) {
    findings_.error(*frame, fmt::format("'frame' is given for '{}', which isn't a TFMessage", source.topic),
                    "it is for /tf: the child frame of the transform");
  }
  source.has_covariance = found->has("pose/pose/position/x");
  source.has_twist = source.has_covariance && found->has("twist/twist/linear/x");
  map_.root = std::move(source);
}

void LogMapReader::read_axes(const YamlNode& node, JoySource& source) {
  if (node.kind != YamlNode::Kind::map)
    return expected(findings_, node, "axes", "a map from names to numbers in the message: {L_STICK_V: 1}");
  source.axes.fill({});
  for (const NamedEntry& entry : read_entries(findings_, node)) {
    const auto axis = find_control(joystick_axes, entry.name);
    if (!axis) {
      findings_.error(*entry.key, fmt::format("there is no axis '{}'", shortened(entry.name)),
                      name_hint(entry.name, {joystick_axes.begin(), joystick_axes.end()}, "axes"));
      continue;
    }
    const YamlNode* index = entry.value;
    if (entry.value->kind == YamlNode::Kind::map) {
      const Keys keys(findings_, *entry.value, axis_source_form());
      bound_axis_source_form().read(keys, source.axes[*axis]);
      index = keys.require("index", "its number in the message");
    }
    if (index != nullptr)
      source.axes[*axis].index = static_cast<int>(read_integer(findings_, *index, entry.name, 0, 255).value_or(-1));
  }
}

void LogMapReader::read_buttons(const YamlNode& node, JoySource& source) {
  if (node.kind != YamlNode::Kind::map)
    return expected(findings_, node, "buttons", "a map from names to numbers in the message: {A: 0}");
  source.buttons.fill(-1);
  for (const NamedEntry& entry : read_entries(findings_, node)) {
    const auto button = find_control(joystick_buttons, entry.name);
    if (button) {
      source.buttons[*button] =
          static_cast<int>(read_integer(findings_, *entry.value, entry.name, 0, 255).value_or(-1));
    } else {
      findings_.error(*entry.key, fmt::format("there is no button '{}'", shortened(entry.name)),
                      name_hint(entry.name, {joystick_buttons.begin(), joystick_buttons.end()}, "buttons"));
    }
  }
}

LogMapReader::Needs LogMapReader::two_vectors(std::string_view one, std::string_view other) {
  Needs needs;
  for (const std::string_view vector : {one, other})
    for (const char* axis : {"x", "y", "z"}) needs.emplace_back(fmt::format("{}/{}", vector, axis), number);
  return needs;
}

void LogMapReader::read_joystick(const YamlNode& node) {
  const std::optional<Keys> keys = keys_of(node, joystick_source_form());
  if (keys && !keys->is_map()) return;
  JoySource source;
  for (std::size_t i = 0; i < source.axes.size(); ++i) source.axes[i].index = static_cast<int>(i);
  for (std::size_t i = 0; i < source.buttons.size(); ++i) source.buttons[i] = static_cast<int>(i);
  read_source(bound_joystick_source_form(), keys ? &*keys : nullptr, source, std::nullopt);
  if (keys) {
    if (const YamlNode* axes = keys->find("axes")) read_axes(*axes, source);
    if (const YamlNode* buttons = keys->find("buttons")) read_buttons(*buttons, source);
  }
  const YamlNode* topic = keys ? keys->require("topic", name_of_topic) : &node;
  if (topic == nullptr) return;
  const Needs joy{{"axes/*", number}, {"buttons/*", number}};
  const LogTopic* found = find_topic(*topic, "joystick", {joy, twist(), twist_stamped()}, "a Joy or Twist", source);
  if (found == nullptr) return;
  source.is_twist = !found->has("axes/*");
  map_.joystick = std::move(source);
}

/// For an array of numbers: reads their joints and their quantity.
void LogMapReader::read_array_commands(const Keys& keys, CommandSource& source) {
  if (const YamlNode* joints = keys.require("joints", "the joint of each number, in order; ~ for none")) {
    for (const YamlNodePtr& item :
         read_list(findings_, *joints, "joints", "a list of joints in the order of the numbers")) {
      const std::optional<int> joint = item->kind == YamlNode::Kind::empty ? std::nullopt : read_joint(*item);
      if (joint && std::ranges::find(source.joints, joint) != source.joints.end())
        findings_.error(*item, fmt::format("'{}' is in 'joints' twice", shortened(item->text)),
                        "expected each joint for one number");
      source.joints.push_back(joint);
    }
  }
  using enum CommandSource::Quantity;
  keys.require("quantity", "position, velocity or effort");
  keys.read("quantity",
            {"position, velocity or effort", {{"position", position}, {"velocity", velocity}, {"effort", effort}}},
            source.quantity);
}

/// The state that a controller takes back by rehearse_state().
void LogMapReader::read_state(const YamlNode& node) {
  const std::optional<Keys> keys = keys_of(node, state_source_form());
  if (!keys) {
    findings_.error(node, "'state' has no names", "expected {topic: ..., names: [...]}, a name for each number");
    return;
  }
  if (!keys->is_map()) return;
  StateSource source;
  read_source(bound_state_source_form(), &*keys, source, std::nullopt);
  std::set<std::string> taken;
  if (const YamlNode* names = keys->require("names", "the name of each number in rehearse_state(); ~ for none")) {
    for (const YamlNodePtr& item :
         read_list(findings_, *names, "names", "a list of names in the order of the numbers")) {
      std::optional<std::string> name;
      if (item->kind != YamlNode::Kind::empty) name = read_text(findings_, *item, "names", "a name, or ~");
      if (name && !taken.insert(*name).second)
        findings_.error(*item, fmt::format("'{}' is in 'names' twice", shortened(*name)),
                        "expected a name of its own for each number");
      source.names.push_back(std::move(name));
    }
  }
  const YamlNode* topic = keys->require("topic", name_of_topic);
  if (topic == nullptr) return;
  const Needs array{{"data/*", number}};
  if (find_topic(*topic, "state", {array}, "an array of numbers, as Float64MultiArray", source) == nullptr) return;
  map_.state = std::move(source);
}

void LogMapReader::read_commands(const YamlNode& node) {
  const std::optional<Keys> keys = keys_of(node, command_source_form());
  if (keys && !keys->is_map()) return;
  CommandSource source;
  read_source(bound_command_source_form(), keys ? &*keys : nullptr, source, std::nullopt);
  if (keys) {
    if (const YamlNode* names = keys->find("names")) read_names(*names, source.names);
  }
  const YamlNode* topic = keys ? keys->require("topic", name_of_topic) : &node;
  if (topic == nullptr) return;
  std::vector<Needs> needs = joint_messages();
  for (Needs& numbers : std::vector<Needs>{{{"data/*", number}}, twist(), twist_stamped()})
    needs.push_back(std::move(numbers));
  const LogTopic* found =
      find_topic(*topic, "commands", needs, "a JointState or an array of numbers, as Float64MultiArray", source);
  if (found == nullptr) return;
  source.is_array = !found->has("name/*", text) && !found->has("joint_names/*", text);
  if (source.is_array && !keys) {
    findings_.error(*topic, fmt::format("'{}' is an array of numbers, which doesn't name its joints", source.topic),
                    "expected {topic: ..., joints: [...], quantity: effort}");
  } else if (source.is_array) {
    read_array_commands(*keys, source);
    if (const YamlNode* names = keys->find("names"))
      findings_.error(*names, "'names' is given for an array of numbers",
                      "expected joints: the joints in the order of the numbers");
  } else if (keys) {
    for (const char* key : {"joints", "quantity"})
      if (const YamlNode* of_arrays = keys->find(key))
        findings_.error(*of_arrays, fmt::format("'{}' is given for a topic that names its joints", key),
                        "it is for arrays of numbers; names: renames joints");
  }
  map_.commands = std::move(source);
}

}  // namespace rehearse
