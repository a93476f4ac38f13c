#include "recorded_outputs.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "output_record.h"
#include "trace/message_numbers.h"

namespace rehearse {
namespace {

constexpr double not_recorded = std::numeric_limits<double>::quiet_NaN();

template <class Message>
bool read_numbers(CdrReader& reader, std::vector<double>& values) {
  Message message;
  if (!msg::decode(reader, message)) return false;
  const auto numbers = numbers_of(message);
  values.assign(numbers.begin(), numbers.end());
  return true;
}

/// Reads the numbers of a message; `names` gets the joints of a message of accelerations.
bool read_values(ChannelKind kind, mcap::Bytes payload, std::vector<double>& values, std::vector<std::string>& names) {
  CdrReader reader(payload);
  switch (kind) {
    case ChannelKind::pose: return read_numbers<msg::PoseStamped>(reader, values);
    case ChannelKind::twist: return read_numbers<msg::TwistStamped>(reader, values);
    case ChannelKind::acceleration: return read_numbers<msg::AccelStamped>(reader, values);
    case ChannelKind::wrench: return read_numbers<msg::WrenchStamped>(reader, values);
    case ChannelKind::joint_accelerations: {
      msg::JointAccelerations message;
      if (!msg::decode(reader, message) || message.name.size() != message.acceleration.size()) return false;
      names = std::move(message.name);
      values.assign(message.acceleration.begin(), message.acceleration.end());
      return true;
    }
    default: break;
  }
  msg::DeviceState state;
  if (!msg::decode(reader, state)) return false;
  values.assign(state.values.begin(), state.values.end());
  return true;
}

}  // namespace

RecordedOutputs::RecordedOutputs(const ControllerHost& host, const std::vector<OutputField>& fields,
                                 const mcap::Reader& trace)
    : host_(host), fields_(fields) {
  for (std::size_t word = 0; word < fields.size(); ++word)
    words_.emplace(std::pair(fields[word].channel, fields[word].element), word);
  for (const auto& [id, channel] : trace.channels()) {
    const ChannelName name = ChannelName::parse(channel.topic);
    for (const HostedController& hosted : host.controllers())
      if (name.is_of(hosted.label, ChannelSide::output) && name.kind != ChannelKind::delay) add_channel(channel, name, hosted);
  }
  sort_words();
}

void RecordedOutputs::add_channel(const mcap::Channel& channel, const ChannelName& name,
                                  const HostedController& hosted) {
  Channel& added = by_id_[channel.id];
  added.topic = channel.topic;
  added.metadata = channel.metadata;
  added.kind = name.kind;
  added.hosted = &hosted;
  added.told = word_of(channel.topic, "told");
  channels_.push_back(channel.id);
}

/// Finds the words that are compared although the recording lacks them.
void RecordedOutputs::sort_words() {
  for (const HostedController& hosted : host_.controllers()) {
    for (std::size_t word = 0; word < fields_.size(); ++word) {
      const OutputField& field = fields_[word];
      if (field.controller != hosted.label) continue;
      if (field.channel == run_topics::tick) {
        if (field.element.starts_with("controller_results/")) result_words_.push_back(word);
        continue;
      }
      const bool of_device = word_of(field.channel, "told") != none;
      const auto is_recorded = [&](const auto& entry) { return entry.second.topic == field.channel; };
      if (!of_device)
        commands_.push_back({word, &hosted});
      else if (field.kind == CellKind::boolean && std::ranges::none_of(by_id_, is_recorded))
        untold_.push_back({word, &hosted});
    }
  }
}

std::size_t RecordedOutputs::word_of(const std::string& channel, const std::string& element) const {
  const auto found = words_.find(std::pair(channel, element));
  return found == words_.end() ? none : found->second;
}

/// With `may_lack_field`, a NaN needs no field: then the recorded controller didn't command it either.
void RecordedOutputs::add_pair(Channel& channel, const double& expected, std::string element, bool may_lack_field) {
  const std::size_t word = word_of(channel.topic, element);
  if (word == none && may_lack_field && std::isnan(expected)) return;
  channel.pairs.push_back({&expected, word, std::move(element)});
}

void RecordedOutputs::pair_joints(Channel& channel) {
  new_pairs_ = true;
  channel.pairs.clear();
  const std::pair<const std::vector<double>&, const char*> arrays[] = {
      {channel.joints.position(), "/q"}, {channel.joints.velocity(), "/dq"}, {channel.joints.effort(), "/u"}};
  for (std::size_t i = 0; i < channel.joints.names().size(); ++i)
    for (const auto& [array, suffix] : arrays)
      if (!array.empty()) add_pair(channel, array[i], channel.joints.names()[i] + suffix, true);
}

void RecordedOutputs::pair_values(Channel& channel) {
  new_pairs_ = true;
  channel.pairs.clear();
  const bool of_joints = channel.kind == ChannelKind::joint_accelerations;
  const std::vector<ChannelElement>& elements = elements_of(channel.kind);
  const auto element = [&](std::size_t i) {
    if (of_joints) return channel.names[i] + "/ddq";
    return channel.kind == ChannelKind::device_state ? fmt::format("values/{}", i) : elements[i].name;
  };
  for (std::size_t i = 0; i < channel.values.size(); ++i) add_pair(channel, channel.values[i], element(i), of_joints);
  if (channel.kind != ChannelKind::device_state) return;
  for (std::size_t i = channel.values.size(); word_of(channel.topic, element(i)) != none; ++i)
    add_pair(channel, not_recorded, element(i), false);
}

/// Finds the fields that no message of this tick contains, if other channels have messages than in the last tick.
void RecordedOutputs::find_unpaired() {
  const auto is_known = [](const auto& entry) { return entry.second.here == entry.second.was_here; };
  if (!new_pairs_ && std::ranges::all_of(by_id_, is_known)) return;
  new_pairs_ = false;
  std::vector<bool> recorded(fields_.size(), false);
  for (auto& [id, channel] : by_id_) {
    channel.was_here = channel.here;
    for (const Pair& pair : channel.pairs)
      if (channel.here && pair.word != none) recorded[pair.word] = true;
  }
  unpaired_.clear();
  std::ranges::copy_if(commands_, std::back_inserter(unpaired_), [&](const Word& at) { return !recorded[at.word]; });
}

void RecordedOutputs::begin_tick() {
  for (auto& [id, channel] : by_id_) channel.here = false;
}

bool RecordedOutputs::read(Channel& channel, mcap::Bytes payload) {
  if (channel.kind == ChannelKind::joints) {
    if (!channel.joints.read(payload)) return false;
    if (channel.joints.layout_changed()) pair_joints(channel);
    return true;
  }
  const std::size_t count = channel.values.size();
  const std::vector<std::string> names = channel.names;
  if (!read_values(channel.kind, payload, channel.values, channel.names)) return false;
  if (channel.values.size() != count || channel.names != names || channel.pairs.empty()) pair_values(channel);
  return true;
}

Result<void> RecordedOutputs::accept(const mcap::Message& message) {
  Channel& channel = by_id_.at(message.channel->id);
  channel.here = true;
  if (read(channel, message.data)) return {};
  return error(fmt::format("a message on {} at {} ns is not of its type", channel.topic, message.log_time));
}

std::int64_t RecordedOutputs::compare(const std::vector<std::uint64_t>& row, const std::vector<bool>& results,
                                      const OnDifference& differs) {
  std::int64_t compared = 0;
  find_unpaired();
  for (const auto& [id, channel] : by_id_) compared += compare_channel(channel, row, differs);
  for (const Word& at : untold_)
    if (auto found = difference(fields_[at.word], 0, row[at.word]); found && at.hosted->running)
      differs(*std::move(found));
  for (const Word& at : unpaired_) {
    if (!at.hosted->running) continue;
    Divergence found = place_of(fields_[at.word]);
    found.note = "the controller commands it now, but didn't in the recording";
    differs(std::move(found));
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::size_t word = result_words_[i];
    if (auto found = difference(fields_[word], results[i] ? 1 : 0, row[word])) differs(*std::move(found));
  }
  return compared + std::ssize(results);
}

/// The difference for a recorded number that no controller commands now.
Divergence RecordedOutputs::lone(const Channel& channel, const Pair& pair) const {
  Divergence found = place_of({channel.hosted->label, channel.topic, pair.element});
  put_numbers(found, *pair.expected, not_recorded, unit_of(channel.metadata, pair.element));
  found.note = "the controller no longer commands it";
  return found;
}

std::int64_t RecordedOutputs::compare_channel(const Channel& channel, const std::vector<std::uint64_t>& row,
                                              const OnDifference& differs) const {
  if (channel.told != none) {
    auto found = difference(fields_[channel.told], channel.here ? 1 : 0, row[channel.told]);
    if (found) differs(*std::move(found));
    if (found) return 1;
  }
  if (!channel.here) return 0;
  for (const Pair& pair : channel.pairs) {
    const auto expected = std::bit_cast<std::uint64_t>(*pair.expected);
    if (pair.word == none || !channel.hosted->running)
      differs(lone(channel, pair));
    else if (expected != row[pair.word])
      differs(*difference(fields_[pair.word], expected, row[pair.word]));
  }
  return std::ssize(channel.pairs);
}

}  // namespace rehearse
