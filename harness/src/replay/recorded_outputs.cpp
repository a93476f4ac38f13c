#include "recorded_outputs.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>

#include "trace/message_numbers.h"

namespace rehearse {
namespace {

template <class Message>
bool read_numbers(CdrReader& reader, std::vector<double>& values) {
  Message message;
  if (!msg::decode(reader, message)) return false;
  const auto numbers = numbers_of(message);
  values.assign(numbers.begin(), numbers.end());
  return true;
}

/// The numbers of a link's or device's message, in the order of its elements.
bool read_values(ChannelKind kind, mcap::Bytes payload, std::vector<double>& values) {
  CdrReader reader(payload);
  switch (kind) {
    case ChannelKind::pose: return read_numbers<msg::PoseStamped>(reader, values);
    case ChannelKind::twist: return read_numbers<msg::TwistStamped>(reader, values);
    case ChannelKind::acceleration: return read_numbers<msg::AccelStamped>(reader, values);
    case ChannelKind::wrench: return read_numbers<msg::WrenchStamped>(reader, values);
    default: break;
  }
  msg::DeviceState state;
  if (!msg::decode(reader, state)) return false;
  values = std::move(state.values);
  return true;
}

}  // namespace

RecordedOutputs::RecordedOutputs(const HostedController& hosted, const Scenario& scenario, const mcap::Reader& trace)
    : hosted_(hosted), model_(*scenario.bodies[hosted.body].model) {
  for (const auto& [id, channel] : trace.channels()) {
    const ChannelName name = ChannelName::parse(channel.topic);
    if (!name.is_of(hosted.label, ChannelSide::output)) continue;
    Channel& added = by_id_[id];
    added.topic = channel.topic;
    added.metadata = channel.metadata;
    added.kind = name.kind;
    if (name.kind == ChannelKind::device_state) added.device = model_.find_device(name.owner);
    if (name.is_of_link()) pair_link(added, model_.find_link(name.owner));
    channels_.push_back(id);
  }
}

int RecordedOutputs::place_of(int link, Quantity quantity) const {
  for (const IoField& field : hosted_.io->outputs().fields)
    if (field.link == link && field.quantity == quantity) return field.offset;
  return -1;
}

void RecordedOutputs::pair_link(Channel& channel, int link) {
  const std::vector<ChannelElement>& elements = elements_of(channel.kind);
  channel.values.assign(elements.size(), 0.0);
  int place = -1;
  for (const IoField& field : hosted_.io->outputs().fields)
    if (field.link == link && field.quantity > Quantity::u && channel_kind_of(field.quantity) == channel.kind)
      place = field.offset;
  for (std::size_t i = 0; i < elements.size(); ++i)
    channel.pairs.push_back({&channel.values[i], place < 0 ? -1 : place + static_cast<int>(i), elements[i].name});
}

void RecordedOutputs::pair_joints(Channel& channel) {
  new_pairs_ = true;
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

/// Finds the fields that no message of this tick contains, if other channels have messages than in the last tick.
void RecordedOutputs::find_unpaired() {
  const auto is_known = [](const auto& entry) { return entry.second.here == entry.second.was_here; };
  if (!new_pairs_ && std::all_of(by_id_.begin(), by_id_.end(), is_known)) return;
  new_pairs_ = false;
  std::vector<bool> recorded(hosted_.io->output_values().size(), false);
  for (auto& [id, channel] : by_id_) {
    channel.was_here = channel.here;
    for (const Pair& pair : channel.pairs)
      if (channel.here && pair.place >= 0) recorded[pair.place] = true;
  }
  unpaired_.clear();
  for (const IoField& field : hosted_.io->outputs().fields)
    if (field.quantity != Quantity::ddq && !recorded[field.offset]) unpaired_.push_back(field.link);
}

void RecordedOutputs::begin_tick() {
  for (auto& [id, channel] : by_id_) channel.here = false;
}

Result<void> RecordedOutputs::accept(const mcap::Message& message) {
  Channel& channel = by_id_.at(message.channel->id);
  channel.here = true;
  bool fits = true;
  if (channel.kind == ChannelKind::joints) {
    fits = channel.joints.read(message.data);
    if (fits && channel.joints.layout_changed()) pair_joints(channel);
  } else if (channel.kind != ChannelKind::joint_accelerations) {
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

std::int64_t RecordedOutputs::compare(const OnDifference& differs) {
  std::int64_t compared = 0;
  const std::vector<double>& now = hosted_.io->output_values();
  find_unpaired();
  for (const auto& [id, channel] : by_id_) {
    if (channel.device >= 0) {
      compared += compare_device(channel, differs);
      continue;
    }
    if (!channel.here) continue;
    for (const Pair& pair : channel.pairs) {
      ++compared;
      if (pair.place >= 0 && hosted_.running && identical(*pair.expected, now[pair.place])) continue;
      Divergence found = divergence(channel.topic, pair.element);
      const bool is_commanded = pair.place >= 0 && hosted_.running;
      put_numbers(found, *pair.expected, is_commanded ? now[pair.place] : std::nan(""),
                  unit_of(channel.metadata, pair.element));
      if (!is_commanded) found.note = "the controller no longer commands it";
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
  for (const int link : unpaired_) {
    Divergence found = divergence("/" + hosted_.label + "/output", model_.links[link].name);
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
    const double expected = i < channel.values.size() ? channel.values[i] : std::nan("");
    const double actual = i < now->values.size() ? now->values[i] : std::nan("");
    if (identical(expected, actual)) continue;
    Divergence found = divergence(channel.topic, "values/" + std::to_string(i));
    put_numbers(found, expected, actual);
    differs(std::move(found));
  }
  return static_cast<std::int64_t>(count);
}

}  // namespace rehearse
