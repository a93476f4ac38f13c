// Reading values from XML, strictly: a value that is missing or malformed becomes a finding with its place.
//
// "An error, and nothing" means: the function adds an error to `findings` and returns nullopt.
#pragma once

#include "urdf_findings.h"

#include <Eigen/Geometry>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words);

/// A finite decimal number, with nothing but blanks around it; independent of the locale.
std::optional<double> parse_number(std::string_view text);

/// The numbers in a text; nullopt unless there are exactly `count` of them.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count);

/// The attribute's number. Missing or malformed: an error, and nothing.
std::optional<double> read_number(const tinyxml2::XMLElement& element, const char* attribute, Findings& findings);

/// The attribute's number, or `fallback` if it is missing. Malformed: an error, and nothing.
std::optional<double> read_number_or(const tinyxml2::XMLElement& element, const char* attribute, double fallback,
                                     Findings& findings);

/// The attribute's three numbers, or `fallback` if it is missing. Malformed: an error, and nothing.
std::optional<Eigen::Vector3d> read_vector_or(const tinyxml2::XMLElement& element, const char* attribute,
                                              const Eigen::Vector3d& fallback, Findings& findings);

/// The attribute's three numbers. Missing or malformed: an error, and nothing.
std::optional<Eigen::Vector3d> read_vector(const tinyxml2::XMLElement& element, const char* attribute,
                                           Findings& findings);

/// The attribute's four numbers. Missing or malformed: an error, and nothing.
std::optional<Eigen::Vector4d> read_vector4(const tinyxml2::XMLElement& element, const char* attribute,
                                            Findings& findings);

/// The pose in `element`'s child <origin>: xyz, and rpy or, since URDF 1.1, quat_xyzw of any length but 0; identity if
/// there is none. Malformed: an error, and identity.
Eigen::Isometry3d read_origin(const tinyxml2::XMLElement& element, Findings& findings);

/// The attribute as a name: not empty, UTF-8 without control characters. Else, or if it is missing: an error, and
/// nothing.
std::optional<std::string> read_name(const tinyxml2::XMLElement& element, const char* attribute, Findings& findings);

/// The element's text without blanks around it. If it has no text: its attribute `value`, which many files use instead
/// of SDF's text; empty if it has neither.
std::string_view text_of(const tinyxml2::XMLElement& element);

/// The element's text as a number, as in SDF. Malformed: an error, and nothing.
std::optional<double> read_text_number(const tinyxml2::XMLElement& element, Findings& findings);

/// The element's text as a flag: true, yes, 1, false, no or 0, in upper or lower case, as in Gazebo. Anything else: an
/// error, and nothing.
std::optional<bool> read_text_flag(const tinyxml2::XMLElement& element, Findings& findings);

/// The element's text as `count` numbers, at most four, as in SDF. Malformed: an error, and nothing.
std::optional<std::vector<double>> read_text_numbers(const tinyxml2::XMLElement& element, std::size_t count,
                                                     Findings& findings);

/// The element's text as a pose "x y z roll pitch yaw", as in SDF. Malformed: an error, and identity.
Eigen::Isometry3d read_text_pose(const tinyxml2::XMLElement& element, Findings& findings);

/// Rotation by roll about x, then pitch about y, then yaw about z, all of the fixed frame [rad]: Rz Ry Rx.
Eigen::Matrix3d rotation_from_rpy(const Eigen::Vector3d& rpy);

/// The inverse of rotation_from_rpy(), exact up to rounding at any pitch: the roll is computed from the rotation that
/// remains after removing yaw and pitch.
Eigen::Vector3d rpy_from_rotation(const Eigen::Matrix3d& rotation);

}  // namespace rehearse::urdf
