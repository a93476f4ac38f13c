#include "base/names.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rehearse {
namespace {

constexpr double slack = 1e-6;  // [rad] or [m]: -90 deg is not beyond a limit that is written -1.5708

class JointReader {
 public:
  JointReader(Findings& findings, ScenarioBody& body)
      : findings_(findings), body_(body), model_(*body.model), places_(model_.joints.size(), nullptr) {
    body.joint_velocities.resize(model_.joints.size(), 0.0);
  }

  void read(const YamlNode& node);
  void place_within_limits(const YamlNode& body_node);
  void place_followers();
  void check_limits(const YamlNode& body_node);
  void state_defaults(const YamlNode& map);
  void read_velocities(const YamlNode& node);

 private:
  const Joint& joint(std::size_t id) const { return model_.links[static_cast<std::size_t>(model_.joints[id])].joint; }
  std::vector<std::string> joint_names() const;
  std::optional<std::size_t> find_id(const NamedEntry& entry, std::string_view quantity);
  void read_all(const YamlNode& node);
  void read_displacement(std::size_t id, const YamlNode& node);

  Findings& findings_;
  ScenarioBody& body_;
  const Model& model_;
  std::vector<const YamlNode*> places_;  // by joint id: node of its displacement; null: none
};

void JointReader::read(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::map) {
    for (const NamedEntry& entry : read_entries(findings_, node))
      if (const auto id = find_id(entry, "displacement")) read_displacement(*id, *entry.value);
  } else if (node.kind == YamlNode::Kind::list) {
    read_all(node);
  } else {
    expected(findings_, node, "joints", "a map of NAME: DISPLACEMENT, or a list of all displacements by joint id");
  }
}

std::vector<std::string> JointReader::joint_names() const {
  std::vector<std::string> names;
  for (std::size_t id = 0; id < model_.joints.size(); ++id) names.push_back(joint(id).name);
  return names;
}

std::optional<std::size_t> JointReader::find_id(const NamedEntry& entry, std::string_view quantity) {
  const int link = model_.find_joint(entry.name);
  if (link < 0) {
    findings_.error(*entry.key, fmt::format("{} has no joint '{}'", body_.name, shortened(entry.name)),
                    name_hint(entry.name, joint_names(), "joints"));
    return std::nullopt;
  }
  const Joint& found = model_.links[static_cast<std::size_t>(link)].joint;
  if (found.name != entry.name) {  // find_joint also accepts the name of the link that a joint moves
    findings_.error(*entry.key, fmt::format("'{}' is a link of {}", entry.name, body_.name),
                    found.name.empty() ? "expected a joint" : fmt::format("its joint is '{}'", found.name));
  } else if (found.id < 0) {
    findings_.error(*entry.key, fmt::format("joint '{}' of {} is {}", entry.name, body_.name, type_name(found.type)),
                    fmt::format("only movable joints have a {}", quantity));
  } else if (found.type == JointType::track) {
    findings_.error(*entry.key, fmt::format("joint '{}' of {} is a track", entry.name, body_.name),
                    fmt::format("a track has a speed by its command, but no initial {}", quantity));
  } else {
    return static_cast<std::size_t>(found.id);
  }
  return std::nullopt;
}

void JointReader::read_all(const YamlNode& node) {
  if (node.items.size() != model_.joints.size()) {
    findings_.error(node,
                    fmt::format("joints lists {} displacements, but {} has {} joints", node.items.size(), body_.name,
                                model_.joints.size()),
                    "expected all of them by joint id, or a map of NAME: DISPLACEMENT");
    return;
  }
  for (std::size_t id = 0; id < node.items.size(); ++id) read_displacement(id, *node.items[id]);
}

void JointReader::read_displacement(std::size_t id, const YamlNode& node) {
  const std::string& name = joint(id).name;
  const bool slides = joint(id).type == JointType::prismatic;
  const auto value = slides ? read_number(findings_, node, name, any_position) : read_angle(findings_, node, name);
  body_.joints[id] = value.value_or(0.0);
  if (value) places_[id] = &node;
}

