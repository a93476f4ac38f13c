#include "altered_inputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <string_view>
#include <type_traits>

#include "model/names.h"
#include "model/text.h"
#include "trace/channel_name.h"

namespace rehearse {
namespace {

/// The elements (name and unit) of a device's values, by index.
std::span<const ChannelElement> value_elements(const Device& device) {
  const std::span<const ChannelElement> of_imu = elements_of(ChannelKind::imu);
  if (std::holds_alternative<ForceSensor>(device.kind)) return elements_of(ChannelKind::wrench);
  if (std::holds_alternative<Gyro>(device.kind)) return of_imu.first(3);
  if (std::holds_alternative<Accelerometer>(device.kind)) return of_imu.last(3);
  if (std::holds_alternative<Imu>(device.kind)) return of_imu;
  if (std::holds_alternative<ContactSensor>(device.kind)) return elements_of(ChannelKind::contact);
  return {};
}

/// The number after the text `before`: 3 for "ranges/3" and "ranges/".
std::optional<std::size_t> number_behind(std::string_view text, std::string_view before) {
  return text.starts_with(before) ? number_in<std::size_t>(text.substr(before.size())) : std::nullopt;
}

double altered(double before, char operation, double operand) {
  return operation == '+' ? before + operand : operation == '*' ? before * operand : operand;
}

/// The series without "/<controller>/input" and without "/measured_joints": the quantity of the body.
std::string of_the_body(const std::string& series, const Scenario& scenario) {
  for (const ScenarioBody& body : scenario.bodies) {
    const std::string measured = body.name + "/measured_joints/";
    if (series.starts_with(measured)) return body.name + "/" + series.substr(measured.size());
    const auto strip = [&](const ScenarioController& controller) {
      const std::string prefix = body.name + "/" + controller.name + "/input/";
      return series.starts_with(prefix) ? body.name + "/" + series.substr(prefix.size()) : std::string();
    };
    for (const ScenarioController& controller : body.controllers) {
      if (std::string stripped = strip(controller); !stripped.empty()) return stripped;
      for (const ScenarioController& child : controller.children)
        if (std::string stripped = strip(child); !stripped.empty()) return stripped;
    }
  }
  return series;
}

/// The numbers of a contact, one after the other: position, normal, force, velocity, depth.
std::optional<std::size_t> contact_element(std::string_view name) {
  const std::vector<ChannelElement>& elements = elements_of(ChannelKind::contacts);
  const auto found = std::find_if(elements.begin(), elements.end(),
                                  [name](const ChannelElement& element) { return element.name == name; });
  return found == elements.end() ? std::nullopt : std::optional<std::size_t>(found - elements.begin());
}

}  // namespace

/// All inputs with a name of their own: no beams of range sensors, points of contact or numbers of lights.
void AlteredInputs::add_names(const Scenario& scenario, std::vector<std::pair<std::string, Target>>& names) {
  for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
    const ScenarioBody& body = scenario.bodies[b];
    const int index = static_cast<int>(b);
    for (std::size_t id = 0; id < body.model->joints.size(); ++id) {
      const Joint& joint = body.model->links[body.model->joints[id]].joint;
      for (const Quantity quantity : {Quantity::q, Quantity::dq, Quantity::ddq, Quantity::u})
        names.push_back({body.name + "/" + joint.name + "/" + name_of(quantity),
                         {Kind::joint, index, static_cast<int>(id), 0, 0, quantity,
                          quantity == Quantity::q && !is_linear(joint.type)}});
    }
    for (std::size_t link = 0; link < body.model->links.size(); ++link)
      for (const Quantity quantity : {Quantity::pose, Quantity::twist, Quantity::acceleration}) {
        const std::vector<ChannelElement>& elements = elements_of(channel_kind_of(quantity));
        for (std::size_t i = 0; i < elements.size(); ++i)
          names.push_back({body.name + "/" + topic_segment(body.model->links[link].name) + "/" + elements[i].name,
                           {Kind::link, index, static_cast<int>(link), i, 0, quantity}});
      }
    for (std::size_t device = 0; device < body.model->devices.size(); ++device) {
      const std::span<const ChannelElement> values = value_elements(body.model->devices[device]);
      for (std::size_t i = 0; i < values.size(); ++i)
        names.push_back({body.name + "/" + topic_segment(body.model->devices[device].name) + "/" + values[i].name,
                         {Kind::device, index, static_cast<int>(device), i}});
    }
  }
  if (!scenario.joystick) return;
  for (std::size_t i = 0; i < joystick_axes.size(); ++i)
    names.push_back({"axes/" + std::string(joystick_axes[i]), {Kind::axis, -1, 0, i}});
  for (std::size_t i = 0; i < joystick_buttons.size(); ++i)
    names.push_back({"buttons/" + std::string(joystick_buttons[i]), {Kind::button, -1, 0, i}});
}

