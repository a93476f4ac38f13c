#include "channel_name.h"

#include <rehearse/diagnostic.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/glob.h"

namespace rehearse {
namespace {

using Level = ChannelForm::Level;

constexpr std::pair<ChannelSide, std::string_view> sides[] = {{ChannelSide::input, "input"},
                                                              {ChannelSide::output, "output"},
                                                              {ChannelSide::acted, "acted"},
                                                              {ChannelSide::variable, "variable"}};

/// `other`: no kind has this segment.
ChannelKind find_kind(Level level, std::string_view segment) {
  const auto forms = channel_forms();
  const auto found = std::ranges::find_if(
      forms, [&](const ChannelForm* form) { return form->level == level && form->segment == segment; });
  return static_cast<ChannelKind>(found - forms.begin());
}

ChannelSide side_of(std::string_view segment) {
  for (const auto& [side, name] : sides)
    if (name == segment) return side;
  return ChannelSide::none;
}

std::string name_of_segment(std::string_view segment) {
  std::string name;
  while (!segment.empty()) {
    const bool is_slash = segment.starts_with("%2F"), is_percent = segment.starts_with("%25");
    name += is_slash ? '/' : segment.front();
    segment.remove_prefix(is_slash || is_percent ? 3 : 1);
  }
  return name;
}

/// The segments of a topic that begins with a slash; none: it has an empty segment, or more than any topic of Rehearse.
std::vector<std::string_view> segments_of(std::string_view topic) {
  constexpr std::size_t most = 5;
  std::vector<std::string_view> segments;
  while (topic.starts_with('/') && segments.size() < most) {
    topic.remove_prefix(1);
    segments.push_back(topic.substr(0, topic.find('/')));
    if (segments.back().empty()) return {};
    topic.remove_prefix(segments.back().size());
  }
  return topic.empty() ? segments : std::vector<std::string_view>();
}

/// The name with these segments; none: no topic of Rehearse has these segments.
std::optional<ChannelName> name_of(const std::vector<std::string_view>& segments) {
  ChannelName name;
  const std::size_t count = segments.size();
  std::size_t owner = count;  // index of the owner's segment
  if (count == 0) return std::nullopt;
  if (count > 1) name.body = segments[0];
  if (count > 3) {
    name.controller = segments[1];
    name.side = side_of(segments[2]);
    if (name.side == ChannelSide::none) return std::nullopt;
  }
  if (name.side == ChannelSide::variable) {
    if (count == 4) name.kind = ChannelKind::variable;
    owner = 3;
  } else {
    const Level level = count == 1 ? Level::run : count == 2 || count == 4 ? Level::body : Level::owner;
    name.kind = find_kind(level, segments.back());
    if (level == Level::owner) owner = count - 2;
  }
  if (name.kind == ChannelKind::other) return std::nullopt;
  if (owner < count) name.owner = name_of_segment(segments[owner]);
  if (owner < count && topic_segment(name.owner) != segments[owner]) return std::nullopt;
  return name;
}

std::string metadata_key(const ElementGroup& group) {
  return group.name.empty() ? "unit" : "unit:" + std::string(group.name);
}

}  // namespace

ChannelName ChannelName::parse(std::string_view topic) {
  if (auto name = name_of(segments_of(topic))) return *std::move(name);
  ChannelName foreign;
  foreign.foreign = topic;
  return foreign;
}

ChannelName ChannelName::of_run(ChannelKind kind) { return {{}, {}, ChannelSide::none, {}, kind}; }

ChannelName ChannelName::of_body(std::string body, ChannelKind kind) {
  return {std::move(body), {}, ChannelSide::none, {}, kind};
}

ChannelName ChannelName::of_owner(std::string body, std::string owner, ChannelKind kind) {
  return {std::move(body), {}, ChannelSide::none, std::move(owner), kind};
}

ChannelName ChannelName::of_controller(std::string_view label, ChannelSide side, ChannelKind kind, std::string owner) {
  const std::string_view body = body_of_name(label);
  REHEARSE_ASSERT(!body.empty(), "a controller is labelled BODY/CONTROLLER");
  return {std::string(body), std::string(label.substr(body.size() + 1)), side, std::move(owner), kind};
}

ChannelName ChannelName::of_variable(std::string_view label, std::string name) {
  return of_controller(label, ChannelSide::variable, ChannelKind::variable, std::move(name));
}

std::string ChannelName::topic() const {
  if (kind == ChannelKind::other) return foreign;
  std::string topic;
  const auto add = [&topic](std::string_view segment) {
    if (!segment.empty()) topic.append("/").append(segment);
  };
  add(body);
  add(controller);
  for (const auto& [known, segment] : sides)
    if (known == side) add(segment);
  add(topic_segment(owner));
  add(form_of(kind).segment);
  return topic;
}

std::string ChannelName::label() const { return controller.empty() ? std::string() : body + "/" + controller; }

bool ChannelName::is_of_link() const {
  if (kind == ChannelKind::other) return false;
  const ChannelForm::OfLink of_link = form_of(kind).of_link;
  return of_link == ChannelForm::OfLink::always ||
         (of_link == ChannelForm::OfLink::on_sides && side != ChannelSide::none);
}

std::string topic_segment(std::string_view name) {
  std::string segment;
  for (const char c : name) {
    if (c == '/' || c == '%')
      segment += c == '/' ? "%2F" : "%25";
    else
      segment += c;
  }
  return segment;
}

std::string series_name(std::string_view topic, std::string_view element) {
  if (topic.starts_with('/')) topic.remove_prefix(1);
  const std::size_t last = topic.rfind('/');
  return std::string(topic.substr(0, last == std::string_view::npos ? 0 : last + 1)).append(element);
}

std::string_view distinguishing_segment(std::string_view topic) {
  const ChannelName name = ChannelName::parse(topic);
  if (!name.controller.empty() && (name.owner.empty() || name.kind == ChannelKind::variable)) return {};
  const std::size_t last = topic.rfind('/');
  if (last == 0 || last == std::string_view::npos) return {};
  const std::size_t before = topic.rfind('/', last - 1);
  return topic.substr(before + 1, last - before - 1);
}

std::string_view body_of_name(std::string_view name) {
  const std::size_t slash = name.find('/');
  return slash == std::string_view::npos ? std::string_view() : name.substr(0, slash);
}

bool may_match(std::string_view topic, std::string_view pattern) {
  const ChannelKind kind = ChannelName::parse(topic).kind;
  if (kind == ChannelKind::other) return true;
  const ChannelForm& form = form_of(kind);
  if (!form.has_series || !form.has_fixed_elements) return form.has_series;
  const std::string whole = std::string(topic.substr(1)) + '/';  // the prefix of a second channel with that name
  return std::ranges::any_of(elements_of(kind), [&](const ChannelElement& element) {
    return matches(pattern, series_name(topic, element.name)) || matches(pattern, whole + element.name);
  });
}

std::string_view unit_of_joint(std::string_view quantity, bool linear) {
  for (const ChannelForm* form : channel_forms())
    for (const ElementGroup& group : form->groups)
      if (group.name == quantity && !group.linear_unit.empty()) return linear ? group.linear_unit : group.unit;
  return {};
}

mcap::StringMap unit_metadata(ChannelKind kind) {
  mcap::StringMap metadata;
  for (const ElementGroup& group : form_of(kind).groups)
    if (group.linear_unit.empty() && !group.unit.empty()) metadata[metadata_key(group)] = group.unit;
  return metadata;
}

mcap::ChunkGroup chunk_group_of(const ChannelName& name) {
  if (name.side != ChannelSide::none) return mcap::numbers;
  if (const auto chunks = form_of(name.kind).chunks) return *chunks;
  switch (stage_of(name)) {
    case Stage::physics: return {3, mcap::Compression::zstd};
    case Stage::sensors:
    case Stage::renderer: return {4, mcap::Compression::zstd};
    default: return mcap::numbers;
  }
}

std::string unit_of(const mcap::StringMap& metadata, std::string_view element) {
  const auto stated = [&](const std::string& key) -> const std::string* {
    const auto found = metadata.find(key);
    return found == metadata.end() ? nullptr : &found->second;
  };
  if (const std::string* unit = stated("unit:" + std::string(element))) return *unit;
  for (std::size_t begin = 0; begin < element.size();) {
    const std::size_t end = std::min(element.find('/', begin), element.size());
    if (const std::string* unit = stated("unit:" + std::string(element.substr(begin, end - begin)))) return *unit;
    begin = end + 1;
  }
  const std::string* unit = stated("unit");
  return unit ? *unit : "";
}

std::string_view to_string(Stage stage) {
  switch (stage) {
    case Stage::inputs: return "inputs";
    case Stage::controller: return "controller";
    case Stage::physics: return "physics";
    case Stage::sensors: return "sensors";
    case Stage::renderer: return "renderer";
    case Stage::costs: return "costs";
  }
  return "";
}

Stage stage_of(const ChannelName& name, std::string_view element) {
  if (name.side == ChannelSide::input) return Stage::inputs;
  if (name.side == ChannelSide::output) return Stage::controller;
  if (name.kind != ChannelKind::other) {
    const ChannelForm& form = form_of(name.kind);
    return form.stage_of_element ? form.stage_of_element(element) : form.stage;
  }
  const std::string_view topic = name.foreign;
  for (const Level level : {Level::body, Level::owner}) {
    const ChannelKind kind = find_kind(level, topic.substr(topic.rfind('/') + 1));
    if (kind != ChannelKind::other) return form_of(kind).stage;
  }
  return Stage::physics;
}

Stage stage_of(std::string_view topic, std::string_view element) {
  return stage_of(ChannelName::parse(topic), element);
}

}  // namespace rehearse
