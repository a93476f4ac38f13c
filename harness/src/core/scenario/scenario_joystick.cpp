// The `joystick` of a scenario: moves of axes and presses of buttons.
#include "base/names.h"
#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse {
namespace {

/// A control has a name and a number.
std::vector<std::string> with_numbers(const auto& names) {
  std::vector<std::string> all(names.begin(), names.end());
  for (std::size_t i = 0; i < names.size(); ++i) all.push_back(std::to_string(i));
  return all;
}

/// The state of an entry while it is read.
struct JoystickEntry {
  std::optional<double> at;  // [s]; none: the entry can't be used
  double over = 0.0;         // [s]
  bool says = false;         // it names an axis or a button
  bool changes = false;      // at least one of these changes its state
};

const BoundForm<JoystickEntry>& bound_joystick_entry_form() {
  static const BoundForm<JoystickEntry> form{
      "joystick_entry",
      "a joystick entry",
      {FormKey{"at", types::number(any_time),
               "its begin, not before the entry above: it takes effect in the first tick that is not before it [s]",
               required},
       FormKey{"axes", types::map(types::number({-1.0, 1.0}), with_numbers(joystick_axes)),
               "positions to which axes move, up and left negative; triggers from 0 to 1"},
       FormKey{"buttons", types::map(types::flag(), with_numbers(joystick_buttons)), "true while pressed, or false"},
       {"over", &JoystickEntry::over, any_time,
        "duration of a linear move of its axes; buttons change at once; only with axes [s]"}},
      {{"axes", "buttons"}}};
  return form;
}

/// The common properties of axes, or of buttons.
struct ControlKind {
  std::string_view one;
  std::string_view many;
  std::vector<std::string> names;
};

template <class Names>
ControlKind kind_of(std::string_view one, std::string_view many, const Names& names) {
  return {one, many, {names.begin(), names.end()}};
}

/// Removes the endings of Choreonoid's enumerators, which repeat the keys `axes` and `buttons`.
std::string_view without_suffix(std::string_view name) {
  for (const std::string_view suffix : {"_AXIS", "_BUTTON"})
    if (name.ends_with(suffix)) name.remove_suffix(suffix.size());
  return name;
}

class JoystickReader {
 public:
  JoystickReader(Findings& findings, double duration, JoystickScript& script)
      : findings_(findings), duration_(duration), script_(script) {}

  void read_entry(const YamlNode& node);

 private:
  void read_times(const Keys& keys, JoystickEntry& entry);
  void check_use(const Keys& keys, const YamlNode& node) const;
  std::vector<NamedEntry> controls(const Keys& keys, std::string_view key, std::string_view what) const;
  void read_axis(const NamedEntry& named, JoystickEntry& entry);
  void read_button(const NamedEntry& named, JoystickEntry& entry);
  void unknown(const NamedEntry& named, const ControlKind& wanted, const ControlKind& other) const;
  void told_twice(const NamedEntry& named, double at) const;

