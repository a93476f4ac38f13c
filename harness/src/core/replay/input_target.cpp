#include "input_target.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/names.h"
#include "base/text.h"
#include "core/kinds/channel_name.h"

namespace rehearse {
namespace {

using Kind = InputTarget::Kind;
using NamedTarget = std::pair<std::string, InputTarget>;

/// The number after the text `before`: 3 for "ranges/3" and "ranges/".
std::optional<std::size_t> number_behind(std::string_view text, std::string_view before) {
  return text.starts_with(before) ? number_in<std::size_t>(text.substr(before.size())) : std::nullopt;
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
  const auto found =
      std::ranges::find_if(elements, [name](const ChannelElement& element) { return element.name == name; });
  return found == elements.end() ? std::nullopt : std::optional<std::size_t>(found - elements.begin());
}

/// All inputs with a name of their own: no beams of range sensors, points of contact or numbers of lights.
void add_names(const Scenario& scenario, std::vector<NamedTarget>& names) {
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

}  // namespace

std::optional<InputTarget> find_input(const std::string& name_of_series, const Scenario& scenario) {
  const std::string series = of_the_body(name_of_series, scenario);
  std::vector<NamedTarget> names;
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
        return InputTarget{Kind::ranges, index, static_cast<int>(i), *beam};
      if (std::holds_alternative<Light>(device.kind) && value)
        return InputTarget{Kind::device, index, static_cast<int>(i), *value};
    }
    for (std::size_t link = 0; link < body.model->links.size(); ++link) {
      const std::string owner = body.name + "/" + topic_segment(body.model->links[link].name) + "/contacts/";
      if (!series.starts_with(owner)) continue;
      const std::size_t slash = std::min(series.find('/', owner.size()), series.size());
      const auto point = number_behind(series.substr(0, slash), owner);
      const auto element = contact_element(std::string_view(series).substr(std::min(slash + 1, series.size())));
      if (point && element) return InputTarget{Kind::contact, index, static_cast<int>(link), *element, *point};
    }
  }
  return std::nullopt;
}

std::string near_inputs(const std::string& name_of_series, const Scenario& scenario) {
  const std::string series = of_the_body(name_of_series, scenario);
  std::vector<NamedTarget> known;
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
      if (std::ranges::find(near_rests, rests[i]) != near_rests.end()) near.push_back(names[i]);
  }
  if (!near.empty()) return fmt::format("similar inputs: {}", fmt::join(near, ", "));
  if (alike.empty()) alike.assign(names.begin(), names.begin() + std::min<std::ptrdiff_t>(3, std::ssize(names)));
  return fmt::format("inputs are, for example: {}", fmt::join(alike, ", "));
}

}  // namespace rehearse
