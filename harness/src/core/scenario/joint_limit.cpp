#include "joint_limit.h"

#include <fmt/format.h>

#include <cmath>

#include "core/expression/name_search.h"

namespace rehearse {
namespace {

struct NamedJoint {
  std::string name;
  const Joint* joint = nullptr;
};

std::vector<NamedJoint> moving_joints(const Scenario& scenario) {
  std::vector<NamedJoint> joints;
  for (const ScenarioBody& body : scenario.bodies)
    if (body.model)
      for (const Link& link : body.model->links)
        if (link.joint.id >= 0) joints.push_back({body.name + "/" + link.joint.name, &link.joint});
  return joints;
}

double value_of(const Joint& joint, std::string_view limit) {
  if (limit == "effort") return joint.effort;
  if (limit == "velocity") return joint.velocity;
  return limit == "upper" ? joint.upper : joint.lower;
}

std::string unit_of_limit(const Joint& joint, std::string_view limit) {
  const bool slides = joint.type == JointType::prismatic;
  if (limit == "effort") return slides ? "N" : "N·m";
  const std::string displacement = slides ? "m" : "rad";
  return limit == "velocity" ? displacement + "/s" : displacement;
}

}  // namespace

std::vector<std::string> joint_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (NamedJoint& joint : moving_joints(scenario)) names.push_back(std::move(joint.name));
  return names;
}

std::vector<std::string> link_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const ScenarioBody& body : scenario.bodies)
    if (body.model)
      for (const Link& link : body.model->links) names.push_back(body.name + "/" + link.name);
  return names;
}

Result<JointLimit> joint_limit(const Scenario& scenario, std::string_view joint, std::string_view limit) {
  const std::vector<NamedJoint> joints = moving_joints(scenario);
  const auto found = REHEARSE_TRY(find_name(joint, joint_names(scenario), "joint"));
  const NamedJoint& named = joints[found];
  const double value = value_of(*named.joint, limit);
  if (!std::isfinite(value)) return error(fmt::format("joint '{}' has no {} limit", named.name, limit));
  return JointLimit{value, unit_of_limit(*named.joint, limit)};
}

}  // namespace rehearse
