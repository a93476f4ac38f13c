#include "log_causes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "base/clock.h"
#include "core/kinds/channel_name.h"

namespace rehearse {
namespace {

/// A common time step near that interval [s]: 1, 2, 2.5, 4, 5 or 8 times a power of ten if it is within 1 %.
double common_step(double interval) {
  const double decade = std::pow(10.0, std::floor(std::log10(interval)));
  for (const double digit : {1.0, 2.0, 2.5, 4.0, 5.0, 8.0, 10.0})
    if (std::abs(interval - digit * decade) <= 0.01 * interval) return digit * decade;
  return interval;
}

class Readings {
 public:
  Readings(const LogMap& map, const std::vector<MappedSource>& sources, const LogSurvey& survey,
           const std::vector<LogTopic>& topics, const Model& model, const LogReplayReport& report)
      : map_(map), sources_(sources), survey_(survey), topics_(topics), model_(model), report_(report) {}

  std::vector<OtherReading> take() {
    if (!map_.tick) add_other_ticks();
    add_other_clock();
    add_other_starts();
    add_skipping();
    add_restart();
    add_limits();
    add_zeros();
    add_later_names();
    add_angles();
    if (map_.tick) add_other_ticks();
    return std::move(readings_);
  }

 private:
  LogMap& add(std::vector<std::string> lines, std::string meaning) {
    return readings_.emplace_back(OtherReading{map_, std::move(lines), std::move(meaning)}).map;
  }

  /// Each topic that sends regularly.
  void add_other_ticks() {
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      const LogSource& source = *sources_[i].source;
      const DurationCounts& intervals = survey_.sources[i].intervals;
      if (!(sources_[i].is_awaited() || sources_[i].commands) || !intervals.is_regular()) continue;
      if (map_.tick && map_.tick->topic == source.topic) continue;
      const double interval = seconds_of(intervals.median());
      const bool is_of_step = std::abs(interval - map_.time_step) <= 0.25 * map_.time_step;
      const double step = is_of_step ? map_.time_step : common_step(interval);
      if (step < Scenario::min_time_step || step > Scenario::max_time_step) continue;
      std::vector<std::string> lines{"tick: " + source.topic};
      if (!is_of_step) lines.push_back(fmt::format("time_step: {:g}", step));
      LogMap& map = add(std::move(lines), fmt::format("the controller is called at each message on {}", source.topic));
      readings_.back().has_same_messages = false;
      map.time_step = step;
      static_cast<LogSource&>(map.tick.emplace()) = source;
    }
  }

  /// Calls `change` with all sources of a map that have a header.
  template <class Change>
  void each_with_stamps(LogMap& map, Change&& change) const {
    const auto look = [&](LogSource& source) {
      const auto topic = std::ranges::find_if(topics_, [&](const LogTopic& one) { return one.name == source.topic; });
      if (topic != topics_.end() && topic->has("header/stamp/sec")) change(source);
    };
    map.each_source(look);
  }

  void add_other_clock() {
    for (const LogClock clock : {LogClock::header_stamp, LogClock::log_time}) {
      LogMap changed = map_;
      bool is_another = false;
      each_with_stamps(changed, [&](LogSource& source) { is_another |= std::exchange(source.clock, clock) != clock; });
      if (!is_another) continue;
      const bool by_stamps = clock == LogClock::header_stamp;
      add({by_stamps ? "clock: header.stamp" : "clock: log_time"},
          by_stamps ? "messages have the order and the times of their stamps"
                    : "messages have the order and the times of the log") = std::move(changed);
      readings_.back().has_same_messages = false;
    }
  }

  void add_start(const StartRule& start, const std::string& value, std::string meaning) {
    if (start.when == map_.start.when && start.topic == map_.start.topic) return;
    add({"start: " + value}, "the controller starts " + std::move(meaning)).start = start;
  }

