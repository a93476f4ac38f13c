#include "map_draft.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "log_contents.h"
#include "log_map.h"
#include "log_map_parts.h"
#include "yaml/yaml_tree.h"

namespace rehearse {
namespace {

/// The words of a name in lower case: LeftKnee_joint2 has left, knee, joint, 2.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words;
  char before = '_';
  for (const char c : name) {
    const auto kind = [](char of) {
      return std::isdigit(static_cast<unsigned char>(of)) ? 1 : std::isalpha(static_cast<unsigned char>(of)) ? 2 : 0;
    };
    const bool begins_capital =
        std::isupper(static_cast<unsigned char>(c)) && std::islower(static_cast<unsigned char>(before));
    if (kind(c) != 0) {
      if (kind(c) != kind(before) || begins_capital) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    before = c;
  }
  return words;
}

/// The name without its spelling: words that many names have are left out, sides are one letter.
std::string core_of(std::string_view name) {
  static const std::set<std::string> common{"joint", "link", "frame", "sensor", "optical", "device"};
  std::string core;
  for (const std::string& word : words_of(name)) {
    if (common.contains(word)) continue;
    core += word == "left" ? "l" : word == "right" ? "r" : word;
  }
  return core;
}

bool has_word(std::string_view name, std::initializer_list<std::string_view> wanted) {
  const std::vector<std::string> words = words_of(name);
  return std::ranges::any_of(words,
                             [&](const std::string& word) { return std::ranges::find(wanted, word) != wanted.end(); });
}

bool is_of_commands(const TopicContents& topic) {
  return has_word(topic.topic.name, {"command", "commands", "cmd", "desired", "target", "targets", "reference",
                                     "setpoint", "output", "goal"});
}

/// A time step near the median interval: a whole rate, if there is one.
double nominal_step(double interval) {
  const double rate = std::round(1.0 / interval);
  return rate >= 1.0 && std::abs(1.0 / rate / interval - 1.0) < 0.02 ? 1.0 / rate : interval;
}

/// The joints of the model that a topic's names stand for.
struct JointMatch {
  std::set<std::string> equal;                               // names that both have
  std::vector<std::pair<std::string, std::string>> similar;  // name in the log, joint of the model
  std::vector<std::string> strangers;                        // names of the log without a joint
  std::size_t joints() const { return equal.size() + similar.size(); }
};

class MapDraft {
 public:
  MapDraft(std::vector<TopicContents> topics, const Model& model) : topics_(std::move(topics)), model_(model) {
    for (const int link : model.joints) joints_.push_back(model.links[link].joint.name);
  }

  Result<std::string> write();

 private:
  JointMatch match(const TopicContents& topic) const;
  void write_joints();
  void write_time();
  void write_devices();
  std::string device_line(const Device& device, TopicUse use, std::size_t devices);
  static std::string remark_on_size(const Device& device, const TopicContents& topic);
  void write_root();
  void write_joystick();
  void write_commands();
  void write_unused();
  const TopicContents* find_topic_for(const Device& device, const std::vector<const TopicContents*>& topics,
                                      std::size_t devices, std::string& why) const;
  std::vector<const TopicContents*> of_use(TopicUse use) const {
    std::vector<const TopicContents*> found;
    for (const TopicContents& topic : topics_)
      if (topic.use == use && topic.messages > 0) found.push_back(&topic);
    return found;
  }
  void line(std::string text) { text_ += std::move(text) + "\n"; }
  std::string names_text(const JointMatch& match) const;

