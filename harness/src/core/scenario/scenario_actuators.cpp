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
    {"quantum",
     "commands are rounded to its multiples, each in its own unit; 0: any number",
     &Actuator::quantum,
     {0.0, most},
     Written::displacement},
    {"delay",
     "from a command to its effect, beside the tick of a controller with delay: true [s]",
     &Actuator::delay,
     {0.0, 1.0, "[s]"},
     Written::time},
    {"jitter",
     "each command's delay lies evenly between delay - jitter and delay + jitter; at most delay [s]",
     &Actuator::jitter,
     {0.0, 1.0, "[s]"},
     Written::time},
    {"position_gain",
     "of the drive's own loop; default: no loop [N·m/rad or N/m]",
     &Actuator::position_gain,
     {0.0, most}},
    {"velocity_gain",
     "of the drive's own loop; default: no loop [N·m·s/rad or N·s/m]",
     &Actuator::velocity_gain,
     {0.0, most}},
    {"period",
     "of that loop, whose effort stays in between; 0: each tick [s]",
     &Actuator::period,
     {0.0, 1.0, "[s]"},
     Written::time},
    {"bandwidth",
     "of efforts: a first-order lag with the time constant 1 / (2 pi bandwidth); default: unlimited [Hz]",
     &Actuator::bandwidth,
     {0.0, 1e6, "[Hz]", true},
     Written::rate},
    {"effort",
     "largest effort, of commands of effort too; default: that of the model, for drives [N·m or N]",
     &Actuator::effort,
     {0.0, most}},
    {"velocity",
     "largest velocity of a drive; commands of effort don't obey it; default: that of the model [rad/s or m/s]",
     &Actuator::velocity,
     {0.0, most}},
    {"stall_effort",
     "effort at rest, of the torque-speed line; with no_load_velocity; default: no line [N·m or N]",
     &Actuator::stall_effort,
     {0.0, most, "", true}},
    {"no_load_velocity",
     "velocity at which the line reaches 0; with stall_effort [rad/s or m/s]",
     &Actuator::no_load_velocity,
     {0.0, most, "", true}},
    {"continuous_effort",
     "largest effort while the motor is hot, at most effort; with thermal_time; default: heat limits nothing [N·m or "
     "N]",
     &Actuator::continuous_effort,
     {0.0, most, "", true}},
    {"thermal_time",
     "time constant of the heat; with continuous_effort [s]",
     &Actuator::thermal_time,
     {0.0, 1e5, "[s]", true},
     Written::time},
    {"armature", "inertia of the rotor; default: that of the model [kg·m² or kg]", &Actuator::armature, {0.0, most}},
    {"backlash",
     "width of the gap in the gear; needs an armature; 0: none",
     &Actuator::backlash,
     {0.0, 1.0},
     Written::displacement},
    {"contact_stiffness",
     "of the teeth on both sides of the gap [N·m/rad or N/m]",
     &Actuator::contact_stiffness,
     {0.0, 1e12, "", true}},
    {"contact_damping", "of the teeth [N·m·s/rad or N·s/m]", &Actuator::contact_damping, {0.0, most}},
    {"efficiency", "of the gear", &Actuator::efficiency, {0.01, 1.0}},
    {"damping", "of the joint; default: that of the model [N·m·s/rad or N·s/m]", &Actuator::damping, {0.0, most}},
    {"coulomb", "dry friction in motion; default: that of the model [N·m or N]", &Actuator::coulomb, {0.0, most}},
    {"stiction",
     "dry friction at rest, at least coulomb; default: that in motion [N·m or N]",
     &Actuator::stiction,
     {0.0, most}},
    {"stribeck",
     "velocity at which the excess of stiction has fallen to 1/e [rad/s or m/s]",
     &Actuator::stribeck,
     {1e-6, most}},
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
  keys.read("gear", gear);
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

/// The default of a key as it would be written, of an actuator of which nothing is stated.
std::string default_of(const ActuatorKey& key, const ValueType& type) {
  return std::visit([&](const auto& member) { return one_text(written_default(type, Actuator{}.*member)); },
                    key.member);
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
                  {{"joint", types::text(),
                    "a joint, or a pattern such as *_knee; not of tracks and of joints that follow others", required},
                   {"gear", types::number(any_gear),
                    "turns of the rotor for a turn of the joint: the armature of a model that states its rotor's own "
                    "inertia; default: that of the model"}}};
    for (const ActuatorKey& key : actuator_keys) {
      ValueType type = value_type_of(key);
      std::string fallback = default_of(key, type);
      actuator.keys.push_back({key.name, std::move(type), key.text, std::move(fallback)});
    }
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
