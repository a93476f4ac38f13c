// Finds ticks, bodies, controllers, devices and channels that only one of two traces has.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "channel_findings.h"
#include "compare_structure.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"
#include "series_rules.h"

namespace rehearse {
namespace {

std::string failure_of(const Trace& trace) {
  const auto outcome = RunFacts::of(trace).outcome;
  return outcome ? outcome->failure.value_or("") : "the recording was cut off";
}

Divergence place_of_tick(const TickClock& clock, std::uint64_t time) {
  Divergence divergence;
  divergence.tick = clock.tick_at(time);
  divergence.time = static_cast<double>(time) / 1e9;
  divergence.channel = run_topics::tick;
  divergence.stage = Stage::inputs;
  return divergence;
}

void compare_lengths(ComparedTraces& traces, ChannelFindings& findings) {
  const std::uint64_t golden_end = traces.clock.last_time(), actual_end = traces.actual_clock.last_time();
  const std::uint64_t asked = std::exchange(traces.end, std::min({golden_end, actual_end, traces.end}));
  if (golden_end == actual_end || asked <= std::min(golden_end, actual_end)) return;
  const bool early = actual_end < golden_end;
  traces.one_goes_on = true;
  const std::string failure = failure_of(early ? traces.actual : traces.golden);
  Divergence divergence = place_of_tick(early ? traces.actual_clock : traces.clock, traces.end);
  divergence.stage = failure.starts_with("controller") ? Stage::controller
                     : failure.empty()                 ? Stage::inputs
                                                       : Stage::physics;
  divergence.note = fmt::format("the {} ends here{}, the {} goes on to tick {}", early ? "run" : "golden",
                                failure.empty() ? "" : " (" + failure + ")", early ? "golden" : "run",
                                (early ? traces.clock : traces.actual_clock).tick_at(std::max(golden_end, actual_end)));
  findings.structure(divergence);
}

/// Reports the ticks that only one clock has: one finding at the first of them, with its neighbours.
void compare_clocks(const ComparedTraces& traces, bool missing, ChannelFindings& findings) {
  const TickClock& of = missing ? traces.clock : traces.actual_clock;
  const TickClock& other = missing ? traces.actual_clock : traces.clock;
  std::vector<std::size_t> lone;
  for (std::size_t i = 0; i < of.size() && of.time(i) <= traces.end; ++i)
    if (!other.has(of.time(i))) lone.push_back(i);
  if (lone.empty()) return;
  const std::size_t first = lone.front();
  std::size_t after = first;
  while (after < of.size() && !other.has(of.time(after))) ++after;
  const std::size_t run = after - first;
  Divergence divergence = place_of_tick(of, of.time(first));
  divergence.stage = Stage::physics;  // the state of the bodies is the first value that is missing
  const auto tick_text = [&](std::size_t index) { return fmt::format("tick {}", of.tick_at(of.time(index))); };
  std::string neighbours = first == 0 ? "the first" : "after " + tick_text(first - 1);
  neighbours += after == of.size() ? ", the last" : ", before " + tick_text(after);
  divergence.note = run == 1 ? fmt::format("this tick is {}", missing ? "missing" : "not in the golden")
                             : fmt::format("ticks {} to {} are {}", divergence.tick, of.tick_at(of.time(after - 1)),
                                           missing ? "missing" : "extra: the golden hasn't them");
  divergence.note += " (" + neighbours + ")";
  if (lone.size() > run) divergence.note += fmt::format("; with later ticks {} in all", lone.size());
  findings.structure(divergence);
  (missing ? findings.result().missing : findings.result().extra) = static_cast<std::int64_t>(lone.size());
}

/// Reports different time steps, in which every tick but the first has a different time, as one finding.
bool has_another_step(const ComparedTraces& traces, ChannelFindings& findings) {
  if (traces.clock.size() < 2 || traces.actual_clock.size() < 2) return false;
  const std::string before = RunFacts::of(traces.golden).stated(facts::time_step),
                    now = RunFacts::of(traces.actual).stated(facts::time_step);
  if (before.empty() || now.empty() || before == now) return false;
  Divergence divergence = place_of_tick(traces.clock, traces.clock.first_time());
  divergence.note =
      fmt::format("the run's time step is {} s, expected {} s: only ticks at the same time are compared", now, before);
  findings.structure(divergence);
  return true;
}

}  // namespace

const TraceChannel* counterpart(const Trace& of, const TraceChannel& channel, const Trace& other) {
  const auto earlier = std::count_if(of.channels().data(), &channel,
                                     [&](const TraceChannel& before) { return before.topic == channel.topic; });
  auto skip = earlier;
  for (const TraceChannel& candidate : other.channels()) {
    if (candidate.topic == channel.topic && skip-- == 0) return &candidate;
  }
  return nullptr;
}

void compare_ticks(ComparedTraces& traces, ChannelComparison& result) {
  ChannelFindings findings(result);
  compare_lengths(traces, findings);
  traces.another_step = has_another_step(traces, findings);
  if (traces.another_step) return;
  compare_clocks(traces, true, findings);
  compare_clocks(traces, false, findings);
}

namespace {

/// The controllers that have channels, as "BODY/CONTROLLER".
std::set<std::string> controllers_with_channels(const Trace& trace) {
  std::set<std::string> labels;
  for (const TraceChannel& channel : trace.channels())
    if (ChannelName name = ChannelName::parse(channel.topic); !name.controller.empty()) labels.insert(name.label());
  return labels;
}

/// Finds the inputs that only one of two runs has, of controllers that both have.
class LoneInputs {
 public:
  LoneInputs(ComparedTraces& traces, bool missing, std::vector<std::string>& names)
      : found_(traces.other_inputs),
        sign_(missing ? '-' : '+'),
        of_(missing ? traces.golden : traces.actual),
        other_(missing ? traces.actual : traces.golden),
        run_(missing ? traces.golden_run : traces.actual_run),
        other_run_(missing ? traces.actual_run : traces.golden_run),
        names_(names) {
    const std::set<std::string> of_other = controllers_with_channels(other_);
    for (const std::string& label : controllers_with_channels(of_))
      if (of_other.contains(label)) controllers_.insert(label);
  }

