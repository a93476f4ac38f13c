#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

std::optional<JointType> read_type(const XMLElement& element, Findings& findings) {
  const char* text = element.Attribute("type");
  const std::string_view type = text == nullptr ? "" : text;
  if (type == "fixed") return JointType::fixed;
  if (type == "revolute") return JointType::revolute;
  if (type == "continuous") return JointType::continuous;
  if (type == "prismatic") return JointType::prismatic;
  if (type == "floating") return JointType::free;
  const std::string what =
      text == nullptr ? "a joint without a type" : fmt::format("unknown joint type {}", in_quotes(type));
  const bool is_known = type == "planar" || type == "spherical" || type == "ball";
  findings.error(element.GetLineNum(), is_known ? fmt::format("{} joints aren't supported", type) : what,
                 "fixed, revolute, continuous, prismatic or floating");
  return std::nullopt;
}

/// The link that <parent> or <child> names.
std::optional<std::string> read_end(const XMLElement& element, const char* end, const std::string& joint,
                                    Findings& findings) {
  const XMLElement* place = element.FirstChildElement(end);
  if (place == nullptr) {
    findings.error(element.GetLineNum(), fmt::format("joint {} has no <{}>", in_quotes(joint), end));
    return std::nullopt;
  }
  return read_name(*place, "link", findings);
}

void read_axis(XMLElement& element, Joint& joint, Findings& findings) {
  XMLElement* axis = element.FirstChildElement("axis");
  if (axis == nullptr) return;
  // urdfdom would take an <axis/> without numbers for 0 0 0.
  if (axis->Attribute("xyz") == nullptr) axis->SetAttribute("xyz", "1 0 0");
  const auto xyz = read_vector(*axis, "xyz", findings);
  if (!xyz || !is_movable(joint.type)) return;
  const double length = xyz->stableNorm();
  if (length == 0.0) {
    findings.error(axis->GetLineNum(), fmt::format("the axis of joint {} is zero", in_quotes(joint.name)),
                   "a direction as in 0 0 1");
    return;
  }
  joint.axis = *xyz / length;
}

/// Reads a limit of effort or velocity. If `attribute` is missing, it is added to the document as 0, which urdfdom
/// requires.
double read_magnitude(XMLElement& limit, const char* attribute, const Joint& joint, Findings& findings) {
  if (limit.Attribute(attribute) == nullptr) {
    findings.repair(limit.GetLineNum(),
                    fmt::format("the limit of joint {} has no {}; it is unlimited", in_quotes(joint.name), attribute));
    limit.SetAttribute(attribute, "0");
    return unlimited;
  }
  const auto value = read_number(limit, attribute, findings);
  if (!value) return unlimited;
  if (*value > 0.0) return *value;
  if (*value < 0.0) {
    findings.repair(limit.GetLineNum(), fmt::format("the {} limit of joint {} is negative; it is unlimited", attribute,
                                                    in_quotes(joint.name)));
  } else {
    findings.note(limit.GetLineNum(), fmt::format("the {} limit of joint {} is 0, which means not given: unlimited",
                                                  attribute, in_quotes(joint.name)));
  }
  return unlimited;
}

/// Typical angles in degrees: multiples of 5 from 30 to 360, but not the hundreds, which stand for "without limit". No
/// joint reaches such a value in [rad].
bool looks_like_degrees(double angle) {
  const double magnitude = std::abs(angle);
  const bool is_round = std::fmod(magnitude, 5.0) == 0.0 && std::fmod(magnitude, 100.0) != 0.0;
  return magnitude >= 30.0 && magnitude <= 360.0 && is_round;
}

void warn_of_degrees(const XMLElement& limit, double lower, double upper, const Joint& joint, Findings& findings) {
  if (joint.type != JointType::revolute || (!looks_like_degrees(lower) && !looks_like_degrees(upper))) return;
  findings.warning(
      limit.GetLineNum(),
      fmt::format("joint {} has limits of {} and {} rad, which look like degrees", in_quotes(joint.name), lower, upper),
      fmt::format("in radians: {:.5g} and {:.5g}", lower * std::numbers::pi / 180.0, upper * std::numbers::pi / 180.0));
}

void read_range(XMLElement& limit, Joint& joint, Findings& findings) {
  const bool has_lower = limit.Attribute("lower") != nullptr;
  const bool has_upper = limit.Attribute("upper") != nullptr;
  auto lower = read_number_or(limit, "lower", 0.0, findings);
  auto upper = read_number_or(limit, "upper", 0.0, findings);
  if (!lower || !upper) return;
  if (joint.type == JointType::continuous) {
    if (has_lower || has_upper) findings.ignored(limit.GetLineNum(), "the range of a continuous joint");
    return;
  }
  if (*lower > *upper) {
    findings.repair(limit.GetLineNum(),
                    fmt::format("joint {} has a lower limit of {} above its upper limit of {}; they are exchanged",
                                in_quotes(joint.name), *lower, *upper));
    std::swap(lower, upper);
    limit.SetAttribute("lower", fmt::format("{}", *lower).c_str());
    limit.SetAttribute("upper", fmt::format("{}", *upper).c_str());
  }
  if (*lower == *upper) {
    findings.warning(
        limit.GetLineNum(),
        fmt::format("joint {} can't move: its lower and upper limits are both {}", in_quotes(joint.name), *lower),
        has_lower || has_upper ? "" : "it states neither; a joint without limits is continuous");
  }
  if (*lower != *upper && (*lower > 0.0 || *upper < 0.0)) {
    findings.warning(
        limit.GetLineNum(),
        fmt::format("joint {} can't be at 0: its range is {} to {}", in_quotes(joint.name), *lower, *upper),
        "a scenario that doesn't state its displacement starts it at the nearest limit");
  }
  warn_of_degrees(limit, *lower, *upper, joint, findings);
  joint.lower = *lower;
  joint.upper = *upper;
}

