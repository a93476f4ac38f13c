#include "altered_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <numbers>
#include <string_view>
#include <type_traits>

#include "base/text.h"

namespace rehearse {
namespace {

double altered(double before, char operation, double operand) {
  return operation == '+' ? before + operand : operation == '*' ? before * operand : operand;
}

}  // namespace

Result<AlteredInputs::Alteration> AlteredInputs::parse_one(const std::string& text, const Scenario& scenario) {
  Alteration found;
  found.text = text;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    return error_at({text, 0, text.size()},
                    "this alters nothing: expected SERIES=VALUE, SERIES+=VALUE or SERIES*=VALUE");
  std::size_t end_of_name = equals;
  if (text[equals - 1] == '+' || text[equals - 1] == '*') found.operation = text[--end_of_name];
  const std::string series = text.substr(0, end_of_name);
  const auto target = find_input(series, scenario);
  if (!target)
    return error_at({text, 0, series.size()},
                    fmt::format("there is no input '{}'; {}", series, near_inputs(series, scenario)));
  found.target = *target;

  const std::size_t begin = equals + 1, at = text.find('@', begin);
  std::string_view value = std::string_view(text).substr(begin, at == std::string::npos ? at : at - begin);
  const std::size_t size = value.size();
  double unit = 1.0;
  if (value.ends_with("deg") && target->is_angle && found.operation != '*') {
    value.remove_suffix(3);
    while (value.ends_with(' ')) value.remove_suffix(1);
    unit = std::numbers::pi / 180.0;
  }
  const auto operand = number_in<double>(value);
  if (!operand)
    return error_at({text, begin, size},
                    fmt::format("'{}' is no number{}", text.substr(begin, size),
                                target->is_angle ? ", nor an angle as 30deg, nor nan, nor inf" : ", nor nan, nor inf"));
  found.operand = *operand * unit;
  if (at == std::string::npos) return found;
  const auto span = REHEARSE_TRY(parse_span(text, at + 1, scenario.time_step));
  if (span.first >= scenario.ticks())
    return error_at({text, at + 1, text.size() - at - 1},
                    fmt::format("the run ends before that, at tick {}", scenario.ticks() - 1));
  found.span = span;
  return found;
}

Result<AlteredInputs> AlteredInputs::parse(const std::vector<std::string>& texts, const Scenario& scenario) {
  AlteredInputs inputs;
  Diagnostics findings;
  for (const std::string& text : texts) {
    auto one = parse_one(text, scenario);
    if (one)
      inputs.alterations_.push_back(*std::move(one));
    else
      findings.insert(findings.end(), one.errors().begin(), one.errors().end());
  }
  if (!findings.empty()) return findings;
  return inputs;
}

bool AlteredInputs::is_read(const InputTarget& target, const ControllerHost& host) {
  if (target.body < 0) return true;  // any controller may read the joystick
  for (const HostedController& hosted : host.controllers()) {
    if (!hosted.running || hosted.body != target.body) continue;
    const auto is_target = [&](int owner) { return owner == target.owner; };
    const std::vector<int>&devices = hosted.io->input_devices(), &links = hosted.io->contact_links();
    switch (target.kind) {
      case InputTarget::Kind::joint:
      case InputTarget::Kind::link:
        for (const IoField& field : hosted.io->inputs().fields)
          if (field.quantity == target.quantity &&
              is_target(target.kind == InputTarget::Kind::joint ? field.joint : field.link))
            return true;
        break;
      case InputTarget::Kind::device:
      case InputTarget::Kind::ranges:
        if (std::ranges::any_of(devices, is_target)) return true;
        break;
      case InputTarget::Kind::contact:
        if (std::ranges::any_of(links, is_target)) return true;
        break;
      case InputTarget::Kind::axis:
      case InputTarget::Kind::button: break;
    }
  }
  return false;
}

Result<void> AlteredInputs::check_read_by(const ControllerHost& host) const {
  Diagnostics findings;
  for (const Alteration& alteration : alterations_) {
    if (is_read(alteration.target, host)) continue;
    const std::size_t end = alteration.text.find('=') - (alteration.operation == '=' ? 0 : 1);
    findings.push_back(error_at(
        {alteration.text, 0, end},
        fmt::format("no controller reads '{}': its alteration has no effect", alteration.text.substr(0, end))));
  }
  if (!findings.empty()) return findings;
  return {};
}

bool AlteredInputs::apply(const Alteration& alteration, Observation& observation) {
  const InputTarget& target = alteration.target;
  const auto alter = [&](auto& number) {
    number = static_cast<std::remove_reference_t<decltype(number)>>(
        altered(static_cast<double>(number), alteration.operation, alteration.operand));
    return true;
  };
  if (target.kind == InputTarget::Kind::axis)
    return observation.joystick && alter(observation.joystick->axes[target.element]);
  if (target.kind == InputTarget::Kind::button) {
    if (!observation.joystick) return false;
    bool& button = observation.joystick->buttons[target.element];
    button = altered(button ? 1.0 : 0.0, alteration.operation, alteration.operand) != 0.0;
    return true;
  }
  BodyObservation& body = observation.bodies[static_cast<std::size_t>(target.body)];
  const auto owner = static_cast<std::size_t>(target.owner);
  const auto of_vectors = [&](Eigen::Vector3d& first, Eigen::Vector3d& second) {
    return alter((target.element < 3 ? first : second)[static_cast<Eigen::Index>(target.element % 3)]);
  };
  switch (target.kind) {
    case InputTarget::Kind::joint: {
      JointReading& joint = body.joints[owner];
      return alter(target.quantity == Quantity::q     ? joint.q
                   : target.quantity == Quantity::dq  ? joint.dq
                   : target.quantity == Quantity::ddq ? joint.ddq
                                                      : joint.u);
    }
    case InputTarget::Kind::link: {
      LinkReading& link = body.links[owner];
      if (target.quantity == Quantity::twist) return of_vectors(link.velocity, link.angular_velocity);
      if (target.quantity == Quantity::acceleration) return of_vectors(link.acceleration, link.angular_acceleration);
      if (target.element < 3) return alter(link.position[static_cast<Eigen::Index>(target.element)]);
      return alter(link.rotation.coeffs()[static_cast<Eigen::Index>(target.element - 3)]);
    }
    case InputTarget::Kind::device: {
      DeviceReading& device = body.devices[owner];
      return device.fresh && target.element < device.values.size() && alter(device.values[target.element]);
    }
    case InputTarget::Kind::ranges: {
      DeviceReading& device = body.devices[owner];
      if (!device.fresh || !device.ranges || target.element >= device.ranges->size()) return false;
      auto ranges = std::make_shared<std::vector<float>>(*device.ranges);
      alter((*ranges)[target.element]);
      device.ranges = std::move(ranges);
      return true;
    }
    case InputTarget::Kind::contact: {
      if (owner >= body.contacts.size() || target.contact >= body.contacts[owner].size()) return false;
      ContactReading& point = body.contacts[owner][target.contact];
      Eigen::Vector3d* const vectors[] = {&point.position, &point.normal, &point.force, &point.velocity};
      if (target.element == 12) return alter(point.depth);
      return alter((*vectors[target.element / 3])[static_cast<Eigen::Index>(target.element % 3)]);
    }
    case InputTarget::Kind::axis:
    case InputTarget::Kind::button: break;
  }
  return false;
}

void AlteredInputs::apply(std::int64_t tick, Observation& observation) {
  for (Alteration& alteration : alterations_)
    if ((!alteration.span || alteration.span->has(tick)) && apply(alteration, observation)) alteration.used = true;
}

Diagnostics AlteredInputs::unused() const {
  Diagnostics warnings;
  for (const Alteration& alteration : alterations_)
    if (!alteration.used)
      warnings.push_back(warning(fmt::format(
          "'{}' altered nothing: its ticks weren't run, or the sensor measured nothing in them", alteration.text)));
  return warnings;
}

std::int64_t AlteredInputs::begins() const {
  std::int64_t first = alterations_.empty() ? 0 : std::numeric_limits<std::int64_t>::max();
  for (const Alteration& alteration : alterations_)
    first = std::min(first, alteration.span ? alteration.span->first : 0);
  return first;
}

bool AlteredInputs::alters_joints(int body) const {
  return std::ranges::any_of(alterations_, [&](const Alteration& alteration) {
    return alteration.target.kind == InputTarget::Kind::joint && alteration.target.body == body;
  });
}

bool AlteredInputs::alters_device(int body, int device) const {
  return std::ranges::any_of(alterations_, [&](const Alteration& alteration) {
    const InputTarget& target = alteration.target;
    const bool of_device = target.kind == InputTarget::Kind::device || target.kind == InputTarget::Kind::ranges;
    return of_device && target.body == body && target.owner == device;
  });
}

bool AlteredInputs::alters_joystick() const {
  return std::ranges::any_of(alterations_, [](const Alteration& alteration) { return alteration.target.body < 0; });
}

}  // namespace rehearse
