#include "recorded_inputs.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "device_message.h"
#include "trace/joint_arrays.h"
#include "trace/run_facts.h"

namespace rehearse {
namespace {

Eigen::Vector3d vector(const msg::Vector3& v) { return {v.x, v.y, v.z}; }
Eigen::Vector3d vector(const msg::Point& p) { return {p.x, p.y, p.z}; }

}  // namespace

/// The destination of the messages of one channel.
struct RecordedInputs::Feed {
  ChannelKind kind = ChannelKind::joints;  // measured joints are joints
  int body = -1;                           // index; -1: no body
  int link = -1, device = -1;              // index; -1: no link, no device
  JointArrays joints;
  std::vector<int> joint_ids;                             // joint id by index in the message; -1: no such joint
  std::vector<std::pair<const double*, double*>> copies;  // from the message to the observation
  std::string topic;
  /// For inputs of a controller: true for the numbers that it reads, by array of the message, then by index.
  std::optional<std::array<std::vector<bool>, 3>> read;

  const std::vector<double>& array(std::size_t index) const {
    return index == 0 ? joints.position() : index == 1 ? joints.velocity() : joints.effort();
  }
  bool has(std::size_t array_index, std::size_t index) const {
    if (array(array_index).empty()) return false;
    return !read || (index < (*read)[array_index].size() && (*read)[array_index][index]);
  }
  bool has(const IoField& field) const {
    if (!read || field.quantity > Quantity::u || field.quantity == Quantity::ddq) return true;
    const std::size_t index = field.quantity == Quantity::q ? 0 : field.quantity == Quantity::dq ? 1 : 2;
    const auto joint = std::find(joint_ids.begin(), joint_ids.end(), field.joint);
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
  constexpr double JointReading::*quantities[] = {&JointReading::q, &JointReading::dq, &JointReading::u};
  copies.clear();
  for (std::size_t i = 0; i < joint_ids.size(); ++i)
    for (std::size_t a = 0; a < std::size(quantities); ++a)
      if (joint_ids[i] >= 0 && has(a, i)) copies.emplace_back(&array(a)[i], &(observed[joint_ids[i]].*quantities[a]));
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
  const auto samples = RunFacts::of(reader).state_rate;
  for (const auto& [id, name] : names) {
    const std::string& topic = reader.channels().at(id).topic;
    if (name.kind == ChannelKind::joints && name.side == ChannelSide::none && measured.contains(name.body)) continue;
    if (name.kind == ChannelKind::joints && name.side == ChannelSide::input)
      add_joints_read(reader, id, name);
    else if (!samples || !samples->reduces(topic))
      add(id, name, topic);
  }
}

RecordedInputs::~RecordedInputs() = default;

void RecordedInputs::add(std::uint16_t id, const ChannelName& name, const std::string& topic) {
  Feed feed;
  feed.kind = name.kind == ChannelKind::measured_joints ? ChannelKind::joints : name.kind;
  feed.topic = topic;
  const auto keep = [&] { feeds_[id] = std::make_unique<Feed>(std::move(feed)); };
  if (name.kind == ChannelKind::joystick) {
    if (scenario_.joystick) keep();
    return;
  }
  const auto body = std::find_if(scenario_.bodies.begin(), scenario_.bodies.end(),
                                 [&](const ScenarioBody& known) { return known.name == name.body; });
  if (body == scenario_.bodies.end()) return;
  feed.body = static_cast<int>(body - scenario_.bodies.begin());
  const bool of_body = name.side == ChannelSide::none;
  if (!of_body && name.side != ChannelSide::input) return;
  if (name.is_of_link()) {
    feed.link = body->model->find_link(name.owner);
    if (feed.link < 0 || feed.kind == ChannelKind::wrench) return;  // a wrench that is read is always zero
    if (feed.kind == ChannelKind::contacts) observation_.bodies[feed.body].contacts.resize(body->model->links.size());
    return keep();
  }
  if (of_body && !name.owner.empty()) {
    feed.device = body->model->find_device(name.owner);
    if (feed.device >= 0 && feed.kind != ChannelKind::camera_info) keep();
  } else if (name.owner.empty() && of_body == (feed.kind == ChannelKind::joints)) {
    keep();  // of a controller's channels only the accelerations, which the body's channels don't have
  }
}

/// Adds the joints that a controller read, by its first inputs: the values of other joints are NaN there.
void RecordedInputs::add_joints_read(mcap::Reader& reader, std::uint16_t id, const ChannelName& name) {
  const auto body = std::ranges::find(scenario_.bodies, name.body, &ScenarioBody::name);
  mcap::OrderedMessages messages(reader, std::span(&id, 1));
  const mcap::Message* first = messages.next();
  auto feed = std::make_unique<Feed>();
  if (body == scenario_.bodies.end() || first == nullptr || !feed->joints.read(first->data) ||
      !feed->joints.fit_the_names())
    return;
  feed->body = static_cast<int>(body - scenario_.bodies.begin());
  feed->topic = reader.channels().at(id).topic;
  feed->find_joints(*body->model);
  auto& read = feed->read.emplace();
  for (std::size_t i = 0; i < read.size(); ++i)
    for (const double value : feed->array(i)) read[i].push_back(!std::isnan(value));
  feed->pair_with(observation_.bodies[feed->body].joints);
  feeds_[id] = std::move(feed);
}

bool RecordedInputs::feeds(const Feed& feed, int body, const IoField& field) const {
  if (feed.body != body || feed.device >= 0 || feed.kind != channel_kind_of(field.quantity)) return false;
  return feed.link < 0 ? feed.has(field) : feed.link == field.link;
}

/// True if a controller's input contains that value of a joint.
bool RecordedInputs::has_input(int body, const IoField& field) const {
  return std::any_of(feeds_.begin(), feeds_.end(),
                     [&](const auto& entry) { return entry.second->read && feeds(*entry.second, body, field); });
}

bool RecordedInputs::has(int body, const IoField& field) const {
  if (field.quantity == Quantity::wrench) return true;  // always zero: nothing to record
  return std::any_of(feeds_.begin(), feeds_.end(),
                     [&](const auto& entry) { return feeds(*entry.second, body, field); });
}

bool RecordedInputs::has_device(int body, int device) const {
  return std::any_of(feeds_.begin(), feeds_.end(), [&](const auto& entry) {
    const Feed& feed = *entry.second;
    return feed.body == body && feed.device == device;
  });
}

bool RecordedInputs::has_contacts(int body, int link) const {
  return std::any_of(feeds_.begin(), feeds_.end(), [&](const auto& entry) {
    const Feed& feed = *entry.second;
    return feed.kind == ChannelKind::contacts && feed.body == body && feed.link == link;
  });
}

bool RecordedInputs::has_joystick() const {
  return std::any_of(feeds_.begin(), feeds_.end(),
                     [](const auto& entry) { return entry.second->kind == ChannelKind::joystick; });
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
  BodyObservation& body = observation_.bodies[feed.body];
  CdrReader reader(message.data);
  bool fits = true;
  switch (feed.kind) {
    case ChannelKind::joints: fits = accept_joints(feed, message.data); break;
    case ChannelKind::joint_accelerations: fits = accept_accelerations(feed, message.data); break;
    case ChannelKind::pose: {
      msg::PoseStamped pose;
      fits = msg::decode(reader, pose);
      const auto& [position, orientation] = pose.pose;
      body.links[feed.link].position = vector(position);
      body.links[feed.link].rotation = {orientation.w, orientation.x, orientation.y, orientation.z};
      break;
    }
    case ChannelKind::twist: {
      msg::TwistStamped twist;
      fits = msg::decode(reader, twist);
      body.links[feed.link].velocity = vector(twist.twist.linear);
      body.links[feed.link].angular_velocity = vector(twist.twist.angular);
      break;
    }
    case ChannelKind::acceleration: {
      msg::AccelStamped acceleration;
      fits = msg::decode(reader, acceleration);
      body.links[feed.link].acceleration = vector(acceleration.accel.linear);
      body.links[feed.link].angular_acceleration = vector(acceleration.accel.angular);
      break;
    }
    case ChannelKind::contacts: {
      msg::Contacts contacts;
      fits = msg::decode(reader, contacts);
      body.contacts[feed.link].clear();
      for (const msg::Contact& contact : contacts.contacts)
        body.contacts[feed.link].push_back({vector(contact.position), vector(contact.normal), vector(contact.force),
                                            vector(contact.velocity), contact.depth});
      break;
    }
    default: break;  // add() keeps no other kinds
  }
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

bool RecordedInputs::accept_accelerations(const Feed& feed, mcap::Bytes payload) {
  CdrReader reader(payload);
  msg::JointAccelerations message;
  if (!msg::decode(reader, message) || message.acceleration.size() != message.name.size()) return false;
  const Model& model = *scenario_.bodies[feed.body].model;
  for (std::size_t i = 0; i < message.name.size(); ++i) {
    const int link = model.find_joint(message.name[i]);
    if (link >= 0 && model.links[link].joint.id >= 0)
      observation_.bodies[feed.body].joints[model.links[link].joint.id].ddq = message.acceleration[i];
  }
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
  std::copy(joy.axes.begin(), joy.axes.end(), reading.axes.begin());
  std::transform(joy.buttons.begin(), joy.buttons.end(), reading.buttons.begin(),
                 [](std::int32_t button) { return button != 0; });
  return {};
}

Result<void> RecordedInputs::accept_device(const Feed& feed, const mcap::Message& message) {
  const Device& device = scenario_.bodies[feed.body].model->devices[feed.device];
  DeviceReading& reading = observation_.bodies[feed.body].devices[feed.device];
  reading.fresh = true;
  return read_device(device, feed.kind, message, scenario_.time_step, reading);
}

}  // namespace rehearse
