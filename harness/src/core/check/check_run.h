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

/// Records the scenario in a world that is proved to make the golden. `replayed`: the scenario's controllers on the
/// golden's inputs; the run is simulated only from a checkpoint before their first different command. Null: the whole
/// run is simulated.
Result<ResumedRun> make_run(const Scenario& scenario, const Trace& golden, const ReplayReport* replayed,
                            const std::filesystem::path& actual, const RecordOptions& options,
                            const Simulation& simulation);

/// Options for replays of any recording: the controllers of the present scenario, independent of those in the
/// recording.
HostOptions with_controllers_of(const Scenario& scenario, const HostOptions& given);

/// The options of a check's replays: controllers see this machine as it is, as in the closed loop. A file that is
/// missing here is missing there, too.
ReplayOptions as_here(const HostOptions& host);

/// True if this process computes like the one that recorded the golden.
bool computes_alike(const Scenario& scenario, const Trace& golden);

/// The result of level controller.
struct ControllerLevel {
  ReplayReport replay;  // judged by the scenario's tolerances
  LevelState state;
};

/// Feeds controllers with the golden's inputs. Their commands must have equal bits, unless the
/// arithmetic differs. Then a controller that calls sin() commands different last bits, and is judged within tolerance.
/// Results of control() may be early or late by a rule in either case.
Result<ControllerLevel> replay_golden(const Scenario& scenario, const Trace& golden, const HostOptions& host);

/// False: if the check is wrong, no level shows why.
bool any_level_differs(const CheckReport& report);

/// Tests whether a run repeats itself. The output of the world is written beside `file`, and removed.
Result<Reproduction> try_reproduction(const Scenario& scenario, const Trace& run, const std::filesystem::path& file,
                                      const HostOptions& host, const Simulation& simulation);

}  // namespace rehearse
