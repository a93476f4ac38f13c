#include "log_observations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/clock.h"

namespace rehearse {
namespace {

/// Maximal number of gaps of one source that become events of the recording; its metadata has the number of all gaps.
constexpr std::int64_t max_gap_events = 20;

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

}  // namespace

bool LogObservations::may_miss_input() const {
  return std::ranges::any_of(fed_,
                             [](const Fed& fed) { return fed.feed && (fed.watch.may_miss() || fed.feed->may_miss()); });
}

Result<void> LogObservations::make_feeds(const std::vector<LogTopic>& topics) {
  const bool are_messages = map_.tick && !map_.tick->grid && !map_.tick->before_commands;
  ticks_are_inputs_ = are_messages && std::ranges::all_of(sources_, [&](const MappedSource& mapped) {
                        return !mapped.is_awaited() || mapped.source->topic == map_.tick->topic;
                      });
  for (const SourceSurvey& source : survey_.sources) ticks_are_inputs_ &= source.backwards == 0;
  for (const LogTopic& topic : topics)
    ticks_are_inputs_ &= !map_.tick || topic.name != map_.tick->topic || topic.has("header/stamp/sec");
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const MappedSource& mapped = sources_[i];
    const auto topic =
        std::ranges::find_if(topics, [&](const LogTopic& known) { return known.name == mapped.source->topic; });
    REHEARSE_ASSERT(topic != topics.end(), "the map was read against these topics");
    const ros2msg::Schema& schema = topic->definitions;
    const DurationCounts& intervals = survey_.sources[i].intervals;
    const bool may_miss = !(map_.skips_missing && map_.tick && map_.tick->topic == mapped.source->topic);
    const std::int64_t period = may_miss && intervals.is_regular() ? intervals.median() : 0;
    Fed& fed = fed_.emplace_back(Fed{mapped, nullptr, TopicWatch(mapped.source->max_age, period)});
    if (plan_) fed.watch.doubt(plan_->window_of(mapped.source->topic));
    if (mapped.joints) fed.feed = make_joint_feed(*mapped.joints, {map_.angles, half_steps_}, model_, schema);
    if (mapped.root) fed.feed = make_root_feed(*mapped.root, schema);
    if (mapped.joystick) fed.feed = make_joy_feed(*mapped.joystick, schema);
    if (mapped.devices) fed.feed = make_device_feed(*mapped.devices, model_, ticks_, *topic, schema);
    if (mapped.state) states_ = std::make_unique<LogStates>(*mapped.state, schema);
    if (mapped.commands) {
      const SourceSurvey& whole = survey_.sources[i];
      CommandFacts facts{survey_.largest_commands,    survey_.ranges, whole.messages, *whole.first, whole.last,
                         plan_ ? plan_->latency() : 0};
      commands_ = std::make_unique<LogCommands>(map_, model_, schema, ticks_, std::move(facts));
    }
    if (fed.feed) lookahead_ = std::max(lookahead_, period);
    if (plan_ && fed.feed) lookahead_ = std::max(lookahead_, plan_->window_of(mapped.source->topic).after + 1);
    if (mapped.source->sampling == Sampling::interpolate)
      lookahead_ = std::max(lookahead_, nanoseconds(*mapped.source->max_age));
  }
  return {};
}

void LogObservations::watch_order(LogTimes& times) {
  constexpr std::int64_t ticks_of_delay = 3;  // a message is hardly ever later
  times_ = &times;
  lookahead_ += nanoseconds(map_.time_step) * ticks_of_delay;
  for (Fed& fed : fed_)
    if (fed.mapped.source->clock == LogClock::log_time) fed.order.emplace(map_.time_step);
}

void LogObservations::take(std::int64_t time, const mcap::Message& message) {
  for (Fed& fed : fed_) {
    if (!fed.mapped.source->is_on(message.channel->topic)) continue;
    if (fed.order) fed.order->add(message, times_->stamp_of(message));
    if (!fed.watch.came(time)) continue;
    Result<void> taken;
    if (fed.feed) taken = fed.feed->take(time, message.data);
    if (fed.mapped.commands) taken = commands_->take(time, message.data);
    if (fed.mapped.state && times_) taken = states_->take(time, message.data);
    ++fed.readable;
    if (!taken) reject(fed, time, taken.errors()[0]);
  }
}

void LogObservations::reject(Fed& fed, std::int64_t time, const Diagnostic& reason) {
  constexpr std::size_t most_reasons = 5;
  --fed.readable;
  fed.watch.reject(time);
  if (!fed.unreadable_first) fed.unreadable_first = reason;
  const auto same = [&](const LogUnreadable& known) { return known.reason == reason.message; };
  auto known = std::ranges::find_if(fed.unreadable_for, same);
  if (known == fed.unreadable_for.end()) {
    if (fed.unreadable_for.size() == most_reasons) return;
    known = fed.unreadable_for.insert(known, {reason.message, 0, seconds_of(time - ticks_.time(0))});
  }
  ++known->messages;
}

