// Contact properties of links: <gazebo reference="LINK"> of Gazebo, and <contact> in a <link> of PyBullet.
#include "urdf_draft.h"
#include "urdf_suggestions.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <map>
#include <string_view>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

/// The allowed range of a number; other numbers are left out.
enum class Allowed { not_negative, positive, share };

bool makes_sense(double value, Allowed allowed) {
  if (allowed == Allowed::positive) return value > 0.0;
  return value >= 0.0 && (allowed != Allowed::share || value <= 1.0);
}

/// A number of a surface, with its names in Gazebo and in PyBullet.
struct Figure {
  std::vector<std::string_view> names;
  std::optional<double> Surface::*place;
  Allowed allowed;
  const char* hint;
};

const std::vector<Figure>& gazebo_figures() {
  static const std::vector<Figure> figures = {
      {{"mu1", "mu"}, &Surface::friction, Allowed::not_negative, "a coefficient of friction is at least 0"},
      {{"mu2"}, &Surface::second_friction, Allowed::not_negative, "a coefficient of friction is at least 0"},
      {{"mu_torsion"}, &Surface::torsional_friction, Allowed::not_negative, "torsional friction is at least 0 [m]"},
      {{"mu_rolling"}, &Surface::rolling_friction, Allowed::not_negative, "rolling friction is at least 0 [m]"},
      {{"kp"}, &Surface::stiffness, Allowed::positive, "a stiffness is above 0 [N/m]"},
      {{"kd"}, &Surface::damping, Allowed::not_negative, "a damping is at least 0 [N·s/m]"},
      {{"minDepth", "min_depth"}, &Surface::min_depth, Allowed::not_negative, "a depth is at least 0 [m]"},
      {{"maxVel", "max_vel"}, &Surface::max_velocity, Allowed::not_negative, "a velocity is at least 0 here [m/s]"},
  };
  return figures;
}

const std::vector<Figure>& bullet_figures() {
  static const std::vector<Figure> figures = {
      {{"lateral_friction"}, &Surface::friction, Allowed::not_negative, "a coefficient of friction is at least 0"},
      {{"spinning_friction"},
       &Surface::torsional_friction,
       Allowed::not_negative,
       "spinning friction is at least 0 [m]"},
      {{"rolling_friction"}, &Surface::rolling_friction, Allowed::not_negative, "rolling friction is at least 0 [m]"},
      {{"stiffness"}, &Surface::stiffness, Allowed::positive, "a stiffness is above 0 [N/m]"},
      {{"damping"}, &Surface::damping, Allowed::not_negative, "a damping is at least 0 [N·s/m]"},
      {{"restitution"}, &Surface::restitution, Allowed::share, "a restitution is 0 to 1"},
  };
  return figures;
}

const Figure* find_figure(const std::vector<Figure>& figures, std::string_view name) {
  const auto found = std::ranges::find_if(
      figures, [&](const Figure& figure) { return std::ranges::find(figure.names, name) != figure.names.end(); });
  return found == figures.end() ? nullptr : &*found;
}

void set(const Figure& figure, double value, const XMLElement& element, Surface& surface, Findings& findings) {
  if (makes_sense(value, figure.allowed)) {
    surface.*figure.place = value;
  } else {
    findings.repair(element.GetLineNum(), fmt::format("{} is {}; it is left out", tag(element.Name()), value),
                    figure.hint);
  }
}

/// In Gazebo 0 0 0 means no direction.
void read_direction(const XMLElement& element, Surface& surface, Findings& findings) {
  const auto numbers = read_text_numbers(element, 3, findings);
  if (!numbers) return;
  const Eigen::Vector3d direction(numbers->data());
  if (!direction.isZero(0.0)) surface.friction_direction = direction.stableNormalized();
}

/// Reads a child of a block that has a reference; false if the child is unknown.
bool read_option(const XMLElement& element, SurfaceDraft& draft, Findings& findings) {
  const std::string_view name = element.Name();
  if (const Figure* figure = find_figure(gazebo_figures(), name)) {
    if (const auto value = read_text_number(element, findings)) set(*figure, *value, element, draft.surface, findings);
  } else if (name == "fdir1") {
    read_direction(element, draft.surface, findings);
  } else if (is_one_of(name, {"selfCollide", "self_collide"})) {
    draft.collides_with_own = read_text_flag(element, findings);
  } else if (name == "gravity") {
    draft.has_weight = read_text_flag(element, findings);
  } else if (is_one_of(name, {"turnGravityOff", "turn_gravity_off"})) {
    if (const auto is_off = read_text_flag(element, findings)) draft.has_weight = !*is_off;
  } else {
    return false;
  }
  draft.says_something = true;
  return true;
}

