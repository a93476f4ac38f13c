// The `faults` of a body: errors of its sensors and actuators, masses of its links, and commands that are lost, for a
// time.
#include <rehearse/scenario.h>

#include "base/glob.h"
#include "base/names.h"
#include "body_faults.h"
#include "model/acting_faults.h"
#include "model/rigid_groups.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"
#include "sensor_error.h"
#include "stated_faults.h"
#include "yaml/yaml_tree.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

constexpr Range any_share{0.0, 1.0};
constexpr Range any_mass_factor{0.01, 100.0};

/// A fault as it is read.
struct ReadFault {
  const Keys& keys;
  const YamlNode& node;
  Spell when;
};

class FaultReader {
 public:
  FaultReader(Findings& findings, ScenarioBody& body) : findings_(findings), body_(body) {}
  void read(const YamlNode& node);
  static std::vector<std::string> kind_names();
  /// Whether faults of this kind read the key.
  static bool reads(std::string_view kind, std::string_view key);

 private:
  using ToReading = void (FaultReader::*)(const ReadFault&, std::span<const std::size_t>, bool of_joint);
  using ToActuator = void (FaultReader::*)(const ReadFault&, Actuator&);
  using ToParts = void (FaultReader::*)(const ReadFault&, std::span<const std::size_t>);
  /// A kind of faults: what it does to readings, to an actuator, or to other parts.
  struct Kind {
    std::string_view name;
    ToReading to_reading = nullptr;
    ToActuator to_actuator = nullptr;
    std::string_view keys = "";  // that it reads beside those of each fault
    ToParts to_parts = nullptr;
    std::string_view parts = "";  // their key

    bool is_of(std::string_view owner) const {
      if (owner == "actuator") return to_actuator != nullptr;
      return to_parts ? owner == parts : to_reading && (owner == "sensor" || owner == "encoder");
    }
  };

  static std::span<const Kind> kinds();
  std::optional<std::vector<std::size_t>> find_owners(const YamlNode& node, std::string_view owner) const;
  const Kind* find_kind(const Keys& keys, std::string_view owner) const;
  ReadingErrors& errors_of(std::size_t index, bool of_joint) {
    return of_joint ? body_.errors.joints[index] : body_.errors.devices[index];
  }
  void add_stuck(const ReadFault& fault, std::span<const std::size_t> to, bool of_joint);
  void add_lost(const ReadFault& fault, std::span<const std::size_t> to, bool of_joint);
  void add_delayed(const ReadFault& fault, std::span<const std::size_t> to, bool of_joint);
  void add_offset(const ReadFault& fault, std::span<const std::size_t> to, bool of_joint);
  void add_offset_to(const ReadFault& fault, const YamlNode& by, const YamlNode& name, std::size_t index,
                     bool of_joint);
  template <ActuatorFault::Kind kind>
  void add_plain(const ReadFault& fault, Actuator& actuator) {
    actuator.faults.push_back({kind, 1.0, fault.when.from, fault.when.until});
  }
  void add_weak(const ReadFault& fault, Actuator& actuator);
  void add_heavier(const ReadFault& fault, std::span<const std::size_t> links);
  void add_lost_commands(const ReadFault& fault, std::span<const std::size_t> controllers);
  bool begins_moving_part(std::size_t link) const;
  std::vector<ScenarioController*> controllers() const;

  Findings& findings_;
  ScenarioBody& body_;
};

std::span<const FaultReader::Kind> FaultReader::kinds() {
  using enum ActuatorFault::Kind;
  static constexpr Kind all[] = {{"stuck", &FaultReader::add_stuck},
                                 {"lost", &FaultReader::add_lost},
                                 {"delayed", &FaultReader::add_delayed, nullptr, "by"},
                                 {"offset", &FaultReader::add_offset, nullptr, "by quantity"},
                                 {"dead", nullptr, &FaultReader::add_plain<dead>},
                                 {"weak", nullptr, &FaultReader::add_weak, "effort"},
                                 {"locked", nullptr, &FaultReader::add_plain<locked>},
                                 {"reversed", nullptr, &FaultReader::add_plain<reversed>},
                                 {"heavier", nullptr, nullptr, "mass", &FaultReader::add_heavier, "link"},
                                 {"lost", nullptr, nullptr, "", &FaultReader::add_lost_commands, "controller"}};
  return all;
}

