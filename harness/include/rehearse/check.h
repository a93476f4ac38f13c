// Check: compares a scenario with its golden on several levels, so that the verdict can name the faulty part.
//
// controller: the golden's inputs are fed to the controllers, without physics; their commands must have equal bits.
// plant: the golden's commands move the world, which is set back at each checkpoint; state, sensors and frames are
// compared.
// closed: the whole run is repeated and compared within the scenario's tolerances and up to its horizon. The scenario's
// expectations are judged on the whole run. A run that is within tolerance but not equal must be reproducible.
//
// If the golden states another physics engine or an earlier solver, and the world differs, the last two levels are not
// compared: the change is the engine's.
//
// On the first two levels no difference grows for longer than from one checkpoint to the next. So these levels show
// which part has changed: the controller, the physics, the sensors or the renderer. This library does not simulate: the
// caller passes a Simulation, which has the functions that make runs.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/golden.h>
#include <rehearse/replay.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>
#include <rehearse/verdict.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

// Expectations: properties that a scenario demands of a run (`expect:`), judged on its recording.
//
// They need no golden: two runs of a chaotic scenario may be metres apart, and both may be right. Every sample of the
// span counts, and NaN violates every bound. A span begins with the first sample of the series; a series without a
// sample isn't judged. An expectation of which nothing was judged, or whose time the run lacks, is undecided. If the
// recording lacks the series itself, the expectation does not hold, and the sentence lists the nearest names.

/// A sample that is out of the bounds, or an event that should not have happened.
struct ViolatingSample {
  std::int64_t tick = 0;
  double time = 0.0;  // of the sample [s]
  /// The bounded number: the value of a series, its magnitude or its change; none: an event.
  std::optional<double> value;
};

/// The place at which a run was closest to the violation of an expectation, or farthest beyond the bound.
struct ClosestPlace {
  double margin = 0.0;  // distance from the violation, in `unit`; below 0: violated
  double value = 0.0;   // what is compared
  double bound = 0.0;   // with this
  std::string unit;     // as recordings have it: "rad"; empty: unknown
  std::string text;     // "6.8 of 8 deg"
  std::int64_t tick = 0;
  double time = 0.0;            // [s]
  std::optional<double> share;  // the margin over the bound's magnitude; none: the bound is 0
};

/// The result of one expectation.
struct ExpectationResult {
  Expectation expectation;
  std::string text;     // "SR1/WAIST/position/z above 0.6 m from 2 s on"
  std::string formula;  // the same in the language of expressions: "always SR1/WAIST/position/z > 0.6"
  bool holds = false;
  bool undecided = false;                // the run lacks ticks or samples that would decide it; then not `holds`
  std::string sentence;                  // "expected TEXT: 0.41 m at tick 3120 (3.12 s)"; empty if it holds
  std::vector<std::string> not_judged;   // series that exist and have no sample in the span
  std::string series;                    // the series of the first violating sample; empty: no series, or an event
  std::optional<ViolatingSample> first;  // none if no single sample violates it
  /// Worst sample of the same series; with `sometime` the sample nearest to the bounds.
  std::optional<ViolatingSample> worst;
  /// Distance from a violation, the robustness of signal temporal logic: of the worst sample of all series from the
  /// nearest bound, in their unit; with `sometime` of the best sample. Below 0: violated; 0: either. None: nothing was
  /// compared, or it is undecided.
  std::optional<double> margin;
  std::optional<ClosestPlace> closest;  // of that margin
  /// A mistake in the expression that only a recording shows: a name that it lacks, or units that differ.
  std::optional<Diagnostic> problem;
};

/// "closest: 6.8 of 8 deg at tick 1607 (3.214 s), 15 % of the bound left"; empty without a margin.
std::string closest_text(const ExpectationResult& result);
/// The same of the expectation with the smallest share of its bound left, with its text if there are others: "closest:
/// 6.8 of 8 deg ...: always abs(SR1/WAIST/pitch) < 8 deg". Empty if one is violated, or none has a margin.
std::string closest_of(const std::vector<ExpectationResult>& results);
/// A line for each expectation that has a margin: the line above and its text, indented by two blanks.
std::string closest_lines(const std::vector<ExpectationResult>& results);

/// One result for each expectation, in their order.
std::vector<ExpectationResult> judge_expectations(const std::vector<Expectation>& expectations, const Trace& run);

/// The results for a recording that may be larger than the memory; it is read in pieces (Trace::load_in_pieces), and of
/// it the channels whose series may match. Fails if the recording can't be read.
Result<std::vector<ExpectationResult>> judge_expectations(const std::vector<Expectation>& expectations,
                                                          const std::filesystem::path& recording,
                                                          std::size_t piece_size = Trace::usual_piece_size);

