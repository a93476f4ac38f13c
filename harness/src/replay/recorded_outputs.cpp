#include "recorded_outputs.h"

#include "recording/topic_segment.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>

namespace rehearse {
namespace {

struct LinkKind {
  const char* name;  // last segment of the topic
  Quantity quantity;
  std::vector<const char*> elements;
};

const std::vector<LinkKind>& link_kinds() {
  static const std::vector<LinkKind> kinds{
      {"pose",
       Quantity::pose,
       {"position/x", "position/y", "position/z", "orientation/x", "orientation/y", "orientation/z", "orientation/w"}},
      {"twist", Quantity::twist, {"linear/x", "linear/y", "linear/z", "angular/x", "angular/y", "angular/z"}},
      {"accel",
       Quantity::acceleration,
       {"linear_acceleration/x", "linear_acceleration/y", "linear_acceleration/z", "angular_acceleration/x",
        "angular_acceleration/y", "angular_acceleration/z"}},
      {"wrench", Quantity::wrench, {"force/x", "force/y", "force/z", "torque/x", "torque/y", "torque/z"}},
  };
  return kinds;
}

const LinkKind* find_kind(const std::string& name) {
  for (const LinkKind& kind : link_kinds())
    if (kind.name == name) return &kind;
  return nullptr;
}

std::string unit_of(const mcap::StringMap& metadata, const std::string& element) {
  const auto exact = metadata.find("unit:" + element);
  if (exact != metadata.end()) return exact->second;
  const auto group = metadata.find("unit:" + element.substr(0, element.find('/')));
  return group == metadata.end() ? "" : group->second;
}

void put(std::vector<double>& values, const msg::Vector3& v) { values.insert(values.end(), {v.x, v.y, v.z}); }

/// The numbers of a link's or device's message, in the order of LinkKind::elements.
bool read_values(const std::string& kind, mcap::Bytes payload, std::vector<double>& values) {
  CdrReader reader(payload);
  values.clear();
  if (kind == "pose") {
    msg::PoseStamped pose;
    if (!msg::decode(reader, pose)) return false;
    const auto& [p, q] = pose.pose;
    values = {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
  } else if (kind == "twist") {
    msg::TwistStamped twist;
    if (!msg::decode(reader, twist)) return false;
    put(values, twist.twist.linear);
    put(values, twist.twist.angular);
  } else if (kind == "accel") {
    msg::AccelStamped acceleration;
    if (!msg::decode(reader, acceleration)) return false;
    put(values, acceleration.accel.linear);
    put(values, acceleration.accel.angular);
  } else if (kind == "wrench") {
    msg::WrenchStamped wrench;
    if (!msg::decode(reader, wrench)) return false;
    put(values, wrench.wrench.force);
    put(values, wrench.wrench.torque);
  } else {
    msg::DeviceState state;
    if (!msg::decode(reader, state)) return false;
    values = state.values;
  }
  return true;
}

}  // namespace

RecordedOutputs::RecordedOutputs(const HostedController& hosted, const Scenario& scenario, const mcap::Reader& trace)
    : hosted_(hosted), model_(*scenario.bodies[hosted.body].model) {
  const std::string prefix = "/" + hosted.label + "/output/";
  for (const auto& [id, channel] : trace.channels()) {
    if (!channel.topic.starts_with(prefix)) continue;
    const std::string rest = channel.topic.substr(prefix.size());
    const std::size_t slash = rest.find('/');
    const std::string owner = slash == std::string::npos ? "" : name_of_segment(rest.substr(0, slash));
    Channel& added = by_id_[id];
    added.topic = channel.topic;
    added.metadata = channel.metadata;
    added.kind = slash == std::string::npos ? rest : rest.substr(slash + 1);
    if (added.kind == "state") added.device = model_.find_device(owner);
    if (find_kind(added.kind)) {
      added.link = model_.find_link(owner);
      pair_link(added);
    }
    channels_.push_back(id);
  }
}

int RecordedOutputs::place_of(int link, Quantity quantity) const {
  for (const IoField& field : hosted_.io->outputs().fields)
    if (field.link == link && field.quantity == quantity) return field.offset;
  return -1;
}

void RecordedOutputs::pair_link(Channel& channel) {
  const LinkKind& kind = *find_kind(channel.kind);
  channel.values.assign(kind.elements.size(), 0.0);
  const int place = place_of(channel.link, kind.quantity);
  for (std::size_t i = 0; i < kind.elements.size(); ++i)
    channel.pairs.push_back({&channel.values[i], place < 0 ? -1 : place + static_cast<int>(i), kind.elements[i]});
}

void RecordedOutputs::pair_joints(Channel& channel) {
  channel.pairs.clear();
  const std::tuple<const std::vector<double>*, Quantity, const char*> arrays[] = {
      {&channel.joints.position(), Quantity::q, "/q"},
      {&channel.joints.velocity(), Quantity::dq, "/dq"},
      {&channel.joints.effort(), Quantity::u, "/u"}};
  for (std::size_t i = 0; i < channel.joints.names().size(); ++i) {
    const std::string& name = channel.joints.names()[i];
    for (const auto& [array, quantity, suffix] : arrays) {
      if (array->empty()) continue;
      const int place = place_of(model_.find_joint(name), quantity);
      // NaN for what isn't commanded now either: it was not enabled for this joint
      if (place < 0 && std::isnan((*array)[i])) continue;
      channel.pairs.push_back({&(*array)[i], place, name + suffix});
    }
  }
}

void RecordedOutputs::begin_tick() {
  for (auto& [id, channel] : by_id_) channel.here = false;
}

Result<void> RecordedOutputs::accept(const mcap::Message& message) {
  Channel& channel = by_id_.at(message.channel->id);
  channel.here = true;
  bool fits = true;
  if (channel.kind == "joints") {
    fits = channel.joints.read(message.data);
    if (fits && channel.joints.names_changed()) pair_joints(channel);
  } else if (channel.kind != "joint_accelerations") {
    const std::size_t count = channel.values.size();
    fits = read_values(channel.kind, message.data, channel.values);
    if (channel.device < 0) fits = fits && channel.values.size() == count;  // pairs point into it
  }
  if (fits) return {};
  return error(fmt::format("a message on {} at {} ns is not of its type", channel.topic, message.log_time));
}

Divergence RecordedOutputs::divergence(const std::string& topic, const std::string& element) const {
  Divergence divergence;
  divergence.channel = topic;
  divergence.element = element;
  divergence.stage = Stage::controller;
  return divergence;
}

std::int64_t RecordedOutputs::compare(const OnDifference& differs) const {
  std::int64_t compared = 0;
  const std::vector<double>& now = hosted_.io->output_values();
  std::vector<bool> recorded(now.size(), false);
  for (const auto& [id, channel] : by_id_) {
    if (channel.device >= 0) {
      compared += compare_device(channel, differs);
      continue;
    }
    if (!channel.here) continue;
    for (const Pair& pair : channel.pairs) {
      ++compared;
      if (pair.place >= 0) recorded[pair.place] = true;
      if (pair.place >= 0 && hosted_.running && identical(*pair.expected, now[pair.place])) continue;
      Divergence found = divergence(channel.topic, pair.element);
      found.unit = unit_of(channel.metadata, pair.element);
      found.expected = *pair.expected;
      if (pair.place < 0 || !hosted_.running) {
        found.actual = std::nan("");
        found.note = "the controller no longer commands it";
      } else {
        found.actual = now[pair.place];
      }
      found.difference = std::abs(found.actual - found.expected);
      found.ulps = ulps_between(found.actual, found.expected);
      differs(std::move(found));
    }
  }
  if (!hosted_.running) return compared;
  for (const DeviceOutput& output : hosted_.tick.device_outputs) {
    const auto of_device = [&output](const auto& entry) { return entry.second.device == output.device; };
    if (std::any_of(by_id_.begin(), by_id_.end(), of_device)) continue;
    Divergence found = divergence("/" + hosted_.label + "/output", model_.devices[output.device].name);
    found.note = "the device is commanded now, and never was in the recording";
    differs(std::move(found));
  }
  for (const IoField& field : hosted_.io->outputs().fields) {
    if (field.quantity == Quantity::ddq || recorded[field.offset]) continue;
    Divergence found = divergence("/" + hosted_.label + "/output", model_.links[field.link].name);
    found.note = "the controller commands it now, and did not in the recording";
    differs(std::move(found));
  }
  return compared;
}

void RecordedOutputs::compare_delay(bool delayed, const OnDifference& differs) const {
  for (const auto& [id, channel] : by_id_) {
    const auto stated = channel.metadata.find("delay");
    if (stated == channel.metadata.end() || (stated->second == "true") == delayed) continue;
    Divergence found = divergence(channel.topic, "");
    found.note = delayed ? "its commands act one tick later than the recorded ones: it has left the no-delay mode"
                         : "its commands act one tick earlier than the recorded ones: it has entered the no-delay mode";
    return differs(std::move(found));
  }
}

std::int64_t RecordedOutputs::compare_device(const Channel& channel, const OnDifference& differs) const {
  const DeviceOutput* now = nullptr;
  for (const DeviceOutput& output : hosted_.tick.device_outputs)
    if (output.device == channel.device) now = &output;
  if (!channel.here && !now) return 0;
  if (channel.here != (now != nullptr)) {
    Divergence found = divergence(channel.topic, "");
    found.note =
        now ? "the device is commanded now, and was not in the recording" : "the device is no longer commanded";
    differs(std::move(found));
    return 1;
  }
  const std::size_t count = std::max(channel.values.size(), now->values.size());
  for (std::size_t i = 0; i < count; ++i) {
    Divergence found = divergence(channel.topic, "values/" + std::to_string(i));
    found.expected = i < channel.values.size() ? channel.values[i] : std::nan("");
    found.actual = i < now->values.size() ? now->values[i] : std::nan("");
    if (identical(found.expected, found.actual)) continue;
    found.difference = std::abs(found.actual - found.expected);
    found.ulps = ulps_between(found.actual, found.expected);
    differs(std::move(found));
  }
  return static_cast<std::int64_t>(count);
}

}  // namespace rehearse
