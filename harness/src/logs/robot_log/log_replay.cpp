#include "log_replay.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/body.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "base/hashing.h"
#include "base/replaceable.h"
#include "base/text.h"
#include "core/guard/float_mode.h"
#include "core/trace/select.h"
#include "log_causes.h"
#include "log_memory.h"
#include "log_replayer.h"
#include "logs/bag/bag_folder.h"
#include "logs/bag/sqlite_bag.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The size and the time of the last change of a file; they differ after a change.
std::pair<std::uintmax_t, fs::file_time_type> state_of(const fs::path& file) {
  std::error_code ignored;
  return {fs::file_size(file, ignored), fs::last_write_time(file, ignored)};
}

/// The hash of all bytes of a file, or of the files that a rosbag2 folder names.
Result<std::string> hash_of(const fs::path& log) {
  std::vector<fs::path> files = bag::SqliteBag::files_of(log);
  if (const fs::path path = bag::folder_of(log); !path.empty()) {
    const auto folder = REHEARSE_TRY(bag::read_folder(path));
    files.clear();
    for (const fs::path& file : folder.files)
      for (const fs::path& part : bag::SqliteBag::files_of(file)) files.push_back(part);
  }
  std::vector<char> block(1 << 20);
  std::uint64_t hash = 0;
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    while (stream) {
      stream.read(block.data(), static_cast<std::streamsize>(block.size()));
      hash = hash_bytes(block.data(), static_cast<std::size_t>(stream.gcount()), hash);
    }
    if (!stream.eof()) return error_in(file.string(), "it can't be read");
  }
  return hash_text(hash);
}

/// Replays parts of a log again, by the same map and by others. The log is surveyed once for all that read the same
/// messages as ticks, with the same clocks.
class Trials {
 public:
  Trials(mcap::Reader& log, const LogMap& map, const std::shared_ptr<const Model>& model,
         const std::vector<LogTopic>& topics, const LogReplayOptions& options, LogReplayReport& report)
      : log_(log), map_(map), model_(model), topics_(topics), options_(options), report_(report) {
    options_.on_difference = {};
    options_.progress = {};
  }

  /// Finds the ticks that decide about the controller: twice a part of the log, once with a controller that starts
  /// later, for its memory; then the whole log.
  void find_certain_ticks() {
    LogReplayOptions whole = options_;
    whole.memory = memory();
    LogMap map = map_;
    if (map.state && !is_whole_state()) {
      report_.remarks.push_back(
          at(map.state->place, warning("the controller keeps more state than it takes: started with it in mid-run, it "
                                       "commands something else; the log's state isn't used",
                                       "call rehearse_state() for each number on which its next commands depend")));
      map.state.reset();
    }
    auto judged = replay(map, whole, !map_.state || map.state);
    if (judged) report_.certain = std::move(judged->certain);
    if (report_.certain && !report_.certain->beyond && report_.beyond && !map_.state && !report_.is_mostly_certain())
      tell_from_state();
  }

  /// Of commands that differ by less than what a rounding of the positions makes: sets the cause to tolerances of that
  /// size.
  void try_rounding(const LogSurvey& survey) {
    constexpr std::int64_t most_ticks = 8000;
    if (!map_.tolerances.empty()) return;
    LogReplayOptions rounded = options_;
    for (const SourceSurvey& source : survey.sources)
      for (const auto& [joint, positions] : source.positions)
        if (const double step = positions.step(); step > 0.0) rounded.half_steps[joint] = step / 2;
    if (rounded.half_steps.empty()) return;
    const std::int64_t until = std::min(report_.ticks, most_ticks);
    const CommandRecord plain = commands_from(0, until), moved = commands_from(0, until, rounded);
    std::vector<double> most(plain.names().size());
    for (const auto& [time, commands] : plain.all()) {
      const auto other = moved.all().find(time);
      if (other == moved.all().end() || commands.size() != most.size() || other->second.size() != most.size()) continue;
      for (std::size_t i = 0; i < most.size(); ++i)
        if (const double off = std::abs(other->second[i] - commands[i]); off > most[i]) most[i] = off;
    }
    OtherReading reading{map_, {}, "the positions are rounded, and half a step of them makes as much"};
    std::vector<std::string> rules;
    for (std::size_t i = 0; i < most.size(); ++i) {
      if (most[i] == 0.0) continue;
      ToleranceRule& rule = reading.map.tolerances.emplace_back();
      rule.channel = "*/" + plain.names()[i];
      rule.atol = number_in<double>(fmt::format("{:.2g}", 1.05 * most[i]));
      rules.push_back(fmt::format("{{channel: \"{}\", atol: {:g}}}", rule.channel, *rule.atol));
    }
    if (rules.empty()) return;
    reading.lines = {fmt::format("tolerances: [{}]", fmt::join(rules, ", "))};
    try_readings({std::move(reading)});
  }

