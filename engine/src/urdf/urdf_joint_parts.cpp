// Springs and rotors of joints, and joints that close loops: parts that are outside of the <joint> elements.
#include "urdf_draft.h"
#include "urdf_suggestions.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <utility>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

const XMLElement* find_either(const XMLElement& block, const char* name, const char* other) {
  const XMLElement* found = block.FirstChildElement(name);
  return found == nullptr ? block.FirstChildElement(other) : found;
}

std::optional<LoopJoint::Type> loop_type(const XMLElement& element, Findings& findings) {
  const char* text = element.Attribute("type");
  const std::string_view type = text == nullptr ? "" : text;
  if (is_one_of(type, {"revolute", "continuous", "hinge", "pin"})) return LoopJoint::Type::revolute;
  if (type == "prismatic") return LoopJoint::Type::prismatic;
  if (is_one_of(type, {"spherical", "ball"})) return LoopJoint::Type::spherical;
  if (type == "fixed") return LoopJoint::Type::fixed;
  findings.error(element.GetLineNum(), fmt::format("unknown type {} of a <loop_joint>", in_quotes(type)),
                 "fixed, revolute, prismatic or spherical");
  return std::nullopt;
}

/// <link1> or <link2>: the link's name, and the joint's place in its frame.
std::optional<std::string> read_end(const XMLElement& loop, const char* end, Eigen::Isometry3d& frame,
                                    Findings& findings) {
  const XMLElement* place = loop.FirstChildElement(end);
  if (place == nullptr) {
    findings.error(loop.GetLineNum(), fmt::format("a <loop_joint> without <{}>", end));
    return std::nullopt;
  }
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const auto xyz = read_vector_or(*place, "xyz", zero, findings);
  const auto rpy = read_vector_or(*place, "rpy", zero, findings);
  if (xyz) frame.translation() = *xyz;
  if (rpy) frame.linear() = rotation_from_rpy(*rpy);
  return read_name(*place, "link", findings);
}

std::optional<LoopDraft> read_loop(const XMLElement& element, Findings& findings) {
  LoopDraft draft;
  draft.line = element.GetLineNum();
  const auto name = read_name(element, "name", findings);
  const auto type = loop_type(element, findings);
  const auto link = read_end(element, "link1", draft.joint.frame, findings);
  const auto other = read_end(element, "link2", draft.joint.other_frame, findings);
  if (const XMLElement* axis = element.FirstChildElement("axis")) {
    const auto xyz = read_vector(*axis, "xyz", findings);
    if (xyz && xyz->isZero(0.0))
      findings.error(axis->GetLineNum(), "the axis of a <loop_joint> is zero", "a direction as in 0 0 1");
    else if (xyz)
      draft.joint.axis = xyz->stableNormalized();
  }
  if (!name || !type || !link || !other) return std::nullopt;
  draft.joint.name = *name;
  draft.joint.type = *type;
  draft.link = *link;
  draft.other_link = *other;
  return draft;
}

Joint* find_joint(Model& model, const std::string& name) {
  for (const int index : model.joints)
    if (Joint& joint = model.links[static_cast<std::size_t>(index)].joint; joint.name == name) return &joint;
  return nullptr;
}

}  // namespace

std::vector<SpringDraft> read_springs(const XMLElement& robot, Findings& findings) {
  std::vector<SpringDraft> springs;
  for (const auto* block = robot.FirstChildElement("gazebo"); block != nullptr;
       block = block->NextSiblingElement("gazebo")) {
    const char* reference = block->Attribute("reference");
    const XMLElement* stiffness = find_either(*block, "springStiffness", "spring_stiffness");
    const XMLElement* zero = find_either(*block, "springReference", "spring_reference");
    if (stiffness == nullptr && zero == nullptr) continue;
    SpringDraft spring;
    spring.line = (stiffness == nullptr ? zero : stiffness)->GetLineNum();
    spring.reference = reference == nullptr ? "" : reference;
    if (stiffness != nullptr) spring.stiffness = read_text_number(*stiffness, findings).value_or(0.0);
    if (zero != nullptr) spring.zero = read_text_number(*zero, findings).value_or(0.0);
    if (spring.stiffness < 0.0) {
      findings.repair(spring.line,
                      fmt::format("the spring of joint {} has a stiffness of {}; it is left out",
                                  in_quotes(spring.reference), spring.stiffness),
                      "a stiffness is at least 0 [N·m/rad] or [N/m]");
      continue;
    }
    springs.push_back(std::move(spring));
  }
  return springs;
}

std::vector<LoopDraft> read_loops(XMLElement& robot, Findings& findings) {
  std::vector<LoopDraft> loops;
  for (const auto* loop = robot.FirstChildElement("loop_joint"); loop != nullptr;
       loop = loop->NextSiblingElement("loop_joint"))
    if (auto read = read_loop(*loop, findings)) loops.push_back(std::move(*read));
  return loops;
}

void apply_joint_parts(const Draft& draft, Model& model, Findings& findings) {
  for (const SpringDraft& spring : draft.springs) {
    if (Joint* joint = find_joint(model, spring.reference)) {
      joint->spring_stiffness = spring.stiffness;
      joint->spring_reference = spring.zero;
    } else {
      findings.warning(spring.line, fmt::format("a spring of {}, which isn't a joint that moves; it is passed over",
                                                in_quotes(spring.reference)));
    }
  }
  for (const RotorInertiaDraft& rotor : draft.rotors) {
    Joint* joint = find_joint(model, rotor.joint);
    if (joint == nullptr) {
      findings.warning(rotor.line, fmt::format("a rotor of {}, which isn't a joint that moves; it is passed over",
                                               in_quotes(rotor.joint)));
    } else if (joint->armature == 0.0) {
      joint->armature = rotor.ratio * rotor.ratio * rotor.inertia;
      joint->rotor_inertia = rotor.inertia;
      joint->gear_ratio = rotor.ratio;
    }
  }
  Suggestions suggestions = links_of(model);
  for (const LoopDraft& loop : draft.loops) {
    LoopJoint joint = loop.joint;
    joint.link = model.find_link(loop.link);
    joint.other_link = model.find_link(loop.other_link);
    for (const auto& [index, name] : {std::pair(joint.link, &loop.link), std::pair(joint.other_link, &loop.other_link)})
      if (index < 0)
        findings.error(
            loop.line,
            fmt::format("loop_joint {} names {}, which isn't a link", in_quotes(joint.name), in_quotes(*name)),
            suggestions.of(*name));
    if (joint.link >= 0 && joint.link == joint.other_link)
      findings.error(loop.line, fmt::format("loop_joint {} connects a link to itself", in_quotes(joint.name)));
    if (joint.link >= 0 && joint.other_link >= 0) model.loops.push_back(std::move(joint));
  }
}

}  // namespace rehearse::urdf