Diagnostics LogObservations::unreadable_sources() const {
  Diagnostics found;
  for (const Fed& fed : fed_)
    if (fed.readable == 0 && fed.unreadable_first)
      found.push_back(
          at(fed.mapped.source->place, error(fmt::format("no message on '{}' can be read: the first has {}",
                                                         fed.mapped.source->topic, fed.unreadable_first->message),
                                             fed.unreadable_first->hint)));
  return found;
}

/// Reads all sources at the tick.
void LogObservations::look(std::int64_t tick) {
  const LogMoment moment{ticks_.time(tick), tick, time_of(tick, map_.time_step)};
  doubts_inputs_ = doubts_commands_ = false;
  for (Fed& fed : fed_) {
    if (fed.feed) {
      fed.feed->look(moment, seen_);
      for (const UnreadableMessage& message : fed.feed->take_unreadable()) reject(fed, message.time, message.reason);
      for (const std::string& joint : fed.feed->take_silences())
        add_gap_event(fed, tick, fmt::format("of joint {} on", joint));
    }
    if (fed.order && fed.order->doubts(moment.time) && (fed.feed || fed.mapped.commands))
      (fed.feed ? doubts_inputs_ : doubts_commands_) = true;
    const bool both_sides = fed.mapped.source->sampling == Sampling::interpolate;
    const auto age = fed.watch.look(moment.time, moment.seconds, both_sides);
    if (fed.feed && age == TopicWatch::Age::gap_begins) add_gap_event(fed, tick, "on");
  }
}

std::optional<std::map<std::string, double>> LogObservations::state_before(std::int64_t tick) {
  if (!states_ || tick == 0) return std::nullopt;
  return states_->in(ticks_.time(tick - 1), ticks_.time(tick));
}

void LogObservations::add_gap_event(Fed& fed, std::int64_t tick, std::string what) {
  if (++fed.gap_events > max_gap_events) return;
  msg::Event& event = gap_events_.emplace_back();
  event.stamp = msg::Time::from_ns(nanoseconds_of(tick, map_.time_step));
  event.tick = tick;
  event.severity = to_string(Severity::warning);
  event.source = "log";
  event.text = fmt::format("nothing {} {} for more than {} s: its last value is held{}", what, fed.mapped.source->topic,
                           *fed.mapped.source->max_age,
                           fed.gap_events == max_gap_events ? "; further gaps of it are counted only" : "");
}

/// Computes the poses of links from the joints and the root link; velocities are available for the root alone.
void LogObservations::place_links() {
  BodyObservation& body = seen_.bodies[0];
  std::vector<double> q;
  for (const JointReading& joint : body.joints) q.push_back(joint.q);
  const std::vector<Eigen::Isometry3d> poses = forward_kinematics(model_, pose_of(body.links[0]), q);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    body.links[i].position = poses[i].translation();
    body.links[i].rotation = Eigen::Quaterniond(poses[i].linear()).normalized();
  }
}

const BodyObservation& LogObservations::look_first() {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  BodyObservation& body = seen_.bodies.emplace_back();
  body.joints.assign(model_.joints.size(), {unknown, unknown, 0.0, unknown});
  body.links.resize(model_.links.size());
  body.devices.resize(model_.devices.size());
  if (map_.joystick) seen_.joystick.emplace();
  look(0);
  return body;
}

bool LogObservations::has_position(int joint) const {
  return std::ranges::any_of(fed_, [joint](const Fed& fed) { return fed.feed && fed.feed->has_position(joint); });
}

void LogObservations::complete_posture(const std::vector<double>& joints) {
  BodyObservation& body = seen_.bodies[0];
  for (std::size_t id = 0; id < body.joints.size(); ++id)
    if (!has_position(static_cast<int>(id))) body.joints[id].q = joints[id];
  place_links();
}

Diagnostics LogObservations::take_remarks() {
  Diagnostics remarks;
  for (Fed& fed : fed_)
    if (fed.feed)
      for (Diagnostic& remark : fed.feed->take_remarks()) remarks.push_back(std::move(remark));
  return remarks;
}

Result<bool> LogObservations::observe(TickData& now) {
  if (now.tick > 0) {
    for (DeviceReading& device : seen_.bodies[0].devices) device.fresh = false;
    look(now.tick);
    place_links();
  }
  now.seen = now.read = &seen_;
  now.events = std::exchange(gap_events_, {});
  return true;
}

/// Only advances the tick: the robot of the log has moved by itself.
Result<bool> LogObservations::advance(TickData& now, Commander& commands) {
  commands.act_late(now);
  return true;
}

std::vector<LogTopicReport> LogObservations::report() const {
  std::vector<LogTopicReport> topics;
  for (const Fed& fed : fed_) {
    LogTopicReport& topic = topics.emplace_back();
    fed.watch.report(topic, ticks_.time(0));
    topic.topic = fed.mapped.source->topic;
    topic.use = fed.mapped.use;
    topic.unreadable_for = fed.unreadable_for;
    if (!fed.feed) continue;
    topic.silent_joints = fed.feed->silent_joints();
    topic.strangers = fed.feed->strangers();
    for (LogStranger& stranger : topic.strangers)
      stranger.first_at = (stranger.first_at - static_cast<double>(ticks_.time(0))) * 1e-9;
  }
  return topics;
}

}  // namespace rehearse
