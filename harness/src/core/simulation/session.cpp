#include <rehearse/session.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "closed_loop.h"
#include "core/guard/float_mode.h"
#include "core/recording/initial_commands.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

/// Records the world's remarks on its bodies as events of the run.
Result<void> record_remarks(ClosedLoop& loop) {
  std::vector<msg::Event> events;
  for (const Diagnostic& remark : loop.plant->world().remarks()) {
    msg::Event& event = events.emplace_back();
    event.severity = to_string(remark.severity);
    event.source = "world";
    event.text = remark.message;
  }
  return loop.sink->record_events(events);
}

}  // namespace

Session::Session(std::unique_ptr<ClosedLoop> loop) : loop_(std::move(loop)) {}
Session::~Session() = default;
std::int64_t Session::tick() const { return loop_->plant->tick(); }
Result<bool> Session::step() { return loop_->step(); }
Result<RunSummary> Session::finish() { return loop_->finish(); }

Result<std::unique_ptr<Session>> Session::create(const Scenario& scenario, const std::filesystem::path& trace,
                                                 const RecordOptions& options) {
  const StandardFloatMode float_mode;
  auto loop = std::make_unique<ClosedLoop>(scenario);
  loop->summary.remarks = float_mode.remarks();
  REHEARSE_TRY(loop->create(trace, options));
  if (options.nudge) loop->plant->world().nudge(*options.nudge);
  if (options.checkpoint_period > 0.0)
    loop->world->save_checkpoints(
        std::max<std::int64_t>(1, std::llround(options.checkpoint_period / scenario.time_step)));
  loop->run->report_progress(options.progress, scenario.ticks());
  loop->initialize();
  loop->plant->obey(-1, loop->run->command);
  loop->host->read_back();
  if (scenario.initial_commands)
    REHEARSE_TRY(loop->recorder->add_metadata(records::initial_commands,
                                              metadata_of_initial_commands(scenario, loop->run->command)));
  loop->start();
  REHEARSE_TRY(record_remarks(*loop));
  REHEARSE_TRY(loop->sink->record_events(loop->host->take_events()));
  return std::unique_ptr<Session>(new Session(std::move(loop)));
}

Result<RunSummary> record(const Scenario& scenario, const std::filesystem::path& trace, const RecordOptions& options) {
  auto session = REHEARSE_TRY(Session::create(scenario, trace, options));
  for (;;) {
    const bool going_on = REHEARSE_TRY(session->step());
    if (!going_on) return session->finish();
  }
}

}  // namespace rehearse
