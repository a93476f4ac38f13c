#include "log_replayer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/body.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/clock.h"
#include "base/hashing.h"
#include "core/guard/own_process.h"
#include "core/host/given_state.h"
#include "core/recording/provenance.h"
#include "log_answers.h"
#include "log_mistakes.h"
#include "log_scenario.h"
#include "topic_watch.h"

namespace rehearse {

namespace fs = std::filesystem;

/// If all times are stamps, those of the log are converted by the delay of the first message.
void LogReplayer::convert_span() {
  span_ = options_.span;
  if (!times_->are_stamps()) return;
  const auto source =
      std::ranges::find_if(survey_.sources, [](const SourceSurvey& one) { return one.first.has_value(); });
  if (source == survey_.sources.end()) return;
  const std::int64_t delay = source->first_delay;
  span_.beginning -= delay;
  if (span_.begin) *span_.begin -= delay;
  if (span_.end) *span_.end -= delay;
  if (span_.compared_from > 0) span_.compared_from -= delay;
}

/// Determines the first tick and the number of ticks from the survey.
Result<void> LogReplayer::find_span() {
  Diagnostics missing;
  std::optional<std::int64_t> start, end, stated;
  const bool with_first = map_.start.when == StartRule::When::first;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const SourceSurvey& found = survey_.sources[i];
    if (!found.first) {
      const LogSource& source = *sources_[i].source;
      const std::string reason = found.timeless.empty() ? "" : ": the first has " + found.timeless[0].reason;
      const bool by_stamp = source.clock == LogClock::header_stamp && !reason.empty();
      missing.push_back(at(
          source.place, error(fmt::format("the log has no message on '{}'{}{}", source.topic,
                                          reason.empty() ? "" : " with a time", reason),
                              by_stamp ? "expected clock: log_time" : "take it out of the map, or use another log")));
      continue;
    }
    if (map_.start.when == StartRule::When::topic && sources_[i].source->topic == map_.start.topic)
      stated = found.first;
    if (!sources_[i].is_awaited() && !sources_[i].joystick) continue;
    end = std::max(end.value_or(found.last), found.last);
    if (!sources_[i].is_awaited()) continue;
    const std::int64_t there = with_first ? *found.first : *found.complete;
    if (!start) start = there;
    start = with_first ? std::min(*start, there) : std::max(*start, there);
  }
  for (Diagnostic& mistake : mistakes_in_names(sources_, survey_, *model_)) missing.push_back(std::move(mistake));
  if (!missing.empty()) return missing;
  if (!start) start = *survey_.sources[0].first;  // only a joystick
  if (stated) start = first_tick_with(*stated);
  *start += std::llround(map_.start.seconds * 1e9);
  if (span_.begin) start = std::max(*start, *span_.begin);
  *start += std::llround(static_cast<double>(options_.skip) * map_.time_step * 1e9);
  return make_ticks(*start, *end);
}

/// The time of the first tick for the first message of the topic that `start` names [ns]. A command comes after the
/// message of its tick.
std::int64_t LogReplayer::first_tick_with(std::int64_t message) const {
  const bool is_of_commands = map_.commands && map_.commands->topic == map_.start.topic;
  if (!is_of_commands || !map_.tick || map_.tick->topic == map_.start.topic) return message;
  const auto after = std::ranges::upper_bound(survey_.tick_messages, message);
  return after == survey_.tick_messages.begin() ? message : *(after - 1);
}

/// Makes ticks at the messages of the map's topic, or a grid up to `end` [ns].
Result<void> LogReplayer::make_ticks(std::int64_t start, std::int64_t end) {
  log_ticks_.emplace(start, map_.time_step);
  if (map_.tick) {
    REHEARSE_TRY(check_interval());
    auto plan = REHEARSE_TRY(TickPlan::make(map_, sources_, survey_));
    plan_.emplace(std::move(plan));
    log_ticks_ = plan_->ticks(survey_.tick_messages, start);
    if (!keeps_survey_) survey_.tick_messages = {};
    if (log_ticks_->size() == 0)
      return at(map_.tick->place,
                error(fmt::format("'{}' has no message after the first one of each input", map_.tick->topic),
                      "look at start"));
  }
  report_.start = log_ticks_->time(0);
  report_.begins = seconds_of(report_.start - span_.beginning);
  const double last = static_cast<double>(end - start) * 1e-9 / map_.time_step;
  double ticks = map_.tick ? static_cast<double>(log_ticks_->size()) : std::floor(last + 1e-6) + 1.0;
  if (span_.end) ticks = std::min(ticks, static_cast<double>(ticks_before(*span_.end, ticks)));
  if (span_.most_ticks) ticks = std::min(ticks, static_cast<double>(*span_.most_ticks));
  const double most = Scenario::max_duration / map_.time_step;
  if (ticks > most)
    return error_in(log_.name(),
                    fmt::format("it has {:.0f} s, and a recording has at most {:.0f}", ticks * map_.time_step,
                                Scenario::max_duration),
                    "limit the time: --until");
  if (ticks < 1.0)
    return error_in(log_.name(), "there is no tick to replay in the span that is asked for",
                    fmt::format("the first tick is {:.9g} s after the log's beginning", report_.begins));
  ticks_ = static_cast<std::int64_t>(ticks);
  return {};
}

