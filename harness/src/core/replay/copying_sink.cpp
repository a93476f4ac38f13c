#include "copying_sink.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>

#include "base/clock.h"
#include "core/kinds/channel_name.h"

namespace rehearse {

CopyingSink::CopyingSink(const Scenario& scenario, mcap::Reader& source, const ControllerHost& host, Recorder& recorder,
                         const AlteredInputs& altered, Diagnostics* remarks)
    : RecordingSink(recorder, remarks), scenario_(scenario), source_(source), host_(host), altered_(altered) {
  const std::size_t ids = source.channels().empty() ? 0 : std::size_t{source.channels().rbegin()->first} + 1;
  is_copied_.assign(ids, false);
  parts_.assign(ids, Part::state);
  for (const auto& [id, channel] : source.channels()) {
    parts_[id] = part_of(channel);
    is_copied_[id] = parts_[id] == Part::state && source.schema_of(channel) && !is_altered(channel.topic);
  }
}

CopyingSink::Part CopyingSink::part_of(const mcap::Channel& channel) const {
  const ChannelName name = ChannelName::parse(channel.topic);
  if (name.kind == ChannelKind::tick) return Part::tick;
  if (name.kind == ChannelKind::events) return Part::events;
  if (name.kind == ChannelKind::cost) return Part::controller;
  const bool is_hosted = std::ranges::any_of(
      host_.controllers(), [&](const HostedController& hosted) { return hosted.label == name.label(); });
  return is_hosted ? Part::controller : Part::state;
}

/// True if the channel records a reading that is altered here.
bool CopyingSink::is_altered(const std::string& topic) const {
  const ChannelName name = ChannelName::parse(topic);
  if (name.kind == ChannelKind::joystick) return altered_.alters_joystick();
  if (name.side != ChannelSide::none) return false;
  for (std::size_t b = 0; b < scenario_.bodies.size(); ++b) {
    const ScenarioBody& body = scenario_.bodies[b];
    const int index = static_cast<int>(b);
    if (body.name != name.body) continue;
    if (name.kind == ChannelKind::measured_joints) return altered_.alters_joints(index);
    const int device = name.owner.empty() ? -1 : body.model->find_device(name.owner);
    if (device >= 0) return altered_.alters_device(index, device);
  }
  return false;
}

void CopyingSink::keep_acted(std::optional<std::int64_t> until, std::optional<std::int64_t> source_until) {
  acted_until_ = until;
  source_acted_until_ = source_until;
}

Result<void> CopyingSink::copy(RecordingSource& from, Run& run, std::optional<std::int64_t> end) {
  from_ = &from;
  const auto copied = from.drive(
      run, [this](const mcap::Message& message) { return take(message); }, {},
      end ? nanoseconds_of(*end, scenario_.time_step) : RecordingSource::no_end);
  if (!copied) return copied;
  if (run.interruption()) return *run.interruption();
  if (!end || run.tick() >= *end || host_.failure()) return {};
  if (!from.damage().empty()) return from.damage();
  return in_recording(source_, error(fmt::format("it has {} ticks, but tick {} is requested", run.tick(), *end)));
}

/// Takes a message of the source before its tick is emitted.
Result<void> CopyingSink::take(const mcap::Message& message) {
  const std::uint16_t id = message.channel->id;
  const mcap::Schema* schema = source_.schema_of(*message.channel);
  if (is_copied_[id]) return recorder_.copy(message, *schema, message.channel->topic);
  if (parts_[id] == Part::controller) return take_output(message, *schema);
  if (parts_[id] != Part::events) return {};
  CdrReader reader(message.data);
  msg::Event event;
  if (!msg::decode(reader, event))
    return error(fmt::format("a message on /events at {} ns is not of its type", message.log_time));
  return is_of_observations(event) ? recorder_.copy(message, *schema, message.channel->topic) : Result<void>();
}

Result<void> CopyingSink::take_output(const mcap::Message& message, const mcap::Schema& schema) {
  const std::int64_t tick = std::llround(static_cast<double>(message.log_time) * 1e-9 / scenario_.time_step);
  if (!acted_until_ || tick >= *acted_until_) return {};
  const bool acted_there = source_acted_until_ && tick < *source_acted_until_;
  ChannelName name = ChannelName::parse(message.channel->topic);
  if (name.side != (acted_there ? ChannelSide::acted : ChannelSide::output)) return {};
  name.side = ChannelSide::acted;
  return recorder_.copy(message, schema, name.topic());
}

Result<void> CopyingSink::emit(const TickData& now) {
  same_outputs_ = same_outputs_ && now.host->output_hash() == from_->recorded().output_hash;
  if (!altered_.empty()) REHEARSE_TRY(record_altered(now));
  return RecordingSink::emit(now);
}

Result<void> CopyingSink::record_altered(const TickData& now) {
  for (std::size_t b = 0; b < now.seen->bodies.size(); ++b) {
    const BodyObservation& seen = now.seen->bodies[b];
    const int body = static_cast<int>(b);
    if (altered_.alters_joints(body)) REHEARSE_TRY(recorder_.record_measured_joints(now.tick, body, seen.joints));
    for (std::size_t d = 0; d < seen.devices.size(); ++d) {
      const int device = static_cast<int>(d);
      if (!seen.devices[d].fresh || !altered_.alters_device(body, device)) continue;
      REHEARSE_TRY(recorder_.record_reading(now.tick, body, device, seen.devices[d]));
    }
  }
  if (!altered_.alters_joystick()) return {};
  return recorder_.record_joystick(now.tick, *now.seen->joystick);
}

}  // namespace rehearse
