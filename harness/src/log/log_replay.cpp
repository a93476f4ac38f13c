#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/clock.h>
#include <rehearse/log_replay.h>
#include <rehearse/urdf.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "host/controller_host.h"
#include "host/float_mode.h"
#include "host/process_guard.h"
#include "log_commands.h"
#include "log_feed.h"
#include "log_requirements.h"
#include "log_scenario.h"
#include "log_survey.h"
#include "recording/hashing.h"
#include "recording/provenance.h"
#include "recording/recorder.h"
#include "topic_watch.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// So many gaps of one source are events of the recording; how many there were stands in its metadata.
constexpr std::int64_t max_gap_events = 20;

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

Diagnostic in_file(const std::string& file, Diagnostic diagnostic) {
  diagnostic.file = file;
  return diagnostic;
}

/// What is missing of a log is said, and what is there is used.
void warn(Diagnostics& remarks, Diagnostics findings) {
  for (Diagnostic& finding : findings) {
    finding.severity = Severity::warning;
    remarks.push_back(std::move(finding));
  }
}

/// Of all its bytes.
Result<std::string> hash_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> block(1 << 20);
  std::uint64_t hash = 0;
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash = hash_bytes(block.data(), static_cast<std::size_t>(stream.gcount()), hash);
  }
  if (!stream.eof()) return in_file(file.string(), error("it can't be read"));
  return hash_text(hash);
}

/// A source while it is fed.
struct Fed {
  const MappedSource& mapped;
  std::unique_ptr<LogFeed> feed;  // null: of commands
  TopicWatch watch;
  std::int64_t unreadable = 0;
  std::int64_t gap_events = 0;
};

class LogReplayer {
 public:
  LogReplayer(mcap::Reader& log, const LogMap& map, std::shared_ptr<const Model> model, const fs::path& trace,
              const LogReplayOptions& options)
      : log_(log), map_(map), model_(std::move(model)), trace_(trace), options_(options), times_(log, map.clock) {}

  Result<LogReplayReport> run(const std::vector<LogTopic>& topics, std::string log_hash);

 private:
  Result<void> find_span();
  Result<void> make_feeds(const std::vector<LogTopic>& topics);
  bool on_message(const mcap::Message& message);
  Result<void> run_ticks_before(std::int64_t time);
  Result<bool> run_tick();
  Result<void> look(Observation& seen);
  void place_links(Observation& seen) const;
  Result<void> begin();
  Result<Scenario> make_scenario();
  mcap::StringMap facts() const;
  Result<void> record_tick();
  Result<void> record_events(std::vector<msg::Event> events);
  void compare();
  Result<void> finish();
  std::int64_t time_of_tick(std::int64_t tick) const;

  mcap::Reader& log_;
  const LogMap& map_;
  std::shared_ptr<const Model> model_;
  const fs::path& trace_;
  const LogReplayOptions& options_;
  LogTimes times_;
  std::vector<MappedSource> sources_;
  LogSurvey survey_;
  std::vector<Fed> fed_;  // parallel to sources_
  std::unique_ptr<LogCommands> commands_;
  std::int64_t ticks_ = 0;      // to be run
  std::int64_t tick_ = 0;       // the next one
  std::int64_t lookahead_ = 0;  // what lies so far behind a tick may still matter to it [ns]
  Observation seen_;
  std::optional<Scenario> scenario_;
  std::unique_ptr<ControllerHost> host_;
  std::unique_ptr<Recorder> recorder_;
  std::optional<ProtectedDescriptor> descriptor_;  // the recorder's
  Command command_;
  std::vector<msg::Event> gap_events_;
  Diagnostics errors_;
  LogReplayReport report_;
};

std::int64_t LogReplayer::time_of_tick(std::int64_t tick) const {
  if (tick < 0) return report_.start - static_cast<std::int64_t>(nanoseconds_of(-tick, map_.time_step));
  return report_.start + static_cast<std::int64_t>(nanoseconds_of(tick, map_.time_step));
}

