// Check: a scenario against its golden, on several levels, so that the guilty part can be named.
//
// controller: the golden's inputs into the controllers, without physics; their commands have to be the same bits.
// plant: the golden's commands into the world, set back at each checkpoint; state, sensors and frames compared.
// closed: the whole run again, compared within the scenario's tolerances and up to its horizon; and what the scenario
// expects of a run, judged on all of it. A run that is within tolerance but not equal has to repeat itself.
//
// Nothing amplifies a difference on the first two levels for longer than from one checkpoint to the next, so they tell
// what changed: the controller, or the physics, the sensors, the renderer. This library does not simulate: whoever
// checks hands in a Simulation, the functions that make runs.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/expectation.h>
#include <rehearse/golden.h>
#include <rehearse/replay.h>
#include <rehearse/scenario.h>
#include <rehearse/simulation.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

enum class LevelState {
  equal,   // bit for bit
  within,  // tolerance
  differs,
  skipped,  // nobody asked, or there was nothing to compare
};

/// "equal", "within", "differs" or "skipped".
std::string_view to_string(LevelState state);

struct CheckOptions {
  bool controller = true;
  bool plant = true;
  bool closed = true;
  std::optional<double> estimated_horizon;  // of closed, if the scenario states none [s]
  RecordOptions run;                        // of all levels
};

struct CheckReport {
  LevelState controller = LevelState::skipped;
  LevelState plant = LevelState::skipped;
  LevelState closed = LevelState::skipped;
  std::string verdict;                   // one sentence, without a full stop; names the guilty part
  std::string message;                   // for a person: where the run's trace is, what to do next; may be empty
  std::optional<Divergence> first;       // on the level that tells most; none if all are equal
  std::optional<ReplayReport> replay;          // of level controller
  std::optional<PlantSummary> plant_run;       // of level plant
  std::optional<Comparison> plant_comparison;  // of level plant; the golden's commands are not compared
  std::optional<Comparison> comparison;        // of level closed
  std::optional<RunSummary> run;               // of level closed
  std::optional<double> horizon;               // of level closed [s]; none: the end of the run
  std::vector<ExpectationResult> expectations;  // of level closed
  std::string controller_problem;  // why the controllers couldn't be fed; empty: they could
  std::string plant_problem;       // why the world couldn't be moved by the golden's commands; empty: it could
  /// What the measured noise says of the tolerances (noise_floor.h). Sentences; they fail nothing.
  std::vector<std::string> remarks;
  bool golden_written = false;
  /// The closed loop is within tolerance, but other bits came of the same programs and files, or the run doesn't repeat
  /// itself (reproduction.h). It counts as different then.
  bool not_reproduced = false;

  bool equal() const;   // every level that was compared
  bool within() const;  // no level differs
};

/// Compares a scenario's behaviour now with a golden recording. The fresh trace is written to `actual`, that of the
/// plant level to `plant/` beside it; each is removed if it is within. Of a golden that was recorded from a log
/// (log_replay.h) the controller level is all there is. Fails if the golden can't be read or the run can't begin.
Result<CheckReport> check_scenario(const Scenario& scenario, const std::filesystem::path& golden,
                                   const std::filesystem::path& actual, const CheckOptions& options,
                                   const Simulation& simulation);

/// The same with the golden that the scenario names, and with that golden's life: a missing one fails, or is written,
/// as the mode says; a run that differs waits in the store's pending folder, or replaces the golden. A run that isn't
/// as its scenario expects becomes no golden. A scenario that names no golden is checked by its expectations alone.
Result<CheckReport> check_golden(const Scenario& scenario, GoldenStore& store, GoldenMode mode,
                                 const CheckOptions& options, const Simulation& simulation);

/// An object with verdict, equal, within, not_reproduced, levels (controller, plant, closed), first, as in compare.h, and comparisons
/// (plant, closed: null, or as to_json(Comparison)); horizon (null or [s]); expectations: for each its text, line,
/// whether it holds, and first: null, or series, tick, time and value; remarks.
std::string to_json(const CheckReport& report);

}  // namespace rehearse