  void add_other_starts() {
    if (map_.start.when == StartRule::When::time) return;
    add_start({StartRule::When::first, "", 0.0}, "first", "with the first message of an input");
    add_start({StartRule::When::all, "", 0.0}, "all", "when each input has had a message");
    std::set<std::string> tried;
    for (const MappedSource& mapped : sources_) {
      const std::string& topic = mapped.source->topic;
      if ((!mapped.is_awaited() && !mapped.commands && !mapped.joystick) || !tried.insert(topic).second) continue;
      add_start({StartRule::When::topic, topic, 0.0}, topic, "with the first message on " + topic);
    }
  }

  void add_skipping() {
    if (!map_.tick || map_.tick->grid || map_.skips_missing || !report_.tick || report_.tick->missing == 0) return;
    add({"missing: skip"}, "the controller isn't called where messages are missing").skips_missing = true;
  }

  /// A fresh controller from the first difference on.
  void add_restart() {
    const std::int64_t tick = report_.beyond->tick;
    if (tick == 0) return;
    const double step = report_.duration / static_cast<double>(report_.ticks);
    // Before the tick by less than half a step, so that it is the first.
    const double time = std::round((report_.beyond_at - 0.25 * step) * 1e6) * 1e-6;
    std::vector<double> all = map_.restarts;
    all.push_back(std::round((report_.begins + time) * 1e6) * 1e-6);
    std::ranges::stable_sort(all);
    LogMap& map = add({fmt::format("restart: [{:.9g}]", fmt::join(all, ", "))},
                      fmt::format("another controller starts at {:.6g} s", report_.begins + report_.beyond_at));
    map.begins_with_controller = true;
    readings_.back().begin = time;
  }

  const std::string& name_of(int joint) const { return model_.links[model_.joints[joint]].joint.name; }

  /// Commands that reach the same magnitude again and again.
  void add_limits() {
    if (!map_.limits.empty()) return;
    LogMap changed = map_;
    std::vector<std::string> entries;
    for (int joint = 0; joint < static_cast<int>(model_.joints.size()); ++joint) {
      const bool slides = is_linear(model_.links[model_.joints[joint]].joint.type);
      for (const auto& [part, quantity] : {std::pair(&CommandedJoint::u, "u"), std::pair(&CommandedJoint::q, "q"),
                                           std::pair(&CommandedJoint::dq, "dq")}) {
        const double limit = survey_.ranges.limit(joint, part);
        if (limit == 0.0) continue;
        changed.limits[joint] = limit;
        entries.push_back(fmt::format("{}: {} {}", name_of(joint), limit, unit_of_joint(quantity, slides)));
        break;
      }
    }
    if (entries.empty()) return;
    add({fmt::format("limits: {{{}}}", fmt::join(entries, ", "))}, "the commands are clipped before they are logged") =
        std::move(changed);
  }

  void add_zeros() {
    if (map_.zeros_are_foreign || !survey_.ranges.has_zeros()) return;
    add({"zeros: unknown"}, "messages whose commands are all 0 aren't the controller's, as in an emergency stop")
        .zeros_are_foreign = true;
  }

  /// A joint without messages from the time on at which an unknown name begins.
  void add_later_names() {
    constexpr double longest_pause = 20.0;  // [time steps]
    for (const LogTopicReport& topic : report_.topics) {
      LogMap changed = map_;
      std::vector<std::string> entries;
      for (const SilentJoint& silent : topic.silent_joints) {
        const double last = silent.worst_age_at - silent.worst_age;
        const auto stranger = std::ranges::find_if(topic.strangers, [&](const LogStranger& one) {
          return one.first_at > last && one.first_at < last + longest_pause * map_.time_step &&
                 std::ranges::none_of(entries, [&](const std::string& entry) { return entry.ends_with(one.name); });
        });
        if (stranger == topic.strangers.end()) continue;
        JointRename later;
        later.joint = model_.links[model_.find_joint(silent.joint)].joint.id;
        later.is_later = true;
        for (JointSource& source : changed.joints) source.names[stranger->name] = later;
        entries.push_back(fmt::format("{}: {}", silent.joint, stranger->name));
      }
      if (entries.empty()) continue;
      add({fmt::format("renamed: {{{}}}", fmt::join(entries, ", "))}, "a joint has another name half-way") =
          std::move(changed);
    }
  }