  /// Sets the report's cause to the first reading with which nine of ten ticks that differ agree, up to some ticks
  /// after the first difference.
  void try_readings(const std::vector<OtherReading>& readings) {
    constexpr double ticks_after = 1000, most_ticks = 100'000;
    const auto all = static_cast<double>(report_.ticks), all_compared = static_cast<double>(report_.ticks_compared);
    const double share = static_cast<double>(report_.ticks_beyond) / all_compared;
    const double ticks = std::min(static_cast<double>(report_.beyond->tick) + ticks_after, all);
    if (ticks > most_ticks) return;
    LogReplayOptions part = options_;
    part.most_beyond = static_cast<std::int64_t>(0.1 * share * ticks);
    for (const OtherReading& reading : readings) {
      const double begin = reading.begin.value_or(0.0) / report_.time_step;
      part.span.begin = options_.span.begin;
      if (reading.begin)
        part.span.begin = options_.span.beginning + std::llround((report_.begins + *reading.begin) * 1e9);
      const double steps = reading.map.time_step / report_.time_step;
      part.span.most_ticks = static_cast<std::int64_t>(std::ceil((ticks - begin) / steps));
      const double fewest = std::max(10.0, 0.5 * (1.0 - begin / ticks) * ticks * all_compared / all);
      const auto tried = replay(reading.map, part, reading.has_same_messages);
      if (!tried || tried->failure || static_cast<double>(tried->ticks_compared) < fewest) continue;
      if (static_cast<double>(tried->ticks_beyond) > 0.1 * share * static_cast<double>(tried->ticks_compared)) continue;
      report_.cause = LogCause{reading.lines, reading.meaning, tried->ticks_compared, tried->ticks_beyond};
      return;
    }
  }

  /// Of a reading that compares more ticks: sets the report's cause if nine of ten of the additional ones agree.
  void try_longer(const OtherReading& reading) {
    constexpr std::int64_t ticks_after = 1000;
    LogReplayOptions part = options_;
    part.span.most_ticks = report_.ticks + ticks_after;
    const auto tried = replay(reading.map, part, reading.has_same_messages);
    if (!tried || tried->failure) return;
    const std::int64_t more = tried->ticks_compared - report_.ticks_compared;
    if (more < 10 || 10 * (tried->ticks_beyond - report_.ticks_beyond) > more) return;
    report_.cause = LogCause{reading.lines, reading.meaning, tried->ticks_compared, tried->ticks_beyond};
  }

 private:
  Result<LogReplayReport> replay(const LogMap& map, const LogReplayOptions& options, bool has_same_messages) {
    const fs::path nowhere = "/dev/null";
    LogReplayer replayer(log_, map, model_, nowhere, options);
    replayer.keep_survey();
    auto report = replayer.run(topics_, report_.log_hash, has_same_messages && surveyed_ ? &*surveyed_ : nullptr);
    if (has_same_messages && !surveyed_) surveyed_ = replayer.take_survey();
    return report;
  }

  /// The controller's; a controller of which it can't be measured has none.
  std::optional<std::int64_t> memory() {
    constexpr std::int64_t most_ticks = 8000;
    for (const std::int64_t part : {4, 8, 2}) {  // of the log, after which the other controller starts
      const std::int64_t later = std::min<std::int64_t>(report_.ticks / part, most_ticks / (2 * part));
      const std::int64_t until = std::min(report_.ticks, later + most_ticks);
      const CommandRecord started_later = commands_from(later, until);
      if (started_later.begins_steadily(map_.time_step))
        return memory_of(commands_from(0, until), started_later, map_.time_step);
    }
    return std::nullopt;
  }

  /// Takes the differences for those of the controller if they are none of a state that the log doesn't contain.
  void tell_from_state() {
    constexpr std::int64_t most_ticks = 8000;
    const std::int64_t later = std::min(report_.ticks / 4, most_ticks / 8), until = std::min(report_.ticks, most_ticks);
    LogReplayOptions watched = options_;
    watched.memory.emplace();  // so that interruptions are found
    if (!is_no_state(commands_from(0, until, watched), commands_from(later, until))) return;
    report_.certain->is_no_state = true;
    report_.certain->beyond = report_.beyond;
    report_.certain->beyond_at = report_.beyond_at;
    report_.certain->first = report_.first;
    report_.certain->worst = report_.worst;
  }

