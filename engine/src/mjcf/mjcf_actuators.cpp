// <actuator>: the drives of joints. Only forms that are affine in displacement and velocity have a meaning here.
#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>

#include "base/names.h"
#include "mjcf_bodies.h"
#include "urdf/urdf_values.h"

namespace rehearse::mjcf {
namespace {

std::optional<double> smaller(std::optional<double> one, std::optional<double> other) {
  return one && other ? std::min(*one, *other) : one ? one : other;
}

/// The first of the numbers; nullopt: none, or 0.
std::optional<double> other_than_zero(std::optional<double> value) {
  return value && *value != 0.0 ? value : std::nullopt;
}

class ActuatorReader {
 public:
  ActuatorReader(const Classes& classes, const Compiler& compiler, Draft& draft)
      : classes_(classes), compiler_(compiler), draft_(draft) {}

  void read(const XMLElement& xml);

 private:
  std::optional<double> largest(const Element& of, const char* range, const char* limited) const {
    const auto values = of.range(range, limited, compiler_);
    return values ? std::optional(std::max(std::abs((*values)[0]), std::abs((*values)[1]))) : std::nullopt;
  }
  MjcfDrive* drive_of(const Element& element);
  void read_general(const Element& element, double squared, MjcfDrive& drive);

  const Classes& classes_;
  const Compiler& compiler_;
  Draft& draft_;
};

MjcfDrive* ActuatorReader::drive_of(const Element& element) {
  const char* own = element.xml().Attribute("joint");
  if (own == nullptr) own = element.xml().Attribute("jointinparent");
  if (own == nullptr) {
    element.unsupported(fmt::format("a {} actuator that drives no joint", element.kind()), "joint=\"NAME\"");
    return nullptr;
  }
  const auto found = std::ranges::find(draft_.drives, std::string(own), &MjcfDrive::joint);
  if (found != draft_.drives.end()) return &*found;
  for (const Coordinate& coordinate : draft_.coordinates) {
    if (coordinate.joint != own) continue;
    element.unsupported(fmt::format("an actuator of the free joint {}", in_quotes(own)), "a hinge or a slide");
    return nullptr;
  }
  std::vector<std::string> names;
  for (const MjcfDrive& drive : draft_.drives) names.push_back(printable(drive.joint));
  element.error(fmt::format("an actuator drives joint {}, which the model lacks", in_quotes(own)),
                names.empty() ? "joint names a hinge or a slide of <worldbody>" : name_hint(own, names, "joints"));
  return nullptr;
}

void ActuatorReader::read_general(const Element& element, double squared, MjcfDrive& drive) {
  const std::string dynamics = element.text_or("dyntype", "none"), gain = element.text_or("gaintype", "fixed");
  if (dynamics != "none" || gain != "fixed")
    return element.unsupported(
        fmt::format("a general actuator with {}",
                    dynamics != "none" ? "dyntype " + printable(dynamics) : "gaintype " + printable(gain)),
        "dyntype none, gaintype fixed");
  const std::string bias_type = element.text_or("biastype", "none");
  const std::vector<double> bias = element.numbers("biasprm", 1, 10).value_or(std::vector<double>());
  if (!urdf::is_one_of(bias_type, {"none", "affine"}))
    return element.unsupported(fmt::format("a general actuator with biastype {}", printable(bias_type)),
                               "none or affine");
  if (bias_type == "none") return;
  if (bias.size() > 1) drive.position_gain = other_than_zero(-squared * bias[1]);
  if (bias.size() > 2) drive.velocity_gain = other_than_zero(-squared * bias[2]);
}

void ActuatorReader::read(const XMLElement& xml) {
  const std::string_view kind = xml.Name();
  const Element element = classes_.described(xml);
  if (!is_actuator(kind)) return element.unsupported(fmt::format("{} of <actuator>", urdf::tag(kind)));
  if (!urdf::is_one_of(kind, {"motor", "position", "velocity", "general"}))
    return element.unsupported(fmt::format("a {} actuator", kind), "motor, position, velocity or general");
  MjcfDrive* drive = drive_of(element);
  if (drive == nullptr) return;
  const double gear = element.numbers("gear", 1, 6).value_or(std::vector<double>{1.0})[0], squared = gear * gear;
  std::optional<double> force = largest(element, "forcerange", "forcelimited");
  if (kind == "motor") force = smaller(force, largest(element, "ctrlrange", "ctrllimited"));
  if (force) drive->effort = smaller(drive->effort, std::abs(gear) * *force);
  if (kind == "position") {
    drive->position_gain = squared * element.number("kp").value_or(1.0);
    if (const auto kv = other_than_zero(element.number("kv"))) drive->velocity_gain = squared * *kv;
    if (element.number("dampratio").value_or(0.0) != 0.0) element.unsupported("dampratio of <position>", "state kv");
  } else if (kind == "velocity") {
    drive->velocity_gain = squared * element.number("kv").value_or(1.0);
  } else if (kind == "general") {
    read_general(element, squared, *drive);
  }
  if (element.number("timeconst").value_or(0.0) != 0.0)
    element.unsupported("timeconst of an actuator", "bandwidth of a scenario's actuators");
}

}  // namespace

void read_actuators(Files& files, const Classes& classes, const Compiler& compiler, Draft& draft) {
  ActuatorReader reader(classes, compiler, draft);
  for (const XMLElement* xml : files.in_section("actuator")) reader.read(*xml);
  for (const MjcfDrive& drive : draft.drives)
    if (urdf::JointDraft* joint = draft.find_joint(drive.joint); joint && drive.effort)
      joint->joint.effort = *drive.effort;
}

}  // namespace rehearse::mjcf