/// The number of ticks before that time [ns], of so many.
std::int64_t LogReplayer::ticks_before(std::int64_t end, double all) const {
  constexpr std::int64_t rounding = 1;  // [ns]
  std::int64_t from = 0, to = static_cast<std::int64_t>(all);
  while (from < to) {
    const std::int64_t middle = from + (to - from) / 2;
    log_ticks_->time(middle) + rounding < end ? from = middle + 1 : to = middle;
  }
  return from;
}

/// Fails unless the nominal time step is the interval of the messages: missing messages are found by it.
Result<void> LogReplayer::check_interval() const {
  const auto source = std::ranges::find_if(
      sources_, [this](const MappedSource& mapped) { return mapped.source->topic == map_.tick->topic; });
  const double interval = seconds_of(survey_.sources[source - sources_.begin()].intervals.median());
  constexpr double allowed = 0.25;
  if (interval == 0.0 || std::abs(interval - map_.time_step) <= allowed * map_.time_step) return {};
  return at(map_.tick->place,
            error(fmt::format("the messages on '{}' are {:.5g} s apart (median), and time_step is {:g} s",
                              map_.tick->topic, interval, map_.time_step),
                  "a tick is one time step after the one before"));
}

Result<LogReplayReport> LogReplayer::run(const std::vector<LogTopic>& topics, std::string log_hash,
                                         const SurveyedLog* known) {
  report_.log_hash = std::move(log_hash);
  report_.has_commands = map_.commands.has_value();
  sources_ = sources_of(map_, *model_);
  times_ = known ? known->times : std::make_shared<LogTimes>(log_, sources_);
  survey_ = known ? known->survey : rehearse::survey(log_, map_, *model_, sources_, *times_);
  append_as_warnings(survey_.damage, report_.remarks);  // the undamaged data is used
  convert_span();
  REHEARSE_TRY(find_span());
  if (options_.tolerates_steps) survey_.ranges.tolerate_steps();
  observations_.emplace(map_, *model_, sources_, survey_, *log_ticks_, plan_ ? &*plan_ : nullptr);
  observations_->move_positions(options_.half_steps);
  REHEARSE_TRY(observations_->make_feeds(topics));
  for (const MappedSource& mapped : sources_)
    if (const auto clock = times_->clock_of(mapped.source->topic); clock && clock->steps > 0)
      observations_->doubt_distances();
  if (options_.memory) observations_->watch_order(*times_);
  auto made = REHEARSE_TRY(in_own_process<Fed>([this] { return feed(); }));
  if (options_.commands) *options_.commands = std::move(made.second);
  return std::move(made.first);
}

Result<LogReplayer::Fed> LogReplayer::feed() {
  times_->begin_pass();
  read_in_order(log_, channels_of(log_, sources_),
                [this](const mcap::Message& message) { return on_message(message); });
  if (errors_.empty())
    if (auto done = run_ticks_before(std::numeric_limits<std::int64_t>::max()); !done) errors_ = done.errors();
  if (!errors_.empty()) return errors_;
  REHEARSE_TRY(finish());
  return Fed(std::move(report_), options_.commands ? *options_.commands : CommandRecord());
}

bool LogReplayer::on_message(const mcap::Message& message) {
  if (times_->is_twin(message)) return true;
  const auto time = times_->of(message);
  if (!time) return true;
  // Messages that are logged from now on aren't earlier than this.
  const std::int64_t known = static_cast<std::int64_t>(message.log_time) - survey_.latest - observations_->lookahead();
  if (auto done = run_ticks_before(known); !done) errors_ = done.errors();
  if (!errors_.empty()) return false;
  observations_->take(*time, message);
  return !over_;
}