/// A recording's expectations, and one number that identifies its messages.
struct JudgedRecording {
  std::vector<ExpectationResult> expectations;
  std::uint64_t content = 0;  // hash of topics, times and bytes of all messages
};

/// Reads the recording once, in pieces.
Result<JudgedRecording> judge_recording(const std::vector<Expectation>& expectations,
                                        const std::filesystem::path& recording);

/// The violation with the earliest known time. A violation without a sample is returned only if there is no other, and
/// an undecided expectation only if none is violated. Null: all hold.
const ExpectationResult* first_violation(const std::vector<ExpectationResult>& results);

/// A violation as a place in the run, with its sentence as note. For a violation without a sample the place is the end
/// of the run.
Divergence divergence_of(const ExpectationResult& violation, const Trace& run);

/// "all 3 expectations hold", or the sentence of the first violation and the number of others. Empty without
/// expectations.
std::string verdict(const std::vector<ExpectationResult>& results);

/// The violations with their places in the scenario, a line each, each after a newline; empty if all hold.
std::string violation_lines(const std::vector<ExpectationResult>& results);

/// The time up to which the values of a run are compared with its golden [s]: the scenario's horizon, else the
/// estimated one, else the end of the run (nullopt).
std::optional<double> horizon_of(const Scenario& scenario, std::optional<double> estimated = std::nullopt);

enum class LevelState {
  equal,   // bit for bit
  proved,  // equal bit for bit, which is known without a simulation
  within,  // different bits, within tolerance
  differs,
  not_compared,  // not requested, or there was nothing to compare
  no_golden,     // there is no golden yet
};

/// "equal", "proved", "within", "differs", "not compared" or "no golden".
std::string_view to_string(LevelState state);

struct CheckOptions {
  bool controller = true;
  bool plant = true;
  bool closed = true;
  std::optional<double> estimated_horizon;  // horizon of level closed if the scenario states none [s]
  /// The folder of certificates: statements of checks that simulated a golden and got its bits. With them, levels are
  /// proved instead of simulated. The scenario must be as Scenario::load made it. None: all levels are simulated.
  std::optional<std::filesystem::path> certificates;
  int sampled = 0;    // share of the proved checks that are simulated, too, chosen by name and day [%]
  RecordOptions run;  // options for the runs of all levels
};

// Proof: levels that need no simulation.
//
// If a check has simulated a golden and got all of its bits, it stores a certificate: this world makes this golden. The
// certificate contains all facts on which the world's bits depend (session.h: describe_plant). As long as none of them
// changes, level plant is proved. If the controllers, fed with the golden's inputs, also repeat the golden bit for bit,
// level closed is proved by induction over the ticks. In all other cases the levels are simulated.

/// How checks use proofs.
struct ProofMode {
  bool on = true;
  int sampled = 0;  // as CheckOptions::sampled
};

/// The mode of REHEARSE_PROOF: on (the default), off, or sample:PERCENT. Any other word is an error.
Result<ProofMode> proof_mode();

/// True if the check of that name is among these percent of today's checks.
Result<bool> is_sampled(const std::string& name, int percent);

struct CheckReport {
  LevelState controller = LevelState::not_compared;
  LevelState plant = LevelState::not_compared;
  LevelState closed = LevelState::not_compared;
  Verdict verdict;                        // names the faulty part
  std::string message;                    // for a person: the run's trace file, the next step; may be empty
  std::optional<Divergence> first;        // on the level that is most specific; none if all are equal
  std::optional<Divergence> first_bit;    // in any bit, of the same part; none: not known, or not apart from `first`
  std::optional<ReplayReport> replay;     // of level controller
  std::optional<PlantSummary> plant_run;  // of level plant
  std::optional<Comparison> plant_comparison;   // of level plant; the golden's commands are not compared
  std::optional<Comparison> comparison;         // of level closed
  std::optional<RunSummary> run;                // of level closed
  std::optional<double> horizon;                // of level closed [s]; none: the end of the run
  std::vector<ExpectationResult> expectations;  // of level closed
  /// Level plant was not requested, and was compared up to this tick to find the part that changed. None: as a whole.
  std::optional<std::int64_t> plant_until;
  std::string controller_problem;  // why the controllers couldn't be fed; empty: they could
  std::string plant_problem;       // why the world couldn't be moved by the golden's commands; empty: it could
  /// The golden's physics engine and the present one, if they differ and so does the world. Then the levels plant and
  /// closed are not compared, and the check counts as different. A sentence; empty: the engine is the golden's.
  std::string other_physics;
  /// Remarks on the tolerances from the measured noise (`rehearse golden noise`). Sentences; they fail nothing.
  std::vector<std::string> remarks;
  bool golden_written = false;
  bool proved = false;  // nothing was simulated
  /// The first tick of the closed loop that was simulated; the ticks before it are proved. None: none was simulated.
  std::optional<std::int64_t> simulated_from;
  std::string not_proved;  // a sentence: why something was simulated; empty if nothing was, or if no proof was wanted
  /// The closed loop is within tolerance, but equal programs and files gave different bits, or the run doesn't repeat
  /// itself (reproduce). The check then counts as different.
  bool not_reproduced = false;
  /// The scenario's time step or duration isn't the golden's. The check then counts as different.
  bool other_duration = false;
  /// A proved check was also simulated, with another result. It then counts as different.
  bool proof_was_wrong = false;

