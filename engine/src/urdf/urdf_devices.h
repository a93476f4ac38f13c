// Reading sensors and lights: one function for each kind of device that has parameters. Private to the URDF loader.
//
// A sensor is described in a <gazebo> block, with SDF's elements, or in <robot> itself. In <robot> its parameters are
// SDF's elements, too, or attributes, as described in http://wiki.ros.org/urdf/XML/sensor and read by Choreonoid. With
// attributes, the axes of cameras and range sensors are z ahead, x to the right and y down, else x ahead and z up.
#pragma once

#include <rehearse/model.h>

#include "urdf_findings.h"

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

struct DeviceDraft;

/// Reports the children that the loader ignores, with their counts.
void report_ignored(const tinyxml2::XMLElement& element, const std::vector<std::string_view>& known,
                    Findings& findings);

/// The child's number, or `fallback` if there is no such child; an error unless it is above 0 and at most `most`.
/// `element` may be null.
double read_positive_or(const tinyxml2::XMLElement* element, const char* child, double fallback, double most,
                        Findings& findings);

/// Like read_positive_or(), for whole numbers.
int read_count_or(const tinyxml2::XMLElement* element, const char* child, int fallback, int most, Findings& findings);

/// The attribute's number; an error and nullopt if it is missing, not above 0, or above `most`.
std::optional<double> read_positive(const tinyxml2::XMLElement& element, const char* attribute, double most,
                                    Findings& findings);

/// Like read_positive(), for whole numbers, which may be written as 640.0.
std::optional<int> read_count(const tinyxml2::XMLElement& element, const char* attribute, int most, Findings& findings);

/// Rotation from SDF's axes of a sensor (x forward, z up) to a Device's (-z forward, y up): columns right, up and back.
Eigen::Matrix3d device_axes();

/// Rotation to a Device's axes from x to the right, y down and z ahead.
Eigen::Matrix3d device_axes_of_optical();

/// Reads `element`, a <camera> of the sensor, and turns `pose` from SDF's axes to a Device's.
void read_camera(const tinyxml2::XMLElement& sensor, const tinyxml2::XMLElement& element, Camera& camera,
                 Eigen::Isometry3d& pose, Findings& findings);

/// Reads a <camera> with attributes and turns `pose` to a Device's axes.
void read_optical_camera(const tinyxml2::XMLElement& sensor, const tinyxml2::XMLElement& element, Camera& camera,
                         Eigen::Isometry3d& pose, Findings& findings);

/// Reads <ray>, or <lidar>, and turns `pose` from SDF's axes to a Device's.
void read_range_sensor(const tinyxml2::XMLElement& sensor, RangeSensor& laser, Eigen::Isometry3d& pose,
                       Findings& findings);

/// Reads <ray> with attributes.
void read_optical_range_sensor(const tinyxml2::XMLElement& sensor, const tinyxml2::XMLElement& ray, RangeSensor& laser,
                               Eigen::Isometry3d& pose, Findings& findings);

/// Reads <force_torque>: the axes and the direction of the measurement. Call it after the draft's pose is read.
void read_force_sensor(const tinyxml2::XMLElement& sensor, DeviceDraft& draft, Findings& findings);

/// Reads the names of collision shapes in <contact>.
void read_contact_sensor(const tinyxml2::XMLElement& sensor, DeviceDraft& draft, Findings& findings);

/// The collision shapes of a link by name.
class ShapeNames {
 public:
  explicit ShapeNames(const Link& link);

  /// Index of the first shape of that name, or -1.
  int find(std::string_view name) const;

 private:
  std::map<std::string_view, int> shapes_;
};

/// Index of the link's collision shape that a contact sensor refers to, or -1 for all shapes; a warning if it refers to
/// something else.
int find_feeling_shape(const DeviceDraft& draft, const Link& link, const ShapeNames& names, Findings& findings);

/// A light of that type with default parameters; nullopt for an unknown type.
std::optional<Light> light_of_type(std::string_view type);

/// Reads the parameters of a light. SDF's frame is kept: a spot shines along its -z unless the file gives a direction.
void read_light(const tinyxml2::XMLElement& element, Light& light, Findings& findings);

/// The noun for the device in messages: "sensor" or "light".
std::string_view word_for(const Device& device);

}  // namespace rehearse::urdf
