#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/clock.h>
#include <rehearse/interruption.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/replay.h>
#include <rehearse/tolerance.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "altered_inputs.h"
#include "audit/virtualised.h"
#include "compare/asked_variables.h"
#include "host/controller_host.h"
#include "host/float_mode.h"
#include "host/opened_files.h"
#include "mcap/whole_input.h"
#include "output_record.h"
#include "recorded_inputs.h"
#include "recorded_outputs.h"
#include "recorded_words.h"
#include "recording/provenance.h"
#include "recording/recorder.h"
#include "recording/variable_topics.h"
#include "replay_recording.h"
#include "trace_scenario.h"

namespace rehearse {
namespace {

Diagnostic in_trace(const mcap::Reader& trace, Diagnostic diagnostic) {
  if (diagnostic.file.empty()) diagnostic.file = trace.name();
  return diagnostic;
}

class Replayer {
 public:
  Replayer(const ReplayOptions& options, Damage damage, const Scenario& scenario, mcap::Reader& trace,
           ControllerHost& host)
      : options_(options),
        damage_(damage),
        scenario_(scenario),
        trace_(trace),
        host_(host),
        inputs_(scenario, trace),
        words_(host, trace) {}

  Result<ReplayReport> run();

 private:
  Result<void> begin();
  Diagnostics unrecorded_inputs() const;
  bool on_message(const mcap::Message& message);
  bool finish_tick();
  bool follows_on();
  void compare_inputs();
  void compare_delays();
  void compare_results();
  void compare_variables();
  void say_differs(Divergence&& found);
  void tell_variables() const;
  const Observation& inputs_of_tick();
  void tell_unused_alterations();
  std::vector<std::string> other_controllers() const;
  std::vector<std::string> changed_files() const;
  void end_at_damage(Diagnostics damage);
  double tolerance_for(const Divergence& found) const;
  void differs(Divergence&& found);
  void take_events();

