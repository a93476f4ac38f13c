#include "own_run.h"

#include <set>
#include <string>
#include <utility>

#include "core/guard/answer.h"
#include "core/guard/own_process.h"
#include "core/mcap/hashing.h"
#include "core/replay/replay_recording.h"

namespace rehearse {

// The members of results. A member that is missing here is lost between two processes.

void each_member(Passed<Diagnostic> auto& value, auto& each) {
  each(value.severity), each(value.file), each(value.line), each(value.column), each(value.message), each(value.hint);
}

void each_member(Passed<Divergence> auto& value, auto& each) {
  each(value.tick), each(value.time), each(value.channel), each(value.element), each(value.expected);
  each(value.actual), each(value.difference), each(value.ulps), each(value.tolerance);
  each(value.distance_from_envelope), each(value.unit), each(value.note), each(value.stage);
}

void each_member(const ControlCosts::Count& value, AnswerWriter& each) {
  each(value.name), each(value.total), each(value.ticks), each(value.first_tick);
}

/// Names of counts are constants of the program.
void each_member(ControlCosts::Count& value, AnswerReader& each) {
  static auto& names = *new std::set<std::string>;
  std::string name;
  each(name), each(value.total), each(value.ticks), each(value.first_tick);
  value.name = *names.insert(std::move(name)).first;
}

void each_member(Passed<ControlCosts> auto& value, auto& each) { each(value.counts), each(value.page_faults); }

void each_member(Passed<ControlTimes> auto& value, auto& each) {
  each(value.controller), each(value.period), each(value.calls), each(value.median), each(value.p999);
  each(value.longest), each(value.longest_tick), each(value.histogram), each(value.costs);
}

void each_member(Passed<RunSummary> auto& value, auto& each) {
  each(value.ticks), each(value.channels), each(value.pictures), each(value.bytes), each(value.failure);
  each(value.end), each(value.trace_changed), each(value.controller_refused), each(value.remarks);
  each(value.control_times);
}

void each_member(Passed<ResumedRun> auto& value, auto& each) { each(value.summary), each(value.from); }

void each_member(Passed<ReplayedWords> auto& value, auto& each) {
  each(value.lines), each(value.variables), each(value.different), each(value.first);
}

void each_member(Passed<ReplayReport> auto& value, auto& each) {
  each(value.values), each(value.values_different), each(value.first), each(value.worst), each(value.beyond);
  each(value.controllers), each(value.ticks), each(value.ticks_different), each(value.same_commands);
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
  const auto text = call_in_own_process([&run] {
    const Result<Outcome> made = run();
    AnswerWriter form;
    form(made ? Diagnostics() : made.errors());
    if (made) form(*made);
    return form.text();
  });
  if (!text) return text.errors();
  AnswerReader form(*text);
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
    if (auto replayed = replay(recording, options); !replayed) return replayed.errors();
    return hashes;
  });
}

}  // namespace rehearse
