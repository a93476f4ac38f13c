#include "parameter_files.h"

#include <yaml-cpp/yaml.h>

#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string_view>

namespace rehearse_ros2 {
namespace {

using rclcpp::ParameterMap;
using rclcpp::ParameterValue;
using rclcpp::exceptions::RCLInvalidROSArgsError;

bool is_one_of(const std::string& text, std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words)
    if (text == word) return true;
  return false;
}

/// A plain scalar is a bool, an integer or a float if it looks like one; else, and if it is quoted, a string.
ParameterValue scalar(const YAML::Node& node) {
  const std::string text = node.Scalar();
  if (node.Tag() == "!" || text.empty()) return ParameterValue(text);
  if (is_one_of(text, {"y", "Y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"}))
    return ParameterValue(true);
  if (is_one_of(text, {"n", "N", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"}))
    return ParameterValue(false);
  const bool is_negative = text[0] == '-';
  const std::string unsigned_text = text.substr(is_negative || text[0] == '+' ? 1 : 0);
  if (is_one_of(unsigned_text, {".inf", ".Inf", ".INF"})) return ParameterValue(is_negative ? -INFINITY : INFINITY);
  if (is_one_of(unsigned_text, {".nan", ".NaN", ".NAN"})) return ParameterValue(static_cast<double>(NAN));
  if (!unsigned_text.empty() &&
      (std::isdigit(static_cast<unsigned char>(unsigned_text[0])) || unsigned_text[0] == '.')) {
    char* end = nullptr;
    errno = 0;
    const long long integer = std::strtoll(text.c_str(), &end, 0);
    if (*end == 0 && errno == 0) return ParameterValue(static_cast<std::int64_t>(integer));
    errno = 0;
    const double number = std::strtod(text.c_str(), &end);
    if (*end == 0 && errno == 0) return ParameterValue(number);
  }
  return ParameterValue(text);
}

template <class Element>
ParameterValue list_of(const std::string& name, const std::vector<ParameterValue>& values) {
  std::vector<Element> elements;
  for (const ParameterValue& value : values) {
    if (value.get_type() != values[0].get_type())
      throw RCLInvalidROSArgsError("the list '" + name + "' has elements of several types");
    elements.push_back(value.get<Element>());
  }
  return ParameterValue(elements);
}

ParameterValue value_of(const std::string& name, const YAML::Node& node) {
  if (node.IsNull()) return ParameterValue(std::string());
  if (!node.IsSequence()) return scalar(node);
  std::vector<ParameterValue> values;
  for (const YAML::Node& element : node) {
    if (!element.IsScalar()) throw RCLInvalidROSArgsError("the list '" + name + "' has elements that are no scalars");
    values.push_back(scalar(element));
  }
  if (values.empty()) return ParameterValue();
  switch (values[0].get_type()) {
    case rclcpp::PARAMETER_BOOL: return list_of<bool>(name, values);
    case rclcpp::PARAMETER_INTEGER: return list_of<std::int64_t>(name, values);
    case rclcpp::PARAMETER_DOUBLE: return list_of<double>(name, values);
    default: return list_of<std::string>(name, values);
  }
}

void add_parameters(const YAML::Node& node, const std::string& prefix, std::vector<rclcpp::Parameter>& parameters) {
  for (const auto& entry : node) {
    const std::string name = prefix + entry.first.Scalar();
    if (entry.second.IsMap())
      add_parameters(entry.second, name + ".", parameters);
    else
      parameters.emplace_back(name, value_of(name, entry.second));
  }
}

void add_nodes(const YAML::Node& node, const std::string& key, ParameterMap& map, std::vector<std::string>& order) {
  for (const auto& entry : node) {
    const std::string name = entry.first.Scalar();
    if (name == "ros__parameters") {
      if (map.find(key) == map.end()) order.push_back(key);
      add_parameters(entry.second, "", map[key]);
    } else if (entry.second.IsMap()) {
      add_nodes(entry.second, key.empty() || name[0] == '/' ? key + name : key + "/" + name, map, order);
    }
  }
}

/// The nodes of a file, and their keys in the order of the file.
ParameterMap read_file(const std::string& file, std::vector<std::string>& order) {
  ParameterMap map;
  try {
    add_nodes(YAML::LoadFile(file), "", map, order);
  } catch (const YAML::Exception& problem) {
    throw RCLInvalidROSArgsError("parameter file '" + file + "': " + problem.what());
  }
  return map;
}

/// "*" is one part of a name, "**" any number of parts.
bool matches(const char* pattern, const char* name) {
  if (*pattern == 0) return *name == 0;
  if (pattern[0] == '*') {
    const bool is_any = pattern[1] == '*';
    pattern += is_any ? 2 : 1;
    for (const char* rest = name;; ++rest) {
      if ((is_any || rest != name) && matches(pattern, rest)) return true;
      if (*rest == 0 || (*rest == '/' && !is_any)) return false;
    }
  }
  return *pattern == *name && matches(pattern + 1, name + 1);
}

std::pair<std::string, std::string> rule(const std::string& text) {
  const std::size_t sign = text.find(":=");
  if (sign == std::string::npos) throw RCLInvalidROSArgsError("'" + text + "' has no ':='");
  return {text.substr(0, sign), text.substr(sign + 2)};
}

/// Of "node:rest" the node; empty: there is none.
std::string take_node(std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {};
  std::string node = text.substr(0, colon);
  text.erase(0, colon + 1);
  return node;
}

struct Argument {
  enum class Kind { remap, parameter, file };
  Kind kind;
  std::string text;
};

std::vector<Argument> ros_arguments(const std::vector<std::string>& all) {
  std::vector<Argument> found;
  bool is_ros = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string& argument = all[i];
    if (!is_ros) {
      is_ros = argument == RCL_ROS_ARGS_FLAG;
      continue;
    }
    if (argument == "--") {
      is_ros = false;
      continue;
    }
    if (argument == RCL_ROS_ARGS_FLAG || argument.rfind("--disable-", 0) == 0 || argument.rfind("--enable-", 0) == 0)
      continue;
    if (i + 1 == all.size()) throw RCLInvalidROSArgsError("nothing stands behind '" + argument + "'");
    const std::string& value = all[++i];
    if (is_one_of(argument, {RCL_SHORT_REMAP_FLAG, RCL_REMAP_FLAG}))
      found.push_back({Argument::Kind::remap, value});
    else if (is_one_of(argument, {RCL_SHORT_PARAM_FLAG, RCL_PARAM_FLAG}))
      found.push_back({Argument::Kind::parameter, value});
    else if (argument == RCL_PARAM_FILE_FLAG)
      found.push_back({Argument::Kind::file, value});
    else if (!is_one_of(argument, {RCL_LOG_LEVEL_FLAG, "--log-config-file", "--log-file-name", "-e", "--enclave"}))
      throw rclcpp::exceptions::UnknownROSArgsError("'" + argument + "' is no argument of ROS 2");
  }
  return found;
}

}  // namespace

std::string full_namespace(const std::string& space) {
  std::string full = space.empty() || space[0] != '/' ? "/" + space : space;
  while (full.size() > 1 && full.back() == '/') full.pop_back();
  return full;
}

std::string full_name(const std::string& space, const std::string& name) {
  const std::string full = full_namespace(space);
  return (full == "/" ? "" : full) + "/" + name;
}

bool key_names_node(std::string key, const std::string& node) {
  if (key.empty() || key[0] != '/') key = "/" + key;
  // "/**/arm" names "/arm", too.
  return matches(key.c_str(), node.c_str()) || (key.rfind("/**/", 0) == 0 && matches(key.c_str() + 3, node.c_str()));
}

ParameterValue value_of_text(const std::string& text) {
  try {
    return value_of("", YAML::Load(text));
  } catch (const YAML::Exception& problem) {
    throw RCLInvalidROSArgsError("'" + text + "': " + problem.what());
  }
}

NodeArguments read_arguments(std::string name, std::string space, const std::vector<std::vector<std::string>>& lists) {
  NodeArguments result{std::move(name), std::move(space), {}, {}};
  const std::string given = result.name;
  std::vector<Argument> arguments;
  for (const auto& list : lists)
    for (Argument& argument : ros_arguments(list)) arguments.push_back(std::move(argument));
  for (const Argument& argument : arguments) {
    if (argument.kind != Argument::Kind::remap) continue;
    auto [from, to] = rule(argument.text);
    const std::string node = take_node(from);
    if (!node.empty() && node != given) continue;
    if (is_one_of(from, {"__node", "__name"}))
      result.name = to;
    else if (from == "__ns")
      result.space = to;
    else
      result.remaps.emplace_back(from, to);
  }
  const std::string node = full_name(result.space, result.name);
  for (const Argument& argument : arguments) {
    if (argument.kind == Argument::Kind::file) {
      std::vector<std::string> order;
      const ParameterMap map = read_file(argument.text, order);
      for (const std::string& key : order)
        if (key_names_node(key, node))
          for (const rclcpp::Parameter& parameter : map.at(key))
            result.overrides[parameter.get_name()] = parameter.get_parameter_value();
    } else if (argument.kind == Argument::Kind::parameter) {
      auto [parameter, value] = rule(argument.text);
      const std::string of = take_node(parameter);
      if (of.empty() || key_names_node(of, node)) result.overrides[parameter] = value_of_text(value);
    }
  }
  return result;
}

}  // namespace rehearse_ros2

namespace rclcpp {

ParameterMap parameter_map_from_yaml_file(const std::string& file, const char* node) {
  std::vector<std::string> order;
  ParameterMap map = rehearse_ros2::read_file(file, order);
  if (node != nullptr)
    for (auto entry = map.begin(); entry != map.end();)
      entry = rehearse_ros2::key_names_node(entry->first, node) ? std::next(entry) : map.erase(entry);
  return map;
}

std::vector<Parameter> parameters_from_map(const ParameterMap& map, const char* node) {
  std::set<std::string> keys;
  for (const auto& [key, parameters] : map)
    if (node == nullptr || rehearse_ros2::key_names_node(key, node)) keys.insert(key);
  std::vector<Parameter> all;
  for (const bool is_wild : {true, false})
    for (const std::string& key : keys)
      if ((key.find('*') != std::string::npos) == is_wild)
        all.insert(all.end(), map.at(key).begin(), map.at(key).end());
  return all;
}

}  // namespace rclcpp
