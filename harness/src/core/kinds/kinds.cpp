#include "kinds.h"

#include <algorithm>
#include <array>

namespace rehearse {

namespace {

constexpr const ChannelForm* all[] = {
#define REHEARSE_KIND(name) &name##_kind,
#include "kinds.inl"
#undef REHEARSE_KIND
};

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

std::vector<ChannelKind> kinds_of(const Device& device) {
  std::vector<ChannelKind> kinds;
  for (std::size_t i = 0; i < std::size(all); ++i)
    if (all[i]->measurement && all[i]->measurement->is_of(device)) kinds.push_back(static_cast<ChannelKind>(i));
  return kinds;
}

std::span<const ChannelElement> value_elements(const Device& device) {
  const auto count = static_cast<std::size_t>(value_count(device));
  const std::vector<ChannelKind> kinds = kinds_of(device);
  if (count == 0 || kinds.empty()) return {};
  const auto first = form_of(kinds[0]).measurement->first_element;
  return std::span(elements_of(kinds[0])).subspan(first ? first(device) : 0, count);
}

const MessageFrame* message_frame(const Device& device) {
  for (const ChannelForm* form : all)  // the first of its kinds
    if (form->measurement && form->measurement->is_of(device)) return form->measurement->frame;
  return nullptr;
}

std::string frame_of(const std::string& body, const Device& device) {
  const MessageFrame* frame = message_frame(device);
  return body + "/" + device.name + std::string(frame ? frame->suffix : "");
}

}  // namespace rehearse
