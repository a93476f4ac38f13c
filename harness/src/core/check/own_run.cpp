#include "own_run.h"

#include <set>
#include <string>
#include <utility>

#include "base/hashing.h"
#include "core/guard/answer.h"
#include "core/guard/own_process.h"
#include "core/replay/replay_recording.h"

namespace rehearse {

// The members of results. They are bound by structured bindings, so that a struct with one more doesn't compile here:
// its value would be lost between two processes.

void each_member(Passed<Diagnostic> auto& value, auto& each) {
  auto& [severity, file, line, column, message, hint] = value;
  each(severity), each(file), each(line), each(column), each(message), each(hint);
}

void each_member(Passed<Divergence> auto& value, auto& each) {
  auto& [tick, time, channel, element, expected, actual, difference, ulps, tolerance, distance, unit, note, stage] =
      value;
  each(tick), each(time), each(channel), each(element), each(expected), each(actual), each(difference), each(ulps);
  each(tolerance), each(distance), each(unit), each(note), each(stage);
}

void each_member(const ControlCosts::Count& value, AnswerWriter& each) {
  auto& [name, total, ticks, first_tick] = value;
  each(name), each(total), each(ticks), each(first_tick);
}

/// Names of counts are constants of the program.
void each_member(ControlCosts::Count& value, AnswerReader& each) {
  static auto& names = *new std::set<std::string>;
  auto& [name, total, ticks, first_tick] = value;
  std::string passed;
  each(passed), each(total), each(ticks), each(first_tick);
  name = *names.insert(std::move(passed)).first;
}

void each_member(Passed<ControlCosts> auto& value, auto& each) {
  auto& [counts, page_faults] = value;
  each(counts), each(page_faults);
}

void each_member(Passed<ControlTimes> auto& value, auto& each) {
  auto& [controller, period, calls, median, p999, longest, longest_tick, histogram, costs] = value;
  each(controller), each(period), each(calls), each(median), each(p999), each(longest), each(longest_tick);
  each(histogram), each(costs);
}

void each_member(Passed<RunSummary> auto& value, auto& each) {
  auto& [ticks, channels, pictures, bytes, failure, end, trace_changed, refused, remarks, control_times] = value;
  each(ticks), each(channels), each(pictures), each(bytes), each(failure), each(end), each(trace_changed);
  each(refused), each(remarks), each(control_times);
}

void each_member(Passed<ResumedRun> auto& value, auto& each) {
  auto& [summary, from] = value;
  each(summary), each(from);
}

void each_member(Passed<PlantSummary> auto& value, auto& each) {
  auto& [ticks, restored, from_the_start, failure] = value;
  each(ticks), each(restored), each(from_the_start), each(failure);
}

void each_member(Passed<ReplayedWords> auto& value, auto& each) {
  auto& [lines, variables, different, first] = value;
  each(lines), each(variables), each(different), each(first);
}

/// Its members can't be bound, because it has a base with members.
void each_member(Passed<ReplayReport> auto& value, auto& each) {
  each(value.values), each(value.values_different), each(value.first), each(value.worst), each(value.beyond);
  each(value.largest), each(value.most_ulps);
  each(value.controllers), each(value.ticks), each(value.ticks_different), each(value.commands_hold);
  each(value.other_inputs), each(value.failure), each(value.words), each(value.explanation);
  each(value.controller_refused), each(value.other_controllers), each(value.changed_files);
  each(value.same_controllers), each(value.first_other_hash), each(value.repeats_the_run), each(value.remarks);
  each(value.control_times);
}

namespace {

/// Makes the run in a process of its own, and passes its result on.
template <class Outcome>
Result<Outcome> in_own_process(const std::function<Result<Outcome>()>& run) {
  if (!has_own_processes()) return run();
  const auto text = REHEARSE_TRY(call_in_own_process([&run] {
    const Result<Outcome> made = run();
    AnswerWriter form;
    form(made ? Diagnostics() : made.errors());
    if (made) form(*made);
    return form.text();
  }));
  AnswerReader form(text);
  Diagnostics errors;
  form(errors);
  if (!errors.empty()) return errors;
  Outcome outcome;
  form(outcome);
  if (!form.is_whole()) return error("the process of a run passed a damaged result");
  return outcome;
}

}  // namespace

Result<RunSummary> own_run(const std::function<Result<RunSummary>()>& run) { return in_own_process(run); }
Result<ResumedRun> own_run(const std::function<Result<ResumedRun>()>& run) { return in_own_process(run); }

Result<void> own_run(const std::function<Result<void>()>& run) {
  const auto made = in_own_process<bool>([&run]() -> Result<bool> {
    REHEARSE_TRY(run());
    return true;
  });
  return made ? Result<void>() : made.errors();
}

RunPlant own_plant(RunPlant run_plant) {
  if (!run_plant) return run_plant;
  return [run_plant = std::move(run_plant)](const Scenario& scenario, const Trace& recording,
                                            const std::filesystem::path& trace, const PlantOptions& options) {
    return in_own_process<PlantSummary>([&] { return run_plant(scenario, recording, trace, options); });
  };
}

Result<ReplayReport> own_replay(const std::filesystem::path& recording, const ReplayOptions& options) {
  return replay_by(recording, options, [](const auto& part) { return in_own_process<ReplayReport>(part); });
}

Result<std::vector<std::uint64_t>> replayed_outputs(const std::filesystem::path& recording, ReplayOptions options) {
  using Hashes = std::vector<std::uint64_t>;
  return in_own_process<Hashes>([&]() -> Result<Hashes> {
    Hashes hashes;
    options.on_outputs = [&hashes](std::int64_t, const std::vector<std::uint64_t>& row) {
      hashes.push_back(hash_bytes(row.data(), row.size() * sizeof(row[0])));
    };
    REHEARSE_TRY(replay(recording, options));
    return hashes;
  });
}

}  // namespace rehearse