  /// True if a controller that is started in mid-run with the numbers that another one would publish commands the same.
  bool is_whole_state() {
    constexpr std::int64_t most_ticks = 2000, fewest_ticks = 40;
    const std::int64_t until = std::min(report_.ticks, most_ticks);
    if (until < fewest_ticks) return true;  // too few to judge
    CommandRecord continued;
    LogReplayOptions part = options_;
    part.commands = &continued;
    part.span.most_ticks = until;
    part.restart_at = until / 2;
    static_cast<void>(replay(map_, part, true));
    return memory_of(commands_from(0, until), continued, map_.time_step) == 0;
  }

  CommandRecord commands_from(std::int64_t tick, std::int64_t until) { return commands_from(tick, until, options_); }

  CommandRecord commands_from(std::int64_t tick, std::int64_t until, LogReplayOptions part) {
    CommandRecord commands;
    part.commands = &commands;
    part.skip = tick;
    part.span.most_ticks = until - tick;
    static_cast<void>(replay(map_, part, true));
    return commands;
  }

  mcap::Reader& log_;
  const LogMap& map_;
  const std::shared_ptr<const Model>& model_;
  const std::vector<LogTopic>& topics_;
  LogReplayOptions options_;
  LogReplayReport& report_;
  std::optional<SurveyedLog> surveyed_;  // by the first replay with the map's messages
};

/// Shared by all parts of a replay.
struct ReplayedLog {
  mcap::Reader& reader;
  const std::vector<LogTopic>& topics;
  std::shared_ptr<const Model> robot;
  std::string hash;
};

/// Remarks that a topic may have been renamed.
void remark_renamed(OtherReading& reading, Diagnostics& remarks) {
  std::optional<Place> place;
  reading.map.each_source([&](const LogSource& source) {
    if (!place && !source.later_topic.empty()) place = source.place;
  });
  remarks.push_back(
      at(place.value_or(Place()), warning("a topic of the map ends where another one of its type begins",
                                          "expected " + reading.lines[0] + " in the map, if it was renamed")));
}

/// True if with these options less than half of the differing ticks differ.
bool is_mostly_explained(const LogReplayReport& report, const ReplayedLog& log, const LogMap& map,
                         LogReplayOptions options) {
  const fs::path nowhere = "/dev/null";
  options.on_difference = {};
  options.progress = {};
  options.most_beyond = report.ticks_beyond / 2;
  const auto tried = LogReplayer(log.reader, map, log.robot, nowhere, options).run(log.topics, log.hash);
  return tried && !tried->failure && 2 * tried->ticks_beyond < report.ticks_beyond;
}

/// Replays the part of a log in the span of the options.
Result<LogReplayReport> replay_part(const ReplayedLog& log, const LogMap& map, const fs::path& trace,
                                    const LogReplayOptions& options) {
  LogReplayer replayer(log.reader, map, log.robot, trace, options);
  auto report = replayer.run(log.topics, log.hash);
  if (!report) return report;
  if (report->beyond && !options.tolerates_steps && replayer.survey().ranges.has_steps()) {
    LogReplayOptions rounded = options;
    rounded.tolerates_steps = true;
    if (is_mostly_explained(*report, log, map, rounded)) return replay_part(log, map, trace, rounded);
  }
  report->trace = trace;
  if (report->failure) return report;
  Trials trials(log.reader, map, log.robot, log.topics, options, *report);
  const bool is_judged = !report->beyond || (report->timing && report->timing->shift);
  if (!is_judged) {
    trials.find_certain_ticks();
    if (!report->within())
      trials.try_readings(other_readings(map, replayer.sources(), replayer.survey(), log.topics, *log.robot, *report));
    if (!report->within() && !report->cause) trials.try_rounding(replayer.survey());
  } else if (auto last = reading_of_last_commands(map, replayer.sources(), replayer.survey(), *report);
             report->beyond && last) {
    trials.try_readings({*std::move(last)});
    if (report->cause) report->timing.reset();
  }
  if (options.span.end) return report;
  auto renamed =
      reading_with_renamed(log.reader, map, replayer.sources(), replayer.survey(), log.topics, options.span.ending);
  if (!renamed) return report;
  if (report->undecided() && !report->cause) trials.try_longer(*renamed);
  if (!report->cause) remark_renamed(*renamed, report->remarks);
  return report;
}

