#include "urdf_devices.h"

#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <limits>
#include <optional>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

/// The child's number, or `fallback` if the child is missing; an error if it is below 0.
float read_not_negative_or(const XMLElement& element, const char* child, float fallback, Findings& findings) {
  const XMLElement* place = element.FirstChildElement(child);
  if (place == nullptr) return fallback;
  const double value = read_text_number(*place, findings).value_or(fallback);
  if (value >= 0.0) return static_cast<float>(value);
  findings.error(place->GetLineNum(), fmt::format("<{}> is {}; it must not be below 0", child, value));
  return fallback;
}

void read_color(const XMLElement& element, Light& light, Findings& findings) {
  const auto rgba = read_text_numbers(element, 4, findings);
  if (!rgba) return;
  for (int i = 0; i < 3; ++i) light.color[i] = static_cast<float>((*rgba)[i]);
  if (light.color.minCoeff() < 0.0f || light.color.maxCoeff() > 1.0f)
    findings.error(element.GetLineNum(),
                   fmt::format("the colour of <{}> has a component outside of 0 to 1", element.Name()),
                   "<intensity> makes a light stronger");
}

void read_attenuation(const XMLElement& element, Light& light, Findings& findings) {
  report_ignored(element, {"range", "constant", "linear", "quadratic"}, findings);
  light.range = read_positive_or(&element, "range", light.range, std::numeric_limits<double>::infinity(), findings);
  light.constant = read_not_negative_or(element, "constant", light.constant, findings);
  light.linear = read_not_negative_or(element, "linear", light.linear, findings);
  light.quadratic = read_not_negative_or(element, "quadratic", light.quadratic, findings);
}

/// SDF's angles are those of the whole cone; Light's angles are measured from the axis.
void read_cone(const XMLElement& element, LightCone& cone, Findings& findings) {
  report_ignored(element, {"inner_angle", "outer_angle", "falloff"}, findings);
  constexpr double all_around = 6.2832;  // [rad]
  const int errors_before = findings.error_count();
  const double outer = read_positive_or(&element, "outer_angle", 0.0, all_around, findings);
  const double inner = read_not_negative_or(element, "inner_angle", 0.0f, findings);
  cone.cut_off_exponent = read_not_negative_or(element, "falloff", 0.0f, findings);
  if (findings.error_count() > errors_before) return;
  if (outer == 0.0) {
    findings.error(element.GetLineNum(), "<spot> has no <outer_angle>", "beyond half of it there is no light [rad]");
  } else if (inner > outer) {
    findings.error(element.GetLineNum(),
                   fmt::format("<inner_angle> is {}, above <outer_angle>, which is {}", inner, outer));
  }
  cone.beam_width = static_cast<float>(0.5 * inner);
  cone.cut_off_angle = static_cast<float>(0.5 * outer);
}

void read_direction(const XMLElement& element, LightCone& cone, Findings& findings) {
  const auto direction = read_text_numbers(element, 3, findings);
  if (!direction) return;
  cone.direction = Eigen::Vector3d(direction->data());
  if (cone.direction.isZero(0.0)) findings.error(element.GetLineNum(), "the <direction> of a light is zero");
}

}  // namespace

std::optional<Light> light_of_type(std::string_view type) {
  Light light;
  light.linear = 1.0f;  // SDF's defaults
  light.range = 10.0;
  if (type == "spot") light.cone.emplace();
  return type == "spot" || type == "point" ? std::optional(light) : std::nullopt;
}

void read_light(const XMLElement& element, Light& light, Findings& findings) {
  if (const XMLElement* diffuse = element.FirstChildElement("diffuse")) read_color(*diffuse, light, findings);
  light.intensity = read_not_negative_or(element, "intensity", light.intensity, findings);
  if (const XMLElement* attenuation = element.FirstChildElement("attenuation"))
    read_attenuation(*attenuation, light, findings);
  if (!light.cone) {
    report_ignored(element, {"id", "pose", "diffuse", "intensity", "attenuation"}, findings);
    return;
  }
  report_ignored(element, {"id", "pose", "diffuse", "intensity", "attenuation", "direction", "spot"}, findings);
  if (const XMLElement* direction = element.FirstChildElement("direction"))
    read_direction(*direction, *light.cone, findings);
  if (const XMLElement* spot = element.FirstChildElement("spot")) {
    read_cone(*spot, *light.cone, findings);
  } else {
    findings.error(element.GetLineNum(), fmt::format("light {} has no <spot>", in_quotes(element.Attribute("name"))),
                   "<spot> contains the cone's <inner_angle> and <outer_angle> [rad]");
  }
}

}  // namespace rehearse::urdf
