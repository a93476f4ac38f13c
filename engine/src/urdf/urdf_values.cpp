#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "urdf_text.h"

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) + 1 - first);
}

const char* count_text(std::size_t count) {
  constexpr const char* texts[] = {"", "a number", "two numbers", "three numbers", "four numbers"};
  return texts[count];
}

std::optional<std::vector<double>> read_numbers(const XMLElement& element, const char* attribute, std::size_t count,
                                                Findings& findings) {
  const char* text = element.Attribute(attribute);
  if (text == nullptr) {
    findings.error(element.GetLineNum(), fmt::format("{} has no attribute '{}'", tag(element.Name()), attribute));
    return std::nullopt;
  }
  std::optional<std::vector<double>> numbers = parse_numbers(text, count);
  if (!numbers) {
    findings.error(
        element.FindAttribute(attribute)->GetLineNum(),
        fmt::format("{} of {} is {}, not {}", attribute, tag(element.Name()), in_quotes(text), count_text(count)),
        "decimal numbers as in 1.5 or -2e-3, with blanks between them");
  }
  return numbers;
}

/// The rotation by quat_xyzw; identity, with an error, if there is none.
Eigen::Matrix3d read_quaternion(const XMLElement& origin, Findings& findings) {
  const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  if (origin.Attribute("rpy") != nullptr) {
    findings.error(origin.GetLineNum(), "an <origin> has both quat_xyzw and rpy", "give one of them");
    return none;
  }
  const auto xyzw = read_vector4(origin, "quat_xyzw", findings);
  if (!xyzw) return none;
  const double length = xyzw->stableNorm();
  if (length == 0.0) {
    findings.error(origin.GetLineNum(), "quat_xyzw of <origin> is zero", "0 0 0 1 is no rotation");
    return none;
  }
  return Eigen::Quaterniond(Eigen::Vector4d(*xyzw / length)).toRotationMatrix();
}

}  // namespace

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count) {
  std::vector<double> numbers;
  for (text = trimmed(text); !text.empty() && numbers.size() <= count; text = trimmed(text)) {
    const std::size_t end = std::min(text.find_first_of(blanks), text.size());
    const std::optional<double> number = parse_number(text.substr(0, end));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    text.remove_prefix(end);
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

std::string_view text_of(const XMLElement& element) {
  const char* text = element.GetText();
  if (text == nullptr) text = element.Attribute("value");
  return text == nullptr ? std::string_view() : trimmed(text);
}

std::optional<double> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto value = number_in<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<double> read_number(const XMLElement& element, const char* attribute, Findings& findings) {
  const auto numbers = read_numbers(element, attribute, 1, findings);
  if (!numbers) return std::nullopt;
  return numbers->front();
}

std::optional<double> read_number_or(const XMLElement& element, const char* attribute, double fallback,
                                     Findings& findings) {
  if (element.Attribute(attribute) == nullptr) return fallback;
  return read_number(element, attribute, findings);
}

std::optional<Eigen::Vector3d> read_vector(const XMLElement& element, const char* attribute, Findings& findings) {
  const auto numbers = read_numbers(element, attribute, 3, findings);
  if (!numbers) return std::nullopt;
  return Eigen::Vector3d(numbers->data());
}

std::optional<Eigen::Vector3d> read_vector_or(const XMLElement& element, const char* attribute,
                                              const Eigen::Vector3d& fallback, Findings& findings) {
  if (element.Attribute(attribute) == nullptr) return fallback;
  return read_vector(element, attribute, findings);
}

std::optional<Eigen::Vector4d> read_vector4(const XMLElement& element, const char* attribute, Findings& findings) {
  const auto numbers = read_numbers(element, attribute, 4, findings);
  if (!numbers) return std::nullopt;
  return Eigen::Vector4d(numbers->data());
}

Eigen::Isometry3d read_origin(const XMLElement& element, Findings& findings) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const XMLElement* origin = element.FirstChildElement("origin");
  if (origin == nullptr) return pose;
  const auto xyz = read_vector_or(*origin, "xyz", Eigen::Vector3d::Zero(), findings);
  const auto rpy = read_vector_or(*origin, "rpy", Eigen::Vector3d::Zero(), findings);
  if (xyz) pose.translation() = *xyz;
  if (rpy) pose.linear() = rotation_from_rpy(*rpy);
  if (origin->Attribute("quat_xyzw") != nullptr) pose.linear() = read_quaternion(*origin, findings);
  return pose;
}

std::optional<std::string> read_name(const XMLElement& element, const char* attribute, Findings& findings) {
  const char* text = element.Attribute(attribute);
  if (text == nullptr || *text == '\0') {
    findings.error(element.GetLineNum(), fmt::format("{} has no {}", tag(element.Name()), attribute));
    return std::nullopt;
  }
  const std::string_view name = text;
  const bool has_control = std::ranges::any_of(name, [](unsigned char byte) { return byte < 0x20 || byte == 0x7F; });
  if (has_control || !is_utf8(name)) {
    findings.error(element.GetLineNum(), fmt::format("the {} {} of {} isn't plain UTF-8 text", attribute,
                                                     in_quotes(name), tag(element.Name())));
    return std::nullopt;
  }
  return std::string(name);
}

std::optional<double> read_text_number(const XMLElement& element, Findings& findings) {
  const std::optional<double> number = parse_number(text_of(element));
  if (!number) {
    findings.error(element.GetLineNum(),
                   fmt::format("{} contains {}, not a number", tag(element.Name()), in_quotes(text_of(element))));
  }
  return number;
}

std::optional<bool> read_text_flag(const XMLElement& element, Findings& findings) {
  std::string word(text_of(element));
  for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (word == "true" || word == "yes" || word == "1") return true;
  if (word == "false" || word == "no" || word == "0") return false;
  findings.error(element.GetLineNum(),
                 fmt::format("{} contains {}, not true or false", tag(element.Name()), in_quotes(text_of(element))));
  return std::nullopt;
}

std::optional<std::vector<double>> read_text_numbers(const XMLElement& element, std::size_t count, Findings& findings) {
  auto numbers = parse_numbers(text_of(element), count);
  if (!numbers) {
    findings.error(element.GetLineNum(), fmt::format("{} contains {}, not {}", tag(element.Name()),
                                                     in_quotes(text_of(element)), count_text(count)));
  }
  return numbers;
}

Eigen::Isometry3d read_text_pose(const XMLElement& element, Findings& findings) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const auto numbers = parse_numbers(text_of(element), 6);
  if (!numbers) {
    findings.error(element.GetLineNum(), fmt::format("{} contains {}, not six numbers: x y z roll pitch yaw",
                                                     tag(element.Name()), in_quotes(text_of(element))));
    return pose;
  }
  pose.translation() = Eigen::Vector3d(numbers->data());
  pose.linear() = rotation_from_rpy(Eigen::Vector3d(numbers->data() + 3));
  return pose;
}

Eigen::Matrix3d rotation_from_rpy(const Eigen::Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Vector3d rpy_from_rotation(const Eigen::Matrix3d& r) {
  const double yaw = std::atan2(r(1, 0), r(0, 0));
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  const double s = std::sin(yaw), c = std::cos(yaw);
  const double roll = std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1));
  return {roll, pitch, yaw};
}

}  // namespace rehearse::urdf