/// run.mcap is the recording of the first controller, run.2.mcap that of the second.
fs::path name_of_part(const fs::path& trace, std::size_t part) {
  if (part == 0 || !trace.has_extension()) return trace;
  return trace.parent_path() / fmt::format("{}.{}{}", trace.stem().string(), part + 1, trace.extension().string());
}

/// Replays a log that has restarts: each controller has a report and a recording of its own.
Result<LogReplayReport> replay_parts(const ReplayedLog& log, LogMap map, const fs::path& trace,
                                     LogReplayOptions options) {
  const std::optional<std::int64_t> end = options.span.end;
  std::optional<LogReplayReport> all;
  for (std::size_t i = 0; i <= map.restarts.size(); ++i) {
    const auto time_of = [&](std::size_t restart) {
      return options.span.beginning + std::llround(map.restarts[restart] * 1e9);
    };
    if (i > 0) {
      options.span.begin = time_of(i - 1);
      map.begins_with_controller = true;
      if (end && *options.span.begin >= *end) break;
    }
    options.span.end = i < map.restarts.size() ? std::optional<std::int64_t>(time_of(i)) : end;
    if (end && options.span.end) options.span.end = std::min(*options.span.end, *end);
    if (i > 0) REHEARSE_TRY(check_replaceable(name_of_part(trace, i), mcap_magic, "trace"));
    auto part = REHEARSE_TRY(replay_part(log, map, name_of_part(trace, i), options));
    if (!all)
      all = std::move(part);
    else
      all->after_restarts.push_back(std::move(part));
    if (all->failure || (i > 0 && all->after_restarts.back().failure)) break;
  }
  return *std::move(all);
}

/// The span of the options in times of the log.
Result<LogSpan> span_of(const LogReplayOptions& options, mcap::Reader& log) {
  LogSpan span;
  const auto times = mcap::log_times(log);
  if (!times) return span;
  constexpr auto latest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  span.beginning = static_cast<std::int64_t>(std::min(times->first, latest));
  span.ending = static_cast<std::int64_t>(std::min(times->second, latest));
  for (const auto& [bound, of_end] : {std::pair(options.from, false), std::pair(options.until, true)}) {
    if (!bound) continue;
    const auto moment = REHEARSE_TRY(mcap::moment_in(*bound, log));
    const auto time = static_cast<std::int64_t>(std::min(moment, latest));
    if (of_end)
      span.end = time;
    else
      span.compared_from = time;
  }
  const bool is_empty = static_cast<std::uint64_t>(span.compared_from) > times->second ||
                        (span.end && (*span.end <= span.compared_from || *span.end <= span.beginning));
  if (is_empty) return mcap::refusal_of_empty(log);
  return span;
}

}  // namespace

Result<LogReplayReport> replay_log(const fs::path& log, const fs::path& trace, const LogReplayOptions& stated) {
  const StandardFloatMode float_mode;
  auto reader = REHEARSE_TRY(mcap::Reader::open(log));
  const std::vector<LogTopic> topics = topics_of(*reader);
  if (topics.empty()) return error_in(log.string(), "it contains no channel", "expected a ROS 2 bag");
  UrdfOptions urdf;
  urdf.meshes = UrdfOptions::Meshes::skip;  // nothing collides, and nothing is rendered
  auto model = REHEARSE_TRY(load_model(stated.model, urdf));
  auto map = REHEARSE_TRY(LogMap::load(stated.map, model, topics));
  std::error_code ignored;
  if (fs::equivalent(log, trace, ignored))
    return error_in(trace.string(), "that is the log itself", "name another file for the recording");
  LogReplayOptions options = stated;
  options.span = REHEARSE_TRY(span_of(stated, *reader));
  const auto before = state_of(log);
  auto hash = REHEARSE_TRY(hash_of(log));
  auto report = replay_parts({*reader, topics, std::make_shared<const Model>(std::move(model)), std::move(hash)},
                             std::move(map), trace, std::move(options));
  if (state_of(log) != before) {
    if (fs::is_regular_file(trace, ignored)) fs::remove(trace, ignored);
    return error_in(log.string(), "it changed while it was read", "replay it when nothing writes it any more");
  }
  if (report)
    for (Diagnostic& remark : float_mode.remarks()) report->remarks.push_back(std::move(remark));
  return report;
}

}  // namespace rehearse
