#include "log_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/kinds/channel_name.h"
#include "core/scenario/scenario_parts.h"
#include "log_map_parts.h"
#include "map_forms.h"

namespace rehearse {

bool LogMapReader::check_version(const YamlNode& root) {
  if (root.kind != YamlNode::Kind::map) {
    expected(findings_, root, "the map", "a map that begins with rehearse_map: 1");
    return false;
  }
  const YamlNode* version = find_key(root, "rehearse_map");
  if (version == nullptr) {
    const bool is_scenario = find_key(root, "rehearse") != nullptr;
    findings_.error(root, is_scenario ? "it is a scenario, not a map" : "the map has no 'rehearse_map'",
                    "expected rehearse_map: 1, the version of the form");
    return !is_scenario;
  }
  if (version->kind == YamlNode::Kind::scalar && version->text == "1") return true;
  expected(findings_, *version, "rehearse_map", "1, the version of the form that this program reads");
  return false;
}

void LogMapReader::read(const YamlNode& root) {
  if (!check_version(root)) return;
  const Keys keys(findings_, root, map_form());
  read_body(keys, root);
  keys.read("clock", clock_words(), clock_);
  bound_map_form().read(keys, map_);
  keys.read("max_age", max_age_);
  if (const YamlNode* node = keys.find("controller")) read_controller(*node);
  if (const YamlNode* node = keys.find("joints")) each(*node, "joints", [&](const YamlNode& one) { read_joints(one); });
  for (const LogInput* input : log_inputs())
    if (const YamlNode* node = has_own_sources(*input) ? keys.find(input->key) : nullptr)
      each(*node, input->key, [&](const YamlNode& one) { read_device_source(one, *input); });
  if (const YamlNode* node = keys.find("joystick")) read_joystick(*node);
  if (const YamlNode* node = keys.find("root")) read_root(*node);
  if (const YamlNode* node = keys.find("commands")) read_commands(*node);
  if (const YamlNode* node = keys.find("state")) read_state(*node);
  if (const YamlNode* node = keys.find("tick")) read_tick(*node);
  if (const YamlNode* node = keys.find("renamed")) read_renamed(*node);
  read_start(keys);
  read_missing(keys);
  if (const YamlNode* node = keys.find("restart")) read_restarts(*node);
  if (const YamlNode* node = keys.find("limits")) read_limits(*node);
  if (const YamlNode* node = keys.find("tolerances")) {
    Scenario place;  // read_tolerances() writes the list into it, in the form of a scenario's tolerances
    place.file = map_.file;
    read_tolerances(findings_, *node, place);
    map_.tolerances = std::move(place.tolerances);
    if (!keys.find("commands"))
      findings_.error(*node, "'tolerances' without 'commands'", "they apply to commands of the log: commands: TOPIC");
  }
  check_something_is_mapped(root);
}

void LogMapReader::read_body(const Keys& keys, const YamlNode& root) {
  map_.body = model_.name;
  if (const YamlNode* node = keys.find("body")) {
    map_.body = read_name(findings_, *node, "body").value_or(map_.body);
    return;
  }
  YamlNode of_the_model;
  of_the_model.kind = YamlNode::Kind::scalar;
  of_the_model.text = model_.name;
  Findings unsaid(map_.file);
  if (!read_name(unsaid, of_the_model, "body"))
    findings_.error(root, fmt::format("channels can't be named after the model, '{}'", shortened(model_.name)),
                    "expected body: a short name without blanks and none of / * ? [ ]");
}

/// Any topic with messages can be the tick. Its clock is that of the topic's other sources.
void LogMapReader::read_tick(const YamlNode& node) {
  std::optional<Keys> keys;
  if (node.kind == YamlNode::Kind::map) keys.emplace(findings_, node, map_tick_form());
  const YamlNode* topic = keys ? keys->require("topic", name_of_topic) : &node;
  if (topic == nullptr) return;
  TickSource source;
  read_source(bound_tick_form(), keys ? &*keys : nullptr, source, std::nullopt);
  const auto known = clocks_.find(topic->text);
  if (known != clocks_.end() && !(keys && keys->find("clock"))) source.clock = known->second.first;
  if (!find_topic(*topic, "tick", {{}}, "messages", source)) return;
  const YamlNode* latency = keys ? keys->find("latency") : nullptr;
  const bool is_of_commands = map_.commands && map_.commands->topic == source.topic;
  source.before_commands = is_of_commands && (latency || source.grid);
  if (latency && !is_of_commands) {
    findings_.error(*latency,
                    fmt::format("'latency' is given for '{}', which isn't the topic of the commands", source.topic),
                    "expected the topic of the commands, which come some time after their ticks");
  } else if (latency && !(latency->kind == YamlNode::Kind::scalar && latency->text == "measured")) {
    source.latency = read_number(findings_, *latency, "latency", {0.0, Scenario::max_time_step, "[s], or measured"});
  }
  map_.tick = std::move(source);
}

bool LogMapReader::has_topic(const std::string& topic) const {
  const auto is_it = [&](const LogSource& source) { return source.topic == topic; };
  return std::ranges::any_of(map_.joints, is_it) || std::ranges::any_of(map_.devices, is_it) ||
         (map_.joystick && is_it(*map_.joystick)) || (map_.root && is_it(*map_.root)) ||
         (map_.commands && is_it(*map_.commands)) || (map_.state && is_it(*map_.state)) ||
         (map_.tick && is_it(*map_.tick));
}

void LogMapReader::read_start(const Keys& keys) {
  const YamlNode* node = keys.find("start");
  if (node == nullptr) return keys.set_default("start", {"all"});
  StartRule& start = map_.start;
  if (node->kind == YamlNode::Kind::scalar && (node->text == "all" || node->text == "first")) {
    start.when = node->text == "all" ? StartRule::When::all : StartRule::When::first;
  } else if (node->kind == YamlNode::Kind::scalar && has_topic(node->text)) {
    start.when = StartRule::When::topic;
    start.topic = node->text;
  } else if (node->kind == YamlNode::Kind::scalar && !node->text.empty() && std::isdigit(node->text[0])) {
    start.when = StartRule::When::time;
    start.seconds = read_number(findings_, *node, "start", {0.0, Scenario::max_duration, "[s]"}).value_or(0.0);
  } else {
    expected(findings_, *node, "start",
             "all (when each input has had a message), first (with the first message), a topic of this map (with its "
             "first message), or a time after all [s]");
  }
}

void LogMapReader::read_restarts(const YamlNode& node) {
  const auto read = [&](const YamlNode& one) {
    const auto time = read_number(findings_, one, "restart", {0.0, Scenario::max_duration, "[s] of the log"});
    if (!time) return;
    if (!map_.restarts.empty() && *time <= map_.restarts.back())
      findings_.error(one, fmt::format("the restart at {:g} s isn't later than the one before it", *time),
                      "expected rising times [s] from the log's beginning");
    map_.restarts.push_back(*time);
  };
  each(node, "restart", read);
}

/// Gives a joint another name in the sources that name their joints. False: there is no such joint.
bool LogMapReader::rename_joint(const NamedEntry& entry, const std::string& later) {
  bool is_one = false;
  const auto rename = [&](std::map<std::string, JointRename>& names) {
    JointRename known;
    if (const auto stated = names.find(entry.name); stated != names.end()) {
      known = stated->second;
    } else {
      const int link = model_.find_joint(entry.name);
      if (link < 0 || model_.links[link].joint.id < 0) return;
      known.joint = model_.links[link].joint.id;
    }
    known.place = {map_.file, entry.key->line, entry.key->column};
    known.is_later = is_one = true;
    names.emplace(later, known);
  };
  for (JointSource& source : map_.joints) rename(source.names);
  if (map_.commands && !map_.commands->is_array) rename(map_.commands->names);
  return is_one;
}

/// The magnitudes at which commands were clipped.
void LogMapReader::read_limits(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::map)
    return expected(findings_, node, "limits", "a map from joints to magnitudes: {KNEE: 8 N·m}");
  if (!map_.commands)
    return findings_.error(node, "'limits' without 'commands'", "they clip commands: commands: TOPIC");
  const char* quantity = "u";
  if (map_.commands->is_array && map_.commands->quantity == CommandSource::Quantity::position) quantity = "q";
  if (map_.commands->is_array && map_.commands->quantity == CommandSource::Quantity::velocity) quantity = "dq";
  for (const NamedEntry& entry : read_entries(findings_, node)) {
    const auto joint = read_joint(*entry.key);
    if (!joint) continue;
    const bool slides = is_linear(model_.links[model_.joints[*joint]].joint.type);
    const std::string_view unit = unit_of_joint(quantity, slides);
    const auto limit =
        read_quantity(findings_, *entry.value, entry.name, find_unit(unit)->all_spellings(), {0.0, 1e9, unit, true});
    if (limit) map_.limits[*joint] = *limit;
  }
}