/// The first tick and how many there are, by what the survey found.
Result<void> LogReplayer::find_span() {
  Diagnostics missing;
  std::optional<std::int64_t> start, end;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const SourceSurvey& found = survey_.sources[i];
    if (!found.first) {
      const bool no_time = found.without_time > 0;
      missing.push_back(at(sources_[i].source->place,
                           error(fmt::format("the log has no message on '{}'{}", sources_[i].source->topic,
                                             no_time ? " whose header.stamp is a time" : ""),
                                 no_time ? "expected clock: log_time" : "take it out of the map, or use another log")));
      continue;
    }
    if (!sources_[i].is_awaited() && !sources_[i].joystick) continue;
    end = std::max(end.value_or(found.last), found.last);
    if (!sources_[i].is_awaited()) continue;
    const std::int64_t there = map_.start_with_first ? *found.first : *found.complete;
    if (!start) start = there;
    start = map_.start_with_first ? std::min(*start, there) : std::max(*start, there);
  }
  if (!missing.empty()) return missing;
  if (!start) start = *survey_.sources[0].first;  // nothing but a joystick
  report_.start = *start;
  const double last = static_cast<double>(*end - *start) * 1e-9 / map_.time_step;
  double ticks = std::floor(last + 1e-6) + 1.0;
  if (options_.until) ticks = std::min(ticks, std::ceil(*options_.until / map_.time_step - 1e-6));
  const double most = Scenario::max_duration / map_.time_step;
  if (ticks > most)
    return in_file(log_.name(), error(fmt::format("it has {:.0f} s, and a recording has at most {:.0f}",
                                                  ticks * map_.time_step, Scenario::max_duration),
                                      "say until when: --until"));
  if (ticks < 1.0) return in_file(log_.name(), error("there is no tick to replay", "look at --until"));
  ticks_ = static_cast<std::int64_t>(ticks);
  return {};
}

Result<void> LogReplayer::make_feeds(const std::vector<LogTopic>& topics) {
  lookahead_ = 0;
  for (const MappedSource& mapped : sources_) {
    const auto topic = std::find_if(topics.begin(), topics.end(),
                                    [&](const LogTopic& known) { return known.name == mapped.source->topic; });
    REHEARSE_ASSERT(topic != topics.end(), "the map was read against these topics");
    const auto schema = ros2msg::Schema::parse(topic->type, topic->schema);
    if (!schema) return schema.errors();
    Fed& fed = fed_.emplace_back(Fed{mapped, nullptr, TopicWatch(mapped.source->max_age)});
    if (mapped.joints) fed.feed = make_joint_feed(*mapped.joints, *model_, *schema);
    if (mapped.root) fed.feed = make_root_feed(*mapped.root, *schema);
    if (mapped.joystick) fed.feed = make_joy_feed(*mapped.joystick, *schema);
    if (mapped.devices)
      fed.feed =
          make_device_feed(*mapped.devices, *model_, {report_.start, map_.time_step, map_.clock}, *topic, *schema);
    if (mapped.commands) {
      commands_ = std::make_unique<LogCommands>(map_, *model_, *schema);
      lookahead_ = std::max(lookahead_, nanoseconds(map_.time_step * (std::max(0, map_.commands->shift) + 1)));
    }
    if (mapped.source->sampling == Sampling::interpolate)
      lookahead_ = std::max(lookahead_, nanoseconds(*mapped.source->max_age));
  }
  return {};
}

Result<LogReplayReport> LogReplayer::run(const std::vector<LogTopic>& topics, std::string log_hash) {
  report_.log_hash = std::move(log_hash);
  report_.has_commands = map_.commands.has_value();
  sources_ = sources_of(map_, *model_);
  survey_ = survey(log_, map_, *model_, sources_);
  warn(report_.remarks, survey_.damage);
  if (auto found = find_span(); !found) return found.errors();
  if (auto made = make_feeds(topics); !made) return made.errors();
  read_in_order(log_, channels_of(log_, sources_),
                [this](const mcap::Message& message) { return on_message(message); });
  if (errors_.empty())
    if (auto done = run_ticks_before(std::numeric_limits<std::int64_t>::max()); !done) errors_ = done.errors();
  if (!errors_.empty()) return errors_;
  if (auto done = finish(); !done) return done.errors();
  return std::move(report_);
}