std::vector<std::string> FaultReader::kind_names() {
  std::vector<std::string> names;
  for (const Kind& kind : kinds())
    if (std::ranges::find(names, kind.name) == names.end()) names.emplace_back(kind.name);
  return names;
}

bool FaultReader::reads(std::string_view kind, std::string_view key) {
  constexpr std::string_view only_some[] = {"by", "quantity", "effort", "mass"};
  if (std::ranges::find(only_some, key) == std::end(only_some)) return true;
  const auto all = kinds();
  const auto found = std::ranges::find_if(all, [&](const Kind& each) { return each.name == kind; });
  return found == all.end() || found->keys.find(key) != std::string_view::npos;
}

/// A fault of a link is that of its rigid part, which has the name of its first link: it would move the common centre
/// of mass otherwise.
bool FaultReader::begins_moving_part(std::size_t link) const {
  if (body_.kinematic) return false;
  const Model& model = *body_.model;
  const RigidGroups groups = group_links(model);
  if (!groups.links[link].leads_group) return false;
  return groups.links[link].group != 0 || !(body_.fixed || model.links[0].joint.type == JointType::fixed);
}

/// Each before its children.
std::vector<ScenarioController*> FaultReader::controllers() const {
  std::vector<ScenarioController*> all;
  for (ScenarioController& controller : body_.controllers) {
    all.push_back(&controller);
    for (ScenarioController& child : controller.children) all.push_back(&child);
  }
  return all;
}

/// The devices that measure, the joints, the links, or the controllers, whose names match; an error if there are none.
std::optional<std::vector<std::size_t>> FaultReader::find_owners(const YamlNode& node, std::string_view owner) const {
  const auto pattern = read_text(findings_, node, owner, "a name, or a pattern such as *_KNEE");
  if (!pattern) return std::nullopt;
  std::vector<std::size_t> found;
  std::vector<std::string> names;
  const auto take = [&](const std::string& name, std::size_t index) {
    names.push_back(name);
    if (matches(*pattern, name)) found.push_back(index);
  };
  const Model& model = *body_.model;
  if (owner == "sensor") {
    for (std::size_t i = 0; i < model.devices.size(); ++i)
      if (!quantities_of(model.devices[i]).empty()) take(model.devices[i].name, i);
  } else if (owner == "link") {
    for (std::size_t i = 0; i < model.links.size(); ++i)
      if (begins_moving_part(i)) take(model.links[i].name, i);
  } else if (owner == "controller") {
    const std::vector<ScenarioController*> all = controllers();
    for (std::size_t i = 0; i < all.size(); ++i) take(all[i]->name, i);
  } else {
    for (std::size_t id = 0; id < model.joints.size(); ++id) {
      const Joint& joint = model.links[static_cast<std::size_t>(model.joints[id])].joint;
      if (owner == "encoder" || (joint.type != JointType::track && !joint.mimic)) take(joint.name, id);
    }
  }
  if (!found.empty()) return found;
  const char* const which = owner != "link"   ? ""
                            : body_.kinematic ? " that a force moves"
                                              : " that begins a moving part";
  findings_.error(node, fmt::format("{} has no {} '{}'{}", body_.name, owner, shortened(*pattern), which),
                  name_hint(*pattern, names, fmt::format("{}s", owner)));
  return std::nullopt;
}

const FaultReader::Kind* FaultReader::find_kind(const Keys& keys, std::string_view owner) const {
  const YamlNode* node = keys.require("fault", "the kind of the fault, as stuck or weak");
  const auto name = node ? read_text(findings_, *node, "fault", "the kind of the fault") : std::nullopt;
  if (!name) return nullptr;
  std::vector<std::string> names;
  for (const Kind& kind : kinds()) {
    if (!kind.is_of(owner)) continue;
    if (kind.name == *name) return &kind;
    names.emplace_back(kind.name);
  }
  findings_.error(*node,
                  fmt::format("'{}' is no fault of {} {}", shortened(*name),
                              owner == "encoder" || owner == "actuator" ? "an" : "a", owner),
                  name_hint(*name, names, "faults"));
  return nullptr;
}

