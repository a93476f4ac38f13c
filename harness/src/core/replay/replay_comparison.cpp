#include "replay_comparison.h"

#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include "base/clock.h"
#include "core/compare/compare_variables.h"
#include "core/guard/turn_calls.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"

namespace rehearse {

ReplayComparison::ReplayComparison(const ReplayOptions& options, const std::vector<ToleranceRule>& rules,
                                   const Scenario& scenario, mcap::Reader& recording, ControllerHost& host,
                                   const RecordingSource& source, SeriesScales scales, ReplayReport& report)
    : options_(options),
      rules_(rules),
      scenario_(scenario),
      recording_(recording),
      host_(host),
      source_(source),
      report_(report),
      words_(host, recording),
      record_(host, scenario),
      judge_(&rules, std::move(scales), scenario.time_step,
             [this](Divergence&& found) { this->report(std::move(found)); }),
      outputs_(host, record_.fields(), recording, judge_),
      results_(record_.fields(), rules, scenario.time_step),
      delays_(host, recording),
      channels_(words_.channels()),
      from_(static_cast<std::uint64_t>(std::llround(std::max(0.0, options.from) * 1e9))) {
  reader_of_.assign(std::size_t{recording.channels().rbegin()->first} + 1, Reader::none);
  for (const std::uint16_t id : words_.channels()) reader_of_[id] = Reader::words;
  for (const std::uint16_t id : outputs_.channels()) reader_of_[id] = Reader::outputs;
  for (const std::uint16_t id : delays_.channels()) reader_of_[id] = Reader::delays;
  channels_.insert(channels_.end(), outputs_.channels().begin(), outputs_.channels().end());
  channels_.insert(channels_.end(), delays_.channels().begin(), delays_.channels().end());
  is_recovered_ = std::ranges::any_of(recording.metadata(),
                                      [](const mcap::Metadata& entry) { return entry.name == "rehearse.recover"; });
  if (options.on_started) options.on_started(record_.fields());
}

Result<void> ReplayComparison::take(const mcap::Message& message) {
  const Reader reader = reader_of_[message.channel->id];
  if (reader == Reader::none) return {};
  if (reader == Reader::delays) return delays_.accept(message), Result<void>();
  auto accepted = reader == Reader::words ? words_.accept(message) : outputs_.accept(message);
  return accepted ? accepted : in_recording(recording_, accepted.errors()[0]);
}

Result<void> ReplayComparison::emit(const TickData& now) {
  const std::int64_t before = std::max<std::int64_t>(0, now.tick - 1);
  words_.begin_tick([&](Divergence&& found) { word_differs(std::move(found), before); });
  if (now.alive && !inputs_are_lost_) {
    const std::vector<std::uint64_t>& row = record_.row();
    report_outputs(now.tick, row);
    compare(now, row);
    judge_.end_tick(now.tick);
    if (!inputs_are_lost_) {
      last_tick_ = now.tick;
      ++report_.ticks;
    }
  }
  take_events();
  outputs_.begin_tick();
  return {};
}

void ReplayComparison::report_outputs(std::int64_t tick, const std::vector<std::uint64_t>& row) {
  if (options_.on_outputs) options_.on_outputs(tick, row);
  if (options_.on_threads)
    if (const auto threads = describe_threads_at_rest(); !threads.empty()) options_.on_threads(tick, threads);
  if (!options_.on_variable) return;
  for (const HostedController& hosted : host_.controllers())
    for (const ControllerVariables::Variable& variable : hosted.variables.all())
      if (variable.is_set)
        options_.on_variable(tick, ChannelName::of_variable(hosted.label, variable.name).topic().substr(1),
                             variable.value);
}

bool ReplayComparison::is_compared(std::int64_t tick) const {
  return nanoseconds_of(tick, scenario_.time_step) >= from_;
}

void ReplayComparison::compare(const TickData& now, const std::vector<std::uint64_t>& row) {
  const auto count = [this](Divergence&& found) { differs(std::move(found)); };
  if (!source_.alters()) compare_inputs(now);
  if (inputs_are_lost_) return outputs_.pass_over(now.tick);
  if (!report_.first_other_hash && host_.output_hash() != source_.recorded().output_hash)
    report_.first_other_hash = now.tick;
  delays_.compare(count);
  if (!is_compared(now.tick)) return outputs_.pass_over(now.tick);
  report_.values += outputs_.compare(now.tick, row, count);
  results_.take(now.tick, row, source_.recorded().controller_results);
  report_.values += std::ssize(source_.recorded().controller_results);
  compare_variables(now.tick);
}

/// The channel of a controller that commands it, or of one that commands the body's joints; without any, the body.
TraceChannel ReplayComparison::channel_of_initial(const InitialNumber& number) const {
  TraceChannel channel;
  channel.topic = "/" + number.body;
  bool is_commanded = false;
  for (const OutputField& field : record_.fields()) {
    const ChannelName name = ChannelName::parse(field.channel);
    if (body_of_name(field.controller) != number.body || name.side != ChannelSide::output) continue;
    const bool commands_it = name.owner.empty() && field.element == number.element;
    if (commands_it || (!is_commanded && name.owner.empty())) channel.topic = field.channel;
    is_commanded = is_commanded || commands_it;
  }
  return channel;
}

void ReplayComparison::compare_initial(const Command& command) {
  const auto recorded = std::ranges::find(recording_.metadata(), records::initial_commands, &mcap::Metadata::name);
  if (!scenario_.initial_commands || recorded == recording_.metadata().end() || !is_compared(0)) return;
  const mcap::StringMap now = metadata_of_initial_commands(scenario_, command);
  for (const InitialNumber& number : initial_numbers(recorded->values, now, scenario_)) {
    const std::size_t judged = judge_.add_channel(channel_of_initial(number));
    judge_.set_columns(judged, {{"initialize/" + number.element, {}, CellKind::floating}});
    const auto expected = std::bit_cast<std::uint64_t>(number.recorded);
    const auto actual = std::bit_cast<std::uint64_t>(number.now);
    judge_.add(judged, 0, std::span(&expected, 1), std::span(&actual, 1));
    ++report_.values;
  }
}

/// Compares the hashes of the inputs. A controller that reads more or fewer values than the recorded controller has
/// other hashes from the first tick on: then a comparison of them has no meaning. Else a different hash in a later tick
/// means that the recorded inputs differ from the inputs of the run.
void ReplayComparison::compare_inputs(const TickData& now) {
  if (!report_.other_inputs.empty()) reads_the_same_ = false;
  if (reads_the_same_ && !*reads_the_same_ && report_.first_other_hash) return;
  const bool same = host_.input_hash(*now.read) == source_.recorded().input_hash;
  if (!same && !report_.first_other_hash) report_.first_other_hash = now.tick;
  if (!reads_the_same_) reads_the_same_ = same;
  if (same || !*reads_the_same_) return;
  if (is_recovered_) return end_where_inputs_are_lost(now.tick);
  if (!is_compared(now.tick)) return;
  Divergence found;
  found.channel = run_topics::tick;
  found.element = "input_hash";
  found.stage = Stage::inputs;
  found.note = "the recorded inputs differ from those that the controllers got when the recording was made";
  differs(std::move(found));
  reads_the_same_ = false;  // reported once
}

/// A recovered recording has each channel up to the last whole chunk, so that some end before others.
void ReplayComparison::end_where_inputs_are_lost(std::int64_t tick) {
  inputs_are_lost_ = true;
  Diagnostic remark =
      warning(fmt::format("the inputs of tick {} ({:g} s) and later ones are lost: commands are compared up to there",
                          tick, time_of(tick, scenario_.time_step)),
              "'rehearse recover' stated what it couldn't save");
  report_.remarks.push_back(in_recording(recording_, std::move(remark)));
}

/// Takes a difference other than of two numbers.
void ReplayComparison::differs(Divergence&& found) {
  found.tick = source_.recorded().tick;
  found.time = time_of(source_.recorded().tick, scenario_.time_step);
  judge_.add(std::move(found));
}

/// True for a difference within a rule that is written for commands.
bool ReplayComparison::is_allowed(const Divergence& found) const {
  if (found.is_beyond()) return false;
  const ToleranceRule* rule = rule_for(series_name(found.channel, found.element), rules_);
  return rule && is_for_commands(*rule);
}

void ReplayComparison::report(Divergence&& found) {
  const bool is_new = found.tick != std::exchange(last_different_, found.tick);
  report_.ticks_different += is_new && !results_.differ_at(found.tick) ? 1 : 0;
  report_.commands_hold = report_.commands_hold && is_allowed(found);
  if (options_.on_difference) options_.on_difference(found);
  report_.add(std::move(found));
}

/// Variables that a rule of tolerances names are compared like commands.
std::optional<std::size_t> ReplayComparison::judged_variable(const std::string& topic) {
  const auto [entry, is_new] = variables_.try_emplace(topic);
  if (is_new && asks_for_variable(topic.substr(1), scenario_.tolerances)) {
    TraceChannel channel;
    channel.topic = topic;
    channel.type = msg::Float64::type_name;
    entry->second = judge_.add_channel(channel);
    judge_.set_columns(*entry->second, {{topic_segment(ChannelName::parse(topic).owner), {}, CellKind::floating}});
  }
  return entry->second;
}

void ReplayComparison::compare_variables(std::int64_t tick) {
  const auto compare = [&](const std::string& topic, std::optional<double> recorded, std::optional<double> now) {
    const std::optional<std::size_t> judged = judged_variable(topic);
    const bool same = recorded && now && identical(*recorded, *now);
    if (recorded && now) history_.add(topic, tick, *recorded, *now);
    if (judged && recorded && now) {
      const auto expected = std::bit_cast<std::uint64_t>(*recorded), actual = std::bit_cast<std::uint64_t>(*now);
      report_.values += same ? 0 : 1;
      judge_.add(*judged, tick, std::span(&expected, 1), std::span(&actual, 1));
      return;
    }
    if (same) return;
    Divergence found;
    found.channel = topic;
    found.element = topic_segment(ChannelName::parse(topic).owner);
    found.stage = Stage::controller;
    if (recorded && now)
      put_numbers(found, *recorded, *now);
    else
      found.note = now ? "is set now, but wasn't in the recording" : "was set in the recording, but isn't now";
    if (!judged) return word_differs(std::move(found), source_.recorded().tick);
    ++report_.values;
    differs(std::move(found));
  };
  report_.words.variables += words_.compare_variables(compare);
}

Result<void> ReplayComparison::finish() {
  Result<void> read;
  const bool goes_on = source_.was_cut_short() || host_.failure();
  if (goes_on && judge_.lead() > 0.0 && !outputs_.channels().empty()) {
    const std::uint64_t begin = nanoseconds_of(last_tick_ + 1, scenario_.time_step);
    const std::uint64_t end = begin + static_cast<std::uint64_t>(std::llround(judge_.lead() * 1e9));
    mcap::OrderedMessages messages(recording_, outputs_.channels(), begin);
    for (const mcap::Message* message; read && (message = messages.next()) && message->log_time < end;) {
      const double ticks = static_cast<double>(message->log_time) * 1e-9 / scenario_.time_step;
      read = outputs_.accept_later(*message, std::llround(ticks));
    }
  }
  judge_.finish();
  report_.ticks_different += results_.ticks_different();
  if (report_.first) report_.explanation = history_.explanation(report_.controllers);
  for (JudgedEvent& event : results_.judge(last_tick_)) {
    report_.commands_hold = report_.commands_hold && !event.beyond;
    if (options_.on_difference) options_.on_difference(event.place);
    report_.add(std::move(event.place), event.beyond);
  }
  return read ? read : in_recording(recording_, read.errors()[0]);
}

void ReplayComparison::word_differs(Divergence&& found, std::int64_t tick) {
  if (inputs_are_lost_) return;
  found.tick = tick;
  found.time = time_of(tick, scenario_.time_step);
  if (found.time < options_.from) return;
  ++report_.words.different;
  if (options_.on_word) options_.on_word(found);
  if (!report_.words.first || found.tick < report_.words.first->tick) report_.words.first = std::move(found);
}

void ReplayComparison::take_events() {
  const std::vector<msg::Event> events = host_.take_events();
  append_remarks(events, report_.remarks);
  words_.say(events);
  if (options_.on_event)
    for (const msg::Event& event : events) options_.on_event(event);
}

/// Compares the lines of the last tick. The lines of an earlier tick are compared when the next tick begins.
void ReplayComparison::end_lines() {
  const std::int64_t last = host_.failure() ? source_.recorded().tick : std::max<std::int64_t>(0, report_.ticks - 1);
  words_.end([&](Divergence&& found) { word_differs(std::move(found), last); });
  report_.words.lines = words_.lines();
}

}  // namespace rehearse