/// Runs all ticks before that time of the log [ns].
Result<void> LogReplayer::run_ticks_before(std::int64_t time) {
  // Up to the end of the tick whose commands are compared.
  const std::int64_t ahead = map_.commands ? std::max(0, map_.commands->shift) + 1 : 0;
  while (!over_ && log_ticks_->time((run_ ? run_->tick() : 0) + ahead) < time) {
    if (!run_) REHEARSE_TRY(begin());
    REHEARSE_TRY(take_state());
    const auto going_on = REHEARSE_TRY(run_->step());
    over_ =
        !going_on || run_->tick() == ticks_ || (options_.most_beyond && report_.ticks_beyond > *options_.most_beyond);
  }
  return {};
}

/// Makes the first tick: its posture becomes the scenario's, and the inputs of the controller are determined only now.
Result<void> LogReplayer::begin() {
  const BodyObservation& seen = observations_->look_first();
  if (Diagnostics unreadable = observations_->unreadable_sources(); !unreadable.empty()) return unreadable;
  for (Diagnostic& remark : observations_->take_remarks()) report_.remarks.push_back(std::move(remark));
  scenario_ = REHEARSE_TRY(make_scenario(seen));
  first_seen_.joints = seen.joints;
  first_seen_.links = {seen.links[0]};
  observations_->complete_posture(scenario_->bodies[0].joints);
  report_.begin.joints = scenario_->bodies[0].joints;
  report_.begin.has_joystick = map_.joystick.has_value();
  if (map_.root) report_.begin.root = LogStart::Root{seen.links[0].position, seen.links[0].rotation};
  report_.time_step = map_.time_step;
  report_.body = map_.body;
  report_.controller = map_.controller;
  return host_controller();
}

Result<void> LogReplayer::host_controller() {
  auto host = ControllerHost::create(*scenario_, options_);
  if (!host) {
    Diagnostics errors = host.errors();
    for (Diagnostic& finding : errors)  // the scenario has no file that the user wrote
      if (finding.file == scenario_->file) finding = error(finding.message, finding.hint);
    return errors;
  }
  host_ = std::move(*host);
  const GivenState none;
  Command at_rest = host_->initialize(initial_observation(*scenario_));
  if (Diagnostics missing = inputs_not_given(*host_, *model_, map_, sources_, survey_); !missing.empty())
    return missing;
  if (map_.commands) {
    const SourceSurvey* found = nullptr;
    for (std::size_t i = 0; i < sources_.size(); ++i)
      if (sources_[i].commands) found = &survey_.sources[i];
    auto comparable = check_commands(*host_, *model_, *map_.commands, *found, report_.remarks);
    if (!comparable) return comparable;
  }
  REHEARSE_TRY(state_tolerances());
  recorder_ = REHEARSE_TRY(Recorder::create(trace_, *scenario_, provenance_of_log()));
  descriptor_.emplace(recorder_->descriptor(), "the recording");
  REHEARSE_TRY(recorder_->attach("map.yaml", "application/yaml", map_.text));
  recorder_->declare(host_.get());
  host_->start();
  state_places_ = none.asked();
  REHEARSE_TRY(check_state());
  commands_.emplace(*host_, HostedCommands::Written::at_once);
  sink_.emplace(*recorder_, options_, span_.compared_from, map_, *scenario_, *observations_, report_);
  run_.emplace(map_.time_step, *observations_, *commands_, *sink_, 0, ticks_);
  run_->command = std::move(at_rest);
  run_->report_progress(options_.progress, ticks_);
  return sink_->record_events(host_->take_events());
}

/// States the tolerances of the commands, by their ranges in the log, in the scenario of the recording.
Result<void> LogReplayer::state_tolerances() {
  if (!map_.commands) return {};
  if (const auto steps = observations_->commands()->steps(*host_); options_.tolerates_steps && !steps.empty()) {
    Diagnostic& found = report_.remarks.emplace_back(
        at(map_.commands->place, warning(fmt::format("the commands on '{}' are rounded to steps: {}",
                                                     map_.commands->topic, fmt::join(steps, ", ")),
                                         "half a step is their tolerance; tolerances: in the map states another one")));
    found.severity = Severity::note;
  }
  auto stated = REHEARSE_TRY(make_scenario(first_seen_, observations_->commands()->tolerances(*host_)));
  scenario_->tolerances = std::move(stated.tolerances);  // the host keeps a reference to the scenario
  scenario_->text = std::move(stated.text);
  return {};
}