void JointReader::place_within_limits(const YamlNode& body_node) {
  for (std::size_t id = 0; id < body_.joints.size(); ++id) {
    const Joint& free = joint(id);
    const double start = free.start;
    if (places_[id] != nullptr || free.mimic || (free.lower <= start + slack && free.upper >= start - slack)) continue;
    body_.joints[id] = std::clamp(start, free.lower, free.upper);
    findings_.warning(
        body_node,
        fmt::format("{} starts at {:.6g}, its limit that is nearest to {:.6g}", free.name, body_.joints[id], start),
        "joints: states where it starts");
  }
}

void JointReader::place_followers() {
  for (std::size_t id = 0; id < body_.joints.size(); ++id) {
    const std::optional<Mimic>& mimic = joint(id).mimic;
    if (!mimic) continue;
    const double followed = mimic->multiplier * body_.joints[static_cast<std::size_t>(mimic->leader)] + mimic->offset;
    const double given = std::exchange(body_.joints[id], followed);
    if (places_[id] == nullptr || std::abs(given - followed) <= slack) continue;
    findings_.error(*places_[id],
                    fmt::format("{} can't start at {:.6g}: it follows {}", joint(id).name, given,
                                joint(static_cast<std::size_t>(mimic->leader)).name),
                    fmt::format("leave it out, or give it {:.6g}", followed));
  }
}

void JointReader::check_limits(const YamlNode& body_node) {
  for (std::size_t id = 0; id < body_.joints.size(); ++id) {
    const double q = body_.joints[id];
    if (q >= joint(id).lower - slack && q <= joint(id).upper + slack) continue;
    findings_.warning(places_[id] != nullptr ? *places_[id] : body_node,
                      fmt::format("{} starts at {:.6g}, outside its limits", joint(id).name, q),
                      fmt::format("they are {:.6g} to {:.6g}", joint(id).lower, joint(id).upper));
  }
}

/// The displacements that the map doesn't state.
void JointReader::state_defaults(const YamlNode& map) {
  for (std::size_t id = 0; id < body_.joints.size(); ++id)
    if (places_[id] == nullptr && !joint(id).mimic && joint(id).type != JointType::track)
      findings_.set_default(map, joint(id).name, {fmt::format("{}", body_.joints[id])});
}

void JointReader::read_velocities(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::map) {
    expected(findings_, node, "joint_velocities", "a map of NAME: VELOCITY, [rad/s] or [m/s]");
    return;
  }
  std::vector<double>& velocities = body_.joint_velocities;
  for (const NamedEntry& entry : read_entries(findings_, node)) {
    const auto id = find_id(entry, "velocity");
    if (!id) continue;
    const Range range = joint(*id).type == JointType::prismatic ? any_velocity : any_angular_velocity;
    if (const auto value = read_number(findings_, *entry.value, entry.name, range)) velocities[*id] = *value;
    if (const std::optional<Mimic>& mimic = joint(*id).mimic)
      findings_.error(*entry.key,
                      fmt::format("{} has no initial velocity of its own: it follows {}", entry.name,
                                  joint(static_cast<std::size_t>(mimic->leader)).name),
                      "give the velocity of the joint that it follows");
  }
  for (std::size_t id = 0; id < velocities.size(); ++id)
    if (const std::optional<Mimic>& mimic = joint(id).mimic)
      velocities[id] = mimic->multiplier * velocities[static_cast<std::size_t>(mimic->leader)];
}

}  // namespace

void read_joint_velocities(Findings& findings, const YamlNode& node, ScenarioBody& body) {
  JointReader(findings, body).read_velocities(node);
}

void read_joints(Findings& findings, const YamlNode& body_node, const YamlNode* node, const Posture* posture,
                 ScenarioBody& body) {
  body.joints.clear();
  for (const int link : body.model->joints)
    body.joints.push_back(body.model->links[static_cast<std::size_t>(link)].joint.start);
  if (posture != nullptr) body.joints = posture->q;
  JointReader reader(findings, body);
  if (node != nullptr) reader.read(*node);
  reader.place_within_limits(body_node);
  reader.place_followers();
  reader.check_limits(body_node);
  reader.state_defaults(node != nullptr ? *node : findings.absent_map(body_node, "joints"));
}

}  // namespace rehearse
