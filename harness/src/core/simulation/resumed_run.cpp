// record_from(): a closed loop whose first part is taken from a golden.
#include <rehearse/mcap.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "closed_loop.h"
#include "core/guard/float_mode.h"
#include "core/replay/copying_sink.h"
#include "core/replay/recording_source.h"
#include "core/trace/event_stream.h"
#include "led_world.h"
#include "recorded_checkpoints.h"

namespace rehearse {
namespace {

/// The latest checkpoint from which the world can be led to the moment; 0: the start.
Result<std::int64_t> checkpoint_before(std::int64_t moment, const RecordedCheckpoints& checkpoints,
                                       const Scenario& scenario) {
  const auto objection = REHEARSE_TRY(checkpoints.objection());
  return objection.empty() ? latest_checkpoint(checkpoints, scenario, moment) : 0;
}

/// None: the part before the moment can't be taken from the golden as it is.
Result<std::optional<RunSummary>> resume(const Scenario& scenario, const Trace& golden,
                                         RecordedCheckpoints& checkpoints, std::int64_t checkpoint, std::int64_t moment,
                                         const std::filesystem::path& trace, const RecordOptions& options) {
  auto reader = REHEARSE_TRY(mcap::Reader::open(golden.file()));
  ClosedLoop loop(scenario);
  REHEARSE_TRY(loop.create(trace, options));
  loop.initialize();
  loop.start();
  REHEARSE_TRY(loop.sink->record_events(loop.host->take_events()));
  auto led = REHEARSE_TRY(
      lead_world(scenario, golden, checkpoints, checkpoint, moment, *loop.plant, *loop.world, *loop.recorder));
  RecordingSource inputs(scenario, *reader, *loop.host, loop.altered);
  CopyingSink copy(scenario, *reader, *loop.host, *loop.recorder, loop.altered, &loop.summary.remarks);
  loop.run->change(inputs, copy, moment);
  REHEARSE_TRY(copy.copy(inputs, *loop.run, moment));
  if (loop.host->failure() || !copy.same_outputs() || inputs.recorded().state_hash != led.hash_before)
    return std::optional<RunSummary>();

  const auto interval = std::max<std::int64_t>(1, std::llround(options.checkpoint_period / scenario.time_step));
  auto summary = REHEARSE_TRY(loop.go_on(std::move(led.command), interval, options.progress));
  return std::optional<RunSummary>(std::move(summary));
}

/// Events of the world have their order among events of the controllers only in a run that is made.
bool has_events_of_world(const Trace& golden) {
  EventStream events(golden);
  while (const msg::Event* event = events.next())
    if (event->source == "world") return true;
  return false;
}

}  // namespace

Result<ResumedRun> record_from(const Scenario& scenario, const Trace& golden, std::int64_t moment,
                               const std::filesystem::path& trace, const RecordOptions& options) {
  const StandardFloatMode float_mode;
  RecordedCheckpoints checkpoints = checkpoints_before(golden, scenario, moment);
  const auto checkpoint = REHEARSE_TRY(checkpoint_before(moment, checkpoints, scenario));
  if (checkpoint > 0 && options.checkpoint_period > 0.0 && !has_events_of_world(golden)) {
    auto resumed = REHEARSE_TRY(resume(scenario, golden, checkpoints, checkpoint, moment, trace, options));
    if (resumed) return ResumedRun{*std::move(resumed), checkpoint};
  }
  auto whole = REHEARSE_TRY(record(scenario, trace, options));
  return ResumedRun{std::move(whole), 0};
}

}  // namespace rehearse