/// Fails unless the map's state has each number that the controller takes.
Result<void> LogReplayer::check_state() {
  if (!map_.state || host_->failure()) return {};
  const std::string& label = host_->controllers()[0].label;
  if (state_places_.empty())
    return at(map_.state->place, error(fmt::format("controller '{}' takes no state back", label),
                                       "expected calls of rehearse_state(), of rehearse_state.h, in its start(); or "
                                       "take 'state' out of the map"));
  for (const auto& [name, place] : state_places_)
    if (std::ranges::find(map_.state->names, std::optional(name)) == map_.state->names.end())
      return at(map_.state->place,
                error(fmt::format("controller '{}' takes '{}' back, which 'state' doesn't have", label, name),
                      "expected it in names, at the place of its number"));
  for (const std::optional<std::string>& name : map_.state->names)
    if (name && !state_places_.contains(*name))
      report_.remarks.push_back(
          at(map_.state->place, warning(fmt::format("controller '{}' doesn't take '{}' back", label, *name),
                                        "~ stands for a number that isn't used")));
  return {};
}

/// Where the controller's state isn't known, starts another one with the state in the log. At the tick of a trial the
/// other one gets the present state of the first.
Result<void> LogReplayer::take_state() {
  if (options_.restart_at == run_->tick()) {
    std::map<std::string, double> state;
    for (const auto& [name, place] : state_places_) state.emplace(name, *place);
    return start_again(std::move(state));
  }
  if (!map_.state || !options_.memory || sink_->knows_state()) return {};
  auto state = observations_->state_before(run_->tick());
  return state ? start_again(*std::move(state)) : Result<void>();
}

/// The new controller begins with the posture of the last tick. Its commands aren't recorded for a replay.
Result<void> LogReplayer::start_again(std::map<std::string, double> state) {
  host_->stop(run_->tick());
  if (host_->failure()) return {};
  commands_.reset();
  host_.reset();
  host_ = REHEARSE_TRY(ControllerHost::create(*scenario_, options_));
  const GivenState given(std::move(state));
  Observation begin = initial_observation(*scenario_);
  for (std::size_t id = 0; id < begin.bodies[0].joints.size(); ++id)
    begin.bodies[0].joints[id].q = observations_->seen().bodies[0].joints[id].q;
  host_->initialize(begin);
  host_->start();
  state_places_ = given.asked();
  commands_.emplace(*host_, HostedCommands::Written::at_once);  // at its old place, to which the run points
  sink_->know_state();
  return {};
}

Result<Scenario> LogReplayer::make_scenario(const BodyObservation& seen, std::vector<ToleranceRule> tolerances) {
  const fs::path model_file = fs::path(model_->source_file).filename();
  const std::string text =
      log_scenario_text({map_, *model_, model_file.string(), fs::path(log_.name()).filename().string(),
                         options_.controller, ticks_, seen, std::move(tolerances)});
  const Scenario::ModelSource model = [this](const std::string&, const UrdfOptions&) -> Result<Model> {
    return *model_;
  };
  auto scenario = Scenario::parse(text, trace_.string() + "/scenario.yaml", model);
  if (scenario && scenario->ticks() != ticks_)
    return error(fmt::format("{} ticks of {} s are no duration", ticks_, map_.time_step), "expected another time_step");
  return scenario;
}

/// The facts of the log and of the map.
mcap::StringMap LogReplayer::provenance_of_log() const {
  mcap::StringMap stated = provenance(*scenario_, host_.get(), "", "");
  stated[facts::source] = "log";
  stated[facts::log] = fs::path(log_.name()).filename().string() + " " + report_.log_hash;
  stated[facts::log_start] = std::to_string(report_.start);
  stated[facts::map] =
      fs::path(map_.file).filename().string() + " " + hash_text(hash_bytes(map_.text.data(), map_.text.size()));
  return stated;
}