/// urdfdom refuses a revolute or prismatic joint without limits: the document gets limits that never act.
void add_endless_limit(XMLElement& element) {
  XMLElement* limit = element.InsertNewChildElement("limit");
  limit->SetAttribute("lower", fmt::format("{}", std::numeric_limits<double>::lowest()).c_str());
  limit->SetAttribute("upper", fmt::format("{}", std::numeric_limits<double>::max()).c_str());
  limit->SetAttribute("effort", "0");
  limit->SetAttribute("velocity", "0");
}

void read_limit(XMLElement& element, Joint& joint, Findings& findings) {
  XMLElement* limit = element.FirstChildElement("limit");
  if (!is_movable(joint.type)) {
    if (limit != nullptr) {
      findings.ignored(limit->GetLineNum(), "the limit of a joint that doesn't move");
      element.DeleteChild(limit);
    }
    return;
  }
  if (limit != nullptr) {
    read_range(*limit, joint, findings);
    joint.effort = read_magnitude(*limit, "effort", joint, findings);
    joint.velocity = read_magnitude(*limit, "velocity", joint, findings);
  } else if (joint.type != JointType::continuous) {
    findings.repair(joint.line, fmt::format("{} joint {} has no <limit>; it is unlimited", type_name(joint.type),
                                            in_quotes(joint.name)));
    add_endless_limit(element);
  }
}

void read_dynamics(XMLElement& element, Joint& joint, Findings& findings) {
  XMLElement* dynamics = element.FirstChildElement("dynamics");
  if (dynamics == nullptr) return;
  joint.damping = read_number_or(*dynamics, "damping", 0.0, findings).value_or(0.0);
  joint.friction = read_number_or(*dynamics, "friction", 0.0, findings).value_or(0.0);
  joint.armature = read_number_or(*dynamics, "armature", 0.0, findings).value_or(0.0);
  if (joint.damping < 0.0 || joint.friction < 0.0 || joint.armature < 0.0) {
    findings.error(dynamics->GetLineNum(),
                   fmt::format("joint {} has a negative damping, friction or armature", in_quotes(joint.name)));
  }
  dynamics->DeleteAttribute("armature");  // of other readers than urdfdom
  // urdfdom refuses an element without attributes.
  if (dynamics->FirstAttribute() == nullptr) element.DeleteChild(dynamics);
}

/// Soft limits are used only by external controllers. urdfdom refuses one without k_velocity.
void read_safety_controller(XMLElement& element, Findings& findings) {
  XMLElement* safety = element.FirstChildElement("safety_controller");
  if (safety == nullptr) return;
  for (const char* figure : {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"})
    static_cast<void>(read_number_or(*safety, figure, 0.0, findings));
  findings.counted(safety->GetLineNum(), "a <safety_controller> isn't enforced");
  element.DeleteChild(safety);
}

std::optional<MimicDraft> read_mimic(XMLElement& element, const Joint& joint, Findings& findings) {
  XMLElement* mimic = element.FirstChildElement("mimic");
  if (mimic == nullptr) return std::nullopt;
  if (!is_movable(joint.type)) {
    findings.ignored(mimic->GetLineNum(), "the <mimic> of a joint that doesn't move");
    element.DeleteChild(mimic);
    return std::nullopt;
  }
  MimicDraft draft;
  draft.line = mimic->GetLineNum();
  const auto leader = read_name(*mimic, "joint", findings);
  const auto multiplier = read_number_or(*mimic, "multiplier", 1.0, findings);
  const auto offset = read_number_or(*mimic, "offset", 0.0, findings);
  if (!leader || !multiplier || !offset) return std::nullopt;
  draft.leader = *leader;
  draft.multiplier = *multiplier;
  draft.offset = *offset;
  return draft;
}

}  // namespace

std::optional<JointDraft> read_joint(XMLElement& element, Findings& findings) {
  JointDraft draft;
  Joint& joint = draft.joint;
  joint.line = element.GetLineNum();
  const auto name = read_name(element, "name", findings);
  if (name) joint.name = *name;
  const auto parent = read_end(element, "parent", joint.name, findings);
  const auto child = read_end(element, "child", joint.name, findings);
  joint.origin = read_origin(element, findings);
  read_safety_controller(element, findings);
  const auto type = read_type(element, findings);
  if (type) {
    joint.type = *type;
    read_axis(element, joint, findings);
    read_limit(element, joint, findings);
    read_dynamics(element, joint, findings);
    draft.mimic = read_mimic(element, joint, findings);
  }
  if (!name || !type || !parent || !child) return std::nullopt;
  draft.parent = *parent;
  draft.child = *child;
  return draft;
}

void declare_world(XMLElement& robot, Draft& draft, Findings& findings) {
  for (const LinkDraft& link : draft.links) {
    if (link.link.name == "world") return;
  }
  for (const JointDraft& joint : draft.joints) {
    if (joint.parent != "world") continue;
    findings.repair(joint.joint.line,
                    fmt::format("the parent of joint {} is a link 'world' that isn't declared; it is added",
                                in_quotes(joint.joint.name)));
    LinkDraft& world = draft.links.emplace_back();
    world.link.name = "world";
    robot.InsertNewChildElement("link")->SetAttribute("name", "world");
    return;
  }
}

}  // namespace rehearse::urdf