void FaultReader::read(const YamlNode& node) {
  const Keys keys(findings_, node, fault_form());
  if (!keys.is_map()) return;
  const auto count =
      std::ranges::count_if(fault_owners, [&](std::string_view key) { return keys.find(key) != nullptr; });
  if (count != 1)
    return findings_.error(node, fmt::format("the fault names {} parts of the body", count),
                           "expected one of sensor, encoder (of a joint), actuator, link and controller");
  const std::string_view owner =
      *std::ranges::find_if(fault_owners, [&](std::string_view key) { return keys.find(key) != nullptr; });
  const auto found = find_owners(*keys.find(owner), owner);
  const Kind* kind = find_kind(keys, owner);
  const ReadFault fault{keys, node, read_spell_keys(findings_, keys)};
  if (!found || !kind) return;
  if (kind->to_reading) return (this->*kind->to_reading)(fault, *found, owner == "encoder");
  if (kind->to_parts) return (this->*kind->to_parts)(fault, *found);
  body_.actuators.resize(body_.model->joints.size());
  for (const std::size_t id : *found) {
    if (!body_.actuators[id]) body_.actuators[id].emplace();
    (this->*kind->to_actuator)(fault, *body_.actuators[id]);
  }
}

void FaultReader::add_stuck(const ReadFault& fault, std::span<const std::size_t> to, bool of_joint) {
  for (const std::size_t index : to) errors_of(index, of_joint).stuck.push_back(fault.when);
}

void FaultReader::add_lost(const ReadFault& fault, std::span<const std::size_t> to, bool of_joint) {
  for (const std::size_t index : to) errors_of(index, of_joint).lost.push_back(fault.when);
}

void FaultReader::add_delayed(const ReadFault& fault, std::span<const std::size_t> to, bool of_joint) {
  const YamlNode* by = fault.keys.require("by", "the delay, as 20 ms");
  const auto delay = by ? read_quantity(findings_, *by, "by", time_units, any_latency) : std::nullopt;
  if (!delay) return;
  for (const std::size_t index : to) errors_of(index, of_joint).delayed.push_back({*delay, fault.when});
}

void FaultReader::add_offset(const ReadFault& fault, std::span<const std::size_t> to, bool of_joint) {
  const YamlNode* by = fault.keys.require("by", "the change of the readings, in the unit of the quantity");
  const YamlNode* name = fault.keys.require("quantity", "the quantity, as angular_velocity");
  if (!by || !name) return;
  for (const std::size_t index : to) add_offset_to(fault, *by, *name, index, of_joint);
}

void FaultReader::add_offset_to(const ReadFault& fault, const YamlNode& by, const YamlNode& name, std::size_t index,
                                bool of_joint) {
  const Model& model = *body_.model;
  const std::vector<MeasuredQuantity> quantities =
      of_joint ? std::vector<MeasuredQuantity>(joint_quantities.begin(), joint_quantities.end())
               : quantities_of(model.devices[index]);
  const auto found =
      std::ranges::find_if(quantities, [&](const MeasuredQuantity& each) { return each.name == name.text; });
  if (found == quantities.end()) {
    std::vector<std::string> names;
    for (const MeasuredQuantity& each : quantities) names.emplace_back(each.name);
    return findings_.error(name, fmt::format("it doesn't measure '{}'", shortened(name.text)),
                           name_hint(name.text, names, "quantities"));
  }
  const auto forms = error_forms();
  const ErrorForm& offset = **std::ranges::find_if(forms, [](const ErrorForm* form) { return form->key == "offset"; });
  const bool slides = of_joint && is_linear(model.links[static_cast<std::size_t>(model.joints[index])].joint.type);
  const auto numbers = read_error_numbers(findings_, by, offset, *found, slides);
  if (!numbers) return;
  ReadingErrors& errors = errors_of(index, of_joint);
  errors.quantities.resize(quantities.size());
  std::vector<GivenError>& given = errors.quantities[static_cast<std::size_t>(found - quantities.begin())].given;
  const auto place_of = [&](const ErrorForm* form) { return std::ranges::find(forms, form); };
  const auto after =
      std::ranges::find_if(given, [&](const GivenError& each) { return place_of(each.form) > place_of(&offset); });
  given.insert(after, {&offset, *numbers, fault.when});
}