/// Reads a child of a block of the whole robot; false if the child is unknown.
bool read_robot_option(const XMLElement& element, Draft& draft, Findings& findings) {
  const std::string_view name = element.Name();
  if (name == "static") {
    draft.is_static = read_text_flag(element, findings).value_or(false);
    draft.static_line = element.GetLineNum();
  } else if (is_one_of(name, {"selfCollide", "self_collide"})) {
    draft.collides_with_own = read_text_flag(element, findings);
  } else {
    return false;
  }
  return true;
}

/// Children that other readers read.
bool is_device(std::string_view name) {
  return is_one_of(name, {"sensor", "light", "rotor", "holder", "pseudo_continuous_track", "springStiffness",
                          "spring_stiffness", "springReference", "spring_reference"}) ||
         name.starts_with("sensor:");
}

void read_block(const XMLElement& block, Draft& draft, Findings& findings) {
  const char* reference = block.Attribute("reference");
  SurfaceDraft surface;
  surface.reference = reference == nullptr ? "" : reference;
  const bool is_of_robot = surface.reference.empty();
  surface.line = block.GetLineNum();
  for (const auto* child = block.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (is_device(child->Name())) {
      surface.has_devices = true;
    } else if (is_of_robot ? !read_robot_option(*child, draft, findings) : !read_option(*child, surface, findings)) {
      const bool needs_link = is_of_robot && find_figure(gazebo_figures(), child->Name()) != nullptr;
      findings.ignored(child->GetLineNum(),
                       fmt::format("<gazebo>{}{}", tag(child->Name()), needs_link ? " without a link" : ""));
    }
  }
  if (!is_of_robot) draft.surfaces.push_back(std::move(surface));
}

template <class Value>
void take_value(const std::optional<Value>& from, std::optional<Value>& to) {
  if (from) to = from;
}

void apply_to(const SurfaceDraft& draft, Link& link) {
  for (const Figure& figure : gazebo_figures()) take_value(draft.surface.*figure.place, link.surface.*figure.place);
  take_value(draft.surface.friction_direction, link.surface.friction_direction);
  link.has_weight = draft.has_weight.value_or(link.has_weight);
  link.collides_with_own = draft.collides_with_own.value_or(link.collides_with_own);
}

}  // namespace

void read_surfaces(const XMLElement& robot, Draft& draft, Findings& findings) {
  for (const auto* block = robot.FirstChildElement("gazebo"); block != nullptr;
       block = block->NextSiblingElement("gazebo")) {
    read_block(*block, draft, findings);
  }
}

void read_contact(const XMLElement& contact, Surface& surface, Findings& findings) {
  for (const auto* child = contact.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const Figure* figure = find_figure(bullet_figures(), child->Name());
    REHEARSE_ASSERT(figure != nullptr, "the schema allows only the elements of this table");
    if (const auto value = read_number(*child, "value", findings)) set(*figure, *value, *child, surface, findings);
  }
}

void apply_surfaces(const Draft& draft, Model& model, Findings& findings) {
  std::map<std::string_view, Link*> links, joints;
  for (Link& link : model.links) {
    links.emplace(link.name, &link);
    joints.emplace(link.joint.name, &link);
    link.collides_with_own = draft.collides_with_own.value_or(false);
  }
  Suggestions suggestions = links_of(model);
  for (const SurfaceDraft& surface : draft.surfaces) {
    const bool is_joint = joints.contains(surface.reference);
    if (const auto link = links.find(surface.reference); link != links.end()) {
      apply_to(surface, *link->second);
    } else if (is_joint && surface.says_something) {
      findings.warning(surface.line, fmt::format("<gazebo> sets properties of links for joint {}; they are passed over",
                                                 in_quotes(surface.reference)));
    } else if (!is_joint && !surface.has_devices) {
      findings.warning(
          surface.line,
          fmt::format("<gazebo> refers to {}, which is neither a link nor a joint", in_quotes(surface.reference)),
          suggestions.of(surface.reference));
    }
  }
}

}  // namespace rehearse::urdf
