#include "base/glob.h"
#include "base/names.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace rehearse {
namespace {

/// How a value is written: with a unit of a list, or as a bare number. A displacement has the units of its joint.
enum class Written { bare, time, rate, displacement };

struct ActuatorKey {
  std::string_view name, text;
  std::variant<double Actuator::*, std::optional<double> Actuator::*> member;
  Range range;
  Written written = Written::bare;
};

constexpr double most = 1e9;
constexpr ActuatorKey actuator_keys[] = {
    {"delay", "from a command to its effect [s]", &Actuator::delay, {0.0, 1.0, "[s]"}, Written::time},
    {"jitter", "the delay varies by it [s]", &Actuator::jitter, {0.0, 1.0, "[s]"}, Written::time},
    {"quantum", "resolution of the drive's encoder", &Actuator::quantum, {0.0, most}, Written::displacement},
    {"position_gain", "of the drive's own loop", &Actuator::position_gain, {0.0, most}},
    {"velocity_gain", "of the drive's own loop", &Actuator::velocity_gain, {0.0, most}},
    {"period", "of the drive's own loop [s]", &Actuator::period, {0.0, 1.0, "[s]"}, Written::time},
    {"bandwidth", "of the effort [Hz]", &Actuator::bandwidth, {0.0, 1e6, "[Hz]", true}, Written::rate},
    {"effort", "largest effort", &Actuator::effort, {0.0, most}},
    {"velocity", "largest velocity", &Actuator::velocity, {0.0, most}},
    {"stall_effort", "largest effort at rest", &Actuator::stall_effort, {0.0, most, "", true}},
    {"no_load_velocity", "velocity at which no effort is left", &Actuator::no_load_velocity, {0.0, most, "", true}},
    {"continuous_effort", "largest effort while it is hot", &Actuator::continuous_effort, {0.0, most, "", true}},
    {"thermal_time", "time constant of its heat [s]", &Actuator::thermal_time, {0.0, 1e5, "[s]", true}, Written::time},
    {"armature", "inertia of the rotor as it acts at the joint", &Actuator::armature, {0.0, most}},
    {"damping", "resistance in proportion to velocity", &Actuator::damping, {0.0, most}},
    {"coulomb", "friction in motion", &Actuator::coulomb, {0.0, most}},
    {"stiction", "friction at rest", &Actuator::stiction, {0.0, most}},
    {"stribeck", "velocity at which stiction has fallen to coulomb", &Actuator::stribeck, {1e-6, most}},
    {"efficiency", "of the gear", &Actuator::efficiency, {0.01, 1.0}},
    {"backlash", "of the gear", &Actuator::backlash, {0.0, 1.0}, Written::displacement},
    {"contact_stiffness", "of the teeth", &Actuator::contact_stiffness, {0.0, 1e12, "", true}},
    {"contact_damping", "of the teeth", &Actuator::contact_damping, {0.0, most}},
};
constexpr std::size_t actuator_key_count = std::size(actuator_keys);
constexpr Range any_gear{1e-3, 1e6};

constexpr std::size_t index_of(std::string_view name) {
  std::size_t index = 0;
  while (actuator_keys[index].name != name) ++index;
  return index;
}

void set(Actuator& actuator, const ActuatorKey& key, double value) {
  std::visit([&](const auto& member) { actuator.*member = value; }, key.member);
}

/// A joint and its actuator.
struct Driven {
  const Joint* joint = nullptr;
  std::optional<Actuator>* actuator = nullptr;
  std::array<const YamlNode*, actuator_key_count> places{};  // by key: its value; null: no rule states it
  const YamlNode* gear_place = nullptr;
  double gear = 1.0;

  const YamlNode* place(std::string_view key) const { return places[index_of(key)]; }
};

class ActuatorReader {
 public:
  ActuatorReader(Findings& findings, ScenarioBody& body);
  void read_rule(const YamlNode& node);
  void check();

 private:
  std::vector<Driven*> find_joints(const YamlNode& node);
  std::optional<double> read_value(const YamlNode& node, const ActuatorKey& key, const Joint& joint);
  void apply_gear(Driven& driven);
  void check_limits(const Driven& driven);
  void check_pair(const Driven& driven, std::string_view key, std::string_view other, std::string_view why);
  void check_loop(const Driven& driven);
  void check_resistance(const Driven& driven);
  void check_play(const Driven& driven);