  const ReplayOptions& options_;
  const Damage damage_;
  const Scenario& scenario_;
  mcap::Reader& trace_;
  ControllerHost& host_;
  RecordedInputs inputs_;
  RecordedWords words_;
  AlteredInputs altered_;
  std::vector<RecordedOutputs> outputs_;       // by controller
  std::optional<OutputRecord> output_record_;  // if somebody wants it
  std::vector<RecordedOutputs*> output_of_;    // by channel id; null: none
  std::vector<bool> is_input_;                 // by channel id
  std::vector<bool> is_word_;                  // by channel id
  std::uint16_t tick_channel_ = 0;
  std::vector<std::uint16_t> channels_;
  msg::Tick tick_;
  bool tick_here_ = false;
  std::uint64_t now_ = 0;  // log time of the tick being gathered [ns]
  std::uint64_t from_ = 0, until_ = std::numeric_limits<std::uint64_t>::max();  // [ns]
  Observation altered_observation_;                                             // used only if something is altered
  bool tick_differs_ = false;
  bool cut_short_ = false;              // the recording goes on
  std::optional<bool> reads_the_same_;  // as when it was recorded; decided at the first tick
  Diagnostics errors_;
  ReplayReport report_;
};

Result<void> Replayer::begin() {
  host_.initialize(initial_observation(scenario_));
  host_.start();
  for (const auto& [id, channel] : trace_.channels())
    if (channel.topic == "/tick") tick_channel_ = id;
  if (tick_channel_ == 0) return in_trace(trace_, error("it has no ticks: nothing of the run was recorded"));
  if (Diagnostics missing = unrecorded_inputs(); !missing.empty()) return missing;
  auto altered = AlteredInputs::parse(options_.set, scenario_);
  if (!altered) return altered.errors();
  altered_ = *std::move(altered);
  if (auto read = altered_.check_read_by(host_); !read) return read;

  const std::size_t ids = std::size_t{trace_.channels().rbegin()->first} + 1;
  is_input_.assign(ids, false);
  is_word_.assign(ids, false);
  output_of_.assign(ids, nullptr);
  channels_ = inputs_.channels_read_by(host_);
  for (const std::uint16_t id : channels_) is_input_[id] = true;
  channels_.push_back(tick_channel_);
  for (const std::uint16_t id : words_.channels()) {
    is_word_[id] = true;
    channels_.push_back(id);
  }
  outputs_.reserve(host_.controllers().size());
  for (const HostedController& hosted : host_.controllers()) {
    RecordedOutputs& outputs = outputs_.emplace_back(hosted, scenario_, trace_);
    for (const std::uint16_t id : outputs.channels()) {
      output_of_[id] = &outputs;
      channels_.push_back(id);
    }
  }
  if (options_.on_outputs) output_record_.emplace(host_, scenario_);
  if (options_.on_started && output_record_) options_.on_started(output_record_->fields());
  from_ = static_cast<std::uint64_t>(std::llround(std::max(0.0, options_.from) * 1e9));
  if (options_.until) until_ = static_cast<std::uint64_t>(std::llround(std::max(0.0, *options_.until) * 1e9));
  return {};
}

Diagnostics Replayer::unrecorded_inputs() const {
  Diagnostics missing;
  if (scenario_.joystick && !inputs_.has_joystick())
    missing.push_back(
        in_trace(trace_, error("the run has a joystick, but what it did was not recorded: there is no /joy",
                               "record the scenario again")));
  for (const HostedController& hosted : host_.controllers()) {
    if (!hosted.running) continue;
    const Model& model = *scenario_.bodies[hosted.body].model;
    const auto report = [&](const std::string& what) {
      missing.push_back(
          in_trace(trace_, error(fmt::format("controller '{}' reads {}, which was not recorded", hosted.label, what),
                                 "record again with this controller")));
    };
    for (const IoField& field : hosted.io->inputs().fields)
      if (!inputs_.has(hosted.body, field))
        report(fmt::format("{} of link '{}'", name_of(field.quantity), model.links[field.link].name));
    for (const int link : hosted.io->contact_links())
      if (!inputs_.has_contacts(hosted.body, link))
        report(fmt::format("the contact points of link '{}'", model.links[link].name));
    for (const int device : hosted.io->input_devices()) {
      const DeviceKind& kind = model.devices[device].kind;
      const bool is_still_camera =
          std::holds_alternative<Camera>(kind) &&
          !scenario_.runs_camera(scenario_.bodies[hosted.body].name, model.devices[device].name);
      const bool said_nothing = is_still_camera || std::holds_alternative<Light>(kind);
      if (!said_nothing && !inputs_.has_device(hosted.body, device))
        report(fmt::format("device '{}'", model.devices[device].name));
    }
  }
  return missing;
}

Result<ReplayReport> Replayer::run() {
  if (virtualised_seed(trace_) && virtualisation().empty()) {
    Diagnostic& remark = report_.remarks.emplace_back(in_trace(
        trace_,
        error("its controllers were given simulated time and seeded random numbers, and here they are given the "
              "system's: their commands may differ for that",
              "rehearse replay gives them what they had")));
    remark.severity = Severity::warning;
  }
  if (auto begun = begin(); !begun) return begun.errors();
  take_events();
  bool going_on = !host_.failure();
  const auto gather = [this, &going_on](const mcap::Message& message) {
    if (message.log_time != now_ && !(going_on = finish_tick())) return false;
    now_ = message.log_time;
    return going_on = on_message(message);
  };
  Result<void> read;
  if (going_on) read = trace_.for_each_message_in_order(gather, channels_);
  if (going_on) finish_tick();
  if (damage_ == Damage::tolerate) {
    end_at_damage(read ? Diagnostics() : read.errors());
  } else {
    if (!errors_.empty()) return errors_;
    // what is damaged behind the part that was wanted doesn't matter
    const bool enough = cut_short_ || (options_.until && time_of(report_.ticks, scenario_.time_step) >= *options_.until);
    if (!read && !enough) return read.errors();
  }
  const auto differs = [this](Divergence&& found) { say_differs(std::move(found)); };
  if (cut_short_) words_.end(differs);  // the recorded controllers were not stopped there
  host_.stop(report_.ticks);
  take_events();
  if (!cut_short_) words_.end(differs);
  report_.words.lines = words_.lines();
  tell_unused_alterations();
  report_.failure = host_.failure();
  report_.controller_refused = host_.any_refused();
  report_.other_controllers = other_controllers();
  report_.changed_files = changed_files();
  report_.same_controllers = report_.other_controllers.empty() && !host_.has_other_options();
  return report_;
}

/// What ended the replay early, or was left out of it, as warnings.
void Replayer::end_at_damage(Diagnostics damage) {
  damage.insert(damage.end(), errors_.begin(), errors_.end());
  for (Diagnostic& finding : damage) {
    finding.severity = Severity::warning;
    report_.remarks.push_back(std::move(finding));
  }
}

bool Replayer::on_message(const mcap::Message& message) {
  const std::uint16_t id = message.channel->id;
  Result<void> accepted;
  if (id == tick_channel_) {
    CdrReader reader(message.data);
    tick_here_ = msg::decode(reader, tick_);
    if (!tick_here_) accepted = error(fmt::format("a message on /tick at {} ns is not of its type", message.log_time));
  } else if (is_input_[id]) {
    accepted = inputs_.accept(message);
  } else if (is_word_[id]) {
    accepted = words_.accept(message);
  } else {
    accepted = output_of_[id]->accept(message);
  }
  if (!accepted) errors_ = {in_trace(trace_, accepted.errors()[0])};
  return accepted.ok();
}

/// All messages of a tick are here: control, and compare. False: the replay ends.
bool Replayer::finish_tick() {
  if (!tick_here_) return true;  // before the first tick, or a tick that wasn't closed
  tick_here_ = false;
  const bool last_state = tick_.controller_results.size() != host_.controllers().size();
  if (last_state) return false;  // after the last step only the state is recorded
  if (now_ >= until_) return cut_short_ = true, false;
  if (!follows_on()) return false;
  if (auto interrupted = interrupted_at(tick_.tick, scenario_.time_step)) {
    errors_ = {*std::move(interrupted)};
    return false;
  }
  tick_differs_ = false;
  words_.begin_tick([this](Divergence&& found) { say_differs(std::move(found)); });
  if (!host_.control(tick_.tick, inputs_of_tick())) return take_events(), false;
  if (output_record_) options_.on_outputs(tick_.tick, output_record_->row());
  if (options_.on_variable) tell_variables();
  if (altered_.empty()) compare_inputs();
  if (report_.ticks == 0) compare_delays();
  if (now_ >= from_) {
    for (const RecordedOutputs& outputs : outputs_)
      report_.values += outputs.compare([this](Divergence&& found) { differs(std::move(found)); });
    compare_results();
    compare_variables();
    report_.ticks_different += tick_differs_ ? 1 : 0;
  }
  ++report_.ticks;
  take_events();
  inputs_.begin_tick();
  for (RecordedOutputs& outputs : outputs_) outputs.begin_tick();
  const std::int64_t all = scenario_.ticks();
  if (options_.progress && report_.ticks % std::max<std::int64_t>(1, all / 100) == 0)
    options_.progress(report_.ticks, all);
  return true;
}

const Observation& Replayer::inputs_of_tick() {
  if (altered_.empty()) return inputs_.observation();
  altered_observation_ = inputs_.observation();
  altered_.apply(tick_.tick, altered_observation_);
  return altered_observation_;
}

void Replayer::tell_unused_alterations() {
  for (const std::string& text : altered_.unused()) {
    Diagnostic& remark = report_.remarks.emplace_back(
        error(fmt::format("'{}' altered nothing: there was no such tick, or nothing was measured then", text)));
    remark.severity = Severity::warning;
  }
}

/// A controller is what all ticks before made of it. So none may be missing: the trace was cut, or some of it was lost.
bool Replayer::follows_on() {
  const std::int64_t expected = report_.ticks;
  if (tick_.tick == expected) return true;
  errors_ = {in_trace(
      trace_,
      expected == 0
          ? error(fmt::format("its first tick is {}: what was before isn't in it, and controllers can't begin in the middle",
                              tick_.tick),
                  "replay the whole recording, with --from")
          : error(fmt::format("tick {} follows tick {}: what was between isn't in it, and controllers can't go on without",
                              tick_.tick, expected - 1),
                  fmt::format("replay it up to there: --until {:g}", time_of(expected, scenario_.time_step))))};
  return false;
}

/// A controller that reads more or less than the recorded one has other hashes from the first tick on: then they tell
/// nothing. Else another hash later on means that the recorded inputs are not those of the run.
void Replayer::compare_inputs() {
  if (reads_the_same_ && !*reads_the_same_) return;
  const bool same = host_.input_hash(inputs_.observation()) == tick_.input_hash;
  if (!reads_the_same_) reads_the_same_ = same;
  if (same || !*reads_the_same_ || now_ < from_) return;
  Divergence found;
  found.channel = "/tick";
  found.element = "input_hash";
  found.stage = Stage::inputs;
  found.note = "what the recording holds of the inputs is not what the controllers were fed with when it was made";
  differs(std::move(found));
  reads_the_same_ = false;  // said once
}

/// By the hashes of their libraries.
std::vector<std::string> Replayer::other_controllers() const {
  const mcap::StringMap* facts = nullptr;
  for (const mcap::Metadata& metadata : trace_.metadata())
    if (metadata.name == "rehearse") facts = &metadata.values;
  std::vector<std::string> others;
  for (const HostedController& hosted : host_.controllers()) {
    const auto recorded = facts ? facts->find("controller." + hosted.label) : mcap::StringMap::const_iterator();
    if (!facts || recorded == facts->end() || !recorded->second.ends_with(" " + hosted.library->content_hash()))
      others.push_back(hosted.label);
  }
  return others;
}

/// What a run ended by a failure would have read later isn't known. A recording from before files were recorded says
/// nothing of what was in them.
std::vector<std::string> Replayer::changed_files() const {
  const mcap::StringMap* recorded = nullptr;
  for (const mcap::Metadata& metadata : trace_.metadata())
    if (metadata.name == files_record) recorded = &metadata.values;
  std::vector<std::string> changes;
  for (const auto& [file, content] : host_.files_read()) {
    const auto before = recorded ? recorded->find(file) : mcap::StringMap::const_iterator();
    const bool is_known = recorded && before != recorded->end();
    if (is_known && before->second == content) continue;
    if (content == missing_file)
      changes.push_back(fmt::format("{} wasn't found", file));
    else if (is_known)
      changes.push_back(fmt::format("{} has changed since the recording", file));
    else
      changes.push_back(fmt::format("{} is read, and the recording doesn't say what was in it", file));
  }
  return changes;
}

/// The same numbers a tick later, or earlier, are other commands.
void Replayer::compare_delays() {
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const HostedController& hosted = host_.controllers()[i];
    if (!hosted.running) continue;
    outputs_[i].compare_delay(host_.is_delayed(hosted), [this](Divergence&& found) { differs(std::move(found)); });
  }
}

void Replayer::compare_results() {
  for (std::size_t i = 0; i < host_.controllers().size(); ++i) {
    ++report_.values;
    const bool result = host_.controllers()[i].result;
    if (result == tick_.controller_results[i]) continue;
    Divergence found;
    found.channel = "/tick";
    found.element = fmt::format("controller_results/{}", i);
    found.expected = tick_.controller_results[i] ? 1.0 : 0.0;
    found.actual = result ? 1.0 : 0.0;
    found.difference = 1.0;
    found.note = fmt::format("control() of '{}' returned {}, and {} in the recording", host_.controllers()[i].label,
                             result, !result);
    differs(std::move(found));
  }
}

/// By the name that the series has in a trace. What isn't a matter of two numbers may not differ at all.
double Replayer::tolerance_for(const Divergence& found) const {
  if (!options_.tolerances || !found.note.empty()) return 0.0;
  const std::string owner = found.channel.substr(1, found.channel.rfind('/'));
  const Tolerance tolerance = tolerance_of(owner + found.element, found.unit, *options_.tolerances);
  return tolerance.bound(std::abs(found.expected));
}

void Replayer::differs(Divergence&& found) {
  found.tick = tick_.tick;
  found.time = time_of(tick_.tick, scenario_.time_step);
  found.tolerance = tolerance_for(found);
  tick_differs_ = true;
  ++report_.values_different;
  if (!report_.beyond && (!found.note.empty() || !(found.difference <= found.tolerance))) report_.beyond = found;
  if (options_.on_difference) options_.on_difference(found);
  if (!report_.worst || found.difference > report_.worst->difference) report_.worst = found;
  if (!report_.first) report_.first = std::move(found);
}

void Replayer::take_events() {
  const std::vector<msg::Event> events = host_.take_events();
  append_remarks(events, report_.remarks);
  words_.say(events);
  if (options_.on_event)
    for (const msg::Event& event : events) options_.on_event(event);
}

void Replayer::tell_variables() const {
  for (const HostedController& hosted : host_.controllers())
    for (const ControllerVariables::Variable& variable : hosted.variables.all())
      if (variable.is_set)
        options_.on_variable(tick_.tick, variable_topic(hosted.label, variable.name).substr(1), variable.value);
}

/// Those that a rule asks for are compared like commands.
void Replayer::compare_variables() {
  report_.words.variables += words_.compare_variables([this](Divergence&& found) {
    if (!asks_for_variable(found.channel.substr(1), scenario_.tolerances)) return say_differs(std::move(found));
    ++report_.values;
    differs(std::move(found));
  });
}

/// A line is found when the next tick begins, or the replay ends.
void Replayer::say_differs(Divergence&& found) {
  const bool is_line = found.channel == "/events";
  found.tick = is_line && !host_.failure() ? std::max<std::int64_t>(0, report_.ticks - 1) : tick_.tick;
  found.time = time_of(found.tick, scenario_.time_step);
  if (found.time < options_.from) return;
  ++report_.words.different;
  if (!report_.words.first || found.tick < report_.words.first->tick) report_.words.first = std::move(found);
}

/// What may have made the last bits differ, if it isn't the controllers.
void tell_other_arithmetic(const mcap::Reader& trace, const Scenario& scenario, Diagnostics& remarks) {
  for (const mcap::Metadata& metadata : trace.metadata()) {
    if (metadata.name != "rehearse") continue;
    const std::string other = other_arithmetic(metadata.values, provenance(scenario, nullptr, "", ""));
    if (other.empty()) continue;
    Diagnostic& remark = remarks.emplace_back(
        error(fmt::format("this process may round otherwise than the one that recorded: {}", other),
              "last bits may differ for that alone; rehearse check compares within tolerance then"));
    remark.severity = Severity::warning;
  }
}

}  // namespace

Result<ReplayReport> replay_recording(mcap::Reader& recording, const Scenario& scenario, const ReplayOptions& options,
                                      Damage damage) {
  const StandardFloatMode float_mode;
  auto host = ControllerHost::create(scenario, options);
  if (!host) return host.errors();
  auto report = Replayer(options, damage, scenario, recording, **host).run();
  if (report && report->first) tell_other_arithmetic(recording, scenario, report->remarks);
  if (report)
    for (Diagnostic& remark : float_mode.remarks()) report->remarks.push_back(std::move(remark));
  return report;
}

Result<ReplayReport> replay(const std::filesystem::path& trace, const ReplayOptions& options) {
  auto reader = mcap::Reader::open(trace);
  if (!reader) return reader.errors();
  if (!(*reader)->damage().empty()) return mcap::with_recover_hint((*reader)->damage());
  const auto scenario = scenario_of(**reader);
  if (!scenario) return scenario.errors();
  return replay_recording(**reader, *scenario, options);
}

}  // namespace rehearse