  std::vector<TopicContents> topics_;
  const Model& model_;
  std::vector<std::string> joints_;                 // names of the movable joints
  std::vector<const TopicContents*> joint_topics_;  // sources of joints
  const TopicContents* commands_ = nullptr;
  std::set<std::string> used_;  // topics
  std::string text_;
};

JointMatch MapDraft::match(const TopicContents& topic) const {
  JointMatch match;
  std::set<std::string> free(joints_.begin(), joints_.end());
  std::vector<std::string> others;
  for (const std::string& name : topic.names)
    if (free.erase(name) > 0)
      match.equal.insert(name);
    else
      others.push_back(name);
  for (const std::string& name : others) {
    std::vector<std::string> alike;
    for (const std::string& joint : free)
      if (core_of(joint) == core_of(name) && !core_of(name).empty()) alike.push_back(joint);
    if (alike.size() == 1) {
      match.similar.emplace_back(name, alike[0]);
      free.erase(alike[0]);
    } else {
      match.strangers.push_back(name);
    }
  }
  return match;
}

std::string MapDraft::names_text(const JointMatch& match) const {
  std::string text;
  for (const auto& [name, joint] : match.similar)
    text += fmt::format("      {}: {}    # unsure: similar names. A sign or an offset may be needed too\n",
                        yaml_text(name), yaml_text(joint));
  return text;
}

/// Writes the sources of joints: the topic with the most joints, then topics that add some.
void MapDraft::write_joints() {
  std::set<std::string> missing(joints_.begin(), joints_.end());
  std::vector<std::pair<const TopicContents*, JointMatch>> chosen;
  auto left = of_use(TopicUse::joint_states);
  std::erase_if(left, [](const TopicContents* topic) { return is_of_commands(*topic); });
  while (!left.empty()) {
    const auto adds = [&](const TopicContents* topic) {
      const JointMatch found = match(*topic);
      std::size_t count = 0;
      for (const std::string& joint : found.equal) count += missing.count(joint);
      for (const auto& [name, joint] : found.similar) count += missing.count(joint);
      return std::tuple(count, topic->has_position, topic->has_velocity, topic->has_effort);
    };
    const auto best = std::ranges::max_element(left, [&](const auto* a, const auto* b) { return adds(a) < adds(b); });
    if (std::get<0>(adds(*best)) == 0) break;
    const JointMatch found = match(**best);
    for (const std::string& joint : found.equal) missing.erase(joint);
    for (const auto& [name, joint] : found.similar) missing.erase(joint);
    chosen.emplace_back(*best, found);
    left.erase(best);
  }
  if (chosen.empty()) return;
  line("");
  line("joints:");
  for (const auto& [topic, found] : chosen) {
    joint_topics_.push_back(topic);
    used_.insert(topic->topic.name);
    line(fmt::format("  - topic: {}    # {} of the model's {} joints", yaml_text(topic->topic.name), found.joints(),
                     joints_.size()));
    if (!found.similar.empty()) text_ += "    names:\n" + names_text(found);
    if (!topic->has_velocity && topic->has_position)
      line("    velocity: differentiate    # its messages have no velocities");
    if (!topic->has_effort) line("    # its messages have no efforts: a controller that reads u isn't fed");
    if (!found.strangers.empty())
      line(fmt::format("    # names without a joint of the model: {}", fmt::join(found.strangers, ", ")));
  }
  if (!missing.empty()) line(fmt::format("  # joints without a source: {}", fmt::join(missing, ", ")));
}

/// The tick and its length, which precede the sources.
void MapDraft::write_time() {
  const TopicContents* tick = joint_topics_.empty() ? nullptr : joint_topics_.front();
  if (tick == nullptr)
    for (const TopicContents& topic : topics_)
      if (tick == nullptr && topic.use == TopicUse::imu && topic.interval) tick = &topic;
  std::string text;
  if (tick == nullptr || !tick->interval || *tick->interval <= 0.0) {
    text = "time_step: 0.001    # [s], unsure: no topic has a rate; expected the controller's tick\n";
  } else {
    std::string why = fmt::format("the distance of the messages on {}", tick->topic.name);
    if (commands_ && commands_->interval && *commands_->interval > 1.25 * *tick->interval) {
      tick = commands_;
      why = "the distance of the commands, which come more rarely than the joints";
    }
    text = fmt::format("time_step: {:.6g}    # [s]: {}\n", nominal_step(*tick->interval), why);
    text += fmt::format("tick: {}    # each of its messages is a tick; without it ticks are a grid\n",
                        yaml_text(tick->topic.name));
    if (!of_use(TopicUse::picture).empty() || !of_use(TopicUse::ranges).empty())
      text += "start: first    # at the first message; all: when pictures and scans have come, too\n";
    if (tick->stamp_lag)
      text += std::abs(*tick->stamp_lag) < 1.0
                  ? fmt::format("# clock: header.stamp    # it is {:.3g} s before the log time (median of {})\n",
                                *tick->stamp_lag, tick->topic.name)
                  : "# header.stamp has another clock than the log time\n";
  }
  text_ += text;
}

/// The topic of a device: by its name, by its frame, or because there is only one of each.
const TopicContents* MapDraft::find_topic_for(const Device& device, const std::vector<const TopicContents*>& topics,
                                              std::size_t devices, std::string& why) const {
  const std::string name = core_of(device.name), link = core_of(model_.links[device.link].name);
  for (const TopicContents* topic : topics)
    if (topic->topic.name.find("/" + device.name + "/") != std::string::npos) return why = "by its name", topic;
  for (const TopicContents* topic : topics)
    if (topic->frame == device.name || (!name.empty() && core_of(topic->frame) == name))
      return why = fmt::format("by its frame {}", topic->frame), topic;
  std::vector<const TopicContents*> on_link;
  for (const TopicContents* topic : topics)
    if (!topic->frame.empty() && core_of(topic->frame) == link) on_link.push_back(topic);
  if (on_link.size() == 1) return why = fmt::format("by its frame {}, the link", on_link[0]->frame), on_link[0];
  if (topics.size() == 1 && devices == 1)
    return why = fmt::format("unsure: the only one of its kind; its frame is '{}'", topics[0]->frame), topics[0];
  return nullptr;
}

/// A remark if the size of a camera or a range sensor differs from that of the log's messages; empty: equal, or
/// unknown.
std::string MapDraft::remark_on_size(const Device& device, const TopicContents& topic) {
  if (const auto* camera = std::get_if<Camera>(&device.kind);
      camera && topic.width != 0 &&
      (topic.width != static_cast<std::uint32_t>(camera->width) ||
       topic.height != static_cast<std::uint32_t>(camera->height)))
    return fmt::format("; it has {} x {} pixels, and the model's camera {} x {}: replay refuses it", topic.width,
                       topic.height, camera->width, camera->height);
  if (const auto* sensor = std::get_if<RangeSensor>(&device.kind);
      sensor && topic.numbers != 0 && topic.numbers != static_cast<std::size_t>(sensor->beams()))
    return fmt::format("; it has {} beams, and the model's sensor {}: replay refuses it", topic.numbers,
                       sensor->beams());
  return "";
}

/// The line of a device's source; empty if no topic fits it. `devices`: the number of devices of its kind.
std::string MapDraft::device_line(const Device& device, TopicUse use, std::size_t devices) {
  const auto is_depth = [](const TopicContents* topic) {
    return topic->encoding.starts_with("32FC1") || topic->encoding.starts_with("16UC1");
  };
  auto topics = of_use(use), depths = topics;
  std::erase_if(topics, is_depth);
  std::erase_if(depths, [&](const TopicContents* topic) { return !is_depth(topic); });
  std::string why, why_depth, entry;
  const auto add = [&](const char* key, const TopicContents* topic) {
    if (topic == nullptr) return;
    entry += fmt::format("{}: {}, ", key, yaml_text(topic->topic.name));
    used_.insert(topic->topic.name);
  };
  const TopicContents* topic = find_topic_for(device, topics, devices, why);
  const auto* camera = std::get_if<Camera>(&device.kind);
  const bool measures_depth = camera && camera->depth;
  const TopicContents* depth = measures_depth ? find_topic_for(device, depths, devices, why_depth) : nullptr;
  if (topic == nullptr && depth == nullptr) return "";
  add("topic", topic);
  add("depth", depth);
  std::string ignored;
  if (camera) add("info", find_topic_for(device, of_use(TopicUse::camera_info), devices, ignored));
  return fmt::format("  - {{{}device: {}}}    # {}{}", entry, yaml_text(device.name), topic ? why : why_depth,
                     topic ? remark_on_size(device, *topic) : "");
}

void MapDraft::write_devices() {
  struct Part {
    const char* key;
    TopicUse use;
    DeviceSource::Kind kind;
  };
  static constexpr Part parts[] = {{"imus", TopicUse::imu, DeviceSource::Kind::imu},
                                   {"wrenches", TopicUse::wrench, DeviceSource::Kind::wrench},
                                   {"cameras", TopicUse::picture, DeviceSource::Kind::picture},
                                   {"ranges", TopicUse::ranges, DeviceSource::Kind::ranges}};
  for (const Part& part : parts) {
    const auto& all = model_.devices;
    const auto fits_part = [&part](const Device& device) { return fits(part.kind, device); };
    const auto devices = static_cast<std::size_t>(std::ranges::count_if(all, fits_part));
    std::vector<std::string> lines, missing;
    for (const Device& device : all) {
      if (!fits_part(device)) continue;
      const std::string source = device_line(device, part.use, devices);
      if (source.empty())
        missing.push_back(device.name);
      else
        lines.push_back(source);
    }
    if (devices == 0) continue;
    line(lines.empty() ? fmt::format("\n# {}:", part.key) : fmt::format("\n{}:", part.key));
    for (const std::string& one : lines) line(one);
    for (const std::string& name : missing)
      line(fmt::format("  # - {{topic: ..., device: {}}}    # no topic fits it by name or frame", yaml_text(name)));
  }
}

void MapDraft::write_root() {
  const Link& root = model_.links[0];
  if (root.joint.type != JointType::free) return;
  const TopicContents* found = nullptr;
  std::string why;
  for (const TopicContents* topic : of_use(TopicUse::odometry))
    if (found == nullptr) found = topic, why = "an Odometry, which also has the velocity";
  if (found == nullptr) {
    for (const TopicContents* topic : of_use(TopicUse::pose))
      if (topic->topic.name.find("/" + root.name + "/") != std::string::npos) found = topic, why = "by its name";
  }
  line("");
  if (found == nullptr)
    return line(
        fmt::format("# root: ...    # no Odometry, and no PoseStamped of its name, has the pose of {}", root.name));
  used_.insert(found->topic.name);
  line(fmt::format("root: {}    # {}", yaml_text(found->topic.name), why));
}

void MapDraft::write_joystick() {
  auto topics = of_use(TopicUse::joystick);
  const char* why = "the order of its axes and buttons is assumed to be Choreonoid's";
  if (topics.empty()) {
    topics = of_use(TopicUse::twist);
    why = "a Twist as axes 0 to 5, linear x, y, z and angular x, y, z; it may also be a command of the controller";
  }
  if (topics.empty()) return;
  used_.insert(topics[0]->topic.name);
  line("");
  line(fmt::format("joystick: {}    # unsure: {}", yaml_text(topics[0]->topic.name), why));
}

/// Writes the commands: a JointState that its name marks as commands and that has the most joints, else an array of
/// numbers.
void MapDraft::write_commands() {
  if (commands_ == nullptr) return line("\n# commands: ...    # no topic has a name for the robot's commands");
  used_.insert(commands_->topic.name);
  line("");
  if (commands_->use == TopicUse::joint_states) {
    const JointMatch found = match(*commands_);
    line(fmt::format("commands:    # by its name; {} of the model's {} joints", found.joints(), joints_.size()));
    line(fmt::format("  topic: {}", yaml_text(commands_->topic.name)));
    if (!found.similar.empty()) text_ += "  names:\n" + names_text(found);
    return;
  }
  std::vector<std::string> joints;
  for (const std::string& joint : joints_) joints.push_back(yaml_text(joint));
  line("commands:    # by its name, and because it has as many numbers as the model has joints");
  line(fmt::format("  topic: {}", yaml_text(commands_->topic.name)));
  line(fmt::format("  joints: [{}]    # unsure: the order of the model's joints", fmt::join(joints, ", ")));
  line("  quantity: effort    # unsure: position, velocity or effort");
}

void MapDraft::write_unused() {
  bool any = false;
  for (const TopicContents& topic : topics_) {
    if (used_.contains(topic.topic.name) || topic.use == TopicUse::other) continue;
    if (!any) line("\n# Topics that could be inputs, and are not used above:");
    any = true;
    line(fmt::format("#   {} ({}{}){}", topic.topic.name, topic.topic.type,
                     topic.frame.empty() ? "" : ", frame " + topic.frame,
                     topic.messages == 0 ? ", without a message in the first minute" : ""));
  }
  for (const TopicContents& topic : topics_)
    if (!topic.topic.problem.empty())
      line(fmt::format("#   {}: its messages can't be read: {}", topic.topic.name, topic.topic.problem));
}

Result<std::string> MapDraft::write() {
  for (const TopicContents* topic : of_use(TopicUse::joint_states))
    if (is_of_commands(*topic) && match(*topic).joints() > (commands_ ? match(*commands_).joints() : 0))
      commands_ = topic;
  for (const TopicContents* topic : of_use(TopicUse::numbers))
    if (commands_ == nullptr && is_of_commands(*topic) && topic->numbers == joints_.size()) commands_ = topic;
  write_joints();
  write_devices();
  write_root();
  write_joystick();
  if (used_.empty()) {
    std::vector<std::string> all;
    for (const TopicContents& topic : topics_) all.push_back(topic.topic.name);
    return error(fmt::format("no topic of the log fits the model {}", model_.name),
                 fmt::format("the log has {}", fmt::join(all, ", ")));
  }
  write_commands();
  write_unused();
  const std::string sources = std::exchange(text_, "");
  line("# A first map, written by rehearse map. Each guess has its reason; check those that are unsure.");
  line("rehearse_map: 1");
  line(fmt::format("body: {}", yaml_text(model_.name)));
  write_time();
  return text_ + sources;
}

}  // namespace

Result<std::string> draft_map(mcap::Reader& log, const Model& model) {
  return MapDraft(contents_of(log), model).write();
}

}  // namespace rehearse