  void find() {
    for (const TraceChannel& channel : of_.channels()) {
      const ChannelName name = ChannelName::parse(channel.topic);
      if (name.side != ChannelSide::input || !controllers_.contains(name.label())) continue;
      if (const TraceChannel* other = counterpart(of_, channel, other_)) {
        if (is_joint_input(name)) find_values(channel, *other, name.label());
      } else {
        found_.topics.insert(channel.topic);
        tell(channel.topic);
      }
    }
    find_devices();
  }

 private:
  void find_values(const TraceChannel& channel, const TraceChannel& other, const std::string& label) {
    if (run_.of(channel).messages == 0 || other_run_.of(other).messages == 0) return;
    for (std::size_t column = 0; column < channel.columns.size(); ++column) {
      const std::string& element = channel.columns[column].element;
      const std::size_t there = column_of(other, element);
      const bool is_there = there < other.columns.size();
      const bool is_read = run_.is_read(channel, column);
      const bool is_read_there = is_there && other_run_.is_read(other, there);
      if (is_read && !is_read_there) tell(fmt::format("{} of {}", element, label));
      if (is_read != is_read_there || !is_there) found_.values.emplace(channel.topic, element);
    }
  }

  void find_devices() {
    const auto here = RunFacts::of(of_).devices_read, there = RunFacts::of(other_).devices_read;
    if (!here || !there) return;
    const auto reads = [](const mcap::StringMap& devices, const std::string& device, const std::string& label) {
      const auto readers = devices.find(device);
      return readers != devices.end() &&
             fmt::format(", {}, ", readers->second).find(fmt::format(", {}, ", label)) != std::string::npos;
    };
    for (const auto& [device, readers] : *here) {
      for (const std::string& label : controllers_) {
        if (!reads(*here, device, label) || reads(*there, device, label)) continue;
        found_.devices = true;
        tell(device);
      }
    }
  }

  void tell(const std::string& what) { names_.push_back(fmt::format("{} {}", sign_, what)); }

  OtherInputs& found_;
  const char sign_;
  const Trace& of_;
  const Trace& other_;
  const RunSurvey& run_;
  const RunSurvey& other_run_;
  std::vector<std::string>& names_;
  std::set<std::string> controllers_;  // that both runs have, as "BODY/CONTROLLER"
};

}  // namespace

std::vector<std::string> find_other_inputs(ComparedTraces& traces) {
  std::vector<std::string> names;
  if (!traces.options.takes(Stage::inputs)) return names;
  for (const bool missing : {true, false}) LoneInputs(traces, missing, names).find();
  return names;
}

std::string other_inputs_sentence(const std::vector<std::string>& names) {
  return fmt::format("the controller reads other inputs: {}", fmt::join(names, ", "));
}

namespace {

/// "has no costs", or the processor as the reason.
std::string why_without_costs(const Trace& trace) {
  const auto provenance = RunFacts::of(trace).provenance;
  const std::string architecture = provenance ? architecture_of(*provenance) : "x86-64";
  if (architecture == "x86-64") return "has no costs";
  return fmt::format("is of {}, a processor on which the costs of control() aren't recorded", architecture);
}

/// The compared channels that only one of the traces has.
class LoneChannels {
 public:
  LoneChannels(const ComparedTraces& traces, bool missing, const std::function<bool(const TraceChannel&)>& takes)
      : traces_(traces),
        missing_(missing),
        of_(missing ? traces.golden : traces.actual),
        run_(missing ? traces.golden_run : traces.actual_run),
        other_(missing ? traces.actual : traces.golden) {
    for (const TraceChannel& channel : of_.channels()) {
      const bool later = run_.of(channel).messages > 0 && run_.of(channel).first_time > traces.end;
      const bool is_input = traces.other_inputs.topics.contains(channel.topic);
      if (takes(channel) && !later && !is_input && !counterpart(of_, channel, other_)) lone_.push_back(&channel);
    }
  }