void FaultReader::add_weak(const ReadFault& fault, Actuator& actuator) {
  const YamlNode* node = fault.keys.require("effort", "the share of its effort that is left, as 0.4");
  const auto share = node ? read_number(findings_, *node, "effort", any_share) : std::nullopt;
  if (share) actuator.faults.push_back({ActuatorFault::Kind::weak, *share, fault.when.from, fault.when.until});
}

void FaultReader::add_heavier(const ReadFault& fault, std::span<const std::size_t> links) {
  const YamlNode* node = fault.keys.require("mass", "the factor of its mass, as 1.5");
  const auto factor = node ? read_number(findings_, *node, "mass", any_mass_factor) : std::nullopt;
  if (!factor) return;
  for (const std::size_t link : links)
    body_.mass_faults.push_back({static_cast<int>(link), *factor, fault.when.from, fault.when.until});
}

void FaultReader::add_lost_commands(const ReadFault& fault, std::span<const std::size_t> controllers) {
  for (const std::size_t index : controllers) this->controllers()[index]->lost.push_back(fault.when);
}

}  // namespace

bool ScenarioController::loses(double time, double time_step) const {
  return std::ranges::any_of(lost, [&](const Spell& spell) { return acts(spell.from, spell.until, time, time_step); });
}

const Form& fault_form() {
  static const Form form{"fault",
                         "a fault",
                         {{"sensor", types::text(), "a device, or a pattern of devices"},
                          {"encoder", types::text(), "a joint, or a pattern of joints"},
                          {"actuator", types::text(), "a joint, or a pattern of joints"},
                          {"link", types::text(), "the first link of a rigid part, or a pattern of such links"},
                          {"controller", types::text(), "a controller, or a pattern of controllers"},
                          {"fault", types::word(FaultReader::kind_names()), "the kind of the fault", required},
                          *spell_form().find("from"),
                          *spell_form().find("until"),
                          {"by", types::either({types::text(), types::vector3({-1e6, 1e6})}),
                           "the delay, as 20 ms, or the change of the readings"},
                          {"quantity", types::text(), "the quantity that an offset changes"},
                          {"effort", types::number(any_share), "share of the effort that is left"},
                          {"mass", types::number(any_mass_factor), "factor of the mass"}},
                         {},
                         {{"sensor", "encoder", "actuator", "link", "controller"}}};
  return form;
}

Result<void> add_faults(ScenarioBody& body, const std::vector<std::string>& entries) {
  std::string text;
  for (const std::string& entry : entries) text += "- " + entry + '\n';
  if (text.empty()) return {};
  const YamlNodePtr list = REHEARSE_TRY(parse_yaml(text, "faults"));
  Findings findings("faults");
  give_room(body);
  FaultReader reader(findings, body);
  for (const YamlNodePtr& fault : list->items) reader.read(*fault);
  if (findings.any_error()) return findings.errors();
  return {};
}

bool fault_reads(std::string_view fault, std::string_view key) { return FaultReader::reads(fault, key); }

void read_faults(Findings& findings, const YamlNode& bodies, Scenario& scenario) {
  const std::vector<YamlNodePtr>& list = bodies.items;
  if (list.size() != scenario.bodies.size()) return;  // it is no list of bodies, which is reported
  for (std::size_t i = 0; i < list.size(); ++i) {
    ScenarioBody& body = scenario.bodies[i];
    const YamlNode* faults = list[i]->kind == YamlNode::Kind::map ? find_key(*list[i], "faults") : nullptr;
    if (!faults || !body.model) continue;
    give_room(body);
    FaultReader reader(findings, body);
    for (const YamlNodePtr& fault :
         read_list(findings, *faults, "faults", "a list of {sensor: NAME, fault: KIND, from: T, until: T}"))
      reader.read(*fault);
  }
}

}  // namespace rehearse