bool LogReplayer::on_message(const mcap::Message& message) {
  const auto time = times_.of(message);
  if (!time) return true;
  // whatever is logged from now on isn't earlier than this
  const std::int64_t known = static_cast<std::int64_t>(message.log_time) - survey_.latest - lookahead_;
  if (auto done = run_ticks_before(known); !done) errors_ = done.errors();
  if (!errors_.empty()) return false;
  for (Fed& fed : fed_) {
    if (fed.mapped.source->topic != message.channel->topic || !fed.watch.came(*time)) continue;
    const bool fits = fed.feed ? fed.feed->take(*time, message.data) : commands_->take(*time, message.data);
    fed.unreadable += fits ? 0 : 1;
  }
  return tick_ < ticks_;
}

/// All ticks before that time of the log [ns].
Result<void> LogReplayer::run_ticks_before(std::int64_t time) {
  while (tick_ < ticks_ && time_of_tick(tick_) < time) {
    const auto going_on = run_tick();
    if (!going_on) return going_on.errors();
    if (!*going_on) ticks_ = tick_;
  }
  return {};
}

/// False: the replay ends with it.
Result<bool> LogReplayer::run_tick() {
  if (tick_ == 0) {
    if (auto begun = begin(); !begun) return begun.errors();
    if (host_->failure()) return false;
  } else {
    for (DeviceReading& device : seen_.bodies[0].devices) device.fresh = false;
    if (auto looked = look(seen_); !looked) return looked.errors();
    place_links(seen_);
  }
  const bool alive = host_->control(tick_, seen_);
  host_->output(Timing::same_step, command_);  // says what isn't finite
  host_->output(Timing::next_step, command_);
  if (auto done = record_tick(); !done) return done.errors();
  if (!alive) return false;
  compare();
  ++tick_;
  if (options_.progress && tick_ % std::max<std::int64_t>(1, ticks_ / 100) == 0) options_.progress(tick_, ticks_);
  return true;
}

/// What all sources know at the tick.
Result<void> LogReplayer::look(Observation& seen) {
  const LogMoment moment{time_of_tick(tick_), tick_, time_of(tick_, map_.time_step)};
  for (Fed& fed : fed_) {
    const bool both_sides = fed.mapped.source->sampling == Sampling::interpolate;
    const auto age = fed.watch.look(moment.time, moment.seconds, both_sides);
    if (!fed.feed) continue;
    if (auto looked = fed.feed->look(moment, seen); !looked) return looked;
    if (age != TopicWatch::Age::gap_begins || ++fed.gap_events > max_gap_events) continue;
    msg::Event& event = gap_events_.emplace_back();
    event.stamp = msg::Time::from_ns(nanoseconds_of(tick_, map_.time_step));
    event.tick = tick_;
    event.severity = to_string(Severity::warning);
    event.source = "log";
    event.text = fmt::format("nothing on {} for more than {} s: its last value is held{}", fed.mapped.source->topic,
                             *fed.mapped.source->max_age,
                             fed.gap_events == max_gap_events ? "; further gaps of it are counted only" : "");
  }
  return {};
}

/// Where the links are follows from the joints and the root link; how they move is known of the root alone.
void LogReplayer::place_links(Observation& seen) const {
  BodyObservation& body = seen.bodies[0];
  Eigen::Isometry3d root = Eigen::Isometry3d::Identity();
  root.translation() = body.links[0].position;
  root.linear() = body.links[0].rotation.toRotationMatrix();
  std::vector<double> q;
  for (const JointReading& joint : body.joints) q.push_back(joint.q);
  const std::vector<Eigen::Isometry3d> poses = forward_kinematics(*model_, root, q);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    body.links[i].position = poses[i].translation();
    body.links[i].rotation = Eigen::Quaterniond(poses[i].linear()).normalized();
  }
}

