#include "recorded_words.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>

#include <algorithm>
#include <utility>

#include "core/kinds/channel_name.h"
#include "core/kinds/cost_fields.h"

namespace rehearse {
namespace {

/// Adds an event of the host or its controllers; ignores events of the world and of a log, and that costs aren't
/// counted.
void add_event(RunningHash& events, const msg::Event& event) {
  if (msg::is_of_observations(event) || event.source == uncounted_costs_source) return;
  CdrWriter cdr;
  msg::encode(event, cdr);
  events.add(cdr.bytes().data(), cdr.bytes().size());
}

}  // namespace

RecordedWords::RecordedWords(const ControllerHost& host, const mcap::Reader& trace) : host_(host) {
  for (const auto& [id, channel] : trace.channels()) {
    const mcap::Schema* schema = trace.schema_of(channel);
    if (!schema) continue;
    const ChannelKind kind = ChannelName::parse(channel.topic).kind;
    if (kind == ChannelKind::events && schema->name == msg::Event::type_name)
      events_channel_ = id;
    else if (kind == ChannelKind::variable && schema->name == msg::Float64::type_name)
      variables_[id].topic = channel.topic;
    else
      continue;
    channels_.push_back(id);
  }
}

bool RecordedWords::is_line(const msg::Event& event) const {
  return event.severity == to_string(Severity::note) &&
         std::ranges::any_of(host_.controllers(),
                             [&](const HostedController& hosted) { return hosted.label == event.source; });
}

Result<void> RecordedWords::accept(const mcap::Message& message) {
  CdrReader reader(message.data);
  bool fits = true;
  if (message.channel->id == events_channel_) {
    msg::Event event;
    fits = msg::decode(reader, event);
    if (fits) add_event(recorded_events_, event);
    if (fits && is_line(event)) coming_.push_back(event.source + ": " + event.text);
  } else {
    msg::Float64 number;
    fits = msg::decode(reader, number);
    variables_.at(message.channel->id).value = number.data;
  }
  if (fits) return {};
  return error(fmt::format("a message on {} at {} ns is not of its type", message.channel->topic, message.log_time));
}

void RecordedWords::say(const std::vector<msg::Event>& events) {
  for (const msg::Event& event : events) {
    add_event(said_events_, event);
    if (is_line(event)) said_.push_back(event.source + ": " + event.text);
  }
}

void RecordedWords::begin_tick(const OnDifference& differs) {
  if (std::exchange(begun_, true)) end(differs);  // lines before the first tick belong to the first tick
  recorded_ = std::exchange(coming_, {});
  for (auto& [id, variable] : variables_) variable.this_tick = std::exchange(variable.value, std::nullopt);
}

void RecordedWords::end(const OnDifference& differs) {
  const Lines recorded = std::exchange(recorded_, {}), said = std::exchange(said_, {});
  lines_ += static_cast<std::int64_t>(std::max(recorded.size(), said.size()));
  const auto [then, now] = std::mismatch(recorded.begin(), recorded.end(), said.begin(), said.end());
  if (then == recorded.end() && now == said.end()) return;
  Divergence found;
  found.channel = run_topics::events;
  found.stage = Stage::controller;
  found.note = now == said.end()        ? fmt::format("this line is missing: \"{}\"", *then)
               : then == recorded.end() ? fmt::format("this line is extra: \"{}\"", *now)
                                        : fmt::format("the line is \"{}\", recorded \"{}\"", *now, *then);
  differs(std::move(found));
}

std::int64_t RecordedWords::compare_variables(const OnVariable& compare) const {
  std::map<std::string, std::pair<std::optional<double>, std::optional<double>>> pairs;  // recorded, now; by topic
  for (const auto& [id, variable] : variables_)
    if (variable.this_tick) pairs[variable.topic].first = variable.this_tick;
  for (const HostedController& hosted : host_.controllers())
    for (const ControllerVariables::Variable& variable : hosted.variables.all())
      if (variable.is_set) pairs[ChannelName::of_variable(hosted.label, variable.name).topic()].second = variable.value;
  for (const auto& [topic, values] : pairs) compare(topic, values.first, values.second);
  return static_cast<std::int64_t>(pairs.size());
}

}  // namespace rehearse
