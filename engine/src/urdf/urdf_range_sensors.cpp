#include "urdf_devices.h"

#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr double a_turn = 6.3, straight_up = 1.6;  // [rad], a little more than 2 pi and pi / 2, for rounded numbers
constexpr int most_beams = 1'000'000;              // of one sensor: a scan is one message, and one array in memory

/// The child; null with an error if it is missing.
const XMLElement* require_child(const XMLElement& element, const char* child, const char* hint, Findings& findings) {
  const XMLElement* found = element.FirstChildElement(child);
  if (found == nullptr)
    findings.error(element.GetLineNum(), fmt::format("{} has no <{}>", tag(element.Name()), child), hint);
  return found;
}

/// The child's number, 0 if the child is missing; an error if its magnitude is above `most`.
double read_angle(const XMLElement& element, const char* child, double most, Findings& findings) {
  const XMLElement* place = element.FirstChildElement(child);
  if (place == nullptr) return 0.0;
  const double angle = read_text_number(*place, findings).value_or(0.0);
  if (std::abs(angle) <= most) return angle;
  findings.error(place->GetLineNum(),
                 fmt::format("<{}> of <{}> is {}; it must be {} to {}", child, element.Name(), angle, -most, most),
                 "angles are in radians");
  return 0.0;
}

/// SDF returns samples * resolution values; here each of them is a beam. `name` formats a value as in the file.
template <class Name>
void set_samples(const XMLElement& element, int rays, double resolution, const Name& name, Sweep& sweep,
                 Findings& findings) {
  const double beams = std::max(1.0, std::round(rays * resolution));
  sweep.samples = static_cast<int>(std::min(beams, most_beams + 1.0));
  if (sweep.lower > sweep.upper) {
    findings.error(element.GetLineNum(), fmt::format("{} of <{}> is {}, above {}, which is {}", name("min_angle"),
                                                     element.Name(), sweep.lower, name("max_angle"), sweep.upper));
  } else if (sweep.samples == 1) {
    sweep.lower = sweep.upper = 0.5 * (sweep.lower + sweep.upper);
  } else if (sweep.lower == sweep.upper) {
    findings.error(element.GetLineNum(),
                   fmt::format("the {} beams of <{}> all have the angle {}", beams, element.Name(), sweep.lower),
                   fmt::format("give a {} above {}, or one sample", name("max_angle"), name("min_angle")));
  }
}

/// Reads <horizontal> or <vertical>.
Sweep read_sweep(const XMLElement& element, int samples, double most_angle, Findings& findings) {
  report_ignored(element, {"samples", "resolution", "min_angle", "max_angle"}, findings);
  const int errors_before = findings.error_count();
  Sweep sweep;
  sweep.lower = read_angle(element, "min_angle", most_angle, findings);
  sweep.upper = read_angle(element, "max_angle", most_angle, findings);
  const int rays = read_count_or(&element, "samples", samples, most_beams, findings);
  const double resolution = read_positive_or(&element, "resolution", 1.0, most_beams, findings);
  if (findings.error_count() > errors_before) return sweep;
  set_samples(
      element, rays, resolution, [](const char* figure) { return tag(figure); }, sweep, findings);
  return sweep;
}

/// Reads a sweep with attributes.
Sweep read_optical_sweep(const XMLElement& element, double most_angle, Findings& findings) {
  const int errors_before = findings.error_count();
  Sweep sweep;
  sweep.lower = read_number_or(element, "min_angle", 0.0, findings).value_or(0.0);
  sweep.upper = read_number_or(element, "max_angle", 0.0, findings).value_or(0.0);
  const auto rays = read_count(element, "samples", most_beams, findings);
  std::optional<double> resolution = 1.0;
  if (element.Attribute("resolution") != nullptr)
    resolution = read_positive(element, "resolution", most_beams, findings);
  if (std::max(std::abs(sweep.lower), std::abs(sweep.upper)) > most_angle) {
    findings.error(element.GetLineNum(),
                   fmt::format("the angles of <{}> are {} and {}; they must be {} to {}", element.Name(), sweep.lower,
                               sweep.upper, -most_angle, most_angle),
                   "angles are in radians");
  }
  if (findings.error_count() > errors_before) return sweep;
  set_samples(
      element, *rays, *resolution, [](const char* figure) { return std::string(figure); }, sweep, findings);
  return sweep;
}

