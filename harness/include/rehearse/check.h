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
#include <rehearse/diagnostic.h>
#include <rehearse/golden.h>
#include <rehearse/host_options.h>
#include <rehearse/replay.h>
#include <rehearse/scenario.h>
#include <rehearse/simulation.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

// Expectations: what a scenario says has to be true of a run (`expect:`), judged on its recording.
//
// They need no golden: a run may be metres away from another one of the same chaotic scenario, and both be right. Every
// sample of the span counts, and NaN is in no bounds. What the recording lacks (a series, a sample, the time itself)
// does not hold, and is told with the nearest names.

/// A sample that is out of the bounds, or an event that should not have happened.
struct ViolatingSample {
  std::int64_t tick = 0;
  double time = 0.0;            // of the sample [s]
  std::optional<double> value;  // what was bounded: of a series, its magnitude or its change; none: an event
};

/// What became of one expectation.
struct ExpectationResult {
  Expectation expectation;
  std::string text;  // "SR1/WAIST/position/z above 0.6 m from 2 s on"
  bool holds = false;
  std::string sentence;                  // "expected TEXT: 0.41 m at tick 3120 (3.12 s)"; empty if it holds
  std::string series;                    // the one of the first sample that violates; empty: none, or an event
  std::optional<ViolatingSample> first;  // none if it is a matter of no sample
  std::optional<ViolatingSample> worst;  // of the same series; with `sometime` the nearest to the bounds
};

/// One result for each expectation, in their order.
std::vector<ExpectationResult> judge_expectations(const std::vector<Expectation>& expectations, const Trace& run);

/// The same of a recording that need not fit into the memory; it is read in pieces (Trace::load_in_pieces). Fails if it
/// can't be read.
Result<std::vector<ExpectationResult>> judge_expectations(const std::vector<Expectation>& expectations,
                                                          const std::filesystem::path& recording,
                                                          std::size_t piece_size = Trace::usual_piece_size);

/// The one that is known first to be violated; one that is a matter of no single sample only if there is no other.
/// Null: all hold.
const ExpectationResult* first_violation(const std::vector<ExpectationResult>& results);

/// A violation as a place in the run, with its sentence as note; without a sample it is the end of the run.
Divergence divergence_of(const ExpectationResult& violation, const Trace& run);

/// "all 3 expectations hold", or the sentence of the first violation, and how many others there are. Empty without any.
std::string verdict(const std::vector<ExpectationResult>& results);

/// What is violated, each with its place in the scenario, a line each, each after a newline; empty if all hold.
std::string violation_lines(const std::vector<ExpectationResult>& results);

/// Up to when a whole run's values are compared with its golden's [s]: as the scenario says, else as was estimated,
/// else (nullopt) to the end.
std::optional<double> horizon_of(const Scenario& scenario, std::optional<double> estimated = std::nullopt);

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
  /// What the measured noise says of the tolerances (`rehearse golden noise`). Sentences; they fail nothing.
  std::vector<std::string> remarks;
  bool golden_written = false;
  /// The closed loop is within tolerance, but other bits came of the same programs and files, or the run doesn't repeat
  /// itself (reproduce). It counts as different then.
  bool not_reproduced = false;

  bool equal() const;   // every level that was compared
  bool within() const;  // no level differs
};

/// Compares a scenario's behaviour now with a golden recording. The fresh trace is written to `actual`, that of the
/// plant level to `plant/` beside it; each is removed if it is within. Of a golden that was recorded from a
/// robot's log the controller level is all there is. Fails if the golden can't be read or the run can't begin.
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

// Reproduction: whether a recording repeats itself, here and now. Neither its golden nor tolerances have a say: bits.
//
// The controllers are fed with its inputs again, from the first tick to the last, and have to give its commands. From
// some of its checkpoints the world goes on under its commands, each time until the next checkpoint, and has to give
// the same state, sensors and pictures. So a recording of ten minutes is tried in seconds. What a controller reads
// beside its inputs may still be the same by accident; `rehearse audit` goes to the bottom of that.

struct ReproductionOptions : HostOptions {
  int spans =
      5;  // of simulation, from one checkpoint to the next, evenly over the recording; the first and last included
  /// Called about every hundredth with what is done and all of it; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

struct Reproduction {
  std::string verdict;                // one sentence, without a full stop
  std::optional<Divergence> first;    // of what came out otherwise: a command, or else what the world did
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung, or the simulation exploded
  std::int64_t replayed = 0;          // ticks whose commands were repeated
  std::int64_t simulated = 0;         // ticks of simulation
  int spans = 0;

  bool reproduced() const { return !first && !failure; }
};

/// Tries a recording of this scenario as it is now. What the world does meanwhile is written to `scratch` and removed.
/// Of a recording without usable checkpoints the whole simulation is run again. Fails if a run can't begin.
Result<Reproduction> reproduce(const Scenario& scenario, const Trace& recording, const std::filesystem::path& scratch,
                               const ReproductionOptions& options, const Simulation& simulation);

/// The first place, in the order of time, where `part` says something that `whole` doesn't say at that time, bit for
/// bit. What only `whole` says is not asked; nor are hashes of inputs and outputs, which a run without controllers
/// lacks.
Result<std::optional<Divergence>> first_not_in(const Trace& whole, const Trace& part);

}  // namespace rehearse