  Findings& findings_;
  ScenarioBody& body_;
  std::vector<Driven> driven_;
};

/// Tracks, and joints that follow others, have no actuator.
ActuatorReader::ActuatorReader(Findings& findings, ScenarioBody& body) : findings_(findings), body_(body) {
  body.actuators.resize(body.model->joints.size());
  for (const int link : body.model->joints) {
    const Joint& joint = body.model->links[static_cast<std::size_t>(link)].joint;
    if (joint.type == JointType::track || joint.mimic) continue;
    Driven& driven = driven_.emplace_back();
    driven.joint = &joint;
    driven.actuator = &body.actuators[static_cast<std::size_t>(joint.id)];
    driven.gear = joint.gear_ratio;
  }
}

/// The joints that the pattern matches; an error if there are none.
std::vector<Driven*> ActuatorReader::find_joints(const YamlNode& node) {
  const auto pattern = read_text(findings_, node, "joint", "a joint, or a pattern such as *_knee");
  if (!pattern) return {};
  std::vector<Driven*> found;
  std::vector<std::string> names;
  for (Driven& driven : driven_) {
    names.push_back(driven.joint->name);
    if (matches(*pattern, driven.joint->name)) found.push_back(&driven);
  }
  if (!found.empty()) return found;
  const int link = body_.model->find_joint(*pattern);
  const bool follows = link >= 0 && body_.model->links[static_cast<std::size_t>(link)].joint.mimic;
  if (follows)
    findings_.error(node, fmt::format("joint '{}' of {} follows another joint", *pattern, body_.name),
                    "its leader has an actuator");
  else
    findings_.error(node, fmt::format("{} has no joint '{}' that a command drives", body_.name, shortened(*pattern)),
                    name_hint(*pattern, names, "joints"));
  return {};
}

std::optional<double> ActuatorReader::read_value(const YamlNode& node, const ActuatorKey& key, const Joint& joint) {
  switch (key.written) {
    case Written::time: return read_quantity(findings_, node, key.name, time_units, key.range);
    case Written::rate: return read_quantity(findings_, node, key.name, rate_units, key.range);
    case Written::displacement:
      return is_linear(joint.type) ? read_quantity(findings_, node, key.name, length_units, key.range)
                                   : read_quantity(findings_, node, key.name, angle_units, key.range);
    case Written::bare: break;
  }
  return read_number(findings_, node, key.name, key.range);
}

void ActuatorReader::read_rule(const YamlNode& node) {
  const Keys keys(findings_, node, actuator_form());
  if (!keys.is_map()) return;
  const YamlNode* pattern = keys.require("joint", "a joint, or a pattern such as *_knee");
  if (!pattern) return;
  const std::vector<Driven*> joints = find_joints(*pattern);
  if (keys.entries().size() == 1)
    findings_.error(node, "the actuator has no property", "expected one, as in delay: 6 ms");
  std::optional<double> gear;
  keys.number("gear", gear);
  const Driven* first = nullptr;
  for (Driven* driven : joints) {
    if (!*driven->actuator) driven->actuator->emplace();
    for (std::size_t i = 0; i < actuator_key_count; ++i) {
      const ActuatorKey& key = actuator_keys[i];
      const YamlNode* value = keys.find(key.name);
      if (!value) continue;
      // a mistake is reported once for all joints of the same units
      const bool is_told =
          first && is_linear(first->joint->type) == is_linear(driven->joint->type) && !first->places[i];
      const auto number = is_told ? std::nullopt : read_value(*value, key, *driven->joint);
      driven->places[i] = number ? value : nullptr;
      if (number) set(**driven->actuator, key, *number);
    }
    if (gear) {
      driven->gear_place = keys.find("gear");
      driven->gear = *gear;
    }
    if (!first) first = driven;
  }
}

/// The rotor of the model, behind another gear.
void ActuatorReader::apply_gear(Driven& driven) {
  if (!driven.gear_place) return;
  if (driven.place("armature"))
    return findings_.warning(*driven.gear_place,
                             fmt::format("gear does nothing for {}: its armature is given", driven.joint->name),
                             "armature is the rotor's inertia times the square of gear");
  if (driven.joint->rotor_inertia <= 0.0)
    return findings_.warning(
        *driven.gear_place,
        fmt::format("gear does nothing for {}: the model states no inertia of its rotor", driven.joint->name),
        "armature states it as it acts at the joint");
  (**driven.actuator).armature = driven.joint->rotor_inertia * driven.gear * driven.gear;
}

void ActuatorReader::check_pair(const Driven& driven, std::string_view key, std::string_view other,
                                std::string_view why) {
  const YamlNode* first = driven.place(key);
  const YamlNode* second = driven.place(other);
  if ((first == nullptr) == (second == nullptr)) return;
  findings_.error(
      first ? *first : *second,
      fmt::format("{} has a '{}' without a '{}'", driven.joint->name, first ? key : other, first ? other : key),
      std::string(why));
}

void ActuatorReader::check_limits(const Driven& driven) {
  check_pair(driven, "stall_effort", "no_load_velocity", "the line from the one to the other needs both");
  check_pair(driven, "continuous_effort", "thermal_time", "heat limits an effort by both");
  const Actuator& actuator = **driven.actuator;
  if (actuator.continuous_effort && actuator.effort && *actuator.continuous_effort > *actuator.effort)
    findings_.error(*driven.place("continuous_effort"),
                    fmt::format("the continuous effort of {} is {}, above its largest effort, {}", driven.joint->name,
                                *actuator.continuous_effort, *actuator.effort),
                    "expected at most effort");
  if (actuator.jitter > actuator.delay)
    findings_.error(*driven.place("jitter"),
                    fmt::format("the jitter of {} is {} s, above its delay of {} s", driven.joint->name,
                                actuator.jitter, actuator.delay),
                    "each command's delay lies between delay - jitter and delay + jitter");
}

void ActuatorReader::check_loop(const Driven& driven) {
  const YamlNode* period = driven.place("period");
  if (period && !(**driven.actuator).has_loop())
    findings_.error(*period, fmt::format("{} has a period without a loop", driven.joint->name),
                    "position_gain and velocity_gain are those of the drive's own loop");
}

void ActuatorReader::check_resistance(const Driven& driven) {
  const Actuator& actuator = **driven.actuator;
  const double coulomb = actuator.coulomb.value_or(driven.joint->friction);
  if (actuator.stiction && *actuator.stiction < coulomb)
    findings_.error(*driven.place("stiction"),
                    fmt::format("the stiction of {} is {}, below its friction in motion, {}", driven.joint->name,
                                *actuator.stiction, coulomb),
                    "expected at least coulomb");
  if (const YamlNode* stribeck = driven.place("stribeck"); stribeck && !actuator.stiction)
    findings_.error(*stribeck, fmt::format("{} has a 'stribeck' without 'stiction'", driven.joint->name),
                    "it is the velocity at which stiction has fallen to coulomb");
}

void ActuatorReader::check_play(const Driven& driven) {
  const Actuator& actuator = **driven.actuator;
  if (actuator.backlash > 0.0 && actuator.armature.value_or(driven.joint->armature) <= 0.0)
    findings_.error(*driven.place("backlash"), fmt::format("{} has backlash, but no armature", driven.joint->name),
                    "the rotor crosses the gap alone: armature is its inertia, as it acts at the joint");
  for (const std::string_view key : {"contact_stiffness", "contact_damping"})
    if (const YamlNode* place = driven.place(key); place && actuator.backlash <= 0.0)
      findings_.error(*place, fmt::format("{} has a '{}' without 'backlash'", driven.joint->name, key),
                      "it is that of the teeth on both sides of the gap");
}

void ActuatorReader::check() {
  for (Driven& driven : driven_) {
    if (!*driven.actuator) continue;
    apply_gear(driven);
    check_limits(driven);
    check_loop(driven);
    check_resistance(driven);
    check_play(driven);
  }
}

ValueType value_type_of(const ActuatorKey& key) {
  switch (key.written) {
    case Written::time: return types::quantity(time_units, key.range);
    case Written::rate: return types::quantity(rate_units, key.range);
    case Written::displacement:
      return types::either({types::quantity(angle_units, key.range), types::quantity(length_units, key.range)});
    case Written::bare: break;
  }
  return types::number(key.range);
}

}  // namespace

const Form& actuator_form() {
  static const Form form = [] {
    Form actuator{"actuator",
                  "an actuator",
                  {{"joint", types::text(), "a joint, or a pattern such as *_knee", required},
                   {"gear", types::number(any_gear), "ratio of the gear between the model's rotor and the joint"}}};
    for (const ActuatorKey& key : actuator_keys) actuator.keys.push_back({key.name, value_type_of(key), key.text});
    return actuator;
  }();
  return form;
}

void read_actuators(Findings& findings, const YamlNode& node, ScenarioBody& body) {
  if (body.kinematic) {
    findings.warning(node, "actuators do nothing: the body is kinematic", "a kinematic body follows its commands");
    return;
  }
  ActuatorReader reader(findings, body);
  for (const YamlNodePtr& rule : read_list(findings, node, "actuators", "a list of {joint: PATTERN, KEY: VALUE, ...}"))
    reader.read_rule(*rule);
  reader.check();
  if (std::ranges::none_of(body.actuators, [](const auto& each) { return each.has_value(); })) body.actuators.clear();
}

}  // namespace rehearse