/// Checks the number of beams: too many are an error.
void check_beams(const XMLElement& scan, const RangeSensor& laser, Findings& findings) {
  const double beams = static_cast<double>(laser.yaw.samples) * laser.pitch.samples;
  if (beams > most_beams) {
    findings.error(scan.GetLineNum(),
                   fmt::format("a scan has {} beams; {} are the most that are supported", beams, most_beams));
  }
}

void read_scan(const XMLElement& scan, RangeSensor& laser, Findings& findings) {
  report_ignored(scan, {"horizontal", "vertical"}, findings);
  const XMLElement* horizontal =
      require_child(scan, "horizontal", "it contains samples, min_angle and max_angle", findings);
  if (horizontal == nullptr) return;
  laser.yaw = read_sweep(*horizontal, 640, a_turn, findings);
  const XMLElement* vertical = scan.FirstChildElement("vertical");
  if (vertical != nullptr) laser.pitch = read_sweep(*vertical, 1, straight_up, findings);
  check_beams(scan, laser, findings);
}

void read_distances(const XMLElement& range, RangeSensor& laser, Findings& findings) {
  report_ignored(range, {"min", "max"}, findings);
  const int errors_before = findings.error_count();
  if (const XMLElement* min = require_child(range, "min", "nearer shapes aren't measured [m]", findings)) {
    laser.min_distance = read_text_number(*min, findings).value_or(0.0);
    if (laser.min_distance < 0.0)
      findings.error(min->GetLineNum(), fmt::format("<min> is {}; it must not be below 0", laser.min_distance));
  }
  if (const XMLElement* max = require_child(range, "max", "farther shapes aren't measured [m]", findings))
    laser.max_distance = read_text_number(*max, findings).value_or(0.0);
  if (findings.error_count() == errors_before && laser.min_distance >= laser.max_distance) {
    findings.error(range.GetLineNum(),
                   fmt::format("<min> is {}, not below <max>, which is {}", laser.min_distance, laser.max_distance));
  }
}

}  // namespace

void read_range_sensor(const XMLElement& sensor, RangeSensor& laser, Eigen::Isometry3d& pose, Findings& findings) {
  constexpr double any = std::numeric_limits<double>::infinity();
  pose.linear() = pose.linear() * device_axes();
  laser.scan_rate = read_positive_or(&sensor, "update_rate", 10.0, any, findings);
  const XMLElement* element = sensor.FirstChildElement("ray");
  if (element == nullptr) element = sensor.FirstChildElement("lidar");
  if (element == nullptr) {
    findings.error(sensor.GetLineNum(),
                   fmt::format("range sensor {} has neither <ray> nor <lidar>", in_quotes(sensor.Attribute("name"))),
                   "<ray> contains the <scan>'s angles and the <range> of distances");
    return;
  }
  report_ignored(*element, {"scan", "range"}, findings);
  if (const XMLElement* scan = require_child(*element, "scan", "it contains <horizontal>", findings))
    read_scan(*scan, laser, findings);
  if (const XMLElement* range = require_child(*element, "range", "it contains <min> and <max> [m]", findings))
    read_distances(*range, laser, findings);
}

void read_optical_range_sensor(const XMLElement& sensor, const XMLElement& ray, RangeSensor& laser,
                               Eigen::Isometry3d& pose, Findings& findings) {
  pose.linear() = pose.linear() * device_axes_of_optical();
  constexpr double any = std::numeric_limits<double>::infinity();
  laser.scan_rate = 1.0;  // Choreonoid's default
  if (sensor.Attribute("update_rate") != nullptr)
    laser.scan_rate = read_positive(sensor, "update_rate", any, findings).value_or(1.0);
  report_ignored(ray, {"horizontal", "vertical"}, findings);
  laser.yaw = read_optical_sweep(*ray.FirstChildElement("horizontal"), a_turn, findings);
  if (const XMLElement* vertical = ray.FirstChildElement("vertical"))
    laser.pitch = read_optical_sweep(*vertical, straight_up, findings);
  check_beams(ray, laser, findings);
}

}  // namespace rehearse::urdf