/// Topics, and joints, that have another name from some time of the log on.
void LogMapReader::read_renamed(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::map)
    return expected(findings_, node, "renamed",
                    "a map from a topic of this map, or a joint, to its later name: {/old: /new}");
  const auto of_log = [&](const std::string& name) {
    return std::ranges::find_if(topics_, [&](const LogTopic& topic) { return topic.name == name; });
  };
  for (const NamedEntry& entry : read_entries(findings_, node)) {
    const auto later = read_text(findings_, *entry.value, "renamed", name_of_topic);
    if (!later) continue;
    if (!has_topic(entry.name) && rename_joint(entry, *later)) continue;
    if (!has_topic(entry.name) || of_log(entry.name) == topics_.end()) {
      findings_.error(*entry.key, fmt::format("'{}' is no topic of this map", shortened(entry.name)),
                      "expected a topic of its sources, its tick, or a joint");
    } else if (of_log(*later) == topics_.end()) {
      findings_.error(*entry.value, fmt::format("the log has no topic '{}'", shortened(*later)),
                      "expected the later name of " + entry.name);
    } else if (has_topic(*later)) {
      findings_.error(*entry.value, fmt::format("'{}' is a topic of this map itself", shortened(*later)),
                      "name it only in 'renamed'");
    } else if (of_log(*later)->type != of_log(entry.name)->type ||
               of_log(*later)->schema != of_log(entry.name)->schema) {
      findings_.error(
          *entry.value,
          fmt::format("'{}' is of another type than '{}': {}", shortened(*later), entry.name, of_log(*later)->type),
          "expected " + of_log(entry.name)->type + " with the same definition");
    } else {
      map_.each_source([&](LogSource& source) {
        if (source.topic == entry.name) source.later_topic = *later;
      });
    }
  }
}

