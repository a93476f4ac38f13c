#include "recorded_inputs.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <utility>

#include "core/kinds/joint_arrays.h"
#include "core/trace/run_facts.h"
#include "device_message.h"

namespace rehearse {

/// The destination of the messages of one channel.
struct RecordedInputs::Feed {
  explicit Feed(ChannelKind of_kind)
      : kind(of_kind == ChannelKind::measured_joints ? ChannelKind::joints : of_kind),
        joints(kind == ChannelKind::joint_accelerations ? 1 : 3) {}

  ChannelKind kind;            // measured joints are joints
  int body = -1;               // index; -1: no body
  int link = -1, device = -1;  // index; -1: no link, no device
  JointArrays joints;
  std::vector<int> joint_ids;                             // joint id by index in the message; -1: no such joint
  std::vector<std::pair<const double*, double*>> copies;  // from the message to the observation
  std::string topic;
  /// For inputs of a controller: true for the numbers that it reads, by array of the message, then by index.
  std::optional<std::vector<std::vector<bool>>> read;

  bool has(std::size_t array_index, std::size_t index) const {
    if (joints.all()[array_index].empty()) return false;
    return !read || (index < (*read)[array_index].size() && (*read)[array_index][index]);
  }
  bool has(const IoField& field) const {
    if (!read) return true;
    const std::size_t index = field.quantity == Quantity::dq ? 1 : field.quantity == Quantity::u ? 2 : 0;
    const auto joint = std::ranges::find(joint_ids, field.joint);
    return joint != joint_ids.end() && has(index, static_cast<std::size_t>(joint - joint_ids.begin()));
  }
  /// The joints of the model, for the names of the last message.
  void find_joints(const Model& model);
  /// Finds the numbers to copy, for the layout of the last message.
  void pair_with(std::vector<JointReading>& observed);
};

void RecordedInputs::Feed::find_joints(const Model& model) {
  joint_ids.clear();
  for (const std::string& name : joints.names()) {
    const int found = model.find_joint(name);
    joint_ids.push_back(found < 0 ? -1 : model.links[found].joint.id);
  }
}

void RecordedInputs::Feed::pair_with(std::vector<JointReading>& observed) {
  constexpr double JointReading::*of_joints[] = {&JointReading::q, &JointReading::dq, &JointReading::u};
  constexpr double JointReading::*of_accelerations[] = {&JointReading::ddq};
  const std::span<double JointReading::*const> quantities =
      kind == ChannelKind::joints ? std::span<double JointReading::*const>(of_joints) : of_accelerations;
  copies.clear();
  for (std::size_t i = 0; i < joint_ids.size(); ++i)
    for (std::size_t a = 0; a < quantities.size(); ++a)
      if (joint_ids[i] >= 0 && has(a, i))
        copies.emplace_back(&joints.all()[a][i], &(observed[joint_ids[i]].*quantities[a]));
}

RecordedInputs::RecordedInputs(const Scenario& scenario, mcap::Reader& reader) : scenario_(scenario) {
  for (const ScenarioBody& body : scenario.bodies) {
    BodyObservation& seen = observation_.bodies.emplace_back();
    seen.joints.resize(body.model->joints.size());
    seen.links.resize(body.model->links.size());
    seen.devices.resize(body.model->devices.size());
  }
  if (scenario.joystick) observation_.joystick.emplace();
  std::map<std::uint16_t, ChannelName> names;
  for (const auto& [id, channel] : reader.channels()) names[id] = ChannelName::parse(channel.topic);
  std::set<std::string> measured;  // bodies
  for (const auto& [id, name] : names)
    if (name.kind == ChannelKind::measured_joints) measured.insert(name.body);
  const RunFacts facts = RunFacts::of(reader);
  const auto& samples = facts.state_rate;
  for (const auto& [id, name] : names) {
    const std::string& topic = reader.channels().at(id).topic;
    const bool is_state = name.kind == ChannelKind::joints && name.side == ChannelSide::none;
    // The state in a flight has no more than the inputs have.
    if (is_state && (facts.is_of_flight || measured.contains(name.body))) continue;
    if (is_joint_input(name))
      add_joints_read(reader, id, name);
    else if (!samples || !samples->reduces(topic))
      add(id, name, topic);
  }
}

RecordedInputs::~RecordedInputs() = default;

void RecordedInputs::add(std::uint16_t id, const ChannelName& name, const std::string& topic) {
  Feed feed(name.kind);
  feed.topic = topic;
  const auto keep = [&] { feeds_[id] = std::make_unique<Feed>(std::move(feed)); };
  if (name.kind == ChannelKind::joystick) {
    if (scenario_.joystick) keep();
    return;
  }
  const auto body =
      std::ranges::find_if(scenario_.bodies, [&](const ScenarioBody& known) { return known.name == name.body; });
  if (body == scenario_.bodies.end()) return;
  feed.body = static_cast<int>(body - scenario_.bodies.begin());
  const bool of_body = name.side == ChannelSide::none;
  if (!of_body && name.side != ChannelSide::input) return;
  if (name.is_of_link()) {
    feed.link = body->model->find_link(name.owner);
    if (feed.link < 0 || !form_of(feed.kind).read_link) return;
    if (feed.kind == ChannelKind::contacts) observation_.bodies[feed.body].contacts.resize(body->model->links.size());
    return keep();
  }
  if (of_body && !name.owner.empty()) {
    feed.device = body->model->find_device(name.owner);
    if (feed.device >= 0 && is_read_from(body->model->devices[feed.device], feed.kind)) keep();
  } else if (of_body && feed.kind == ChannelKind::joints) {
    keep();
  }
}

/// Adds the values of joints that a controller read, by its first inputs: the others are NaN there.
void RecordedInputs::add_joints_read(mcap::Reader& reader, std::uint16_t id, const ChannelName& name) {
  const auto body = std::ranges::find(scenario_.bodies, name.body, &ScenarioBody::name);
  mcap::OrderedMessages messages(reader, std::span(&id, 1));
  const mcap::Message* first = messages.next();
  auto feed = std::make_unique<Feed>(name.kind);
  if (body == scenario_.bodies.end() || first == nullptr || !feed->joints.read(first->data) ||
      !feed->joints.fit_the_names())
    return;
  feed->body = static_cast<int>(body - scenario_.bodies.begin());
  feed->topic = reader.channels().at(id).topic;
  feed->find_joints(*body->model);
  auto& read = feed->read.emplace();
  for (const std::vector<double>& values : feed->joints.all()) {
    std::vector<bool>& of_array = read.emplace_back();
    for (const double value : values) of_array.push_back(!std::isnan(value));
  }
  feed->pair_with(observation_.bodies[feed->body].joints);
  feeds_[id] = std::move(feed);
}

bool RecordedInputs::feeds(const Feed& feed, int body, const IoField& field) const {
  if (feed.body != body || feed.device >= 0 || feed.kind != channel_kind_of(field.quantity)) return false;
  return feed.link < 0 ? feed.has(field) : feed.link == field.link;
}

/// True if a controller's input contains that value of a joint.
bool RecordedInputs::has_input(int body, const IoField& field) const {
  return std::ranges::any_of(
      feeds_, [&](const auto& entry) { return entry.second->read && feeds(*entry.second, body, field); });
}

std::set<std::string> RecordedInputs::joints_read() const {
  std::set<std::string> values;
  for (const auto& [id, feed] : feeds_) {
    if (!feed->read) continue;
    const ChannelName name = ChannelName::parse(feed->topic);
    for (std::size_t array = 0; array < feed->read->size(); ++array)
      for (std::size_t i = 0; i < feed->joints.names().size(); ++i)
        if (feed->has(array, i))
          values.insert(
              fmt::format("{}/{} of {}", feed->joints.names()[i], form_of(name.kind).groups[array].name, name.label()));
  }
  return values;
}

bool RecordedInputs::has(int body, const IoField& field) const {
  if (field.quantity == Quantity::wrench) return true;  // always zero: nothing to record
  return std::ranges::any_of(feeds_, [&](const auto& entry) { return feeds(*entry.second, body, field); });
}

bool RecordedInputs::has_device(int body, int device) const {
  return std::ranges::any_of(feeds_, [&](const auto& entry) {
    const Feed& feed = *entry.second;
    return feed.body == body && feed.device == device;
  });
}

bool RecordedInputs::has_contacts(int body, int link) const {
  return std::ranges::any_of(feeds_, [&](const auto& entry) {
    const Feed& feed = *entry.second;
    return feed.kind == ChannelKind::contacts && feed.body == body && feed.link == link;
  });
}

bool RecordedInputs::has_joystick() const {
  return std::ranges::any_of(feeds_, [](const auto& entry) { return entry.second->kind == ChannelKind::joystick; });
}

std::vector<std::uint16_t> RecordedInputs::channels_read_by(const ControllerHost& host, bool whole_state) const {
  std::vector<std::uint16_t> channels;
  for (const auto& [id, feed] : feeds_) {
    bool read = feed->kind == ChannelKind::joystick;
    for (const HostedController& hosted : host.controllers()) {
      if (!hosted.running || hosted.body != feed->body) continue;
      for (const IoField& field : hosted.io->inputs().fields)
        read |= feeds(*feed, hosted.body, field) && (feed->read || whole_state || !has_input(hosted.body, field));
      for (const int device : hosted.io->input_devices()) read |= feed->device == device;
      for (const int link : hosted.io->contact_links())
        read |= feed->kind == ChannelKind::contacts && feed->link == link;
    }
    if (read) channels.push_back(id);
  }
  return channels;
}

void RecordedInputs::begin_tick() {
  for (BodyObservation& body : observation_.bodies)
    for (DeviceReading& device : body.devices) device.fresh = false;
}

Result<void> RecordedInputs::accept(const mcap::Message& message) {
  Feed& feed = *feeds_.at(message.channel->id);
  if (feed.kind == ChannelKind::joystick) return accept_joystick(message);
  if (feed.device >= 0) return accept_device(feed, message);
  const auto read_link = form_of(feed.kind).read_link;
  const bool fits = read_link ? read_link(message.data, feed.link, observation_.bodies[feed.body])
                              : accept_joints(feed, message.data);
  if (fits) return {};
  return error(fmt::format("a message on {} at {} ns is not of its type", feed.topic, message.log_time));
}

bool RecordedInputs::accept_joints(Feed& feed, mcap::Bytes payload) {
  if (!feed.joints.read(payload) || !feed.joints.fit_the_names()) return false;
  if (feed.joints.layout_changed()) {
    feed.find_joints(*scenario_.bodies[feed.body].model);
    feed.pair_with(observation_.bodies[feed.body].joints);
  }
  for (const auto& [from, to] : feed.copies) *to = *from;
  return true;
}

Result<void> RecordedInputs::accept_joystick(const mcap::Message& message) {
  CdrReader reader(message.data);
  msg::Joy joy;
  JoystickReading& reading = *observation_.joystick;
  if (!msg::decode(reader, joy) || joy.axes.size() != reading.axes.size() ||
      joy.buttons.size() != reading.buttons.size())
    return error(fmt::format("a message on /joy at {} ns is not of a joystick with {} axes and {} buttons",
                             message.log_time, reading.axes.size(), reading.buttons.size()));
  std::ranges::copy(joy.axes, reading.axes.begin());
  std::ranges::transform(joy.buttons, reading.buttons.begin(), [](std::int32_t button) { return button != 0; });
  return {};
}

Result<void> RecordedInputs::accept_device(const Feed& feed, const mcap::Message& message) {
  const Device& device = scenario_.bodies[feed.body].model->devices[feed.device];
  DeviceReading& reading = observation_.bodies[feed.body].devices[feed.device];
  reading.fresh = true;
  return read_device(device, feed.kind, message, scenario_.time_step, reading);
}

}  // namespace rehearse
