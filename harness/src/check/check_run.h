// The runs of a check: makes them, feeds controllers with a golden's inputs, and tests whether a run repeats itself.
// Internal.
#pragma once

#include <rehearse/check.h>

#include <filesystem>
#include <optional>

namespace rehearse {

/// Records the scenario into `actual`, whose folder is made if there is none.
Result<RunSummary> make_run(const Scenario& scenario, const std::filesystem::path& actual, const RecordOptions& options,
                            const Simulation& simulation);

/// The same in a world that is known to make the golden. `replayed`: the scenario's controllers on the golden's inputs;
/// the run is simulated only from a checkpoint before their first other command. Null: nothing is known.
Result<ResumedRun> make_run(const Scenario& scenario, const Trace& golden, const ReplayReport* replayed,
                            const std::filesystem::path& actual, const RecordOptions& options,
                            const Simulation& simulation);

/// For replays of any recording: the controllers of the scenario as it is now, whatever the recording names.
HostOptions with_controllers_of(const Scenario& scenario, const HostOptions& given);

/// Feeds controllers with the golden's inputs, until that time [s]. Their commands have to be the same bits, unless the
/// arithmetic isn't: a controller that calls sin() then commands other last bits, and is judged within tolerance.
Result<ReplayReport> replay_golden(const Scenario& scenario, const Trace& golden, const HostOptions& host,
                                   std::optional<double> until = std::nullopt);
LevelState state_of(const ReplayReport& replayed);

/// Whether a run repeats itself; what the world does meanwhile is written beside it, and removed.
Result<Reproduction> try_reproduction(const Scenario& scenario, const Trace& run, const std::filesystem::path& file,
                                      const HostOptions& host, const Simulation& simulation);

}  // namespace rehearse