  Findings& findings_;
  double duration_;  // [s]; 0: unknown
  JoystickScript& script_;
  double last_at_ = 0.0;  // [s]
  const ControlKind axes_ = kind_of("an axis", "axes", joystick_axes);
  const ControlKind buttons_ = kind_of("a button", "buttons", joystick_buttons);
};

void JoystickReader::read_entry(const YamlNode& node) {
  const Keys keys(findings_, node, joystick_entry_form());
  if (!keys.is_map()) return;
  JoystickEntry entry;
  read_times(keys, entry);
  for (const NamedEntry& named : controls(keys, "axes", "a map of AXIS: POSITION")) read_axis(named, entry);
  for (const NamedEntry& named : controls(keys, "buttons", "a map of BUTTON: true or false")) read_button(named, entry);
  check_use(keys, node);
  if (entry.at && entry.says && !entry.changes)
    findings_.warning(
        node, fmt::format("nothing changes at {} s: all named axes and buttons have these values already", *entry.at),
        "an axis keeps its position, and a button stays pressed, until another entry names it");
}

/// Checks that an entry names a control, and an axis if it takes time; a misspelt key may have been meant as one.
void JoystickReader::check_use(const Keys& keys, const YamlNode& node) const {
  bool names_something = false, names_axes = false;
  for (const NamedEntry& key : keys.entries()) {
    if (key.name == "at" || key.name == "over") continue;
    const bool empty = key.value->kind == YamlNode::Kind::map && key.value->keys.empty();
    names_something |= !empty;
    names_axes |= !empty && key.name != "buttons";
  }
  if (!names_something) {
    findings_.error(node, "a joystick entry names no axis and no button",
                    "expected axes: {L_STICK_V: -1} or buttons: {A: true}");
  } else if (const YamlNode* over = keys.find("over"); over != nullptr && !names_axes) {
    findings_.error(*over, "'over' without 'axes'",
                    "it is the duration of a move of an axis; a button changes at once");
  }
}

void JoystickReader::read_times(const Keys& keys, JoystickEntry& entry) {
  const Range times{0.0, Scenario::max_duration, "[s]"};
  bound_joystick_entry_form().read(keys, entry);
  const YamlNode* node = keys.require("at", "when it begins [s]");
  if (node == nullptr) return;
  const auto at = read_number(findings_, *node, "at", times);
  if (!at) return;
  if (*at < last_at_) {
    findings_.error(*node, fmt::format("at is {}, which is before the entry above it", *at),
                    fmt::format("expected entries in order of time, here from {} [s] on", last_at_));
    return;
  }
  if (duration_ > 0.0 && *at >= duration_)
    findings_.warning(*node, fmt::format("the joystick entry begins at {} s, after the end of the run", *at),
                      fmt::format("the duration is {} s", duration_));
  entry.at = last_at_ = *at;
}

std::vector<NamedEntry> JoystickReader::controls(const Keys& keys, std::string_view key, std::string_view what) const {
  const YamlNode* node = keys.find(key);
  if (node == nullptr) return {};
  if (node->kind == YamlNode::Kind::map) return read_entries(findings_, *node);
  expected(findings_, *node, key, what);
  return {};
}

void JoystickReader::read_axis(const NamedEntry& named, JoystickEntry& entry) {
  const auto axis = find_control(joystick_axes, named.name);
  if (!axis) return unknown(named, axes_, buttons_);
  const auto to = read_number(findings_, *named.value, joystick_axes[*axis], Range{lowest_position(*axis), 1.0});
  if (!to || !entry.at) return;
  if (script_.last_move(*axis) >= *entry.at) return told_twice(named, *entry.at);
  entry.says = true;
  entry.changes |= !script_.rests(*axis, *entry.at, *to);
  script_.move(*axis, *entry.at, entry.over, *to);
}

void JoystickReader::read_button(const NamedEntry& named, JoystickEntry& entry) {
  const auto button = find_control(joystick_buttons, named.name);
  if (!button) return unknown(named, buttons_, axes_);
  const auto pressed = read_flag(findings_, *named.value, joystick_buttons[*button]);
  if (!pressed || !entry.at) return;
  if (script_.last_press(*button) >= *entry.at) return told_twice(named, *entry.at);
  entry.says = true;
  entry.changes |= script_.is_pressed(*button, *entry.at) != *pressed;
  script_.press(*button, *entry.at, *pressed);
}

void JoystickReader::unknown(const NamedEntry& named, const ControlKind& wanted, const ControlKind& other) const {
  const std::string_view meant = without_suffix(named.name);
  const std::string there_is_no =
      fmt::format("there is no {} '{}'", wanted.one.substr(wanted.one.find(' ') + 1), shortened(named.name));
  if (std::ranges::find(other.names, meant) != other.names.end()) {
    findings_.error(*named.key, fmt::format("'{}' is {}", named.name, other.one),
                    fmt::format("write it under {}", other.many));
  } else if (named.name.find_first_not_of("0123456789") == std::string::npos) {
    findings_.error(*named.key, there_is_no, fmt::format("they are 0 to {}", wanted.names.size() - 1));
  } else {
    findings_.error(*named.key, there_is_no, name_hint(meant, wanted.names, wanted.many));
  }
}

void JoystickReader::told_twice(const NamedEntry& named, double at) const {
  findings_.error(*named.key, fmt::format("'{}' is named twice at {} s", named.name, at), "name it once");
}

}  // namespace

const Form& joystick_entry_form() { return bound_joystick_entry_form(); }

void read_joystick(Findings& findings, const YamlNode& node, Scenario& scenario) {
  JoystickScript& script = scenario.joystick.emplace();
  const char* const what = "a list of moves and presses with their times; [] is a joystick at rest";
  JoystickReader reader(findings, scenario.duration, script);
  for (const YamlNodePtr& entry : read_list(findings, node, "joystick", what)) reader.read_entry(*entry);
}

}  // namespace rehearse