std::optional<AlteredInputs::Target> AlteredInputs::find(const std::string& series, const Scenario& scenario) {
  std::vector<std::pair<std::string, Target>> names;
  add_names(scenario, names);
  for (const auto& [name, target] : names)
    if (name == series) return target;
  for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
    const ScenarioBody& body = scenario.bodies[b];
    const int index = static_cast<int>(b);
    for (std::size_t i = 0; i < body.model->devices.size(); ++i) {
      const Device& device = body.model->devices[i];
      const std::string owner = body.name + "/" + topic_segment(device.name) + "/";
      const auto* laser = std::get_if<RangeSensor>(&device.kind);
      const auto beam = number_behind(series, owner + "ranges/"), value = number_behind(series, owner + "values/");
      if (laser && beam && *beam < static_cast<std::size_t>(laser->beams()))
        return Target{Kind::ranges, index, static_cast<int>(i), *beam};
      if (std::holds_alternative<Light>(device.kind) && value)
        return Target{Kind::device, index, static_cast<int>(i), *value};
    }
    for (std::size_t link = 0; link < body.model->links.size(); ++link) {
      const std::string owner = body.name + "/" + topic_segment(body.model->links[link].name) + "/contacts/";
      if (!series.starts_with(owner)) continue;
      const std::size_t slash = std::min(series.find('/', owner.size()), series.size());
      const auto point = number_behind(series.substr(0, slash), owner);
      const auto element = contact_element(std::string_view(series).substr(std::min(slash + 1, series.size())));
      if (point && element) return Target{Kind::contact, index, static_cast<int>(link), *element, *point};
    }
  }
  return std::nullopt;
}

/// Names that the user may have meant: similar names, else names that are similar without the body, else up to three
/// names with the same last part.
std::string AlteredInputs::near_inputs(const std::string& series, const Scenario& scenario) {
  std::vector<std::pair<std::string, Target>> known;
  add_names(scenario, known);
  const auto without_body = [](const std::string& name) {
    return name.substr(std::min(name.find('/') + 1, name.size()));
  };
  std::vector<std::string> names, rests, alike;
  for (const auto& [name, target] : known) {
    names.push_back(name);
    rests.push_back(without_body(name));
    if (alike.size() < 3 && name.ends_with(series.substr(std::min(series.rfind('/'), series.size()))))
      alike.push_back(name);
  }
  std::vector<std::string> near = near_names(series, names);
  if (near.empty()) {
    const std::vector<std::string> near_rests = near_names(without_body(series), rests);
    for (std::size_t i = 0; i < names.size() && near.size() < 3; ++i)
      if (std::find(near_rests.begin(), near_rests.end(), rests[i]) != near_rests.end()) near.push_back(names[i]);
  }
  if (!near.empty()) return fmt::format("similar inputs: {}", fmt::join(near, ", "));
  if (alike.empty()) alike.assign(names.begin(), names.begin() + std::min<std::ptrdiff_t>(3, std::ssize(names)));
  return fmt::format("inputs are, for example: {}", fmt::join(alike, ", "));
}

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
  const auto target = find(of_the_body(series, scenario), scenario);
  if (!target) {
    return error_at({text, 0, series.size()}, fmt::format("there is no input '{}'; {}", series,
                                                          near_inputs(of_the_body(series, scenario), scenario)));
  }
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
  const auto span = parse_span(text, at + 1, scenario.time_step);
  if (!span) return span.errors();
  if (span->first >= scenario.ticks())
    return error_at({text, at + 1, text.size() - at - 1},
                    fmt::format("the run ends before that, at tick {}", scenario.ticks() - 1));
  found.span = *span;
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