  bool equal() const;   // within(), and every compared level is equal
  bool within() const;  // no level differs, and run_is_wrong() is false
  /// The run of level closed differs, has no golden, violates an expectation, or isn't certain.
  bool run_is_wrong() const;
  /// Nothing is known to be wrong, and an expectation is undecided; then not within().
  bool undecided() const;
  bool failed() const;  // a controller failed or refused to take part, or the simulation exploded
};

/// "controller: equal; plant: equal up to tick 512; closed: differs"
std::string levels_text(const CheckReport& report);

/// The differences of the levels plant and closed as tables (compare.h), each below a line with its level; of the plant
/// only if it differs. Empty without a difference.
std::string tables_text(const CheckReport& report);

/// "its bits differ from tick 0 on", if that is before the first difference beyond tolerance; else empty.
std::string bits_sentence(const CheckReport& report);

/// Compares the present behaviour of a scenario with a golden recording. The fresh trace is written to `actual`, the
/// trace of the plant level to `plant/` beside it. Each is removed if it is within tolerance. A golden that was
/// recorded from a robot's log is compared on the controller level only. Fails if the golden can't be read or the run
/// can't begin.
Result<CheckReport> check_scenario(const Scenario& scenario, const std::filesystem::path& golden,
                                   const std::filesystem::path& actual, const CheckOptions& options,
                                   const Simulation& simulation);

/// Compares with the golden that the scenario names, in this store. A golden that is missing fails, or is written, as
/// `mode` states. A run that differs is kept in the store's pending folder, or replaces the golden. A run that violates
/// an expectation of its scenario becomes no golden. A scenario that names no golden is checked by its expectations
/// alone.
Result<CheckReport> check_golden(const Scenario& scenario, GoldenStore& store, GoldenMode mode,
                                 const CheckOptions& options, const Simulation& simulation);

/// A JSON object with verdict, code (of its first part), codes, equal, within, not_reproduced, proved, simulated_from
/// (null or a tick), not_proved (null or a sentence), levels (controller, plant, closed), first (as in compare.h) and
/// comparisons (controller: null, or the numbers of the replay, which are of the golden's inputs; plant, closed: null,
/// or as to_json(Comparison)). Further members: horizon (null or [s]), expectations
/// and remarks. Each expectation has its text, line, whether it holds, and first: null, or series, tick, time and
/// value.
std::string to_json(const CheckReport& report);

// Reproduction: whether a recording repeats itself here and now, bit for bit. Goldens and tolerances play no part.
//
// The recording's inputs are fed to the controllers again, from the first tick to the last; the commands must be equal
// to the recorded ones. From some of its checkpoints the world runs on under the recorded commands, until the next
// checkpoint. State, sensors and pictures must be equal to the recorded ones. So a recording of ten minutes is tested
// in seconds. Other data that a controller reads may still be equal by accident; `rehearse audit` examines that.

struct ReproductionOptions : HostOptions {
  /// Number of spans to simulate, each from one checkpoint to the next, evenly distributed over the recording; the
  /// first and the last one are included.
  int spans = 5;
  /// Called about every hundredth with the amount done and the total; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

struct Reproduction {
  std::string verdict;                // one sentence, without a full stop
  std::optional<Divergence> first;    // the first value that differs: a command, or else a value of the world
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung, or the simulation exploded
  std::int64_t replayed = 0;          // ticks with equal commands
  std::int64_t simulated = 0;         // ticks of simulation
  int spans = 0;

  bool reproduced() const { return !first && !failure; }
};

/// Tests a recording of this scenario in its present form. The output of the world is written to `scratch` and removed.
/// If the recording has no usable checkpoint, the whole simulation is repeated. Fails if a run can't begin.
Result<Reproduction> reproduce(const Scenario& scenario, const Trace& recording, const std::filesystem::path& scratch,
                               const ReproductionOptions& options, const Simulation& simulation);

}  // namespace rehearse
