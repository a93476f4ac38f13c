// What the replays of an audit say of one controller: which changes changed its commands, and why.
#pragma once

#include <rehearse/audit.h>

#include <string>
#include <utility>
#include <vector>

#include "experiments.h"
#include "library_scan.h"
#include "replay_process.h"

namespace rehearse {

/// All that was run.
struct Evidence {
  ReplayOutcome plain, still;
  std::vector<Experiment> experiments;
  std::vector<std::vector<ReplayOutcome>> outcomes;  // by experiment
  double time_step = 0.0;                            // [s]
  bool recorded_here = false;                        // the recording was made for this audit, by these controllers
  bool virtualised = false;                          // time and random numbers are given
  bool fixed_addresses = true;                       // they could be held still
};

/// The calls of one controller, or of all if it is empty, each once, that the plain and the still replay made.
std::vector<ObservedCall> calls_of(const Evidence& evidence, const std::string& controller);

/// What replays differ in, of one controller. A failure in one of two differs too.
std::optional<Divergence> difference(const ReplayPass& expected, const ReplayPass& actual, double time_step,
                                     const std::string& controller);

/// Finds which factors change the controller's outputs.
std::vector<FactorResult> judge_factors(const Evidence& evidence, const std::string& controller);

/// Whether the still replay, made again, gave the same.
bool is_repeatable(const Evidence& evidence, const std::string& controller);

const FactorResult* find_factor(const std::vector<FactorResult>& factors, Factor factor);

/// The call with what was found of it, before it is known what it reached.
AuditedCall describe(const ObservedCall& call, const Evidence& evidence);

/// Sets whether what calls were answered reached an output. `tried`: calls that were answered otherwise one by one,
/// with what came of it. The audit's calls are in the order of `seen`.
void judge_calls(const Evidence& evidence, const std::vector<ObservedCall>& seen, ControllerAudit& audit,
                 const std::vector<std::pair<CodePlace, bool>>& tried);

/// What was the same in all replays and has an answer; and what of the code depends on the processor.
std::vector<std::string> what_it_rests_on(const Evidence& evidence, const std::vector<ObservedCall>& seen,
                                          const ControllerAudit& audit);

/// Sets deterministic, reason, depends_on and first, from all the rest.
void conclude(const Evidence& evidence, const std::vector<ObservedCall>& seen, ControllerAudit& audit);

/// A sentence for each thing that a controller did to the process it ran in.
std::vector<std::string> liberties_of(const std::vector<ObservedCall>& calls);

}  // namespace rehearse