bool AlteredInputs::is_read(const Target& target, const ControllerHost& host) {
  if (target.body < 0) return true;  // any controller may read the joystick
  for (const HostedController& hosted : host.controllers()) {
    if (!hosted.running || hosted.body != target.body) continue;
    const auto is_target = [&](int owner) { return owner == target.owner; };
    const std::vector<int>&devices = hosted.io->input_devices(), &links = hosted.io->contact_links();
    switch (target.kind) {
      case Kind::joint:
      case Kind::link:
        for (const IoField& field : hosted.io->inputs().fields)
          if (field.quantity == target.quantity && is_target(target.kind == Kind::joint ? field.joint : field.link))
            return true;
        break;
      case Kind::device:
      case Kind::ranges:
        if (std::any_of(devices.begin(), devices.end(), is_target)) return true;
        break;
      case Kind::contact:
        if (std::any_of(links.begin(), links.end(), is_target)) return true;
        break;
      case Kind::axis:
      case Kind::button: break;
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
  const Target& target = alteration.target;
  const auto alter = [&](auto& number) {
    number = static_cast<std::remove_reference_t<decltype(number)>>(
        altered(static_cast<double>(number), alteration.operation, alteration.operand));
    return true;
  };
  if (target.kind == Kind::axis) return observation.joystick && alter(observation.joystick->axes[target.element]);
  if (target.kind == Kind::button) {
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
    case Kind::joint: {
      JointReading& joint = body.joints[owner];
      return alter(target.quantity == Quantity::q     ? joint.q
                   : target.quantity == Quantity::dq  ? joint.dq
                   : target.quantity == Quantity::ddq ? joint.ddq
                                                      : joint.u);
    }
    case Kind::link: {
      LinkReading& link = body.links[owner];
      if (target.quantity == Quantity::twist) return of_vectors(link.velocity, link.angular_velocity);
      if (target.quantity == Quantity::acceleration) return of_vectors(link.acceleration, link.angular_acceleration);
      if (target.element < 3) return alter(link.position[static_cast<Eigen::Index>(target.element)]);
      return alter(link.rotation.coeffs()[static_cast<Eigen::Index>(target.element - 3)]);
    }
    case Kind::device: {
      DeviceReading& device = body.devices[owner];
      return device.fresh && target.element < device.values.size() && alter(device.values[target.element]);
    }
    case Kind::ranges: {
      DeviceReading& device = body.devices[owner];
      if (!device.fresh || !device.ranges || target.element >= device.ranges->size()) return false;
      auto ranges = std::make_shared<std::vector<float>>(*device.ranges);
      alter((*ranges)[target.element]);
      device.ranges = std::move(ranges);
      return true;
    }
    case Kind::contact: {
      if (owner >= body.contacts.size() || target.contact >= body.contacts[owner].size()) return false;
      ContactReading& point = body.contacts[owner][target.contact];
      Eigen::Vector3d* const vectors[] = {&point.position, &point.normal, &point.force, &point.velocity};
      if (target.element == 12) return alter(point.depth);
      return alter((*vectors[target.element / 3])[static_cast<Eigen::Index>(target.element % 3)]);
    }
    case Kind::axis:
    case Kind::button: break;
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
  return std::any_of(alterations_.begin(), alterations_.end(), [&](const Alteration& alteration) {
    return alteration.target.kind == Kind::joint && alteration.target.body == body;
  });
}

bool AlteredInputs::alters_device(int body, int device) const {
  return std::any_of(alterations_.begin(), alterations_.end(), [&](const Alteration& alteration) {
    const Target& target = alteration.target;
    const bool of_device = target.kind == Kind::device || target.kind == Kind::ranges;
    return of_device && target.body == body && target.owner == device;
  });
}

bool AlteredInputs::alters_joystick() const {
  return std::any_of(alterations_.begin(), alterations_.end(),
                     [](const Alteration& alteration) { return alteration.target.body < 0; });
}

}  // namespace rehearse
