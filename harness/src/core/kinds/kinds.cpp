#include "kinds.h"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>
#include <variant>

namespace rehearse {

namespace {

constexpr const ChannelForm* all[] = {
#define REHEARSE_KIND(name, ...) &name##_kind,
#include "kinds.inl"
#undef REHEARSE_KIND
};

template <class... Kinds>
bool is_any_of(const DeviceKind& kind) {
  return (std::holds_alternative<Kinds>(kind) || ...);
}

/// Whether a device is in the row of a kind, by kind.
constexpr bool (*has_device[])(const DeviceKind&) = {
#define REHEARSE_KIND(name, ...) &is_any_of<__VA_ARGS__>,
#include "kinds.inl"
#undef REHEARSE_KIND
};

template <class Kind, class... Kinds>
constexpr bool is_in_row = (std::is_same_v<Kind, Kinds> || ...);

template <class Kind>
constexpr bool only_acts() {
  if constexpr (requires { Kind::form(); }) return Kind::form().readings.acts();
  return false;
}

template <class Kind>
constexpr bool has_row = only_acts<Kind>()
#define REHEARSE_KIND(name, ...) || is_in_row<Kind __VA_OPT__(, ) __VA_ARGS__>
#include "kinds.inl"
#undef REHEARSE_KIND
    ;

template <class... Kinds>
constexpr bool have_rows(const std::variant<Kinds...>*) {
  return (has_row<Kinds> && ...);
}
static_assert(have_rows(static_cast<const DeviceKind*>(nullptr)),
              "each kind of device that measures is in a row of harness/src/core/kinds/kinds.inl");

std::vector<ChannelElement> list_elements(const ChannelForm& form) {
  std::vector<ChannelElement> elements;
  for (const ElementGroup& group : form.groups) {
    if (group.axes.empty()) elements.push_back({std::string(group.name), group.unit});
    for (const char axis : group.axes) elements.push_back({std::string(group.name) + '/' + axis, group.unit});
  }
  return elements;
}

}  // namespace

std::span<const ChannelForm* const> channel_forms() { return all; }

const ChannelForm& form_of(ChannelKind kind) {
  REHEARSE_ASSERT(kind != ChannelKind::other, "only topics of Rehearse have a form");
  return *all[static_cast<std::size_t>(kind)];
}

const ChannelForm* form_of_type(std::string_view type) {
  const auto found = std::ranges::find(all, type, &ChannelForm::type);
  return found == std::end(all) ? nullptr : *found;
}

const std::vector<ChannelElement>& elements_of(ChannelKind kind) {
  static const auto elements = [] {
    std::array<std::vector<ChannelElement>, std::size(all)> of_all;
    std::ranges::transform(all, of_all.begin(), [](const ChannelForm* form) { return list_elements(*form); });
    return of_all;
  }();
  return elements[static_cast<std::size_t>(kind)];
}

bool measures(const ChannelForm& form, const Device& device) {
  if (!form.measurement) return false;
  const auto index = static_cast<std::size_t>(std::ranges::find(all, &form) - std::begin(all));
  return has_device[index](device.kind) && (!form.measurement->is_of || form.measurement->is_of(device));
}

std::vector<ChannelKind> kinds_of(const Device& device) {
  std::vector<ChannelKind> kinds;
  for (std::size_t i = 0; i < std::size(all); ++i)
    if (measures(*all[i], device)) kinds.push_back(static_cast<ChannelKind>(i));
  return kinds;
}

std::span<const LogInput* const> log_inputs() {
  static const std::vector<const LogInput*> inputs = [] {
    std::vector<const LogInput*> found;
    for (const ChannelForm* form : all) {
      if (!form->measurement || form->measurement->log.content == LogInput::Content::none) continue;
      const LogInput* input = &form->measurement->log;
      if (std::ranges::find(found, input) == found.end()) found.push_back(input);
    }
    std::ranges::stable_sort(found, {}, [](const LogInput* input) { return std::pair(input->content, input->key); });
    return found;
  }();
  return inputs;
}

const ChannelForm& form_of_input(const LogInput& input) {
  const auto found = std::ranges::find_if(
      all, [&](const ChannelForm* form) { return form->measurement && &form->measurement->log == &input; });
  REHEARSE_ASSERT(found != std::end(all), "an input belongs to a kind");
  return **found;
}

const LogInput* log_input_of(const Device& device) {
  for (const ChannelForm* form : all)
    if (measures(*form, device) && form->measurement->log.content != LogInput::Content::none)
      return &form->measurement->log;
  return nullptr;
}

std::vector<std::string> fields_of(const LogInput& input) {
  std::vector<std::string> fields;
  for (const ChannelElement& element : list_elements(form_of_input(input)))
    fields.push_back(std::string(input.fields) + element.name);
  return fields;
}

bool feeds(const LogInput& input, const Device& device) {
  return std::ranges::any_of(all, [&](const ChannelForm* form) {
    return form->measurement && &form->measurement->log == &input && measures(*form, device);
  });
}

std::size_t first_element(const Device& device) {
  const std::vector<ChannelKind> kinds = kinds_of(device);
  const auto first = kinds.empty() ? nullptr : form_of(kinds[0]).measurement->first_element;
  return first ? first(device) : 0;
}

std::span<const ChannelElement> value_elements(const Device& device) {
  const auto count = static_cast<std::size_t>(value_count(device));
  const std::vector<ChannelKind> kinds = kinds_of(device);
  if (count == 0 || kinds.empty()) return {};
  return std::span(elements_of(kinds[0])).subspan(first_element(device), count);
}

const MessageFrame* message_frame(const Device& device) {
  for (const ChannelForm* form : all)  // the first of its kinds
    if (measures(*form, device)) return form->measurement->frame;
  return nullptr;
}

std::string frame_of(const std::string& body, const Device& device) {
  const MessageFrame* frame = message_frame(device);
  return body + "/" + device.name + std::string(frame ? frame->suffix : "");
}

}  // namespace rehearse