/// The first tick: its posture is the scenario's, and only now is it clear what a controller reads.
Result<void> LogReplayer::begin() {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  BodyObservation& body = seen_.bodies.emplace_back();
  body.joints.assign(model_->joints.size(), {unknown, unknown, 0.0, unknown});
  body.links.resize(model_->links.size());
  body.devices.resize(model_->devices.size());
  if (map_.joystick) seen_.joystick.emplace();
  if (auto looked = look(seen_); !looked) return looked;
  for (Fed& fed : fed_)
    if (fed.feed)
      for (Diagnostic& remark : fed.feed->take_remarks()) report_.remarks.push_back(std::move(remark));
  auto scenario = make_scenario();
  if (!scenario) return scenario.errors();
  scenario_ = *std::move(scenario);
  for (std::size_t id = 0; id < body.joints.size(); ++id)
    if (std::isnan(body.joints[id].q)) body.joints[id].q = scenario_->bodies[0].joints[id];
  place_links(seen_);

  auto host = ControllerHost::create(*scenario_, options_);
  if (!host) {
    Diagnostics errors = host.errors();
    for (Diagnostic& finding : errors)  // nobody wrote the scenario that they are told of
      if (finding.file == scenario_->file) finding = error(finding.message, finding.hint);
    return errors;
  }
  host_ = std::move(*host);
  command_ = host_->initialize(initial_observation(*scenario_));
  if (Diagnostics missing = inputs_not_given(*host_, *model_, map_, sources_, survey_); !missing.empty())
    return missing;
  auto recorder = Recorder::create(trace_, *scenario_, facts());
  if (!recorder) return recorder.errors();
  recorder_ = std::move(*recorder);
  descriptor_.emplace(recorder_->descriptor(), "the recording");
  if (auto done = recorder_->attach("map.yaml", "application/yaml", map_.text); !done) return done;
  recorder_->declare(host_.get());
  host_->start();
  return record_events(host_->take_events());
}

Result<Scenario> LogReplayer::make_scenario() {
  const fs::path model_file = fs::path(model_->source_file).filename();
  const std::string text =
      log_scenario_text({map_, *model_, model_file.string(), fs::path(log_.name()).filename().string(),
                         options_.controller, ticks_, seen_.bodies[0]});
  const Scenario::ModelSource model = [this](const std::string&, const UrdfOptions&) -> Result<Model> {
    return *model_;
  };
  auto scenario = Scenario::parse(text, trace_.string() + "/scenario.yaml", model);
  if (scenario && scenario->ticks() != ticks_)
    return error(fmt::format("{} ticks of {} s are no duration", ticks_, map_.time_step), "expected another time_step");
  return scenario;
}

/// Which log, and which map.
mcap::StringMap LogReplayer::facts() const {
  mcap::StringMap facts = provenance(*scenario_, host_.get(), "", "");
  facts["source"] = "log";
  facts["log"] = fs::path(log_.name()).filename().string() + " " + report_.log_hash;
  facts["log.start"] = std::to_string(report_.start);
  facts["map"] =
      fs::path(map_.file).filename().string() + " " + hash_text(hash_bytes(map_.text.data(), map_.text.size()));
  return facts;
}

Result<void> LogReplayer::record_tick() {
  if (auto done = recorder_->record_state(tick_, seen_, seen_); !done) return done;
  // there is no simulation whose state could have a hash
  if (auto done = recorder_->record_tick(tick_, host_.get(), {0, host_->input_hash(seen_), host_->output_hash()});
      !done)
    return done;
  if (auto done = record_events(std::exchange(gap_events_, {})); !done) return done;
  return record_events(host_->take_events());
}

Result<void> LogReplayer::record_events(std::vector<msg::Event> events) {
  for (const msg::Event& event : events)
    if (event.source != "log") append_remarks({event}, report_.remarks);  // gaps are told by topic
  return recorder_->record_events(events);
}

void LogReplayer::compare() {
  if (!commands_) return;
  const double now = time_of(tick_, map_.time_step);
  if (now < options_.from) return;
  const std::int64_t wanted = tick_ + map_.commands->shift;
  bool differs = false;
  const std::int64_t compared =
      commands_->compare(time_of_tick(wanted), time_of_tick(wanted + 1), *host_, *scenario_, [&](Divergence&& found) {
        found.tick = tick_;
        found.time = now;
        differs = true;
        ++report_.values_different;
        if (!report_.beyond && !(found.difference <= found.tolerance)) report_.beyond = found;
        if (!report_.worst || found.difference > report_.worst->difference) report_.worst = found;
        if (options_.on_difference) options_.on_difference(found);
        if (!report_.first) report_.first = std::move(found);
      });
  report_.values += compared;
  report_.ticks_compared += compared > 0 ? 1 : 0;
  report_.ticks_different += differs ? 1 : 0;
}

