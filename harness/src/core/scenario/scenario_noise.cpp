// The `noise` of a scenario: deviations of the readings of sensors and joints from the truth.
#include <rehearse/scenario.h>

#include "core/mcap/glob.h"
#include "model/names.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace rehearse {
namespace {

/// The quantities of all devices, and those of joints.
const std::vector<std::string_view>& quantity_keys() {
  static const std::vector<std::string_view> all = [] {
    std::vector<std::string_view> names;
    for (const DeviceKind& kind : device_kinds()) {
      Device device;
      device.kind = kind;
      for (const MeasuredQuantity& quantity : quantities_of(device))
        if (std::find(names.begin(), names.end(), quantity.name) == names.end()) names.push_back(quantity.name);
    }
    for (const MeasuredQuantity& quantity : joint_quantities) names.push_back(quantity.name);
    return names;
  }();
  return all;
}

std::vector<std::string_view> with_quantities(std::vector<std::string_view> keys) {
  keys.insert(keys.end(), quantity_keys().begin(), quantity_keys().end());
  return keys;
}

constexpr double largest = 1e6;  // of a bias or standard deviation, in any unit

/// A device or a joint with noise.
struct Target {
  std::string name;  // Body/Device or Body/Joint
  std::vector<MeasuredQuantity> quantities;
  std::vector<Noise>* noise = nullptr;  // destination; null for a joint
  double* dropout = nullptr;            // null for a joint
  JointNoise* joint = nullptr;          // null for a device
};

class NoiseReader {
 public:
  NoiseReader(Findings& findings, Scenario& scenario);
  void read_rule(const YamlNode& node);

 private:
  using Given = std::vector<std::pair<std::string_view, Noise>>;  // by quantity

  std::optional<std::vector<const Target*>> find_targets(const Keys& keys, const YamlNode& node) const;
  Given read_quantities(const Keys& keys, const std::vector<const Target*>& targets) const;
  Noise read_noise(const NamedEntry& entry, int axes) const;
  static void give(const Target& target, const Given& given, double dropout);

