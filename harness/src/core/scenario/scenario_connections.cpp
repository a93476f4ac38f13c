// Joints between links in addition to those of the models, and welds for a time.
#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace rehearse {
namespace {

using Type = LoopJoint::Type;

constexpr const char* two_links = "a list of two links, [BODY/LINK, BODY/LINK]";
constexpr const char* motions = "fixed, revolute, prismatic or spherical";

/// A joint while it is read.
struct JointKeys : Connection {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

const BoundForm<JointKeys>& bound_joint_form() {
  static const BoundForm<JointKeys> form{
      "joint",
      "a joint",
      {FormKey{"name", types::name(), "unique among joints and welds"},
       {"type",
        &JointKeys::type,
        {motions,
         {{"fixed", Type::fixed},
          {"revolute", Type::revolute},
          {"prismatic", Type::prismatic},
          {"spherical", Type::spherical}}},
        "the motion that the joint leaves",
        {motions}},
       FormKey{"between", types::list(types::text(), 2, 2), "two links, [BODY/LINK, BODY/LINK]", required},
       {"at", &JointKeys::place, any_position, "its place in the first link's frame, in the initial posture [m]"},
       FormKey{"axis", types::vector3({-1e6, 1e6}),
               "required of revolute and prismatic joints: in the first link's frame, of any length but 0"}}};
  return form;
}

/// Body and link of "BODY/LINK", or of "BODY", which means its root link.
std::optional<std::pair<int, int>> read_end(Findings& findings, const YamlNode& node, const Scenario& scenario) {
  const auto name = read_text(findings, node, "a link", two_links);
  if (!name) return std::nullopt;
  const std::size_t slash = std::min(name->find('/'), name->size());
  const auto body = find_body(findings, node, std::string_view(*name).substr(0, slash), scenario);
  if (!body) return std::nullopt;
  const ScenarioBody& of = scenario.bodies[static_cast<std::size_t>(*body)];
  if (slash == name->size() || of.model == nullptr) return std::pair(*body, 0);
  const auto link = find_link(findings, node, name->substr(slash + 1), of);
  return link ? std::optional(std::pair(*body, *link)) : std::nullopt;
}

/// The two links, and the default name. False if there is a mistake.
bool read_between(Findings& findings, const Keys& keys, const Scenario& scenario, Connection& connection) {
  const YamlNode* node = keys.require("between", two_links);
  if (node == nullptr) return false;
  if (node->kind != YamlNode::Kind::list || node->items.size() != 2) {
    expected(findings, *node, "between", two_links);
    return false;
  }
  const auto first = read_end(findings, *node->items[0], scenario);
  const auto second = read_end(findings, *node->items[1], scenario);
  if (!first || !second) return false;
  std::tie(connection.body, connection.link) = *first;
  std::tie(connection.other_body, connection.other_link) = *second;
  if (first == second) {
    findings.error(*node, "a link is connected to itself", two_links);
    return false;
  }
  return true;
}

/// Adds a connection. Its name must be unique, because states are matched by it.
void add(Findings& findings, const YamlNode& node, const Keys& keys, const char* kind, Connection connection,
         Scenario& scenario) {
  const YamlNode* name = keys.find("name");
  connection.name = fmt::format("{} {}", kind, scenario.connections.size() + 1);
  if (name != nullptr) connection.name = read_name(findings, *name, "name").value_or(connection.name);
  const auto is_same = [&](const Connection& other) { return other.name == connection.name; };
  if (std::ranges::any_of(scenario.connections, is_same))
    findings.error(name == nullptr ? node : *name, fmt::format("a second connection is named '{}'", connection.name),
                   "expected a name of its own");
  scenario.connections.push_back(std::move(connection));
}

void read_connection(Findings& findings, const YamlNode& node, Scenario& scenario) {
  const Keys keys(findings, node, joint_form());
  if (!keys.is_map()) return;
  JointKeys connection;
  bound_joint_form().read(keys, connection);
  const bool is_right = read_between(findings, keys, scenario, connection);
  connection.frame.translation() = connection.place;
  const bool has_axis = connection.type == Type::revolute || connection.type == Type::prismatic;
  const YamlNode* axis = keys.find("axis");
  if (axis != nullptr && !has_axis)
    findings.error(*axis, "axis is given for a joint without one", "revolute and prismatic joints have an axis");
  if (has_axis) axis = keys.require("axis", "a direction in the first link's frame, as in [0, 0, 1]");
  if (axis != nullptr) {
    const auto along = read_vector3(findings, *axis, "axis", {-1e6, 1e6});
    if (along && along->isZero(0.0)) expected(findings, *axis, "axis", "a direction as in [0, 0, 1]");
    if (along && !along->isZero(0.0)) connection.axis = along->stableNormalized();
  }
  if (is_right) add(findings, node, keys, "joint", std::move(connection), scenario);
}

void read_weld(Findings& findings, const YamlNode& node, Scenario& scenario) {
  const Keys keys(findings, node, weld_form());
  if (!keys.is_map()) return;
  Connection connection;
  const bool is_right = read_between(findings, keys, scenario, connection);
  if (const auto span = read_span(findings, keys, scenario, "weld")) {
    connection.from = span->from;
    connection.until = span->until;
  }
  if (is_right) add(findings, node, keys, "weld", std::move(connection), scenario);
}

}  // namespace

const Form& joint_form() { return bound_joint_form(); }

const Form& weld_form() {
  static const Form form{"weld",
                         "a weld",
                         {{"name", types::name(), "unique among joints and welds"},
                          {"between", types::list(types::text(), 2, 2), "two links, [BODY/LINK, BODY/LINK]", required},
                          {"from", types::number(any_time), "when it begins [s]", required},
                          {"until", types::number(any_time), "when it ends [s]", required}}};
  return form;
}

void read_connections(Findings& findings, const YamlNode& node, Scenario& scenario) {
  for (const YamlNodePtr& joint : read_list(findings, node, "joints", "a list of joints between links"))
    read_connection(findings, *joint, scenario);
}

void read_welds(Findings& findings, const YamlNode& node, Scenario& scenario) {
  for (const YamlNodePtr& weld : read_list(findings, node, "welds", "a list of welds"))
    read_weld(findings, *weld, scenario);
}

}  // namespace rehearse