void LogMapReader::read_missing(const Keys& keys) {
  if (map_.skips_missing && (!map_.tick || map_.tick->grid))
    findings_.error(*keys.find("missing"), "'missing: skip' without ticks at messages",
                    "expected tick: TOPIC, whose missing messages it is about");
}

void LogMapReader::read_controller(const YamlNode& node) {
  const Keys keys(findings_, node, map_controller_form());
  if (const YamlNode* name = keys.find("name")) map_.controller.name = read_name(findings_, *name, "name").value_or("");
  bound_map_controller_form().read(keys, map_.controller);
}

void LogMapReader::check_something_is_mapped(const YamlNode& root) {
  for (const std::string_view key : map_form().needed[0])
    if (find_key(root, key) != nullptr) return;
  if (findings_.any_error()) return;  // the reason may be a misspelt key
  findings_.error(root, "the map names no input", "expected at least one topic, as joints: /joint_states");
}

Result<LogMap> LogMap::parse(std::string text, const std::string& file, const Model& model,
                             const std::vector<LogTopic>& topics) {
  const YamlNodePtr root = REHEARSE_TRY(parse_yaml(text, file));
  LogMap map;
  map.file = file;
  map.text = std::move(text);
  Findings findings(file);
  LogMapReader(findings, model, topics, map).read(*root);
  if (findings.any_error()) return findings.errors();
  return map;
}

Result<LogMap> LogMap::load(const std::filesystem::path& file, const Model& model,
                            const std::vector<LogTopic>& topics) {
  std::string text = REHEARSE_TRY(read_yaml_file(file, "a map"));
  return parse(std::move(text), file.string(), model, topics);
}

}  // namespace rehearse