  void report(const AddChannel& add, std::vector<std::string>& remarks) {
    while (!lone_.empty()) {
      const TraceChannel& channel = *lone_.front();
      if (channel.type == msg::ContactChange::type_name && is_older_than_contacts()) {
        remarks.push_back(fmt::format("the {} was recorded by a version without contacts: {} is not compared",
                                      missing_ ? "run" : "golden", channel.topic));
        lone_.erase(lone_.begin());
        continue;
      }
      if (stage_of(channel.topic) == Stage::costs) {
        remarks.push_back(fmt::format("the {} {}: {} is not compared", missing_ ? "run" : "golden",
                                      why_without_costs(other_), channel.topic));
        lone_.erase(lone_.begin());
        continue;
      }
      const Group group = group_of(channel.topic);
      ChannelComparison& result = add(channel.topic);
      result.channels = static_cast<int>(take(group.prefix));
      if (result.channels > 1) result.group = group.prefix;
      result.is_lone = !group.is_whole;
      Divergence divergence =
          place_of(traces_, channel, run_.of(channel).messages > 0 ? run_.of(channel).first_time : 0);
      divergence.note = text_of(group, result.channels);
      ChannelFindings(result).structure(divergence);
    }
  }

 private:
  /// A body, controller, link or device that is missing: all channels whose topics have this beginning.
  struct Group {
    std::string prefix;     // with the slash at its end; a whole topic for a channel of its own
    std::string what;       // "body 'SR1'"; empty: a channel
    bool is_whole = false;  // a body or a controller
  };

  bool is_older_than_contacts() const {
    const RunFacts other = RunFacts::of(other_);
    return other.provenance && other.trace_revision < revision_of_contacts;
  }

  /// True if no topic of the other trace has this beginning.
  bool lacks(const std::string& prefix) const {
    return std::ranges::none_of(other_.channels(),
                                [&](const TraceChannel& channel) { return channel.topic.starts_with(prefix); });
  }

  Group group_of(const std::string& topic) const {
    const ChannelName name = ChannelName::parse(topic);
    if (name.body.empty()) return {topic, ""};
    const std::string body = "/" + name.body + "/";
    if (lacks(body)) return {body, "body '" + name.body + "'", true};
    const bool controls = !name.controller.empty();
    if (!controls && name.owner.empty()) return {topic, ""};
    const std::string owner = body + (controls ? name.controller : topic_segment(name.owner)) + "/";
    if (!lacks(owner)) return {topic, ""};
    return {owner,
            fmt::format("{} '{}/{}'",
                        controls            ? "controller"
                        : name.is_of_link() ? "link"
                                            : "device",
                        name.body, controls ? name.controller : name.owner),
            controls};
  }

  /// Removes the channels whose topics have this beginning, and returns their number.
  std::size_t take(const std::string& prefix) {
    return std::erase_if(lone_, [&](const TraceChannel* channel) {
      return prefix.ends_with('/') ? channel->topic.starts_with(prefix) : channel->topic == prefix;
    });
  }

  std::string text_of(const Group& group, int channels) const {
    const char* what = missing_ ? "missing" : "not in the golden";
    if (group.what.empty() && channels > 1) return fmt::format("{} channels of this topic are {}", channels, what);
    if (group.what.empty() || channels == 1) return fmt::format("the channel is {}", what);
    return fmt::format("{} is {} (its {} channels)", group.what, what, channels);
  }

  const ComparedTraces& traces_;
  const bool missing_;
  const Trace& of_;
  const RunSurvey& run_;
  const Trace& other_;
  std::vector<const TraceChannel*> lone_;
};

}  // namespace

void compare_lone_channels(const ComparedTraces& traces, const std::function<bool(const TraceChannel&)>& takes,
                           const AddChannel& add, std::vector<std::string>& remarks) {
  for (const bool missing : {true, false}) LoneChannels(traces, missing, takes).report(add, remarks);
}

}  // namespace rehearse
