#include "channel_name.h"

#include <rehearse/diagnostic.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/mcap/glob.h"

namespace rehearse {
namespace {

using Level = ChannelForm::Level;

constexpr ElementGroup pose_groups[] = {{"position", "m", "xyz"}, {"orientation", "quaternion", "xyzw"}};
constexpr ElementGroup joint_groups[] = {{"q", "rad", {}, "m"}, {"dq", "rad/s", {}, "m/s"}, {"u", "N·m", {}, "N"}};
constexpr ElementGroup joint_acceleration_groups[] = {{"ddq", "rad/s²", {}, "m/s²"}};
constexpr ElementGroup twist_groups[] = {{"linear", "m/s", "xyz"}, {"angular", "rad/s", "xyz"}};
constexpr ElementGroup acceleration_groups[] = {{"linear_acceleration", "m/s²", "xyz"},
                                                {"angular_acceleration", "rad/s²", "xyz"}};
constexpr ElementGroup wrench_groups[] = {{"force", "N", "xyz"}, {"torque", "N·m", "xyz"}};
constexpr ElementGroup contacts_groups[] = {{"position", "m", "xyz"},
                                            {"normal", "unit vector", "xyz"},
                                            {"force", "N", "xyz"},
                                            {"velocity", "m/s", "xyz"},
                                            {"depth", "m"}};
constexpr ElementGroup imu_groups[] = {{"angular_velocity", "rad/s", "xyz"}, {"linear_acceleration", "m/s²", "xyz"}};
constexpr ElementGroup contact_groups[] = {{"count", ""}, {"force", "N", "xyz"}};
constexpr ElementGroup range_groups[] = {
    {"angle_min", "rad"}, {"angle_max", "rad"}, {"range_min", "m"}, {"range_max", "m"}, {"ranges", "m"}};
constexpr ElementGroup delay_groups[] = {{"delay", "ticks"}};
constexpr ElementGroup image_groups[] = {{"", "pixels"}};
constexpr ElementGroup depth_groups[] = {{"", "m"}};

constexpr ChannelForm forms[] = {
    {ChannelKind::tick, Level::run, "tick", msg::Tick::type_name, Stage::controller},
    {ChannelKind::transforms, Level::run, "tf", msg::TFMessage::type_name, Stage::physics, pose_groups},
    {ChannelKind::joystick, Level::run, "joy", msg::Joy::type_name, Stage::inputs},
    {ChannelKind::events, Level::run, "events", msg::Event::type_name, Stage::controller},
    {ChannelKind::contact_changes, Level::run, "contacts", msg::ContactChange::type_name, Stage::physics},
    {ChannelKind::checkpoint, Level::run, "checkpoint", msg::Checkpoint::type_name, Stage::physics},
    {ChannelKind::joints, Level::body, "joints", msg::JointState::type_name, Stage::physics, joint_groups},
    {ChannelKind::measured_joints, Level::body, "measured_joints", msg::JointState::type_name, Stage::sensors,
     joint_groups},
    {ChannelKind::joint_accelerations, Level::body, "joint_accelerations", msg::JointAccelerations::type_name,
     Stage::physics, joint_acceleration_groups},
    {ChannelKind::pose, Level::owner, "pose", msg::PoseStamped::type_name, Stage::physics, pose_groups},
    {ChannelKind::twist, Level::owner, "twist", msg::TwistStamped::type_name, Stage::physics, twist_groups},
    {ChannelKind::acceleration, Level::owner, "accel", msg::AccelStamped::type_name, Stage::physics,
     acceleration_groups},
    {ChannelKind::wrench, Level::owner, "wrench", msg::WrenchStamped::type_name, Stage::sensors, wrench_groups},
    {ChannelKind::contacts, Level::owner, "contacts", msg::Contacts::type_name, Stage::physics, contacts_groups},
    {ChannelKind::imu, Level::owner, "imu", msg::Imu::type_name, Stage::sensors, imu_groups},
    {ChannelKind::contact, Level::owner, "contact", msg::ContactForce::type_name, Stage::sensors, contact_groups},
    {ChannelKind::scan, Level::owner, "scan", msg::LaserScan::type_name, Stage::sensors, range_groups},
    {ChannelKind::points, Level::owner, "points", msg::PointCloud2::type_name, Stage::sensors, range_groups},
    {ChannelKind::image, Level::owner, "image", msg::CompressedImage::type_name, Stage::renderer, image_groups},
    {ChannelKind::depth, Level::owner, "depth", msg::Image::type_name, Stage::renderer, depth_groups},
    {ChannelKind::camera_info, Level::owner, "camera_info", msg::CameraInfo::type_name, Stage::renderer},
    {ChannelKind::device_state, Level::owner, "state", msg::DeviceState::type_name, Stage::physics},
    {ChannelKind::delay, Level::body, "delay", msg::Float64::type_name, Stage::controller, delay_groups},
    {ChannelKind::variable, Level::variable, "", msg::Float64::type_name, Stage::controller},
};
static_assert(std::size(forms) == static_cast<std::size_t>(ChannelKind::other));

constexpr std::pair<ChannelSide, std::string_view> sides[] = {{ChannelSide::input, "input"},
                                                              {ChannelSide::output, "output"},
                                                              {ChannelSide::acted, "acted"},
                                                              {ChannelSide::variable, "variable"}};

const ChannelForm* find_form(Level level, std::string_view segment) {
  const auto found = std::find_if(std::begin(forms), std::end(forms), [&](const ChannelForm& form) {
    return form.level == level && form.segment == segment;
  });
  return found == std::end(forms) ? nullptr : found;
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
  const ChannelForm* form = nullptr;
  std::size_t owner = count;  // index of the owner's segment
  if (count == 0) return std::nullopt;
  if (count > 1) name.body = segments[0];
  if (count > 3) {
    name.controller = segments[1];
    name.side = side_of(segments[2]);
    if (name.side == ChannelSide::none) return std::nullopt;
  }
  if (name.side == ChannelSide::variable) {
    form = count == 4 ? &form_of(ChannelKind::variable) : nullptr;
    owner = 3;
  } else {
    form = find_form(count == 1 ? Level::run : count == 2 || count == 4 ? Level::body : Level::owner, segments.back());
    if (form && form->level == Level::owner) owner = count - 2;
  }
  if (!form) return std::nullopt;
  name.kind = form->kind;
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
  switch (kind) {
    case ChannelKind::pose:
    case ChannelKind::twist:
    case ChannelKind::acceleration:
    case ChannelKind::contacts: return true;
    case ChannelKind::wrench: return side != ChannelSide::none;  // otherwise a force sensor
    default: return false;
  }
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

const ChannelForm& form_of(ChannelKind kind) {
  REHEARSE_ASSERT(kind != ChannelKind::other, "only topics of Rehearse have a form");
  return forms[static_cast<std::size_t>(kind)];
}

const std::vector<ChannelElement>& elements_of(ChannelKind kind) {
  static const auto all = [] {
    std::array<std::vector<ChannelElement>, std::size(forms)> elements;
    for (const ChannelForm& form : forms) {
      for (const ElementGroup& group : form.groups) {
        std::vector<ChannelElement>& of_kind = elements[static_cast<std::size_t>(form.kind)];
        if (group.axes.empty()) of_kind.push_back({std::string(group.name), group.unit});
        for (const char axis : group.axes) of_kind.push_back({std::string(group.name) + '/' + axis, group.unit});
      }
    }
    return elements;
  }();
  return all[static_cast<std::size_t>(form_of(kind).kind)];
}

bool may_match(std::string_view topic, std::string_view pattern) {
  const ChannelKind kind = ChannelName::parse(topic).kind;
  if (kind == ChannelKind::image || kind == ChannelKind::depth) return false;
  constexpr ChannelKind fixed[] = {ChannelKind::pose,   ChannelKind::twist, ChannelKind::acceleration,
                                   ChannelKind::wrench, ChannelKind::imu,   ChannelKind::contact};
  const bool names_elements = std::ranges::find(fixed, kind) == std::end(fixed);  // in its messages
  if (names_elements) return true;
  const std::string whole = std::string(topic.substr(1)) + '/';  // the prefix of a second channel with that name
  return std::ranges::any_of(elements_of(kind), [&](const ChannelElement& element) {
    return matches(pattern, series_name(topic, element.name)) || matches(pattern, whole + element.name);
  });
}

std::string_view unit_of_joint(std::string_view quantity, bool linear) {
  for (const ChannelKind kind : {ChannelKind::joints, ChannelKind::joint_accelerations})
    for (const ElementGroup& group : form_of(kind).groups)
      if (group.name == quantity) return linear ? group.linear_unit : group.unit;
  return {};
}

mcap::StringMap unit_metadata(ChannelKind kind) {
  mcap::StringMap metadata;
  for (const ElementGroup& group : form_of(kind).groups)
    if (group.linear_unit.empty() && !group.unit.empty()) metadata[metadata_key(group)] = group.unit;
  return metadata;
}

mcap::ChunkGroup chunk_group_of(const ChannelName& name) {
  // joints share chunks with the inputs that repeat them: in separate chunks, a humanoid's recording is 29 % larger
  if (name.side != ChannelSide::none || name.kind == ChannelKind::joints) return mcap::numbers;
  if (name.kind == ChannelKind::image) return mcap::pictures;
  if (name.kind == ChannelKind::depth) return {2, mcap::Compression::zstd};
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
  }
  return "";
}

Stage stage_of(const ChannelName& name, std::string_view element) {
  if (name.side == ChannelSide::input) return Stage::inputs;
  if (name.side == ChannelSide::output) return Stage::controller;
  switch (name.kind) {
    case ChannelKind::tick:
      return element == "state_hash" ? Stage::physics : element == "input_hash" ? Stage::inputs : Stage::controller;
    case ChannelKind::transforms:
      return element.find("/scan/") == std::string_view::npos ? Stage::physics : Stage::sensors;
    case ChannelKind::other: {
      const std::string_view topic = name.foreign;
      for (const Level level : {Level::body, Level::owner})
        if (const ChannelForm* form = find_form(level, topic.substr(topic.rfind('/') + 1))) return form->stage;
      return Stage::physics;
    }
    default: return form_of(name.kind).stage;
  }
}

Stage stage_of(std::string_view topic, std::string_view element) {
  return stage_of(ChannelName::parse(topic), element);
}

}  // namespace rehearse
