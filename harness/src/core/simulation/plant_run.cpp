#include <fmt/format.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/clock.h"
#include "core/compare/scenario_changes.h"
#include "core/guard/float_mode.h"
#include "core/recording/provenance.h"
#include "core/recording/recorder.h"
#include "core/run/recording_sink.h"
#include "core/trace/trace_windows.h"
#include "world_source.h"

namespace rehearse {
namespace {

/// The last tick with a recorded state.
std::int64_t last_tick_of(const Trace& recording, double time_step) {
  const TraceChannel* ticks = recording.find_channel(run_topics::tick);
  if (!ticks) return -1;
  const auto at = static_cast<std::size_t>(ticks - recording.channels().data());
  std::optional<std::uint64_t> last;
  for_each_window(recording, {at}, [&](const Trace& window) {
    const std::vector<std::uint64_t>& times = window.channels()[at].times;
    if (!times.empty()) last = times.back();
    return true;
  });
  return last ? std::llround(static_cast<double>(*last) * 1e-9 / time_step) : -1;
}

/// A world that is set back to the recorded state before each step from a tick with a checkpoint.
class SetBackWorld final : public WorldSource {
 public:
  SetBackWorld(const Scenario& scenario, Plant& plant, RecordedCheckpoints& checkpoints, const PlantOptions& options,
               PlantSummary& summary)
      : WorldSource(scenario, plant), plant_(plant), checkpoints_(checkpoints), options_(options), summary_(summary) {}

  Result<bool> advance(TickData& now, Commander& commands) override {
    if (options_.resync && summary_.from_the_start.empty()) REHEARSE_TRY(set_back(now.tick));
    return WorldSource::advance(now, commands);
  }

 private:
  Result<void> set_back(std::int64_t tick) {
    const auto restored = REHEARSE_TRY(checkpoints_.restore(tick, plant_.world()));
    if (!restored) return {};
    ++summary_.restored;
    if (options_.nudge) plant_.world().nudge(*options_.nudge + static_cast<std::uint32_t>(tick));
    return {};
  }

  Plant& plant_;
  RecordedCheckpoints& checkpoints_;
  const PlantOptions& options_;
  PlantSummary& summary_;
};

/// Makes the run from its first tick to the state after its last.
Result<void> go(Run& run, std::int64_t last, PlantSummary& summary) {
  const std::int64_t from = run.tick();
  if (from > last) return {};
  REHEARSE_TRY(run.go());
  if (run.interruption()) return *run.interruption();
  summary.ticks = run.tick() - from;
  if (!run.broke_down()) return run.close();
  --summary.ticks;  // the last one has no state after it
  summary.failure = error(fmt::format("the simulation exploded in the step after tick {}", run.tick() - 1));
  return {};
}

}  // namespace

Result<PlantSummary> run_plant(const Scenario& scenario, const Trace& recording, const std::filesystem::path& trace,
                               const PlantOptions& options) {
  const StandardFloatMode float_mode;
  if (const auto change = changed_time_step(scenario, recording))
    return error_in(recording.file(),
                    fmt::format("its time step is {} s, and that of {} is {} s: no tick of it can be repeated",
                                change->expected, scenario.name, change->actual));
  auto commands = REHEARSE_TRY(RecordedCommands::find(scenario, recording));
  auto plant = REHEARSE_TRY(Plant::create(scenario, options.noise_of));
  auto recorder = REHEARSE_TRY(Recorder::create(
      trace, scenario, provenance(scenario, nullptr, World::engine_description(), plant->renderer_description())));
  recorder->declare(nullptr);
  PlantSummary summary;
  RecordedCheckpoints checkpoints(recording, scenario);
  summary.from_the_start = REHEARSE_TRY(checkpoints.objection());

  const std::int64_t end = last_tick_of(recording, scenario.time_step);
  const std::int64_t last = std::min(end, options.until.value_or(end));
  SetBackWorld world(scenario, *plant, checkpoints, options, summary);
  RecordingSink sink(*recorder);
  if (options.from > 0) sink.take_contacts_for_known(options.from + 2);
  Run run(scenario.time_step, world, commands, sink, options.from, last);
  run.report_progress(options.progress, last - options.from);
  const auto begun = REHEARSE_TRY(begin_at_checkpoint(options.from, *plant, checkpoints, commands, run.command));
  if (!begun) return error(fmt::format("the recording has no checkpoint at tick {}", options.from));
  summary.restored = options.from > 0 ? 1 : 0;
  if (options.from == 0 && options.nudge) plant->world().nudge(*options.nudge);
  if (end < 0) return error_in(recording.file(), "it has no ticks: nothing of the run was recorded");
  REHEARSE_TRY(go(run, last, summary));

  RunOutcome outcome{.ticks = summary.ticks, .complete = !summary.failure};
  if (summary.failure) outcome.failure = summary.failure->message;
  REHEARSE_TRY(recorder->close(outcome));
  return summary;
}

}  // namespace rehearse
