// Reading sensors and lights: one function for each kind of device that has parameters. Private to the URDF loader.
//
// A sensor is described in a <gazebo> block, with SDF's elements, or in <robot> itself. In <robot> its parameters are
// SDF's elements, too, or attributes, as described in http://wiki.ros.org/urdf/XML/sensor and read by Choreonoid. With
// attributes, the axes of cameras and range sensors are z ahead, x to the right and y down, else x ahead and z up.
#pragma once

#include <rehearse/model.h>

#include "model/rigid_groups.h"
#include "urdf_findings.h"

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

struct DeviceDraft;

/// Reports the children that the loader ignores, with their counts.
void report_ignored(const tinyxml2::XMLElement& element, const std::vector<std::string_view>& known,
                    Findings& findings);

/// The child's number, or `fallback` if the child is missing; an error unless it is above 0 and at most `most`.
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

/// A collision shape, by link index and by its index in the link.
struct NamedShape {
  int link = 0;
  int collision = 0;

  auto operator<=>(const NamedShape&) const = default;
};

/// The collision shapes of a rigid group, which other simulators merge into one link, by their names there.
class MergedShapes {
 public:
  MergedShapes(const Model& model, const RigidGroups& groups, int group);

  /// The shape with this name: its own, as in PyBullet; or as in Gazebo LINK_collision and LINK_collision_N, the
  /// shape's name with "_collision", and either after OTHER_LINK_fixed_joint_lump__, where N counts the shapes of all
  /// links before it, too. The part before a "::" is a scope.
  /// If several links have it, the shape of `own` is meant, else that of the first link.
  std::optional<NamedShape> find(std::string_view name, int own) const;

 private:
  std::optional<NamedShape> find_named(std::string_view name, int own) const;

  struct MergedLink {
    int link = 0;
    int first = 0;  // number of its first shape among those of the group
  };

  const Model& model_;
  int shape_count_ = 0;
  std::map<std::string_view, MergedLink> links_;
  std::map<std::pair<std::string_view, int>, int> shapes_;  // by name and link: the first shape of that name
};

/// The link's own name in the name that Gazebo gives to a merged link; else the name itself.
std::string_view unmerged(std::string_view link);

/// Sets the shape of a contact sensor. A sensor that names a shape of another link of its rigid group moves to that
/// link. A warning if it names something else.
void set_feeling_shape(const DeviceDraft& draft, const Model& model, const RigidGroups& groups,
                       const MergedShapes& merged, Device& device, Findings& findings);

/// A light of that type with default parameters; nullopt for an unknown type.
std::optional<Light> light_of_type(std::string_view type);

/// Reads the parameters of a light. SDF's frame is kept: a spot shines along its -z unless the file gives a direction.
void read_light(const tinyxml2::XMLElement& element, Light& light, Findings& findings);

/// The noun for the device in messages: "sensor" or "light".
std::string_view word_for(const Device& device);

}  // namespace rehearse::urdf
