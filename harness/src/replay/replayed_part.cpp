#include "replayed_part.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/clock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "branch_origin.h"
#include "recording/topic_segment.h"

namespace rehearse {

ReplayedPart::ReplayedPart(const Scenario& scenario, mcap::Reader& source, ControllerHost& host, Recorder& recorder,
                           AlteredInputs& altered)
    : scenario_(scenario),
      source_(source),
      host_(host),
      recorder_(recorder),
      altered_(altered),
      inputs_(scenario, source) {
  const std::size_t ids = source.channels().empty() ? 0 : std::size_t{source.channels().rbegin()->first} + 1;
  is_input_.assign(ids, false);
  is_copied_.assign(ids, false);
  parts_.assign(ids, Part::state);
  for (const std::uint16_t id : inputs_.channels_read_by(host)) is_input_[id] = true;
  for (const auto& [id, channel] : source.channels()) {
    parts_[id] = part_of(channel);
    is_copied_[id] = parts_[id] == Part::state && source.schema_of(channel) && !is_altered(channel.topic);
  }
  for (const ScenarioBody& body : scenario.bodies) {
    BodyCommand& command = unheard_.bodies.emplace_back();
    command.joints.resize(body.model->joints.size());
    command.external.resize(body.model->links.size());
    command.devices.resize(body.model->devices.size());
  }
}

ReplayedPart::Part ReplayedPart::part_of(const mcap::Channel& channel) const {
  if (channel.topic == "/tick") return Part::tick;
  if (channel.topic == "/events") return Part::events;
  for (const HostedController& hosted : host_.controllers()) {
    const std::string prefix = "/" + hosted.label + "/";
    if (!channel.topic.starts_with(prefix)) continue;
    const std::string_view rest = std::string_view(channel.topic).substr(prefix.size());
    for (const char* side : {"input/", "output/", "variable/", "acted/"})
      if (rest.starts_with(side)) return Part::controller;
  }
  return Part::state;
}

/// What is recorded of a reading that is another one here.
bool ReplayedPart::is_altered(const std::string& topic) const {
  if (topic == "/joy") return altered_.alters_joystick();
  for (std::size_t b = 0; b < scenario_.bodies.size(); ++b) {
    const ScenarioBody& body = scenario_.bodies[b];
    const int index = static_cast<int>(b);
    if (topic == "/" + body.name + "/measured_joints") return altered_.alters_joints(index);
    for (std::size_t d = 0; d < body.model->devices.size(); ++d)
      if (topic.starts_with("/" + body.name + "/" + topic_segment(body.model->devices[d].name) + "/"))
        return altered_.alters_device(index, static_cast<int>(d));
  }
  return false;
}

void ReplayedPart::keep_acted(std::optional<std::int64_t> until, std::optional<std::int64_t> source_until) {
  acted_until_ = until;
  source_acted_until_ = source_until;
}

Result<void> ReplayedPart::run(std::optional<std::int64_t> end) {
  const std::uint64_t end_time =
      end ? nanoseconds_of(*end, scenario_.time_step) : std::numeric_limits<std::uint64_t>::max();
  Result<void> taken;
  bool going_on = end_time > 0;
  const auto close = [&] {
    const auto closed = close_tick();
    if (!closed) taken = closed.errors();
    return closed && *closed;
  };
  const auto gather = [&](const mcap::Message& message) {
    if (message.log_time != now_ && !(going_on = close())) return false;
    now_ = message.log_time;
    if (now_ >= end_time) return going_on = false;
    taken = take(message);
    return going_on = taken.ok();
  };
  Result<void> read;
  if (going_on) read = source_.for_each_message_in_order(gather);
  if (going_on) close();
  if (!taken) return taken;
  if (end && ticks_ < *end && !host_.failure()) {
    if (!read) return read;
    Diagnostic missing = error(fmt::format("it has {} ticks, and tick {} is wanted", ticks_, *end));
    missing.file = source_.name();
    return missing;
  }
  return {};
}

Result<void> ReplayedPart::take(const mcap::Message& message) {
  const std::uint16_t id = message.channel->id;
  if (is_input_[id])
    if (auto accepted = inputs_.accept(message); !accepted) return accepted;
  const mcap::Schema* schema = source_.schema_of(*message.channel);
  if (is_copied_[id]) return recorder_.copy(message, *schema, message.channel->topic);
  CdrReader reader(message.data);
  switch (parts_[id]) {
    case Part::state: return {};
    case Part::controller:
      return take_output(message, *schema,
                         std::llround(static_cast<double>(message.log_time) * 1e-9 / scenario_.time_step));
    case Part::tick:
      if (!msg::decode(reader, tick_.emplace()))
        return error(fmt::format("a message on /tick at {} ns is not of its type", now_));
      return {};
    case Part::events: {
      msg::Event event;
      if (!msg::decode(reader, event))
        return error(fmt::format("a message on /events at {} ns is not of its type", now_));
      const bool of_the_host = event.source != "world" && event.source != "log";
      return of_the_host ? Result<void>() : recorder_.copy(message, *schema, message.channel->topic);
    }
  }
  return {};
}

Result<void> ReplayedPart::take_output(const mcap::Message& message, const mcap::Schema& schema, std::int64_t tick) {
  if (!acted_until_ || tick >= *acted_until_) return {};
  const std::string& topic = message.channel->topic;
  const bool acted_there = source_acted_until_ && tick < *source_acted_until_;
  if (is_acted_topic(topic)) return acted_there ? recorder_.copy(message, schema, topic) : Result<void>();
  const std::string as_acted = acted_topic(topic);
  return as_acted.empty() || acted_there ? Result<void>() : recorder_.copy(message, schema, as_acted);
}

Result<void> ReplayedPart::record_altered(std::int64_t tick, const Observation& seen) {
  for (std::size_t b = 0; b < seen.bodies.size(); ++b) {
    const int body = static_cast<int>(b);
    if (altered_.alters_joints(body))
      if (auto done = recorder_.record_measured_joints(tick, body, seen.bodies[b].joints); !done) return done;
    for (std::size_t d = 0; d < seen.bodies[b].devices.size(); ++d) {
      const DeviceReading& reading = seen.bodies[b].devices[d];
      if (!reading.fresh || !altered_.alters_device(body, static_cast<int>(d))) continue;
      if (auto done = recorder_.record_reading(tick, body, static_cast<int>(d), reading); !done) return done;
    }
  }
  if (!altered_.alters_joystick()) return {};
  return recorder_.record_joystick(tick, *seen.joystick);
}

/// All messages of a tick are here. False: it was the last.
Result<bool> ReplayedPart::close_tick() {
  if (!tick_) return true;
  const msg::Tick recorded = *std::exchange(tick_, std::nullopt);
  if (recorded.controller_results.size() != host_.controllers().size()) {
    last_state_ = recorded;
    return false;
  }
  const std::int64_t tick = recorded.tick;
  if (tick != ticks_) {
    Diagnostic missing =
        error(fmt::format("tick {} comes where tick {} should be: what is between isn't in it", tick, ticks_));
    missing.file = source_.name();
    return missing;
  }
  const Observation* seen = &inputs_.observation();
  if (!altered_.empty()) {
    altered_seen_ = *seen;
    altered_.apply(tick, altered_seen_);
    if (auto done = record_altered(tick, altered_seen_); !done) return done.errors();
    seen = &altered_seen_;
  }
  const bool alive = host_.control(tick, *seen);
  host_.output(ControllerHost::Timing::same_step, unheard_);  // says what isn't finite
  const TickHashes hashes{recorded.state_hash, host_.input_hash(*seen), host_.output_hash()};
  if (auto done = recorder_.record_tick(tick, &host_, hashes); !done) return done.errors();
  if (auto done = recorder_.record_events(host_.take_events()); !done) return done.errors();
  if (!alive) return false;
  host_.output(ControllerHost::Timing::next_step, unheard_);
  for (BodyCommand& body : unheard_.bodies) std::fill(body.external.begin(), body.external.end(), Wrench{});
  inputs_.begin_tick();
  ++ticks_;
  return true;
}

}  // namespace rehearse