void LogReplayer::report_topics() {
  report_.topics = observations_->report();
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    LogTopicReport& topic = report_.topics[i];
    for (const auto& [id, channel] : log_.channels())
      if (channel.topic == topic.topic && log_.schema_of(channel)) topic.type = log_.schema_of(channel)->name;
    const SourceSurvey& whole = survey_.sources[i];
    topic.clock = times_->clock_of(topic.topic);
    topic.unreadable += whole.without_time;
    for (LogUnreadable found : whole.timeless) {
      found.first_at -= static_cast<double>(report_.start) * 1e-9;
      topic.unreadable_for.push_back(std::move(found));
    }
    for (const LogUnreadable& found : topic.unreadable_for) warn_of(found, *sources_[i].source);
    topic.skipped += whole.messages - whole.without_time - topic.messages;  // after the last tick
    topic.messages = whole.messages;
    topic.twins = whole.twins;
    topic.out_of_order = whole.out_of_order;
  }
}

void LogReplayer::warn_of(const LogUnreadable& found, const LogSource& source) {
  const std::string amount = found.messages == 1 ? "1 message" : fmt::format("{} messages", found.messages);
  report_.remarks.push_back(at(source.place, warning(fmt::format("{} on '{}' can't be read: {} (the first at {:.3f} s)",
                                                                 amount, source.topic, found.reason, found.first_at),
                                                     "no tick uses them")));
}

void LogReplayer::report_ticks() {
  if (!map_.tick) return;
  LogTickReport& tick = report_.tick.emplace(plan_->report());
  for (std::int64_t i = 0; i < recorder_->size().ticks; ++i) tick.missing += log_ticks_->has_message(i) ? 0 : 1;
  for (std::size_t i = 0; i < sources_.size(); ++i)
    if (sources_[i].source->topic == tick.topic) tick.interval = seconds_of(survey_.sources[i].intervals.median());
  if (!map_.commands) tick.latency.reset();
}

/// Ends the recording, and makes the report of the topics.
Result<void> LogReplayer::finish() {
  REHEARSE_ASSERT(run_, "there is at least one tick");
  host_->stop(run_->tick());
  sink_->finish();
  report_.failure = run_->interruption() ? run_->interruption() : host_->failure();
  report_.controller_refused = host_->any_refused();
  report_.control_times = host_->control_times();
  REHEARSE_TRY(sink_->record_events(host_->take_events()));
  report_topics();
  report_ticks();
  count_without_inputs();
  REHEARSE_TRY(close_file());
  if (report_.has_commands && report_.values == 0 && !report_.failure)
    report_.remarks.push_back(
        at(map_.commands->place,
           warning(fmt::format("nothing was compared: '{}' has no number that the controller commands in these ticks",
                               map_.commands->topic),
                   "look at its joints and quantities, and at shift")));
  return {};
}

/// Counts the log's commands after the last tick, whose inputs the log lacks.
void LogReplayer::count_without_inputs() {
  const LogSpan& span = span_;
  if (!map_.commands || span.end || span.most_ticks || span.compared_from > report_.start || report_.failure) return;
  const auto source = std::ranges::find_if(sources_, [](const MappedSource& mapped) { return mapped.commands; });
  const std::int64_t last = survey_.sources[static_cast<std::size_t>(source - sources_.begin())].last;
  const double after = seconds_of(last - log_ticks_->time(recorder_->size().ticks)) / map_.time_step;
  if (after < ticks_of_an_end) return;
  report_.ticks_without_inputs = static_cast<std::int64_t>(std::floor(after + 1e-6)) + 1;
  report_.inputs_end = seconds_of(log_ticks_->time(recorder_->size().ticks - 1) - report_.start);
}

Result<void> LogReplayer::close_file() {
  const RecordingSize& size = recorder_->size();
  // A log has no state after the last tick.
  RunOutcome outcome{.ticks = size.ticks, .complete = false, .checkpoints = "none"};
  if (report_.failure) outcome.failure = report_.failure->message;
  for (const LogTopicReport& topic : report_.topics) {
    auto done = recorder_->add_metadata(records::log_topic + topic.topic, metadata_of(topic));
    if (!done) return done;
  }
  descriptor_.reset();
  report_.ticks = size.ticks;
  report_.channels = size.channels;
  report_.pictures = size.pictures;
  report_.duration = static_cast<double>(size.ticks) * map_.time_step;
  REHEARSE_TRY(recorder_->close(outcome));
  std::error_code ignored;
  report_.bytes = fs::file_size(trace_, ignored);
  return {};
}

}  // namespace rehearse