/// The recording's end, and what is to be said of the topics.
Result<void> LogReplayer::finish() {
  REHEARSE_ASSERT(recorder_, "there is at least one tick");
  host_->stop(tick_);
  report_.failure = host_->failure();
  report_.controller_refused = host_->any_refused();
  if (auto done = record_events(host_->take_events()); !done) return done;
  for (std::size_t i = 0; i < fed_.size(); ++i) {
    LogTopicReport& topic = report_.topics.emplace_back();
    fed_[i].watch.report(topic, report_.start);
    topic.topic = sources_[i].source->topic;
    topic.use = sources_[i].use;
    for (const auto& [id, channel] : log_.channels())
      if (channel.topic == topic.topic && log_.schema_of(channel)) topic.type = log_.schema_of(channel)->name;
    const SourceSurvey& whole = survey_.sources[i];
    topic.unreadable = fed_[i].unreadable + (fed_[i].feed ? fed_[i].feed->unreadable() : 0) + whole.without_time;
    topic.skipped += whole.messages - whole.without_time - topic.messages;  // behind the last tick
    topic.messages = whole.messages;
    topic.out_of_order = whole.out_of_order;
  }
  const RecordingSize& size = recorder_->size();
  mcap::StringMap outcome{
      {"ticks", std::to_string(size.ticks)}, {"complete", report_.failure ? "false" : "true"}, {"checkpoints", "none"}};
  if (report_.failure) outcome["failure"] = report_.failure->message;
  for (const LogTopicReport& topic : report_.topics) {
    auto done = recorder_->add_metadata("rehearse.log " + topic.topic, metadata_of(topic));
    if (!done) return done;
  }
  descriptor_.reset();
  report_.ticks = size.ticks;
  report_.channels = size.channels;
  report_.frames = size.frames;
  report_.duration = static_cast<double>(size.ticks) * map_.time_step;
  if (auto done = recorder_->close(outcome); !done) return done;
  std::error_code ignored;
  report_.bytes = fs::file_size(trace_, ignored);
  if (report_.has_commands && report_.values == 0 && !report_.failure) {
    Diagnostic& remark = report_.remarks.emplace_back(
        at(map_.commands->place,
           error(fmt::format("nothing was compared: '{}' has none of what the controller commands in these ticks",
                             map_.commands->topic),
                 "look at its joints and quantities, and at shift")));
    remark.severity = Severity::warning;
  }
  return {};
}

}  // namespace

Result<LogReplayReport> replay_log(const fs::path& log, const fs::path& trace, const LogReplayOptions& options) {
  const StandardFloatMode float_mode;
  auto reader = mcap::Reader::open(log);
  if (!reader) return reader.errors();
  const std::vector<LogTopic> topics = topics_of(**reader);
  if (topics.empty()) return in_file(log.string(), error("it holds no channel", "expected a ROS 2 bag in MCAP"));
  UrdfOptions urdf;
  urdf.meshes = UrdfOptions::Meshes::skip;  // nothing is touched, and nothing drawn
  auto model = load_urdf(options.model, urdf);
  if (!model) return model.errors();
  auto map = LogMap::load(options.map, *model, topics);
  if (!map) return map.errors();
  std::error_code ignored;
  if (fs::equivalent(log, trace, ignored))
    return in_file(trace.string(), error("that is the log itself", "name another file for the recording"));
  auto hash = hash_of(log);
  if (!hash) return hash.errors();
  LogReplayer replayer(**reader, *map, std::make_shared<const Model>(*std::move(model)), trace, options);
  auto report = replayer.run(topics, *std::move(hash));
  if (report)
    for (Diagnostic& remark : float_mode.remarks()) report->remarks.push_back(std::move(remark));
  return report;
}

}  // namespace rehearse
