#include "log_scenario.h"

#include <fmt/format.h>
#include <yaml-cpp/emitter.h>
#include <yaml-cpp/emittermanip.h>

#include <cmath>
#include <filesystem>
#include <vector>

namespace rehearse {
namespace {

/// The shortest text that is read back as the same bits.
std::string exact(double value) { return fmt::format("{}", value); }

void emit_numbers(YAML::Emitter& yaml, std::initializer_list<double> numbers) {
  yaml << YAML::Flow << YAML::BeginSeq;
  for (const double number : numbers) yaml << exact(number);
  yaml << YAML::EndSeq;
}

void emit_text(YAML::Emitter& yaml, const char* key, const std::string& text) {
  yaml << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << text;
}

void emit_number(YAML::Emitter& yaml, const char* key, const std::optional<double>& number) {
  if (number) yaml << YAML::Key << key << YAML::Value << exact(*number);
}

void emit_controller(YAML::Emitter& yaml, const LogScenarioParts& parts) {
  const MappedController& controller = parts.map.controller;
  yaml << YAML::Key << "controllers" << YAML::Value << YAML::BeginSeq << YAML::BeginMap;
  if (!controller.name.empty()) emit_text(yaml, "name", controller.name);
  emit_text(yaml, "library", parts.library);
  if (!controller.options.empty()) emit_text(yaml, "options", controller.options);
  if (!controller.delay) yaml << YAML::Key << "delay" << YAML::Value << false;
  yaml << YAML::EndMap << YAML::EndSeq;
}

void emit_body(YAML::Emitter& yaml, const LogScenarioParts& parts) {
  yaml << YAML::BeginMap;
  emit_text(yaml, "name", parts.map.body);
  emit_text(yaml, "model", parts.model_file);
  const LinkReading& root = parts.seen.links[0];
  yaml << YAML::Key << "position" << YAML::Value;
  emit_numbers(yaml, {root.position.x(), root.position.y(), root.position.z()});
  yaml << YAML::Key << "rotation" << YAML::Value << YAML::BeginMap << YAML::Key << "quaternion" << YAML::Value;
  emit_numbers(yaml, {root.rotation.w(), root.rotation.x(), root.rotation.y(), root.rotation.z()});
  yaml << YAML::EndMap;
  yaml << YAML::Key << "joints" << YAML::Value << YAML::BeginMap;
  for (std::size_t id = 0; id < parts.model.joints.size(); ++id) {
    const Joint& joint = parts.model.links[parts.model.joints[id]].joint;
    if (!is_movable(joint.type) || !std::isfinite(parts.seen.joints[id].q)) continue;
    yaml << YAML::Key << YAML::DoubleQuoted << joint.name << YAML::Value << exact(parts.seen.joints[id].q);
  }
  yaml << YAML::EndMap;
  emit_controller(yaml, parts);
  yaml << YAML::EndMap;
}

void emit_cameras(YAML::Emitter& yaml, const LogScenarioParts& parts) {
  yaml << YAML::Key << "cameras" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  std::vector<bool> named(parts.model.devices.size(), false);
  for (const DeviceSource& source : parts.map.devices) {
    const LogInput::Content content = source.input->content;
    if (content != LogInput::Content::picture && content != LogInput::Content::depth) continue;
    for (const int device : source.devices) {
      if (named[device]) continue;
      named[device] = true;
      yaml << YAML::DoubleQuoted << parts.map.body + "/" + parts.model.devices[device].name;
    }
  }
  yaml << YAML::EndSeq;
}

void emit_tolerances(YAML::Emitter& yaml, const std::vector<ToleranceRule>& rules) {
  yaml << YAML::Key << "tolerances" << YAML::Value << YAML::BeginSeq;
  for (const ToleranceRule& rule : rules) {
    yaml << YAML::Flow << YAML::BeginMap;
    emit_text(yaml, "channel", rule.channel);
    emit_number(yaml, "atol", rule.atol);
    emit_number(yaml, "rtol", rule.rtol);
    emit_number(yaml, "lead", rule.lead);
    emit_number(yaml, "lag", rule.lag);
    if (rule.ticks) yaml << YAML::Key << "ticks" << YAML::Value << *rule.ticks;
    emit_number(yaml, "pixel_window", rule.pixel_window);
    emit_number(yaml, "pixel_share", rule.pixel_share);
    emit_number(yaml, "pixel_delta", rule.pixel_delta);
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndSeq;
}

}  // namespace

std::string log_scenario_text(const LogScenarioParts& parts) {
  YAML::Emitter yaml;
  yaml << YAML::Comment("What was replayed of the log " + parts.log + ": its first tick's posture, its duration.");
  yaml << YAML::BeginMap << YAML::Key << "rehearse" << YAML::Value << 1;
  emit_text(yaml, "name", std::filesystem::path(parts.log).stem().string());
  const double duration = static_cast<double>(parts.ticks) * parts.map.time_step;
  yaml << YAML::Key << "duration" << YAML::Value << exact(duration);
  yaml << YAML::Key << "time_step" << YAML::Value << exact(parts.map.time_step);
  yaml << YAML::Key << "bodies" << YAML::Value << YAML::BeginSeq;
  emit_body(yaml, parts);
  yaml << YAML::EndSeq;
  if (parts.map.joystick)
    yaml << YAML::Key << "joystick" << YAML::Value << YAML::Flow << YAML::BeginSeq << YAML::EndSeq;
  emit_cameras(yaml, parts);
  std::vector<ToleranceRule> rules = parts.map.tolerances;
  rules.insert(rules.end(), parts.tolerances.begin(), parts.tolerances.end());
  if (!rules.empty()) emit_tolerances(yaml, rules);
  yaml << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

}  // namespace rehearse
