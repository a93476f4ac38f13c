#include "log_verbs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "base/replaceable.h"
#include "control_times.h"
#include "core/guard/interruption.h"
#include "core/guard/own_process.h"
#include "core/guard/supervise.h"
#include "core/host/controller_library.h"
#include "core/host/source_age.h"
#include "core/host/virtualised.h"
#include "model_scenario.h"
#include "output.h"
#include "progress.h"

namespace rehearse::tool {
namespace {

/// True if a comparison was requested but nothing could be compared.
bool is_of_nothing(const LogReplayReport& report) { return report.has_commands && report.values == 0; }

std::string agreeing_text(std::int64_t ticks, std::int64_t different) {
  return fmt::format("{} of {}", ticks - different, count_text(ticks, "tick"));
}

/// Names the time as the reason, if it is; else empty.
std::string timing_text(const LogReplayReport& report) {
  if (!report.timing) return "";
  const LogTiming& timing = *report.timing;
  const std::string amount = agreeing_text(timing.ticks, timing.different);
  if (!timing.shift)
    return fmt::format("the time differs: in {} that differ the commands agree with those of a neighbouring tick{}; ",
                       amount, report.tick ? "" : " (expected tick: TOPIC in the map, of the controller's inputs)");
  const int ticks = std::abs(*timing.shift);
  return fmt::format("the time differs: the commands agree in {} if taken {} {} ({} the map's shift by {}); ", amount,
                     count_text(ticks, "tick"), *timing.shift > 0 ? "later" : "earlier",
                     *timing.shift > 0 ? "increase" : "decrease", ticks);
}

/// A difference; with the time in the log if that of the recording is another one.
std::string difference_text(const LogReplayReport& report, const Divergence& found, double at) {
  at += report.begins;
  const bool is_elsewhere = std::abs(at - found.time) > 0.5 * report.time_step;
  return to_string(found) + (is_elsewhere ? fmt::format(", at {:.4f} s of the log", at) : "");
}

/// The reason why ticks are uncertain, and how many are certain.
std::string stretches_text(const LogReplayReport& report) {
  const LogStretches& certain = *report.certain;
  const std::string memory = certain.memory
                                 ? fmt::format("the controller remembers up to {}", count_text(*certain.memory, "tick"))
                                 : "the controller has a state that doesn't fade, such as an integral";
  return fmt::format("{} of {} are certain; the others follow the log's beginning or a missing or late message, and {}",
                     certain.compared, count_text(report.ticks_compared, "compared tick"), memory);
}

/// The differences of the ticks that aren't certain.
std::string rest_text(const LogReplayReport& report) {
  const LogStretches& certain = *report.certain;
  if (!certain.rest) return "no tick that isn't certain differs";
  const LogRest& rest = *certain.rest;
  const std::string unit = rest.unit.empty() ? "" : " " + rest.unit;
  const std::string reason = certain.memory ? "" : ": a state that the log doesn't contain, or another gain";
  const std::string share =
      rest.share() < 1.0 ? fmt::format("{:.2g} % of", 100.0 * rest.share()) : fmt::format("{:.2g} times", rest.share());
  return fmt::format("from {:.3f} s on {} is off by at most {} its range ({:.3g}{}){}{}", report.begins + rest.from,
                     rest.series, share, rest.largest(), unit, rest.is_constant() ? ", nearly constant" : "", reason);
}

std::string without_inputs_text(const LogReplayReport& report) {
  return fmt::format("for {} of commands after {:.3f} s the log has no inputs",
                     count_text(report.ticks_without_inputs, "tick"), report.begins + report.inputs_end);
}

/// What can't be decided by the map as it is.
std::string as_the_map_is(const LogReplayReport& report) {
  if (!report.beyond) return without_inputs_text(report);
  return fmt::format("{} of {} are beyond their tolerance", report.ticks_beyond,
                     count_text(report.ticks_compared, "tick"));
}

/// Another reading of the log with which the commands agree.
std::string cause_text(const LogReplayReport& report) {
  const LogCause& cause = *report.cause;
  return fmt::format("undecided: the commands agree in {} with {} in the map: {}; as the map is, {}",
                     agreeing_text(cause.ticks, cause.different), fmt::join(cause.lines, " and "), cause.meaning,
                     as_the_map_is(report));
}

/// The verdict for commands beyond their tolerance.
std::string verdict_of_difference(const LogReplayReport& report) {
  if (report.undecided() && report.is_at_neighbours())
    return "undecided: " + timing_text(report) + "as the map is, " + as_the_map_is(report);
  if (!report.certain)
    return timing_text(report) + "differs from the log's commands at " +
           difference_text(report, *report.beyond, report.beyond_at);
  const LogStretches& certain = *report.certain;
  if (certain.is_no_state)
    return fmt::format(
        "differs from the log's commands at {}, and no state that the log lacks explains it: the "
        "difference grows where that of two controllers with different states doesn't",
        difference_text(report, *certain.beyond, certain.beyond_at));
  if (certain.beyond)
    return fmt::format("differs from the log's commands at {}; it is the first of {} that differ and are certain",
                       difference_text(report, *certain.beyond, certain.beyond_at),
                       count_text(certain.different, "tick"));
  const std::string ending = report.ticks_without_inputs > 0 ? "; " + without_inputs_text(report) : "";
  if (report.undecided())
    return fmt::format(
        "undecided: {}; {}{}; if the controller started with the log, state begins: controller in the map",
        rest_text(report), stretches_text(report), ending);
  return fmt::format("within tolerance of the log's commands where the controller's state is known: {}; {}{}",
                     stretches_text(report), rest_text(report), ending);
}

std::string verdict(const LogReplayReport& report) {
  if (report.failure) return "failed: " + report.failure->message;
  if (!report.has_commands) return "nothing to compare with: the map names no commands";
  if (report.values == 0) return "nothing was compared: the log has no commands in these ticks";
  if (report.undecided() && report.cause) return cause_text(report);
  if (report.beyond) return verdict_of_difference(report);
  const std::string amount =
      fmt::format("{}, {}", count_text(report.ticks_compared, "tick"), count_text(report.values, "commanded number"));
  const std::string unknown =
      report.ticks_unknown() > 0 ? fmt::format("; unknown in {}", count_text(report.ticks_unknown(), "tick")) : "";
  if (report.undecided())
    return fmt::format("undecided: {}; the commands before agree: {}{}", without_inputs_text(report), amount, unknown);
  const std::string ending = report.ticks_without_inputs > 0 ? "; " + without_inputs_text(report) : "";
  const std::string equal =
      report.first ? "within tolerance of the log's commands: " : "the log's commands, bit for bit: ";
  return equal + amount + unknown + ending;
}

Json unreadable_json(const LogTopicReport& topic) {
  Json reasons = Json::array();
  for (const LogUnreadable& found : topic.unreadable_for)
    reasons.push_back({{"reason", found.reason}, {"messages", found.messages}, {"first_at", found.first_at}});
  return reasons;
}

Json silent_json(const LogTopicReport& topic) {
  Json joints = Json::array();
  for (const SilentJoint& silent : topic.silent_joints)
    joints.push_back({{"joint", silent.joint},
                      {"gaps", silent.gaps},
                      {"ticks_in_gaps", silent.ticks_in_gaps},
                      {"worst_age", {{"seconds", silent.worst_age}, {"at", silent.worst_age_at}}}});
  return joints;
}

Json clock_json(const LogTopicReport& topic) {
  if (!topic.clock) return nullptr;
  return {{"offset_ns", topic.clock->offset},       {"drift", topic.clock->drift},
          {"reference_ns", topic.clock->reference}, {"least_delay", topic.clock->least_delay},
          {"stated", topic.clock->is_stated},       {"steps", topic.clock->steps}};
}

Json topic_json(const LogTopicReport& topic) {
  return {{"topic", topic.topic},
          {"type", topic.type},
          {"use", topic.use},
          {"messages", topic.messages},
          {"used", topic.used},
          {"skipped", topic.skipped},
          {"out_of_order", topic.out_of_order},
          {"same_stamp", topic.same_stamp},
          {"backwards", topic.backwards},
          {"twins", topic.twins},
          {"unreadable", topic.unreadable},
          {"unreadable_for", unreadable_json(topic)},
          {"silent_joints", silent_json(topic)},
          {"clock", clock_json(topic)},
          {"rate", topic.rate},
          {"longest_gap", {{"seconds", topic.longest_gap}, {"at", topic.longest_gap_at}}},
          {"worst_age", {{"seconds", topic.worst_age}, {"at", topic.worst_age_at}}},
          {"gaps", topic.gaps},
          {"ticks_in_gaps", topic.ticks_in_gaps},
          {"ticks_without", topic.ticks_without}};
}

Json tick_json(const LogReplayReport& report) {
  if (!report.tick) return nullptr;
  const LogTickReport& tick = *report.tick;
  return {{"topic", tick.topic},       {"grid", tick.is_grid},
          {"interval", tick.interval}, {"rate", tick.rate},
          {"drift", tick.drift},       {"jitter", tick.jitter},
          {"phase", tick.phase},       {"measured_by", tick.measured_by},
          {"missing", tick.missing},   {"latency", tick.latency ? Json(*tick.latency) : Json(nullptr)}};
}

Json timing_json(const LogReplayReport& report) {
  if (!report.timing) return nullptr;
  const LogTiming& timing = *report.timing;
  return {{"shift", timing.shift ? Json(*timing.shift) : Json(nullptr)},
          {"ticks", timing.ticks},
          {"different", timing.different}};
}

Json cause_json(const LogReplayReport& report) {
  if (!report.cause) return nullptr;
  const LogCause& cause = *report.cause;
  return {{"lines", cause.lines}, {"meaning", cause.meaning}, {"ticks", cause.ticks}, {"different", cause.different}};
}

Json rest_json(const LogStretches& certain) {
  if (!certain.rest) return nullptr;
  const LogRest& rest = *certain.rest;
  return {{"series", rest.series}, {"from", rest.from}, {"ticks", rest.ticks},
          {"low", rest.low},       {"high", rest.high}, {"range", rest.range}};
}

Json certain_json(const LogReplayReport& report) {
  if (!report.certain) return nullptr;
  const LogStretches& certain = *report.certain;
  return {{"memory", certain.memory ? Json(*certain.memory) : Json(nullptr)},
          {"ticks", certain.compared},
          {"different", certain.different},
          {"beyond", json_of(certain.beyond)},
          {"is_no_state", certain.is_no_state},
          {"rest", rest_json(certain)}};
}

Json report_json(const LogReplayReport& report, const std::vector<std::string>& notes) {
  const Differences none, &named = report.named() ? *report.named() : none;
  Json topics = Json::array();
  for (const LogTopicReport& topic : report.topics) topics.push_back(topic_json(topic));
  Json after_restarts = Json::array();
  for (const LogReplayReport& part : report.after_restarts) after_restarts.push_back(report_json(part, {}));
  return {{"verdict", verdict(report)},
          {"equal", report.equal() && !is_of_nothing(report)},
          {"within", report.within() && !is_of_nothing(report)},
          {"first", json_of(named.first)},
          {"worst", json_of(named.worst)},
          {"beyond", json_of(named.beyond)},
          {"trace", report.trace.string()},
          {"log_hash", report.log_hash},
          {"start", report.start},
          {"begins", report.begins},
          {"ticks", report.ticks},
          {"duration", report.duration},
          {"ticks_compared", report.ticks_compared},
          {"ticks_different", report.ticks_different},
          {"ticks_unknown",
           {{"without_message", report.ticks_without_message},
            {"without_command", report.ticks_without_command},
            {"in_doubt", report.ticks_in_doubt}}},
          {"ticks_without_inputs", report.ticks_without_inputs},
          {"tick", tick_json(report)},
          {"timing", timing_json(report)},
          {"cause", cause_json(report)},
          {"undecided", report.undecided()},
          {"certain", certain_json(report)},
          {"values", report.values},
          {"values_different", report.values_different},
          {"topics", topics},
          {"failure", report.failure ? Json(report.failure->message) : Json(nullptr)},
          {"controller_refused", report.controller_refused},
          {"after_restarts", after_restarts},
          {"control_times", json_of(report.control_times)},
          {"remarks", json_of_remarks(report.remarks, notes)}};
}

/// The problem of a topic in a few words; empty: none.
std::string troubles(const LogTopicReport& topic) {
  std::vector<std::string> words;
  if (topic.gaps > 0)
    words.push_back(
        fmt::format("{}, {} on an old value", count_text(topic.gaps, "gap"), count_text(topic.ticks_in_gaps, "tick")));
  for (const SilentJoint& silent : topic.silent_joints)
    words.push_back(fmt::format("{} silent in {}, {} on an old value", silent.joint, count_text(silent.gaps, "gap"),
                                count_text(silent.ticks_in_gaps, "tick")));
  if (topic.ticks_without > 0)
    words.push_back(fmt::format("not yet there in {}", count_text(topic.ticks_without, "tick")));
  if (topic.out_of_order > 0) words.push_back(fmt::format("{} out of order", topic.out_of_order));
  if (topic.backwards > 0) words.push_back(fmt::format("{} back in time, not used", topic.backwards));
  if (topic.same_stamp > 0) words.push_back(fmt::format("{} with the time of the one before", topic.same_stamp));
  if (topic.twins > 0) words.push_back(fmt::format("{} recorded twice, used once", topic.twins));
  if (topic.unreadable > 0) words.push_back(fmt::format("{} unreadable", topic.unreadable));
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : "; ") + word;
  return text;
}

void tell_topics(const LogReplayReport& report) {
  std::vector<TableRow> rows{{"topic", "for", "messages", "Hz", "used", "longest gap", "oldest at a tick", ""}};
  for (const LogTopicReport& topic : report.topics) {
    const bool is_input = topic.use != "commands";  // commands are compared, not read by controllers
    rows.push_back({topic.topic, topic.use, fmt::format("{}", topic.messages),
                    topic.rate > 0.0 ? fmt::format("{:.4g}", topic.rate) : "",
                    is_input ? fmt::format("{}", topic.used) : "",
                    topic.messages > 1
                        ? fmt::format("{:.4g} s at {:.3f} s", topic.longest_gap, report.begins + topic.longest_gap_at)
                        : "",
                    is_input && topic.used > 0
                        ? fmt::format("{:.4g} s at {:.3f} s", topic.worst_age, report.begins + topic.worst_age_at)
                        : "",
                    troubles(topic)});
  }
  print_table(rows);
}

std::string ticks_text(const LogTickReport& tick) {
  const std::string commands = tick.latency ? fmt::format("; commands {:.5g} s later (medians)", *tick.latency) : "";
  const std::string phase =
      tick.phase == 0.0 ? "" : fmt::format("{:.4g} s {} ", std::abs(tick.phase), tick.phase < 0.0 ? "before" : "after");
  const std::string measured =
      tick.measured_by.empty() ? "" : fmt::format(", half-way to the last message on {}", tick.measured_by);
  if (tick.is_grid)
    return fmt::format("a grid of {:.6g} Hz, {}{}{}; a drift of {:+.3g} ppm from time_step, messages within {:.3g} s{}",
                       tick.rate, phase.empty() ? "at " : phase, tick.topic, measured, tick.drift * 1e6, tick.jitter,
                       commands);
  return fmt::format("{}each message on {}{}, {:.5g} s apart, {} missing{}", phase, tick.topic, measured, tick.interval,
                     tick.missing, commands);
}

std::string clock_text(const LogTopicReport& topic) {
  const LogClockReport& clock = *topic.clock;
  if (clock.is_stated)
    return fmt::format("stamps on {} and {:g} s are times of the log (stated)", topic.topic,
                       static_cast<double>(clock.offset) * 1e-9);
  if (clock.offset == 0 && clock.steps == 0)
    return fmt::format("stamps on {} are times of the log: logged {:.3g} s later at least", topic.topic,
                       clock.least_delay);
  return fmt::format("stamps on {} and {:.9g} s are times of the log, with a drift of {:+.3g} ppm (estimated){}",
                     topic.topic, static_cast<double>(clock.offset) * 1e-9, clock.drift * 1e6,
                     clock.steps > 0 ? ", until the first of " + count_text(clock.steps, "step") + " of a clock" : "");
}

void tell_ticks(const LogReplayReport& report) {
  if (report.tick) fmt::print("ticks: {}\n", ticks_text(*report.tick));
  for (const LogTopicReport& topic : report.topics)
    if (topic.clock) fmt::print("clock: {}\n", clock_text(topic));
  if (report.ticks_unknown() > 0)
    fmt::print(
        "unknown: {} whose message is missing, {} without a command, {} that {} after missing or late messages\n",
        count_text(report.ticks_without_message, "tick"), report.ticks_without_command, report.ticks_in_doubt,
        report.ticks_in_doubt == 1 ? "differs" : "differ");
}

void tell_part(const LogReplayReport& report) {
  tell_topics(report);
  tell_ticks(report);
  fmt::print("{}, {}, {} in {}\n", count_text(report.channels, "channel"), count_text(report.pictures, "picture"),
             file_size_text(report.bytes), report.trace.string());
  tell_control_times(report.control_times);
  fmt::print("{}\n", verdict(report));
  if (!report.first) return;
  if (const Differences* named = report.named(); named && named->first)
    fmt::print("first: {}\nworst: {}\n", to_string(*named->first), to_string(*named->worst));
  fmt::print("{} of {} and {} of {} differ\n", report.ticks_different, count_text(report.ticks_compared, "tick"),
             report.values_different, count_text(report.values, "commanded number"));
}

void tell(const LogSettings& settings, const LogReplayReport& report, double seconds) {
  fmt::print("replayed the log {}: {}, {:g} s, in {:.3f} s\n", settings.log, count_text(report.ticks, "tick"),
             report.duration, seconds);
  tell_part(report);
  for (const LogReplayReport& part : report.after_restarts) {
    fmt::print("\nafter the restart at {:.4f} s of the log: {}, {:g} s\n", part.begins, count_text(part.ticks, "tick"),
               part.duration);
    tell_part(part);
  }
}

void tell_warnings_of(const LogSettings& settings, const LogReplayReport& part) {
  tell_remarks(part.remarks, part.failure);
  tell_missed_deadlines(part.control_times, settings.deadline);
}

Exit exit_of(const LogReplayReport& report) {
  if (report.failure || report.controller_refused) return Exit::controller_failed;
  if (is_of_nothing(report)) return Exit::bad_input;
  if (report.undecided()) return Exit::odd;
  return report.within() ? Exit::done : Exit::differs;
}

/// That of the worst part.
Exit exit_of_all(const LogReplayReport& report) {
  std::vector<Exit> exits{exit_of(report)};
  for (const LogReplayReport& part : report.after_restarts) exits.push_back(exit_of(part));
  for (const Exit worst : {Exit::controller_failed, Exit::differs, Exit::odd, Exit::done})
    if (std::ranges::find(exits, worst) != exits.end()) return worst;
  return Exit::bad_input;  // nothing was compared in any
}

}  // namespace