  void add_angles() {
    if (map_.joints.empty() || map_.angles != LogAngles::radians) return;
    add({"angles: degrees"}, "the angles of the joints are in degrees").angles = LogAngles::degrees;
    add({"angles: wrapped"}, "the angles of the joints jump by a turn").angles = LogAngles::wrapped;
  }

  const LogMap& map_;
  const std::vector<MappedSource>& sources_;
  const LogSurvey& survey_;
  const std::vector<LogTopic>& topics_;
  const Model& model_;
  const LogReplayReport& report_;
  std::vector<OtherReading> readings_;
};

}  // namespace

std::vector<OtherReading> other_readings(const LogMap& map, const std::vector<MappedSource>& sources,
                                         const LogSurvey& survey, const std::vector<LogTopic>& topics,
                                         const Model& model, const LogReplayReport& report) {
  return Readings(map, sources, survey, topics, model, report).take();
}

std::optional<OtherReading> reading_of_last_commands(const LogMap& map, const std::vector<MappedSource>& sources,
                                                     const LogSurvey& survey, const LogReplayReport& report) {
  constexpr double fewest_in_a_tick = 1.5;
  if (!map.tick || map.take == TakenCommand::last) return std::nullopt;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto messages = static_cast<double>(survey.sources[i].messages);
    if (!sources[i].commands || messages < fewest_in_a_tick * static_cast<double>(report.ticks)) continue;
    OtherReading reading{map, {"take: last"}, "the last of several commands of a tick is the controller's"};
    reading.map.take = TakenCommand::last;
    return reading;
  }
  return std::nullopt;
}

namespace {

/// The log time of the first message of a topic [ns]; nullopt: it has none.
std::optional<std::uint64_t> first_logged(mcap::Reader& log, const std::string& topic) {
  std::vector<std::uint16_t> channels;
  for (const auto& [id, channel] : log.channels())
    if (channel.topic == topic) channels.push_back(id);
  std::optional<std::uint64_t> first;
  read_in_order(log, channels, [&](const mcap::Message& message) {
    first = message.log_time;
    return false;
  });
  return first;
}

}  // namespace

std::optional<OtherReading> reading_with_renamed(mcap::Reader& log, const LogMap& map,
                                                 const std::vector<MappedSource>& sources, const LogSurvey& survey,
                                                 const std::vector<LogTopic>& topics, std::int64_t ending) {
  constexpr double steps = 20.0, longest_pause = 1.0;  // [s]
  OtherReading reading{map, {}, "the topic is renamed half-way", false};
  std::map<std::string, std::string> renamed;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const LogSource& source = *sources[i].source;
    const auto own = std::ranges::find_if(topics, [&](const LogTopic& topic) { return topic.name == source.topic; });
    const bool is_event = sources[i].joystick != nullptr;  // it ends when nobody moves it
    if (own == topics.end() || is_event || !source.later_topic.empty() || renamed.contains(source.topic)) continue;
    const auto last = static_cast<double>(survey.sources[i].last_logged);
    const bool ends_early = static_cast<double>(ending) - last > steps * map.time_step * 1e9;
    if (!ends_early) continue;
    for (const LogTopic& topic : topics) {
      const auto maps_it = [&](const MappedSource& mapped) { return mapped.source->is_on(topic.name); };
      if (topic.type != own->type || topic.schema != own->schema || std::ranges::any_of(sources, maps_it)) continue;
      const auto first = first_logged(log, topic.name);
      const double after = first ? (static_cast<double>(*first) - last) * 1e-9 : -1.0;
      if (after < -0.5 * map.time_step || after > std::max(steps * map.time_step, longest_pause)) continue;
      renamed.emplace(source.topic, topic.name);
      break;
    }
  }
  if (renamed.empty()) return std::nullopt;
  std::vector<std::string> entries;
  for (const auto& [old, later] : renamed) {
    entries.push_back(fmt::format("{}: {}", old, later));
    reading.map.each_source([&, &topic = old, &name = later](LogSource& source) {
      if (source.topic == topic) source.later_topic = name;
    });
  }
  reading.lines = {fmt::format("renamed: {{{}}}", fmt::join(entries, ", "))};
  return reading;
}

}  // namespace rehearse
