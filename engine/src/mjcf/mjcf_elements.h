// Elements of a MuJoCo model with the attributes of their classes, and the settings of <compiler>.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf_files.h"

namespace rehearse::mjcf {

/// <compiler>, of all files.
struct Compiler {
  bool degrees = true;
  std::string euler_order = "xyz";
  std::string mesh_folder;
  bool strips_paths = false;
  bool auto_limits = true;
  bool discards_visual = false;
  bool exact_inertia = false;
  bool balances_inertia = false;
  std::optional<bool> inertia_from_geoms;  // nullopt: of bodies without <inertial>
  std::array<double, 2> inertia_groups = {0.0, 5.0};
  double least_mass = 0.0;     // [kg]
  double least_inertia = 0.0;  // [kg·m²]
  double whole_mass = -1.0;    // [kg]; not above 0: as it is

  double radians(double angle) const { return degrees ? angle * 3.14159265358979323846 / 180.0 : angle; }
};

using Attributes = std::map<std::string, std::string>;
/// The attributes that a class states, by the name of the element.
using DefaultClass = std::map<std::string, Attributes>;

/// An element with the attributes of its class. Each reader adds an error for what it can't read.
class Element {
 public:
  /// `defaults`: of its class; null: none.
  Element(Files& files, const XMLElement& xml, const Attributes* defaults)
      : files_(files), xml_(xml), defaults_(defaults) {}

  const XMLElement& xml() const { return xml_; }
  Files& files() const { return files_; }
  std::string_view kind() const;

  /// As written, from the element or its class; nullopt: neither states it.
  std::optional<std::string> text(const char* attribute) const;
  std::string text_or(const char* attribute, const char* otherwise) const {
    return text(attribute).value_or(otherwise);
  }
  bool states(const char* attribute) const { return text(attribute).has_value(); }

  /// Nullopt if it isn't stated or, with an error, if it is no list of `least` to `most` numbers.
  std::optional<std::vector<double>> numbers(const char* attribute, std::size_t least, std::size_t most) const;
  std::optional<double> number(const char* attribute) const;
  std::optional<Eigen::Vector3d> vector(const char* attribute) const;
  /// A whole number of at least 0.
  int mask(const char* attribute, int otherwise) const;
  /// true or false; nullopt: not stated, or auto.
  std::optional<bool> flag(const char* attribute) const;

  /// pos and the orientation: quat, axisangle, xyaxes, zaxis or euler.
  Eigen::Isometry3d pose(const Compiler& compiler) const;
  Eigen::Matrix3d rotation(const Compiler& compiler) const;

  /// The limits of a range that limits anything; `limited`: the attribute that states whether.
  std::optional<std::array<double, 2>> range(const char* attribute, const char* limited,
                                             const Compiler& compiler) const;

  void error(std::string message, std::string hint = {}) const {
    files_.error(xml_, std::move(message), std::move(hint));
  }
  void unsupported(const std::string& what, const std::string& hint = {}) const {
    files_.unsupported(xml_, what, hint);
  }

 private:
  Files& files_;
  const XMLElement& xml_;
  const Attributes* defaults_;
};

/// The classes of <default>.
class Classes {
 public:
  explicit Classes(Files& files) : files_(files) {}
  void read();
  /// `childclass`: of the bodies around it.
  Element described(const XMLElement& element, const std::string& childclass = {}) const;

 private:
  void read_class(const XMLElement& element, const DefaultClass& outer, bool is_root);

  Files& files_;
  std::map<std::string, DefaultClass> classes_;
};

Compiler read_compiler(Files& files);

/// Warns of attributes that no version of MuJoCo's reference has, and counts those that are ignored.
void check_attributes(Files& files, const XMLElement& element);

/// True for the elements of <actuator>.
bool is_actuator(std::string_view kind);

/// The rotation that turns z to the direction.
Eigen::Matrix3d rotation_of_z(const Eigen::Vector3d& direction);

}  // namespace rehearse::mjcf