  Findings& findings_;
  std::vector<Target> sensors_;
  std::vector<Target> joints_;
};

NoiseReader::NoiseReader(Findings& findings, Scenario& scenario) : findings_(findings) {
  for (ScenarioBody& body : scenario.bodies) {
    if (body.model == nullptr) continue;
    body.noise.devices.resize(body.model->devices.size());
    body.noise.joints.resize(body.model->joints.size());
    for (std::size_t i = 0; i < body.model->devices.size(); ++i) {
      const Device& device = body.model->devices[i];
      DeviceNoise& noise = body.noise.devices[i];
      if (std::vector<MeasuredQuantity> quantities = quantities_of(device); !quantities.empty())
        sensors_.push_back(
            {body.name + "/" + device.name, std::move(quantities), &noise.quantities, &noise.dropout, nullptr});
    }
    for (std::size_t id = 0; id < body.model->joints.size(); ++id) {
      const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
      joints_.push_back({body.name + "/" + joint.name,
                         {joint_quantities.begin(), joint_quantities.end()},
                         nullptr,
                         nullptr,
                         &body.noise.joints[id]});
    }
  }
}

/// The targets that match the rule's pattern; if there are none, an error is reported and the result is none.
std::optional<std::vector<const Target*>> NoiseReader::find_targets(const Keys& keys, const YamlNode& node) const {
  const YamlNode* sensor = keys.find("sensor");
  const YamlNode* joint = keys.find("joint");
  if ((sensor == nullptr) == (joint == nullptr)) {
    findings_.error(node,
                    sensor == nullptr ? "noise names neither a sensor nor a joint" : "noise names a sensor and a joint",
                    "expected one of sensor: Body/Sensor and joint: Body/Joint");
    return std::nullopt;
  }
  const YamlNode& at = sensor == nullptr ? *joint : *sensor;
  const std::string_view key = sensor == nullptr ? "joint" : "sensor";
  const auto pattern = read_text(findings_, at, key, fmt::format("a pattern such as SR1/*"));
  if (!pattern) return std::nullopt;
  std::vector<const Target*> targets;
  std::vector<std::string> names;
  for (const Target& target : sensor == nullptr ? joints_ : sensors_) {
    if (matches(*pattern, target.name)) targets.push_back(&target);
    names.push_back(target.name);
  }
  if (!targets.empty()) return targets;
  findings_.error(at, fmt::format("there is no {} '{}'", key, shortened(*pattern)),
                  name_hint(*pattern, names, fmt::format("{}s", key)));
  return std::nullopt;
}

Noise NoiseReader::read_noise(const NamedEntry& entry, int axes) const {
  Noise noise;
  const Keys keys(findings_, *entry.value, "the noise of a quantity", {"stddev", "bias"});
  if (!keys.is_map()) return noise;
  keys.number("stddev", {0.0, largest}, noise.stddev);
  if (const YamlNode* bias = keys.find("bias")) {
    if (bias->kind == YamlNode::Kind::scalar || axes == 1) {
      const auto all = read_number(findings_, *bias, "bias", {-largest, largest});
      if (all) noise.bias.setConstant(*all);
    } else {
      keys.vector3("bias", {-largest, largest}, noise.bias);
    }
  }
  if (keys.find("stddev") == nullptr && keys.find("bias") == nullptr)
    findings_.error(*entry.value, fmt::format("the noise of {} has neither 'stddev' nor 'bias'", entry.name),
                    "expected {stddev: S, bias: B}, one of them or both");
  return noise;
}

/// Checks that each quantity is one that a target measures.
NoiseReader::Given NoiseReader::read_quantities(const Keys& keys, const std::vector<const Target*>& targets) const {
  Given given;
  for (const NamedEntry& entry : keys.entries()) {
    if (std::find(quantity_keys().begin(), quantity_keys().end(), entry.name) == quantity_keys().end()) continue;
    std::vector<std::string> known;
    std::optional<MeasuredQuantity> found;
    for (const Target* target : targets) {
      for (const MeasuredQuantity& quantity : target->quantities) {
        if (quantity.name == entry.name) found = quantity;
        if (std::find(known.begin(), known.end(), quantity.name) == known.end()) known.emplace_back(quantity.name);
      }
    }
    if (found) {
      given.emplace_back(found->name, read_noise(entry, found->axes));
    } else {
      findings_.error(*entry.key,
                      targets.size() == 1 ? fmt::format("{} doesn't measure '{}'", targets[0]->name, entry.name)
                                          : fmt::format("none of them measures '{}'", entry.name),
                      name_hint(entry.name, known, "quantities"));
    }
  }
  return given;
}

/// A later rule replaces an earlier one completely.
void NoiseReader::give(const Target& target, const Given& given, double dropout) {
  std::vector<Noise> noise(target.quantities.size());
  for (std::size_t i = 0; i < noise.size(); ++i)
    for (const auto& [name, figures] : given)
      if (name == target.quantities[i].name) noise[i] = figures;
  if (target.joint != nullptr) {
    std::copy(noise.begin(), noise.end(), target.joint->quantities.begin());
  } else {
    *target.noise = std::move(noise);
    *target.dropout = dropout;
  }
}

void NoiseReader::read_rule(const YamlNode& node) {
  const Keys keys(findings_, node, "noise", with_quantities({"sensor", "joint", "dropout"}));
  if (!keys.is_map()) return;
  const auto targets = find_targets(keys, node);
  if (!targets) return;
  const Given given = read_quantities(keys, *targets);
  double dropout = 0.0;
  keys.number("dropout", {0.0, 1.0}, dropout);
  if (const YamlNode* place = keys.find("dropout"); place != nullptr && keys.find("joint") != nullptr)
    findings_.error(*place, "joints have no dropout", "each tick has a reading of every joint");
  if (keys.entries().size() == 1)
    findings_.error(node, "noise has neither a quantity nor a dropout",
                    "expected a quantity, as in range: {stddev: 0.01}, or dropout: 0.1");
  for (const Target* target : *targets) give(*target, given, dropout);
}

}  // namespace

void read_noise(Findings& findings, const YamlNode& node, Scenario& scenario) {
  NoiseReader reader(findings, scenario);
  for (const YamlNodePtr& rule : read_list(findings, node, "noise", "a list of noise of sensors and joints"))
    reader.read_rule(*rule);
}

}  // namespace rehearse
