#include "urdf_devices.h"
#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

/// The axes along which the sensor measures.
void read_frame(const XMLElement& element, DeviceDraft& draft, Findings& findings) {
  const std::string_view frame = text_of(element);
  if (frame == "sensor") return;
  if (frame != "child" && frame != "parent") {
    findings.error(element.GetLineNum(),
                   fmt::format("<frame> contains {}, not child, parent or sensor", in_quotes(frame)));
    return;
  }
  draft.device.pose = Eigen::Isometry3d::Identity();
  draft.has_parents_axes = frame == "parent";
}

void read_direction(const XMLElement& element, const Device& device, Findings& findings) {
  const std::string_view direction = text_of(element);
  if (direction == "child_to_parent") return;
  if (direction != "parent_to_child") {
    findings.error(
        element.GetLineNum(),
        fmt::format("<measure_direction> contains {}, not child_to_parent or parent_to_child", in_quotes(direction)));
    return;
  }
  findings.warning(element.GetLineNum(),
                   fmt::format("sensor {} is to measure the wrench of the parent link on its child; here it measures "
                               "the opposite wrench, so its numbers have the opposite sign",
                               in_quotes(device.name)));
}

}  // namespace

void read_force_sensor(const XMLElement& sensor, DeviceDraft& draft, Findings& findings) {
  const XMLElement* element = sensor.FirstChildElement("force_torque");
  if (element == nullptr) return;
  report_ignored(*element, {"frame", "measure_direction"}, findings);
  if (const XMLElement* frame = element->FirstChildElement("frame")) read_frame(*frame, draft, findings);
  if (const XMLElement* direction = element->FirstChildElement("measure_direction"))
    read_direction(*direction, draft.device, findings);
}

}  // namespace rehearse::urdf
