#include "own_run.h"

#include <string>
#include <utility>

#include "base/hashing.h"
#include "core/compare/difference_answer.h"
#include "core/guard/own_process.h"
#include "core/host/control_times_answer.h"
#include "core/replay/replay_recording.h"

namespace rehearse {

// The members of results are bound, as in core/guard/answer.h.

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
  each_difference(value, each);
  each(value.controllers), each(value.ticks), each(value.ticks_different), each(value.commands_hold);
  each(value.other_inputs), each(value.failure), each(value.words), each(value.explanation);
  each(value.other_mathematics);
  each(value.controller_refused), each(value.other_controllers), each(value.changed_files);
  each(value.same_controllers), each(value.first_other_hash), each(value.repeats_the_run), each(value.remarks);
  each(value.control_times);
}

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
