#include "log_causes.h"

#include <fmt/format.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "model/clock.h"

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
           const std::vector<LogTopic>& topics, const LogReplayReport& report)
      : map_(map), sources_(sources), survey_(survey), topics_(topics), report_(report) {}

  std::vector<OtherReading> take() {
    if (!map_.tick) add_other_ticks();
    add_other_clock();
    add_other_starts();
    add_skipping();
    add_restart();
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
    for (JointSource& joints : map.joints) look(joints);
    for (DeviceSource& devices : map.devices) look(devices);
    if (map.joystick) look(*map.joystick);
    if (map.root) look(*map.root);
    if (map.commands) look(*map.commands);
    if (map.tick) look(*map.tick);
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
    if (tick == 0 || map_.start.when != StartRule::When::all) return;
    const double step = report_.duration / static_cast<double>(report_.ticks);
    // Before the tick by less than half a step, so that it is the first.
    const double time = std::round((report_.beyond_at - 0.25 * step) * 1e6) * 1e-6;
    const std::vector<std::string> lines{fmt::format("start: {:.6g}", time), "begins: controller"};
    LogMap& map = add(lines, fmt::format("another controller starts at {:.6g} s", report_.beyond_at));
    map.start = {StartRule::When::time, "", time};
    map.begins_with_controller = true;
  }

  const LogMap& map_;
  const std::vector<MappedSource>& sources_;
  const LogSurvey& survey_;
  const std::vector<LogTopic>& topics_;
  const LogReplayReport& report_;
  std::vector<OtherReading> readings_;
};

}  // namespace

std::vector<OtherReading> other_readings(const LogMap& map, const std::vector<MappedSource>& sources,
                                         const LogSurvey& survey, const std::vector<LogTopic>& topics,
                                         const LogReplayReport& report) {
  return Readings(map, sources, survey, topics, report).take();
}

}  // namespace rehearse
