// Expectations: what a scenario says has to be true of a run (`expect:`), judged on its recording.
//
// They need no golden: a run may be metres away from another one of the same chaotic scenario, and both be right. Every
// sample of the span counts, and NaN is in no bounds. What the recording lacks (a series, a sample, the time itself)
// does not hold, and is told with the nearest names.
#pragma once

#include <rehearse/divergence.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

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

}  // namespace rehearse