Exit replay_log_of(LogSettings settings) {
  supervise_process();
  if (!is_interposed()) begin_own_processes();
  end_runs_on_signals();
  if (settings.trace.empty()) {
    const std::filesystem::path log = settings.log;  // of a folder, perhaps with a / at its end
    settings.trace = (log.has_filename() ? log : log.parent_path()).stem().string() + ".replay.mcap";
  }
  if (const auto allowed = check_replaceable(settings.trace, mcap_magic, "trace"); !allowed)
    return refuse(allowed.errors());
  if (!settings.scenario.empty())
    if (const auto unused = check_unused(settings.scenario); !unused) return refuse(unused.errors());
  const auto library = find_controller_library(settings.replay.controller, {});  // the replay reports a missing one
  const auto notes = library ? notes_on_old_library(*library) : std::vector<std::string>();
  tell_old_libraries(notes);
  InterposerWatch watch;
  if (is_interposed()) settings.replay.watch = &watch;
  const Stopwatch stopwatch;
  const Result<LogReplayReport> report = [&] {
    Progress progress("replaying");
    settings.replay.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    return replay_log(settings.log, settings.trace, settings.replay);
  }();
  if (!report) return refuse(report.errors());
  if (!settings.scenario.empty()) {
    const ModelScenario scenario{
        settings.replay.model.string(),
        {settings.replay.controller},
        report->duration,
        RunOfALog{settings.log, report->body, report->begin, report->time_step, report->controller}};
    if (const auto saved = save_scenario(scenario, settings.scenario); !saved) return refuse(saved.errors());
  }
  if (settings.json) {
    print(report_json(*report, notes));
  } else {
    tell(settings, *report, stopwatch.seconds());
    std::fflush(stdout);  // before related output on stderr
    tell_warnings_of(settings, *report);
    for (const LogReplayReport& part : report->after_restarts) tell_warnings_of(settings, part);
  }
  return exit_of_all(*report);
}

}  // namespace rehearse::tool
