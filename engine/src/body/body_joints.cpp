// The joint of a link: type, axis, ranges, rotor, start.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "body_draft.h"

namespace rehearse::body {
namespace {

void read_type(Mapping& keys, Joint& joint) {
  const auto word = keys.text({"joint_type", "jointType"});
  if (word) {
    if (*word == "revolute")
      joint.type = JointType::revolute;
    else if (*word == "prismatic" || *word == "slide")
      joint.type = JointType::prismatic;
    else if (*word == "free")
      joint.type = JointType::free;
    else if (*word == "fixed")
      joint.type = JointType::fixed;
    else if (*word == "pseudo_continuous_track" || *word == "pseudoContinuousTrack")
      joint.type = JointType::track;
    else
      keys.document().error(keys.node(), fmt::format("the joint type {} isn't known", in_quotes(*word)),
                            "revolute, prismatic, free, fixed or pseudo_continuous_track");
  }
  const auto mode = keys.text({"actuation_mode", "actuationMode"});
  if (!mode) return;
  if (*mode == "jointSurfaceVelocity")
    joint.type = JointType::track;
  else if (joint.type != JointType::fixed)
    keys.document().passed_over(keys.node(), "a link", "actuationMode");
}

std::optional<Eigen::Vector3d> axis_of(const YamlNode& node, Document& document) {
  if (node.kind != YamlNode::Kind::scalar) {
    const auto values = read_numbers(node, 3, "joint_axis", document);
    if (!values) return std::nullopt;
    return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
  }
  const bool is_negative = node.text.starts_with('-');
  const std::string letter = node.text.substr(is_negative ? 1 : 0);
  for (int i = 0; i < 3; ++i)
    if (letter == std::string(1, "XYZ"[i]) || letter == std::string(1, "xyz"[i]))
      return Eigen::Vector3d(Eigen::Vector3d::Unit(i) * (is_negative ? -1.0 : 1.0));
  document.error(node, fmt::format("the joint axis {} isn't known", in_quotes(node.text)),
                 "X, -X, Y, -Y, Z, -Z or [x, y, z]");
  return std::nullopt;
}

void read_axis(Mapping& keys, Joint& joint) {
  const YamlNode* node = keys.find({"joint_axis", "jointAxis"});
  const auto axis = node == nullptr ? std::nullopt : axis_of(*node, keys.document());
  if (!axis) return;
  if (joint.type == JointType::fixed || joint.type == JointType::free) return;  // an axis means nothing there
  const double length = axis->norm();
  if (length < 1e-6) return keys.document().error(*node, "the joint axis is zero", "as in [0, 0, 1]");
  constexpr double slack = 1e-6;
  if (joint.type == JointType::prismatic && std::abs(length - 1.0) > slack)
    keys.document().warning(*node,
                            fmt::format("the axis of a sliding joint has the length {:.6g}; it is made 1", length),
                            "Choreonoid multiplies the displacement by that length");
  joint.axis = *axis / length;
}

/// A limit as in jointRange: a number or "unlimited".
std::optional<double> read_limit(const YamlNode& node, std::string_view label, double otherwise, Document& document) {
  if (node.kind == YamlNode::Kind::scalar && node.text == "unlimited") return otherwise;
  return read_number(node, label, document);
}

struct Range {
  double lower = -unlimited;
  double upper = unlimited;
};

/// A number for both sides, or a list of two limits.
std::optional<Range> read_range(const YamlNode& node, std::string_view label, Document& document) {
  const bool is_pair = node.kind == YamlNode::Kind::list && node.items.size() == 2;
  if (!is_pair && node.kind != YamlNode::Kind::scalar) {
    document.error(node, fmt::format("{} is neither a number nor a list of two", label), "as in [-90, 90]");
    return std::nullopt;
  }
  const auto upper = read_limit(is_pair ? *node.items[1] : node, label, unlimited, document);
  const auto lower = is_pair ? read_limit(*node.items[0], label, -unlimited, document)
                     : upper ? std::optional(-*upper)
                             : std::nullopt;
  if (!lower || !upper) return std::nullopt;
  if (*lower > *upper) {
    document.error(node, fmt::format("{} begins at {} and ends at {}", label, *lower, *upper), "the lower limit first");
    return std::nullopt;
  }
  return Range{*lower, *upper};
}

/// A file in radians is taken at its word, as Choreonoid does.
void tell_of_degrees(const YamlNode& node, const char* what, double angle, Mapping& keys) {
  constexpr double many_turns = 20.0;  // [rad]
  if (keys.document().degrees || !std::isfinite(angle) || std::abs(angle) <= many_turns) return;
  keys.document().warning(node, fmt::format("the {} {:.6g} rad of a joint looks like degrees", what, angle),
                          "the file states angleUnit: radian");
}

void read_displacement_range(Mapping& keys, Joint& joint) {
  const YamlNode* node = keys.find({"joint_range", "jointRange"});
  const auto range = node == nullptr ? std::nullopt : read_range(*node, "joint_range", keys.document());
  if (!range) return;
  if (!is_movable(joint.type))
    return keys.document().passed_over(*node, "a link that has no displacement", "jointRange");
  const bool turns = joint.type == JointType::revolute;
  joint.lower = turns ? keys.radians(range->lower) : range->lower;
  joint.upper = turns ? keys.radians(range->upper) : range->upper;
  const double upper = std::isfinite(joint.upper) ? std::abs(joint.upper) : 0.0;
  const double lower = std::isfinite(joint.lower) ? std::abs(joint.lower) : 0.0;
  if (turns) tell_of_degrees(*node, "limit", upper >= lower ? joint.upper : joint.lower, keys);
}

void read_velocity_range(Mapping& keys, Joint& joint) {
  const YamlNode* most = keys.find({"max_joint_velocity", "maxJointVelocity"});
  const YamlNode* both = keys.find({"joint_velocity_range", "jointVelocityRange"});
  const YamlNode* node = most != nullptr ? most : both;
  const auto range = node == nullptr ? std::nullopt : read_range(*node, "the range of velocity", keys.document());
  if (!range) return;
  const double slower = std::min(std::abs(range->lower), std::abs(range->upper));
  const auto in_si = [&](double limit) { return joint.type == JointType::revolute ? keys.radians(limit) : limit; };
  joint.velocity = in_si(slower);
  if (range->lower == -range->upper) return;
  joint.velocity_range = {in_si(range->lower), in_si(range->upper)};
  keys.document().warning(*node,
                          fmt::format("the range of velocity is {} to {}: controllers see both limits, drives keep "
                                      "to {} in both directions",
                                      range->lower, range->upper, slower));
}

void read_start(Mapping& keys, Joint& joint) {
  if (const auto angle = keys.angle({"joint_angle", "jointAngle"})) joint.start = *angle;
  const auto displacement = keys.number({"joint_displacement", "jointDisplacement"});
  if (displacement) joint.start = joint.type == JointType::revolute ? keys.radians(*displacement) : *displacement;
  if (!is_movable(joint.type)) joint.start = 0.0;
  if (joint.type == JointType::revolute) tell_of_degrees(keys.node(), "displacement", joint.start, keys);
}

void read_rotor(Mapping& keys, Joint& joint) {
  const auto whole = keys.number({"joint_axis_inertia"});
  const double rotor = keys.soft_number({"rotor_inertia", "rotorInertia"}, 0.0);
  const double ratio = keys.soft_number({"gear_ratio", "gearRatio"}, 1.0);
  joint.armature = whole.value_or(rotor * ratio * ratio);
  joint.rotor_inertia = rotor;
  joint.gear_ratio = ratio;
  if (joint.armature >= 0.0) return;
  keys.document().error(keys.node(), fmt::format("the rotor's inertia is {} kg·m²", joint.armature), "0 or above");
  joint.armature = 0.0;
}

}  // namespace

void read_joint(Mapping& keys, bool of_sub_body, Joint& joint) {
  if (of_sub_body) {  // as in Choreonoid: not those of the sub-body's own root
    joint.lower = -unlimited;
    joint.upper = unlimited;
    joint.velocity = unlimited;
    joint.velocity_range.reset();
  }
  read_type(keys, joint);
  if (const auto id = keys.number({"joint_id", "jointId"})) {
    if (*id >= max_body_links || *id != std::floor(*id))
      keys.document().error(keys.node(), fmt::format("the jointId is {}", *id),
                            fmt::format("a whole number below {}", max_body_links));
    else
      joint.controller_id = std::max(-1, static_cast<int>(*id));
  }
  read_axis(keys, joint);
  read_start(keys, joint);
  read_displacement_range(keys, joint);
  read_velocity_range(keys, joint);
  if (const YamlNode* node = keys.find({"max_joint_effort"}))
    joint.effort = std::abs(read_limit(*node, "max_joint_effort", unlimited, keys.document()).value_or(unlimited));
  read_rotor(keys, joint);
  if (joint.type == JointType::revolute && joint.lower == -unlimited && joint.upper == unlimited)
    joint.type = JointType::continuous;
}

}  // namespace rehearse::body
