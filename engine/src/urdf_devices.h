// Reading what stands in <gazebo> blocks: one function for each kind of device that has figures of its own. Private to
// the URDF loader.
#pragma once

#include <rehearse/model.h>

#include "urdf_findings.h"

#include <Eigen/Geometry>
#include <initializer_list>
#include <optional>
#include <string_view>

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

/// Counts the children that nobody reads.
void report_ignored(const tinyxml2::XMLElement& element, std::initializer_list<std::string_view> known,
                    Findings& findings);

/// The child's number, or `fallback` if there is no such child; an error unless it is above 0 and at most `most`.
/// `element` may be null.
double read_positive_or(const tinyxml2::XMLElement* element, const char* child, double fallback, double most,
                        Findings& findings);

/// The same for whole numbers.
int read_count_or(const tinyxml2::XMLElement* element, const char* child, int fallback, int most, Findings& findings);

/// From SDF's axes of a sensor (x forward, z up) to a Device's (-z forward, y up): its columns are right, up and back.
Eigen::Matrix3d device_axes();

/// Reads <camera>, and turns `pose` from SDF's axes to ours.
void read_camera(const tinyxml2::XMLElement& sensor, Camera& camera, Eigen::Isometry3d& pose, Findings& findings);

/// Reads <ray>, or <lidar>, and turns `pose` from SDF's axes to ours.
void read_range_sensor(const tinyxml2::XMLElement& sensor, RangeSensor& laser, Eigen::Isometry3d& pose,
                       Findings& findings);

/// A light of that type as it is without figures; null if we have no such type.
std::optional<Light> light_of_type(std::string_view type);

/// Reads the figures of a light. SDF's frame is kept: a spot shines along its -z unless told otherwise.
void read_light(const tinyxml2::XMLElement& element, Light& light, Findings& findings);

/// What messages call it: "sensor" or "light".
std::string_view word_for(const Device& device);

}  // namespace rehearse::urdf
